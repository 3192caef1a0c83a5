"""Motion files: a `Motion` as an MCAP file that robot viewers, `ros2 bag play` and we can read.

Profile ros2: CDR messages, their definitions as schemas, zstd chunks that each hold all topics of a
span of time, quality of service in every channel's metadata. Log time, publish time and stamp of
sample k are 1 s + k dt; only the stamp in /joint_trajectory is 0, which controllers take for "now".
A metadata record `mgs` and the attachments gait.yaml, robot.yaml and robot.urdf make a file
complete in itself. The same motion gives the same bytes.

With one message per sample:
    /joint_states           position, velocity and, as effort, the predicted torque
    /joint_commands         position that servos are told (mgs.motion.servo_commands), where
                            robot.yaml says how stiff they are; follows from the
                            rest, so reading ignores it
    /tf                     world to base to every moving link
    /base_twist             velocity of the base in its own frame
    /com, /zmp, /sole/left, /sole/right, /hand/left, /hand/right    reached
    ..._reference of each   asked; a hand has no orientation task, its quaternion is the identity
    /support                double, left or right
With a single message:
    /robot_description, /tf_static, /footsteps (sole rectangles), /joint_trajectory (all samples)
"""

from typing import TYPE_CHECKING

from mgs.motion_file.write import motion_bytes, write_motion

if TYPE_CHECKING:
    from mgs.motion_file.read import read_info, read_motion

__all__ = ["motion_bytes", "read_info", "read_motion", "write_motion"]


def __getattr__(name: str) -> object:
    """Import the functions that read when they are first used (PEP 562).

    A command that only writes spends a tenth less time on imports without them.
    """
    if name in ("read_info", "read_motion"):
        from mgs.motion_file import read

        return getattr(read, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
