"""Sway of a robot on servos that give way, when one leg takes its weight."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from mgs.core.constants import FLOATING_BASE_NQ, GRAVITY
from mgs.core.contact import Side
from mgs.gait import load_gait
from mgs.motion_planner import for_robot
from mgs.motion_planner.sway import swing_of_zmp
from mgs.robot import Robot, load_robot
from mgs.robot.init import init_robot
from mgs.robot.roles import find_roles
from tests.support.bipeds import Biped


def height_over_sole(robot: Robot, joint: int, angle: float) -> float:
    """Height of the CoM above the left sole, which stands still, with a joint turned [m]."""
    q = robot.standing_q.copy()
    q[FLOATING_BASE_NQ + joint] += angle
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    com = pin.centerOfMass(robot.model, data, q, False)
    return float(data.oMf[robot.sole_frames[Side.LEFT]].actInv(com)[2])


@pytest.mark.parametrize("name", ["melson", "coman"])
def test_the_swing_follows_from_the_potential_energy(name: str):
    """The hip's torque on one leg is the derivative of the potential energy."""
    robot = load_robot(name)
    roles = find_roles(robot)
    hip, ankle = (roles[f"left_{joint}_roll"][0] for joint in ("hip", "ankle"))
    turn = 1e-5
    heights = [height_over_sole(robot, hip, angle) for angle in (-turn, turn)]
    arm = abs(np.diff(heights)[0]) / (2 * turn)  # torque / (m g)
    k_hip, k_ankle = (robot.torque_limit[j] / np.radians(1.0) for j in (hip, ankle))
    z = height_over_sole(robot, hip, 0.0)
    both = k_hip * k_ankle / (k_hip + k_ankle)
    shift = z * arm * robot.mass * GRAVITY / k_hip
    omega2 = (both - robot.mass * GRAVITY * z) / (robot.mass * z**2)
    swing = shift * (1.0 + omega2 * z / GRAVITY)
    assert swing_of_zmp(robot) == pytest.approx(swing / (robot.spec.soles.left.width / 2), rel=0.02)


def test_a_robot_that_tips_its_soles_walks_more_slowly(tmp_path: Path):
    times, swings = [], []
    for width in (0.1, 0.05):
        path = tmp_path / f"{width}.urdf"
        path.write_text(Biped(sole=(0.2, width)).urdf())
        robot = init_robot(path).robot
        gait = for_robot(load_gait("generic/walk"), robot)
        times.append(gait.walk.single_support)
        swings.append(swing_of_zmp(robot))
    assert swings[0] < 1.0 < swings[1]
    assert times[1] == pytest.approx(2.0 * times[0], abs=0.02)
