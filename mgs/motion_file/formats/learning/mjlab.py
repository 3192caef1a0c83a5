"""mjlab: motion for the tracking tasks of mjlab, which its csv_to_npz makes for one robot.

NumPy arrays in single precision, T frames, J joints, B links, the root link first:

    fps             (1,)       [Hz]; not read: it has to be the rate of the task, 50 Hz
    joint_pos       (T, J)     [rad]
    joint_vel       (T, J)     [rad/s]
    body_pos_w      (T, B, 3)  origins of the links in the world [m]
    body_quat_w     (T, B, 4)  their orientations w, x, y, z
    body_lin_vel_w  (T, B, 3)  velocities of the origins of the links [m/s]
    body_ang_vel_w  (T, B, 3)  angular velocities in the world [rad/s]
    joint_names (J,), body_names (B,)    which no trainer reads

Joints and links stand depth first, as MuJoCo counts them, without `world` and the free joint, with
links that are fixed to others merged into them. The keys are those of beyondmimic, but order and
velocities are not: a file of one is wrong for the other, and nothing checks that.
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
    return write_tracking(sampled, path, options, "depth-first", "origin")


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the arrays."""
    del robot
    return read_tracking(path, "mjlab", "depth-first", "origin")
