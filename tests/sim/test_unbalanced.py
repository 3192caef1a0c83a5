"""Keyframes without balance: how the robot is put down, and what is judged of it."""

from __future__ import annotations

from typing import Any

import coal
import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.errors import ConfigError
from mgs.gait import parse_gait
from mgs.judge.motion_checks import check_motion
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.motion.dynamics import place_lowest
from mgs.pipeline import run_stages
from mgs.robot import Robot
from mgs.sim import EngineName, replay
from tests.support.strategies import keyframes_gait


def unbalanced(robot: Robot, *keys: dict[str, Any], **frames: Any) -> Motion:
    gait = keyframes_gait(*keys, balance="off", rest=0.2, **frames)
    return run_stages(robot, gait).motion


def touches_below(robot: Robot, q: np.ndarray, height: float) -> bool:
    """Whether any collision shape reaches below a height [m], by the collision library."""
    data, shapes = robot.geometry.createData(), robot.geometry.geometryObjects
    pin.updateGeometryPlacements(robot.model, robot.model.createData(), robot.geometry, data, q)
    below, here = coal.Halfspace(np.array([0.0, 0.0, 1.0]), height), coal.Transform3s()
    return any(
        coal.collide(
            shape.geometry,
            coal.Transform3s(placement.rotation, placement.translation),
            below,
            here,
            coal.CollisionRequest(),
            coal.CollisionResult(),
        )
        for shape, placement in zip(shapes, data.oMg, strict=True)
    )


def test_the_lowest_point_of_the_robot_is_on_the_ground(melson: Robot):
    rng = np.random.default_rng(3)
    joints = melson.posture + rng.uniform(-0.3, 0.3, (6, melson.n))
    turns = rng.normal(size=(6, 4))
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    for q in place_lowest(melson, joints, turns):
        assert not touches_below(melson, q, -1e-6)
        assert touches_below(melson, q, 1e-6)


def test_a_standing_robot_is_put_on_its_soles(melson: Robot):
    (q,) = place_lowest(melson, melson.posture[None], melson.standing_q[None, 3:7])
    assert_allclose(q[2:], melson.standing_q[2:], atol=1e-9)


@pytest.mark.parametrize(("lying", "face"), [("front", -1.0), ("back", 1.0), (None, 0.0)])
def test_it_begins_as_it_lies_in_the_posture_that_it_begins_with(melson, lying, face):
    motion = unbalanced(melson, {"time": 1.0, "rest": True}, lying=lying, begin={"waist_yaw": 0.2})
    forward = pin.Quaternion(*motion.q[0, [6, 3, 4, 5]]).matrix()[:, 0]
    assert forward[2] == pytest.approx(face, abs=1e-9)  # where the chest looks
    assert motion.q[0, 7 + melson.joint_names.index("waist_yaw")] == 0.2
    assert_allclose(motion.q[-1], [0.0, 0.0, *melson.standing_q[2:]], atol=1e-9)


def test_only_checks_that_need_no_ground_are_made(melson: Robot):
    motion = unbalanced(melson, {"time": 1.0, "posture": {"left_knee_pitch": 1.5}}, lying="back")
    checks = check_motion(motion)
    names = ["joint_position", "joint_speed", "self_collision", "rest"]
    assert [check.name for check in checks] == names
    assert all(check.ok for check in checks)
    quick = unbalanced(melson, {"time": 0.4, "posture": {"left_knee_pitch": 2.0}})
    assert [check.name for check in check_motion(quick) if not check.ok] == ["joint_speed"]


@pytest.mark.parametrize(("lying", "stands"), [(None, True), ("front", False)])
def test_it_passes_if_it_stands_at_the_end(melson, engine_name: EngineName, lying, stands):
    result = replay(unbalanced(melson, {"time": 0.4, "rest": True}, lying=lying), engine_name)
    checks = replay_checks(result)
    assert [check.name for check in checks] == [
        f"{engine_name}_stands",
        f"{engine_name}_soles_bear",
    ]
    assert [check.ok for check in checks] == [stands, stands]
    assert result.fell != stands
    tilt, load = (check.value for check in checks)
    if stands:
        assert tilt < 1.0 and load == pytest.approx(0.5, abs=0.05)
    else:
        assert tilt > 60.0 and load < 0.1


HEAD = "mgs: 1\nmotion: keyframes\nkeyframes:\n"


def test_an_unquoted_off_is_meant_as_written():
    for word in ("off", "'off'", "false"):
        gait = parse_gait(f"{HEAD}  balance: {word}\n  keys: [{{time: 1.0}}]", "a.yaml")
        assert not gait.is_balanced
        assert parse_gait(gait.to_yaml(), "again") == gait
    assert parse_gait(f"{HEAD}  balance: on\n  keys: [{{time: 1.0}}]", "a.yaml").is_balanced


@pytest.mark.parametrize(
    ("block", "message"),
    [
        (
            "  balance: off\n  keys: [{time: 1.0, crouch: 3.0}]",
            "keys.0.crouch: not possible without balance",
        ),
        ("  lying: front\n  keys: [{time: 1.0}]", "lying is for motions without balance"),
        ("  balance: maybe\n  keys: [{time: 1.0}]", "input should be 'on' or 'off'"),
    ],
)
def test_what_does_not_go_with_or_without_balance_is_refused(block: str, message: str):
    with pytest.raises(ConfigError, match=message):
        parse_gait(HEAD + block, "a.yaml")
