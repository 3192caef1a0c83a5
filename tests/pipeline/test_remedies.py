"""A gait that the robot cannot do is refused with keys of its own kind, and of no other kind."""

from __future__ import annotations

import re
from typing import Any

import pytest

from mgs.core.errors import IkError, InfeasibleGaitError, JointLimitError, JointSpeedError
from mgs.gait import GAITS, load_gait
from mgs.pipeline import run_stages
from mgs.robot import load_robot
from tests.support.strategies import balance_gait, constant, keyframes_gait

BLOCKS = [kind for kind in GAITS if kind != "sequence"]


def refusal(gait: Any) -> InfeasibleGaitError:
    with pytest.raises(InfeasibleGaitError) as caught:
        run_stages(load_robot("melson"), gait)
    return caught.value


def blocks_named_in(message: str) -> set[str]:
    """Blocks of gait files whose keys a message names, such as walk for walk.com_height."""
    return {block for block in BLOCKS if re.search(rf"\b{block}\.\w", message)}


@pytest.mark.parametrize(
    ("gait", "kind", "keys"),
    [
        (
            load_gait("melson/walk_5cm", ("walk.com_height=0.33",)),
            IkError,
            ["walk.com_height", "walk.step_length", "walk.single_support"],
        ),
        (
            load_gait("melson/walk_5cm", ("walk.step_width=0.4",)),
            IkError,
            ["walk.step_width", "walk.com_height"],
        ),
        (
            load_gait("melson/kick", ("kick.com_height=0.33",)),
            IkError,
            ["kick.com_height", "kick.ball.x", "kick.back_swing"],
        ),
        (load_gait("melson/kick", ("kick.speed=2.0",)), JointSpeedError, ["kick.speed"]),
        (
            load_gait("melson/sway", ("balance.com_height=0.15",)),
            JointLimitError,
            ["balance.channels", "balance.com_height", "ik.on_limit"],
        ),
        (balance_gait(constant("com_y", 0.2)), InfeasibleGaitError, ["balance.channels"]),
        (keyframes_gait({"time": 1.0, "right_hand": [0.5, 0.0, 0.0]}), IkError, ["keyframes.keys"]),
        (
            keyframes_gait({"time": 1.0, "com": [0.0, 0.2, 0.0]}),
            InfeasibleGaitError,
            ["keyframes.keys"],
        ),
        (
            load_gait("melson/pick_up", ("pick_up.object=[0.5, -0.1, 0.1]",)),
            InfeasibleGaitError,
            ["pick_up.object"],
        ),
    ],
    ids=lambda value: value.motion if hasattr(value, "motion") else None,
)
def test_the_message_names_keys_of_the_gait_that_was_asked_for_alone(
    gait: Any, kind: type[InfeasibleGaitError], keys: list[str]
):
    error = refusal(gait)
    assert isinstance(error, kind)
    for key in keys:
        assert key in str(error)
    assert blocks_named_in(str(error)) == {gait.motion}


def test_the_remedy_of_a_walk_that_is_too_high_leads_to_a_walk_that_can_be_done():
    error = refusal(load_gait("melson/walk_5cm", ("walk.com_height=0.33",)))
    assert "a lower walk.com_height" in error.remedy
    lower = load_gait("melson/walk_5cm", ("walk.com_height=0.26",))
    assert run_stages(load_robot("melson"), lower).motion.n_samples == 1201
