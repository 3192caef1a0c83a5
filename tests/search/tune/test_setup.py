"""Tests of what a search begins with."""

from __future__ import annotations

import pytest

from mgs.core.errors import InfeasibleGaitError
from mgs.gait import WalkGait, load_gait
from mgs.motion_planner import for_robot
from mgs.pipeline import generate
from mgs.robot import load_robot
from mgs.search.tune import setup

COMAN = load_robot("coman")


def generic() -> WalkGait:
    """Two steps, whose sizes are left to the robot."""
    gait = load_gait("generic/walk")
    assert isinstance(gait, WalkGait)
    return gait.model_copy(update={"walk": gait.walk.model_copy(update={"n_steps": 2})})


GENERIC = generic()


def test_a_search_begins_with_the_sizes_that_generate_chooses():
    made = generate(COMAN, GENERIC)
    assert made.fit is not None and made.fit.changes  # not those derived from the leg length
    task = setup.make_task(COMAN, GENERIC, "speed", engines=("mujoco",))
    planned = made.motion.gait
    assert isinstance(planned, WalkGait)
    rolling = task.space.gait.walk.foot_roll
    assert planned.walk.model_copy(update={"foot_roll": rolling}) == task.space.gait.walk


def test_a_robot_that_can_do_no_walk_is_searched_from_the_derived_sizes(
    monkeypatch: pytest.MonkeyPatch,
):
    def refuse(*_: object) -> None:
        raise InfeasibleGaitError("no walk")

    monkeypatch.setattr(setup, "fit_walk", refuse)
    assert setup.with_sizes(COMAN, GENERIC) == for_robot(GENERIC, COMAN)
