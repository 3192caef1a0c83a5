"""toddlerbot-zmp: lookup table of ToddlerBot's ZMP walk (walk_zmp_lookup_table.pkl).

Pickle of a tuple of four lists, which have one entry per walk; n frames of 0.02 s, L leg joints:

    velocities       (vx, vy, wz) [m/s, rad/s]
    CoM              (n, 2) forward, to the left [m], seen from the middle of the soles at the
                     beginning of the cycle
    contacts         (n, 2) left and right foot; 1: on the ground
    leg joints       (n, L) angles [rad], the left leg before the right one, each from the hip down

All in single precision. The reader takes the walk with the nearest velocity and repeats its frames,
so a cycle ends before its first frame. It expects 12 leg joints: `mgs export` tells their order.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.learning.motion_lib import foot_contacts
from mgs.motion_file.formats.lookup.walk import Walk
from mgs.motion_file.formats.pickle_file import write_pickle
from mgs.motion_file.formats.recorded import as_float32
from mgs.robot import Robot, leg_joints

BEFORE = 2  # joints of Pinocchio's model that are the world and the floating base


def write(walks: Sequence[Walk], path: Path, options: Options) -> Written:
    """Write the table."""
    robot = walks[0].sampled.robot
    names, index = chosen_joints(robot, options, None)
    if options.joints is None:
        names, index = _legs(robot)
    found: tuple[list[Any], ...] = ([], [], [], [])
    for walk in sorted(walks, key=lambda walk: walk.velocity):
        frames = slice(walk.n_frames)
        found[0].append(walk.velocity)
        found[1].append(as_float32(_com(walk.sampled)[frames]))
        found[2].append(as_float32(foot_contacts(walk.sampled)[frames]))
        found[3].append(as_float32(walk.sampled.joints[frames, index]))
    write_pickle(path, found)
    return Written(names)


def _legs(robot: Robot) -> tuple[tuple[str, ...], Any]:
    """Joints of the left and the right leg, from the hip down."""
    index = np.concatenate([leg_joints(robot, side) for side in Side]) - BEFORE
    return tuple(robot.joint_names[k] for k in index), index


def _com(sampled: SampledMotion) -> Array:
    """Horizontal place of the centre of mass (T, 2) [m]."""
    model, data = sampled.robot.model, sampled.robot.model.createData()
    return np.array([pin.centerOfMass(model, data, q, False)[:2] for q in sampled.q])
