"""Each type of plan is followed by the planner of its own kind."""

from __future__ import annotations

import numpy as np
import pytest

from mgs.core.contact import Support
from mgs.core.errors import ComOutsideFeetError
from mgs.gait import Gait, KickGait
from mgs.motion_planner import plan_motion
from mgs.robot import load_robot
from mgs.trajectory_planner import plan_trajectories
from tests.support.strategies import (
    balance_gait,
    constant,
    keyframes_gait,
    pick_up_gait,
    walk_gait,
)

MELSON = load_robot("melson")


@pytest.mark.parametrize(
    ("gait", "com", "steps", "posture", "payload"),
    [
        (walk_gait(step_length=0.05), False, True, False, False),
        (KickGait(mgs=1, motion="kick"), False, True, False, False),
        (balance_gait(constant("com_y", 0.01)), True, False, False, False),
        (keyframes_gait({"time": 1.0, "crouch": 2.0}), True, False, True, False),
        (pick_up_gait(object=[0.1, -0.12, 0.12]), True, False, True, False),
        (pick_up_gait(object=[0.1, -0.12, 0.12], payload=0.1), True, False, True, True),
    ],
    ids=["walk", "kick", "balance", "keyframes", "pick_up", "pick_up with a payload"],
)
def test_trajectories_ask_for_what_belongs_to_the_kind_of_plan(
    gait: Gait, com: bool, steps: bool, posture: bool, payload: bool
):
    plan = plan_motion(MELSON, gait)
    tasks = plan_trajectories(plan)
    assert tasks.n_samples == plan.n_samples and tasks.dt == plan.dt
    assert (tasks.com is not None) == com
    assert (tasks.support != Support.DOUBLE).any() == steps
    assert (tasks.posture is not None) == posture
    assert (tasks.payload is not None) == payload
    assert tasks.start is None
    if tasks.posture is not None:
        assert tasks.posture.angles.shape == (tasks.n_samples, MELSON.n)
        assert tasks.posture.held.shape == (MELSON.n,)


def test_keyframes_whose_com_leaves_both_feet_are_refused_with_the_distance():
    gait = keyframes_gait({"time": 1.0, "com": [0.0, 0.15, 0.0]})
    with pytest.raises(ComOutsideFeetError) as caught:
        plan_trajectories(plan_motion(MELSON, gait))
    assert caught.value.distance == pytest.approx(0.15, abs=1e-3)
    assert np.isfinite(caught.value.distance)
