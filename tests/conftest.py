"""Fixtures that many tests share: the robot, its reference walk, and every gait that ships."""

from __future__ import annotations

import pytest
from hypothesis import settings

from mgs.gait import list_gaits, load_gait
from mgs.motion import Motion
from mgs.pipeline import Stages, generate, run_stages
from mgs.robot import Robot, load_robot
from tests.support.crooked import crooked_robot
from tests.support.libraries import address, made, plan, sweep
from tests.support.shipped import Generated, generated

__all__ = ["address", "made", "plan", "sweep"]  # fixtures

# the same examples in every run, and no failure because a machine is slow
settings.register_profile("quick", derandomize=True, deadline=None, max_examples=40)
settings.register_profile("thorough", settings.get_profile("quick"), max_examples=60)
settings.load_profile("quick")


@pytest.fixture(scope="session")
def melson() -> Robot:
    return load_robot("melson")


@pytest.fixture(scope="session", params=["melson", "crooked"])
def any_robot(request: pytest.FixtureRequest) -> Robot:
    """Melson, and a robot with none of its right angles."""
    return load_robot("melson") if request.param == "melson" else crooked_robot(seed=3)


@pytest.fixture(scope="session")
def walk_5cm(melson: Robot) -> Stages:
    return run_stages(melson, load_gait("melson/walk_5cm"), "melson/walk_5cm")


MOTIONS = {name: load_gait(name).motion for name in list_gaits()}


@pytest.fixture(scope="session", params=[name for name in MOTIONS if MOTIONS[name] != "sequence"])
def shipped(request: pytest.FixtureRequest) -> Generated:
    """Every shipped gait of one part in turn; one that names no robot is Melson's."""
    return generated(request.param)


@pytest.fixture(scope="session", params=[name for name in MOTIONS if MOTIONS[name] == "sequence"])
def shipped_sequence(request: pytest.FixtureRequest) -> Motion:
    """The motion of every shipped sequence."""
    gait = load_gait(request.param)
    assert gait.robot is not None
    return generate(load_robot(gait.robot), gait, request.param).motion


@pytest.fixture(scope="session", params=[name for name in MOTIONS if MOTIONS[name] == "walk"])
def shipped_walk(request: pytest.FixtureRequest) -> Generated:
    """Those shipped gaits that are walks."""
    return generated(request.param)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Make cases slow that `slow_if` names: in `make test` the other cases stand for them."""
    for item in items:
        marker = item.get_closest_marker("slow_if")
        case = item.name.partition("[")[2].rstrip("]").split("-")
        if marker is not None and not set(marker.args).isdisjoint(case):
            item.add_marker(pytest.mark.slow)
