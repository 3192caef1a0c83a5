"""Static checks and verdict: figures against hand-made motions whose worst value is known."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from mgs.core.contact import Support
from mgs.judge.motion_checks import Check, check_motion
from mgs.judge.verdict import judge
from mgs.motion import Motion
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot
from mgs.sim.measure import travel
from tests.support.strategies import balance_gait, sine


def check(motion: Motion, name: str) -> Check:
    return next(item for item in check_motion(motion) if item.name == name)


def with_joint_moved(motion: Motion, joint: str, offset: np.ndarray) -> Motion:
    q = motion.q.copy()
    q[:, 7 + motion.robot.joint_names.index(joint)] += offset
    return dataclasses.replace(motion, q=q)


def test_a_joint_that_chatters_from_sample_to_sample_is_as_fast_as_it_looks(walk_5cm: Stages):
    """Central differences would see nothing of it."""
    motion = walk_5cm.motion
    chatter = 0.05 * (-1.0) ** np.arange(motion.n_samples)
    found = check(with_joint_moved(motion, "waist_yaw", chatter), "joint_speed")
    assert (found.ok, found.where) == (False, "waist_yaw")
    assert found.value == pytest.approx(0.1 / motion.dt, rel=0.05)


def test_a_joint_that_moves_at_once_is_not_at_rest(walk_5cm: Stages):
    motion = walk_5cm.motion
    found = check(with_joint_moved(motion, "waist_yaw", 0.06 * motion.times), "rest")
    assert (found.ok, found.where) == (False, "waist_yaw")
    assert found.value == pytest.approx(0.06, rel=0.01)


def test_torques_that_the_file_denies_are_found_all_the_same(walk_5cm: Stages):
    """In single support they follow from the motion, whatever the file says."""
    motion = walk_5cm.motion
    denied = dataclasses.replace(motion, torque=np.zeros_like(motion.torque))
    single = motion.support != Support.DOUBLE
    for name, expected in (
        ("joint_torque", np.abs(motion.torque[single]).max()),
        ("joint_torque_rms", np.sqrt((motion.torque[single] ** 2).sum(0) / len(single)).max()),
    ):
        # the worst sample is that nearest its speed-torque line, not quite the one of most torque
        assert check(denied, name).value == pytest.approx(expected, rel=0.01)


def test_a_static_pass_says_that_no_physics_was_asked():
    verdict = judge("walk.mcap", [], [])
    assert (verdict.passed, verdict.to_dict()["physics"]) == (True, [])


def test_half_a_turn_is_half_a_turn_though_the_soles_wrap_to_either_side():
    soles = np.zeros((2, 2, 7))
    soles[:, :, 6] = 1.0
    for side, yaw in enumerate((np.pi - 0.01, -np.pi + 0.01)):
        soles[1, side, 5:] = np.sin(yaw / 2), np.cos(yaw / 2)
    assert abs(travel(soles)[2]) == pytest.approx(np.pi, abs=1e-9)


def test_the_torsos_error_is_the_angle_between_where_it_points_and_where_it_should(
    walk_5cm: Stages,
):
    """Torso by forward kinematics of one sample, angle by scipy; whatever the file says of both."""
    motion, k = walk_5cm.motion, 700
    robot, data = motion.robot, motion.robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, motion.q[k])
    actual = Rotation.from_matrix(data.oMf[robot.torso_frame].rotation)
    asked = Rotation.from_euler("ZYX", [0.1, -0.2, 0.3]) * actual
    torso_ref = motion.torso_ref.copy()
    torso_ref[k] = -asked.as_quat()  # the same rotation with the other sign
    denied = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], (motion.n_samples, 1))
    found = check(dataclasses.replace(motion, torso_ref=torso_ref, torso=denied), "torso_rotation")
    assert found.value == pytest.approx((asked * actual.inv()).magnitude(), rel=1e-9)
    assert (found.ok, found.time, found.unit) == (False, k * motion.dt, "rad")
    assert found.limit == pytest.approx(np.radians(0.01))


def test_a_torso_of_which_nothing_is_asked_is_where_it_should_be(walk_5cm: Stages):
    found = check(walk_5cm.motion, "torso_rotation")
    assert found.ok and found.value < 1e-12


@pytest.mark.parametrize(("gap", "ok"), [(4.9e-3, True), (5.1e-3, False)])
def test_a_gait_may_give_its_com_more_room(melson: Robot, gap: float, ok: bool):
    gait = balance_gait(sine("com_y", 0.01), com_tolerance=5e-3)
    motion = run_stages(melson, gait).motion
    off = dataclasses.replace(motion, com_ref=motion.com + np.array([0.0, gap, 0.0]))
    found = check(off, "com_position")
    assert (found.ok, found.limit) == (ok, 5e-3)
    assert found.value == pytest.approx(gap, abs=1e-9)


def test_the_com_of_a_walk_has_the_room_it_always_had(walk_5cm: Stages):
    assert check(walk_5cm.motion, "com_position").limit == 2e-4


def test_collisions_are_those_that_every_pair_of_shapes_gives(walk_5cm: Stages):
    """The tree of bounding boxes against all pairs, in random postures that touch or do not."""
    motion, robot = walk_5cm.motion, walk_5cm.motion.robot
    rng = np.random.default_rng(3)
    apart = np.zeros((60, robot.model.nv))
    apart[:, 6:] = rng.normal(scale=0.3, size=(60, robot.n))
    data, geometry = robot.model.createData(), robot.geometry.createData()
    touching = []
    for v in apart:
        q = pin.integrate(robot.model, motion.q[0], v)
        posed = dataclasses.replace(motion, q=np.repeat(q[None], motion.n_samples, axis=0))
        (check,) = [c for c in check_motion(posed, collision_step=10**6) if "collision" in c.name]
        touches = pin.computeCollisions(robot.model, data, robot.geometry, geometry, q, False)
        assert check.ok is not touches
        touching.append(touches)
        if touches:
            pairs = {
                " and ".join(
                    robot.model.frames[robot.geometry.geometryObjects[i].parentFrame].name
                    for i in (pair.first, pair.second)
                )
                for pair, result in zip(
                    robot.geometry.collisionPairs, geometry.collisionResults, strict=True
                )
                if result.isCollision()
            }
            assert check.where in pairs
    assert 10 < sum(touching) < 50
