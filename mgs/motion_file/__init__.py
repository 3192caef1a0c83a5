"""Motion files: a `Motion` as an MCAP file for robot viewers, `ros2 bag play` and mgs itself.

Layout of a file (MCAP specification: mcap.dev/spec):

- Profile `ros2`: messages in CDR, schemas in the form `ros2msg`, the quality of service of each
  topic in the metadata of its channel. Chunks are compressed by zstd; a chunk holds the messages of
  all topics in a span of time. Data section, summary, chunks and attachments have checksums.
- The library in the header is `mgs VERSION`.
- Metadata record `mgs`: version of mgs, version of this format, names of gait and robot, origin and
  parameters of the IK solver and the CoM generator, sampling period, number of samples, duration,
  mass, footsteps and scene; numbers and lists as JSON.
- Attachments gait.yaml, robot.yaml and robot.urdf: with them a file is complete in itself.
- Sample k has log time, publish time and header stamp 1 s + k dt. Only the stamp of
  /joint_trajectory is 0, which asks a controller to start at once.
- The same motion gives the same bytes.

Topics with one message per sample; frame `world` unless another is named:

    /joint_states           joint angles [rad], velocities [rad/s] and, as effort, torques [N m]
    /joint_commands         commanded joint angles [rad] (mgs.motion.servo_commands), if robot.yaml
                            gives the stiffness of the servos; ignored when a file is read
    /tf                     poses of the base in `world` and of each moving link in its parent
    /base_twist             velocity of the base in its own frame [m/s], [rad/s]
    /com, /com_reference    centre of mass [m]: as reached by the joints, and as planned
    /zmp, /zmp_reference    ZMP [m] of the whole robot, and as planned; z = 0
    /sole/left, /sole/right, /sole/left_reference, /sole/right_reference
                            poses of the soles, reached and planned
    /hand/left, /hand/right, /hand/left_reference, /hand/right_reference
                            poses of the hands; planned hands have no orientation, theirs is the
                            identity quaternion
    /torso                  pose of the torso
    /torso_reference        planned orientation of the torso
    /support                `double`, `left` or `right`

Topics with a single message, at 1 s:

    /robot_description      URDF
    /tf_static              poses of the links that are fixed to others
    /footsteps              soles on the ground, as boxes
    /joint_trajectory       joint angles, velocities and accelerations of all samples, for
                            ros2_control; the first and the last velocity are 0
    /com_path, /zmp_path    paths of CoM and ZMP; of a long motion 4000 points of them
    /scene                  boxes and balls on the ground
    /soles                  soles as boxes in the frames of the feet, which move with /tf

The last four are for viewers alone; a file without them is read too.

Files that another program rewrote are read too: with chunks of any size or none, compressed by zstd
or lz4 or not at all, with messages in any order, and without summary, indexes or statistics. A
checksum of 0 is not compared: it means that the program computed none.
"""

from typing import TYPE_CHECKING

from mgs.motion_file.write import motion_bytes, write_motion

if TYPE_CHECKING:
    from mgs.motion_file.read import read_info, read_motion

__all__ = ["motion_bytes", "read_info", "read_motion", "write_motion"]


def __getattr__(name: str) -> object:
    """Import the functions that read when they are first used (PEP 562).

    A command that only writes takes 4 % less CPU time without them.
    """
    if name in ("read_info", "read_motion"):
        from mgs.motion_file import read

        return getattr(read, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
