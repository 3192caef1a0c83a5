"""beyondmimic: motion of whole_body_tracking (Isaac Lab), which its csv_to_npz.py makes.

NumPy arrays in single precision, T frames, J joints, B links, the root link first:

    fps             (1,)       [Hz]; not used: it has to be the rate of the controller, 50 Hz
    joint_pos       (T, J)     [rad]
    joint_vel       (T, J)     [rad/s]
    body_pos_w      (T, B, 3)  origins of the links in the world [m]
    body_quat_w     (T, B, 4)  their orientations w, x, y, z
    body_lin_vel_w  (T, B, 3)  velocities of the centres of mass of the links [m/s]
    body_ang_vel_w  (T, B, 3)  angular velocities in the world [rad/s]
    joint_names (J,), body_names (B,)    which no trainer reads

Joints and links stand breadth first, as Isaac Lab counts them, with links that are fixed to others
merged into them. Nothing checks that: a file in another order maps every target to the wrong link.
"""

from __future__ import annotations

from pathlib import Path

from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.learning.tracking_npz import read_tracking, write_tracking
from mgs.motion_file.formats.recorded import RecordedMotion
from mgs.robot import Robot


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the arrays."""
    return write_tracking(sampled, path, options, "breadth-first", "com")


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the arrays."""
    del robot
    return read_tracking(path, "beyondmimic", "breadth-first", "com")
