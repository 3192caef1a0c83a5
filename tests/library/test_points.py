"""Sweeps: their points, the order of the points, and the refusal of malformed sweeps."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.core.errors import ConfigError
from mgs.gait import load_gait, parse_gait
from mgs.library.points import Plan, flat, plain, plan_sweep
from mgs.library.sweep import KINDS, Axis

LENGTH, HEIGHT = "walk.step_length", "walk.step_height"


def sweep_of(folder: Path, **content: Any) -> Path:
    path = folder / "sweep.yaml"
    path.write_text(
        yaml.safe_dump({"mgs": 1, "base": "melson/walk_5cm", **content}, sort_keys=False)
    )
    return path


def plan_of(folder: Path, **content: Any) -> Plan:
    return plan_sweep(sweep_of(folder, **content))


def test_a_grid_has_every_combination_in_order(tmp_path: Path):
    plan = plan_of(tmp_path, axes={LENGTH: [0.01, 0.02], "ik.solver": ["clik", "ik4"]})
    assert plan.keys == (LENGTH, "ik.solver")
    assert plan.points == [(0.01, "clik"), (0.01, "ik4"), (0.02, "clik"), (0.02, "ik4")]


def test_linspace_and_logspace_have_the_expected_values(tmp_path: Path):
    axes = {
        LENGTH: {"linspace": [0.01, 0.05, 5]},
        HEIGHT: {"logspace": [0.01, 0.04, 3]},
        "walk.n_steps": {"integers": [2, 4]},
    }
    plan = plan_of(tmp_path, axes=axes)
    found = [sorted(set(column)) for column in zip(*plan.points, strict=True)]
    assert_allclose(found[0], [0.01, 0.02, 0.03, 0.04, 0.05])
    assert_allclose(found[1], [0.01, 0.02, 0.04])
    assert found[2] == [2, 3, 4]
    assert len(plan.points) == 5 * 3 * 3


def test_whole_numbers_stay_integers(tmp_path: Path):
    plan = plan_of(tmp_path, axes={"walk.n_steps": {"linspace": [2, 10, 5]}})
    assert [point for (point,) in plan.points] == [2, 4, 6, 8, 10]
    for number in range(5):  # strict integers of a gait file take them
        parse_gait(plan.base_text, plan.base, plan.assignments(number))


@pytest.mark.parametrize("sampling", ["latin_hypercube", "sobol"])
def test_draws_fill_their_ranges_evenly_and_depend_on_the_seed_alone(tmp_path: Path, sampling: str):
    """Each of 16 equal parts of each range has one draw of 16: both samplings promise it."""
    content = {
        "sampling": sampling,
        "samples": 16,
        "seed": 3,
        "axes": {
            LENGTH: {"uniform": [-0.05, 0.05]},
            HEIGHT: {"log_uniform": [0.01, 0.04]},
            "ik.solver": ["clik", "ik4"],
        },
    }
    plan = plan_of(tmp_path, **content)
    length, height, solver = zip(*plan.points, strict=True)
    assert sorted(np.floor((np.array(length) + 0.05) / 0.1 * 16)) == list(range(16))
    assert sorted(np.floor(np.log(np.array(height) / 0.01) / np.log(4.0) * 16)) == list(range(16))
    assert solver.count("clik") == 8
    assert plan_of(tmp_path, **content).points == plan.points
    assert plan_of(tmp_path, **content | {"seed": 4}).points != plan.points


def test_each_row_of_a_table_is_combined_with_all_axes(tmp_path: Path):
    (tmp_path / "rows.csv").write_text(f"{LENGTH}, ik.solver\n0.01,clik\n1e-2,ik4\n")
    plan = plan_of(tmp_path, sampling="table", table="rows.csv", axes={HEIGHT: [0.02, 0.03]})
    assert plan.keys == (LENGTH, "ik.solver", HEIGHT)
    assert plan.points == [
        (0.01, "clik", 0.02), (0.01, "clik", 0.03), (0.01, "ik4", 0.02), (0.01, "ik4", 0.03),
    ]  # fmt: skip


def test_filters_may_use_any_key_of_the_gait(tmp_path: Path):
    """walk_5cm has steps of 1.2 s + 2.4 s, which no axis says."""
    text = f"{LENGTH} / (walk.single_support + walk.double_support) > 0.01 and robot == 'melson'"
    plan = plan_of(tmp_path, axes={LENGTH: [0.01, 0.03, 0.04, 0.05]}, filters=[text])
    assert [point for (point,) in plan.points] == [0.04, 0.05]
    assert plan.n_filtered == 2


@given(st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=4, unique=True))
def test_a_value_reaches_the_gait_exactly(lengths: list[float]):
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        plan = plan_of(Path(folder), axes={LENGTH: lengths, "walk.zmp_offset": [[0.0, 0.004]]})
    for number, length in enumerate(lengths):
        gait = parse_gait(plan.base_text, plan.base, plan.assignments(number))
        assert gait.walk.step_length == length
        assert gait.walk.zmp_offset == [0.0, 0.004]


def test_the_order_of_the_points_is_that_of_nested_loops(tmp_path: Path):
    axes = {LENGTH: [0.0, 0.1], HEIGHT: [0.1, 0.2, 0.3], "ik.gamma_joint": [0.0, 0.5]}
    assert plan_of(tmp_path, axes=axes).points == list(itertools.product(*axes.values()))


def test_the_base_gait_may_be_a_file_beside_the_sweep(tmp_path: Path):
    (tmp_path / "mine.yaml").write_text(load_gait("melson/walk_5cm").to_yaml())
    assert plan_of(tmp_path, base="mine.yaml", axes={LENGTH: [0.0]}).base == tmp_path / "mine.yaml"


def test_values_that_a_database_cannot_hold_are_stored_as_text():
    assert [plain(x) for x in (1, 0.5, "a", None, True)] == [1, 0.5, "a", None, True]
    assert [plain(x) for x in (10**30, [0.0, 1], {"a": None})] == [
        "1" + 30 * "0", "[0.0, 1]", '{"a": null}',
    ]  # fmt: skip


def test_flat_names_are_dotted():
    assert flat({"a": {"b": {"c": 1}, "d": None}, "e": [2]}) == {"a.b.c": 1, "a.d": None, "e": [2]}


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ({}, "nothing is varied"),
        ({"axes": {"walk.stp_length": [1]}}, "did you mean 'walk.step_length'?"),
        ({"axes": {"walk": [1]}}, "no such key"),
        ({"axes": {"motion": ["balance"]}}, "axes.motion: cannot be varied"),
        ({"axes": {LENGTH: []}}, f"axes.{LENGTH}.values: "),
        ({"axes": {LENGTH: {"linspace": [0, 1]}}}, f"axes.{LENGTH}.linspace: "),
        ({"axes": {LENGTH: {"linspace": [0, 1, 2.5]}}}, "whole number from 1"),
        ({"axes": {LENGTH: {"linspace": [0, 1, 0]}}}, "whole number from 1"),
        ({"axes": {LENGTH: {"logspace": [0, 1, 3]}}}, "above 0, found 0"),
        ({"axes": {LENGTH: {"integers": [3, 3]}}}, "3 is not below 3"),
        ({"axes": {LENGTH: {}}}, "found none"),
        ({"axes": {LENGTH: {"integers": [1, 2], "linspace": [0, 1, 2]}}}, "linspace and integers"),
        ({"axes": {LENGTH: {"linespace": [0, 1, 2]}}}, "did you mean 'linspace'?"),
        ({"axes": {LENGTH: 0.05}}, f"axes.{LENGTH}: input should be a valid dictionary"),
        ({"axes": {LENGTH: {"uniform": [0, 1]}}}, "use linspace or logspace"),
        ({"axes": {LENGTH: [1]}, "samples": 3}, "samples: "),
        ({"axes": {LENGTH: [1]}, "sampling": "sobol"}, "samples: "),
        ({"axes": {LENGTH: [1]}, "sampling": "table"}, "table: "),
        ({"axes": {LENGTH: [1]}, "table": "x.csv"}, "table: "),
        ({"sampling": "table", "table": "missing.csv"}, "missing.csv: no such file"),
        ({"axes": {LENGTH: [1]}, "sampling": "random"}, "sampling: "),
        ({"axes": {LENGTH: [1]}, "seed": -1}, "seed: "),
        ({"axes": {LENGTH: [1]}, "base": "melson/none"}, "no gait of that name"),
        ({"axes": {LENGTH: [1]}, "mgs": 2}, "mgs: "),
        ({"axes": {LENGTH: [1]}, "filters": ["sped > 1"]}, "filters: no column 'sped'"),
        ({"axes": {LENGTH: [1]}, "filters": ["False"]}, "exclude all 1 points"),
        ({"axes": {LENGTH: [math.nan]}}, f"axes.{LENGTH}: nan is not a value"),
        ({"axes": {"robot": [3]}}, "3 is not the name of a robot"),
        (
            {"axes": {key: {"linspace": [0, 1, 5000]} for key in (LENGTH, HEIGHT)}},
            "25000000 gaits; at most 1000000",
        ),
    ],
)
def test_a_malformed_sweep_is_refused_with_its_key(
    tmp_path: Path, content: dict[str, Any], told: str
):
    with pytest.raises(ConfigError) as caught:
        plan_of(tmp_path, **content)
    assert told in str(caught.value)
    assert str(tmp_path) in str(caught.value) or "melson/none" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (f"{LENGTH}\n", "needs a first row"),
        (f"{LENGTH}\n0.1,0.2\n", "row 2 has 2 fields"),
        (f"{LENGTH},{LENGTH}\n0.1,0.2\n", "twice"),
        (f"{LENGTH}\n[1\n", "row 2"),
        ("walk.colour\nred\n", "no such key"),
    ],
)
def test_a_malformed_table_is_refused(tmp_path: Path, text: str, told: str):
    (tmp_path / "rows.csv").write_text(text)
    with pytest.raises(ConfigError, match=told):
        plan_of(tmp_path, sampling="table", table="rows.csv")


def test_every_form_of_an_axis_is_a_key_of_its_model():
    assert tuple(Axis.model_fields) == KINDS
