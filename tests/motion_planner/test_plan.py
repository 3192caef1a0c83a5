"""The type of plan that each kind of gait has, and what all plans have in common."""

from __future__ import annotations

import pytest

from mgs.core.contact import Side
from mgs.core.scene import EMPTY
from mgs.gait import Gait, KickGait, load_gait
from mgs.motion_planner import (
    BalancePlan,
    KeyframePlan,
    PosturePlan,
    WalkPlan,
    plan_motion,
)
from mgs.robot import load_robot
from tests.support.strategies import (
    balance_gait,
    constant,
    keyframes_gait,
    pick_up_gait,
    walk_gait,
)

MELSON = load_robot("melson")
WITHOUT_BALANCE = keyframes_gait({"time": 1.0}, balance="off", lying="front")


@pytest.mark.parametrize(
    ("gait", "kind"),
    [
        (walk_gait(step_length=0.05), WalkPlan),
        (load_gait("coman/stairs"), WalkPlan),
        (KickGait(mgs=1, motion="kick"), WalkPlan),
        (balance_gait(constant("com_y", 0.01)), BalancePlan),
        (keyframes_gait({"time": 1.0, "crouch": 2.0}), KeyframePlan),
        (pick_up_gait(object=[0.1, -0.12, 0.12]), KeyframePlan),
        (WITHOUT_BALANCE, PosturePlan),
    ],
    ids=["walk", "stairs", "kick", "balance", "keyframes", "pick_up", "keyframes without balance"],
)
def test_a_gait_has_the_plan_of_its_kind(gait: Gait, kind: type):
    robot = load_robot(gait.robot or "melson")
    plan = plan_motion(robot, gait)
    assert type(plan) is kind
    assert plan.dt == gait.dt and plan.n_samples > 1
    assert [footstep.side for footstep in plan.footsteps[:2]] == list(Side)
    if kind is not WalkPlan:
        assert len(plan.footsteps) == 2 and plan.scene is EMPTY


def test_only_a_kick_has_a_ball_and_only_stairs_have_boxes():
    kick, walk = (
        plan_motion(MELSON, KickGait(mgs=1, motion="kick")),
        plan_motion(MELSON, walk_gait()),
    )
    stairs = plan_motion(load_robot("coman"), load_gait("coman/stairs"))
    assert (len(kick.scene.balls), len(kick.scene.boxes)) == (1, 0)
    assert stairs.scene.boxes and not stairs.scene.balls
    assert walk.scene == EMPTY


def test_the_height_of_the_com_is_bounded_by_the_legs_on_stairs_alone():
    assert plan_motion(load_robot("coman"), load_gait("coman/stairs")).reach is not None
    assert plan_motion(MELSON, walk_gait()).reach is None


def test_a_sequence_is_refused_since_its_parts_have_plans():
    with pytest.raises(TypeError, match="a plan for each of its parts"):
        plan_motion(MELSON, load_gait("melson/walk_kick_walk"))
