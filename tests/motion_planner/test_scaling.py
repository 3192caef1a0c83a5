"""Walks whose lengths and durations are derived from the size of the robot."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mgs.com_generator.qp import default_margin
from mgs.gait import list_gaits, load_gait, parse_gait
from mgs.motion_planner import for_robot
from mgs.robot import leg_length, load_robot
from mgs.robot.init import init_robot
from tests.support.bipeds import Biped

MELSON = load_robot("melson")
GENERIC = "mgs: 1\nmotion: walk\nwalk: {n_steps: 4, sizes: robot}"


@settings(max_examples=5)
@given(size=st.floats(0.3, 1.0), scale=st.floats(1.2, 2.0))
def test_walks_of_robots_of_two_sizes_have_the_same_froude_number(
    size: float, scale: float, tmp_path_factory: pytest.TempPathFactory
):
    found = []
    for length in (size, scale * size):
        path = tmp_path_factory.mktemp("sizes") / "boxes.urdf"
        path.write_text(Biped(size=length, sole=(0.3 * length, 0.12 * length)).urdf())
        robot = init_robot(path).robot
        gait = for_robot(parse_gait(GENERIC, "a.yaml"), robot)
        walk, leg = gait.walk, leg_length(robot)
        speed = walk.step_length / (walk.single_support + walk.double_support)
        margin = default_margin(robot)  # of the zero-moment point, where the gait gives none
        found.append((speed**2 / (9.81 * leg), walk.step_height / leg, margin / leg))
    assert found[0] == pytest.approx(found[1], rel=0.08)  # times are whole samples of 10 ms


def test_values_that_the_file_states_are_not_replaced():
    stated = {"step_length": 0.011, "single_support": 0.77, "lead_in": 2.5, "step_height": 0.013}
    assignments = tuple(f"walk.{key}={value}" for key, value in stated.items())
    gait = for_robot(load_gait("walk", (*assignments, "com.margin=0.002")), MELSON)
    assert {key: getattr(gait.walk, key) for key in stated} == stated
    assert gait.com.margin == 0.002
    assert gait.walk.sizes == "given"
    assert for_robot(gait, load_robot("coman")) == gait  # once resolved it is any other gait


@pytest.mark.parametrize("name", [name for name in list_gaits() if not name.startswith("generic")])
def test_gaits_that_state_their_sizes_are_not_changed(name: str):
    gait = load_gait(name)
    assert for_robot(gait, MELSON) is gait


def test_the_generic_walk_names_neither_robot_nor_sizes():
    gait = load_gait("walk")
    assert gait == load_gait("generic/walk")
    assert gait.robot is None
    assert gait.walk.model_fields_set == {"n_steps", "sizes"}


def test_a_gait_that_is_changed_keeps_leaving_its_sizes_to_the_robot():
    by_name = load_gait("walk", robot="melson")
    by_object = load_gait(load_gait("walk"), robot="melson")
    assert by_object == by_name
    assert by_object.walk.model_fields_set == {"n_steps", "sizes"}
    assert for_robot(by_object, MELSON) == for_robot(by_name, MELSON)


def test_a_file_of_the_user_comes_before_the_generic_one(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("walk").write_text("mgs: 1\nmotion: walk\nwalk: {n_steps: 9}")
    assert load_gait("walk").walk.n_steps == 9
