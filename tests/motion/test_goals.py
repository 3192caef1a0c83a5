"""Goals of servos along a motion: what is sent, at any rate, to any physical robot."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import mgs
from mgs.core.errors import ConfigError
from mgs.motion.goals import goals_along
from mgs.motion.servo_commands import servo_commands
from mgs.robot.servos import servos_of
from mgs.robot.unit import JointCorrection, UnitSpec, unit_of


@pytest.fixture(scope="module")
def squat():
    return mgs.generate(gait="melson/squat")


def test_commanded_angles_are_the_default_of_described_servos(squat):
    goals = goals_along(squat)
    assert (goals.kind, goals.unit) == ("commanded", None)
    np.testing.assert_allclose(goals.position, servo_commands(squat).position, atol=1e-12)
    planned = goals_along(squat, kind="planned")
    np.testing.assert_array_equal(planned.position, squat.q[:, 7:])


def test_servos_without_stiffness_are_told_the_plan_and_commands_are_refused():
    sway = mgs.generate(gait="melson/sway")
    spec = sway.robot.spec
    update = {"compliance_slope": None, "stiffness": None}
    servos = {name: servo.model_copy(update=update) for name, servo in spec.servos.items()}
    robot = dataclasses.replace(sway.robot, spec=spec.model_copy(update={"servos": servos}))
    motion = dataclasses.replace(sway, robot=robot)
    assert goals_along(motion).kind == "planned"
    with pytest.raises(ConfigError, match="stiffness"):
        goals_along(motion, kind="commanded")


@pytest.mark.parametrize("rate", [33.3, 100.0, 125.0, 400.0])
def test_any_rate_follows_the_clamped_cubic_spline_and_keeps_both_ends(squat, rate):
    goals = goals_along(squat, rate, "planned")
    spline = CubicSpline(squat.times, squat.q[:, 7:], bc_type="clamped")
    expected = spline(np.minimum(goals.times, squat.duration))
    np.testing.assert_allclose(goals.position, expected, atol=1e-9)
    np.testing.assert_allclose(goals.position[[0, -1]], squat.q[[0, -1], 7:], atol=1e-12)
    assert 0.0 <= goals.times[-1] - squat.duration < 1.0 / rate


def test_the_law_of_the_physical_robot_brings_commanded_joints_to_the_plan(squat):
    """The law of docs/robots.md, evaluated here for every joint in turn."""
    robot = squat.robot
    joints = {
        name: JointCorrection(zero_offset=0.02, sign=-1, scale=1.05, backlash=0.01, stiffness=20.0)
        for name in robot.joint_names
    }
    unit = unit_of(UnitSpec(mgs=1, unit="u", robot="melson", joints=joints), robot)
    goals = goals_along(squat, kind="planned", unit=unit)
    assert goals.unit == "u"
    torque = squat.torque
    side = np.clip(torque / (0.01 * robot.torque_limit), -1.0, 1.0)
    reached = -1.05 * goals.position + 0.02 - torque / 20.0 - 0.005 * side
    inside = (squat.q[:, 7:] > robot.lower + 0.1) & (squat.q[:, 7:] < robot.upper - 0.1)
    np.testing.assert_allclose(reached[inside], squat.q[:, 7:][inside], atol=1e-9)
    # of described servos friction and damping are compensated too, at the stiffness of this robot
    servos, v = servos_of(robot), squat.v[:, 6:]
    load = torque + servos.friction_under_load(v, torque) + servos.damping * v
    goals = goals_along(squat, kind="commanded", unit=unit)
    reached = -1.05 * goals.position + 0.02 - load / 20.0 - 0.005 * side
    np.testing.assert_allclose(reached[inside], squat.q[:, 7:][inside], atol=1e-9)
