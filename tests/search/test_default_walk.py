"""Whether engines load a robot and whether it can take the first steps of the default walk."""

from __future__ import annotations

import dataclasses

import pytest

from mgs.core.engines import available_engines
from mgs.core.errors import SimulationError
from mgs.robot import load_robot
from mgs.search import default_walk
from mgs.search.default_walk import check_use


def test_a_shipped_robot_is_loaded_and_walks():
    engines, steps = check_use(load_robot("melson"))
    assert engines.ok and steps.ok
    assert all(name in engines.figure for name in available_engines())


def test_a_robot_that_an_engine_refuses_is_named(monkeypatch: pytest.MonkeyPatch):
    def refuse(name: str, robot: object, settings: object) -> None:
        raise SimulationError(f"{name} has loaded another robot than {robot}")

    monkeypatch.setattr(default_walk, "make_engine", refuse)
    engines, _ = check_use(load_robot("melson"))
    assert not engines.ok
    assert "has loaded another robot" in engines.figure


@pytest.mark.slow_if("speed_limit")
@pytest.mark.parametrize(
    ("figure", "factor", "told"),
    [("torque_limit", 0.2, "joint_torque "), ("speed_limit", 0.02, "")],
)
def test_steps_that_leave_a_limit_name_it(figure: str, factor: float, told: str):
    robot = load_robot("melson")
    weak = dataclasses.replace(robot, **{figure: factor * getattr(robot, figure)})
    _, steps = check_use(weak)
    assert not steps.ok
    assert told in steps.figure
