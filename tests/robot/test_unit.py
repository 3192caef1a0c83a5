"""Tests of the corrections of one physical robot: the law, its inverse, and its file."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.errors import ConfigError, OutputExistsError
from mgs.robot import Robot, load_robot
from mgs.robot.unit import JointCorrection, UnitSpec, load_unit, unit_of, write_unit

MELSON = load_robot("melson")
corrections = st.builds(
    JointCorrection,
    zero_offset=st.floats(-0.1, 0.1),
    sign=st.sampled_from([1, -1]),
    scale=st.floats(0.9, 1.1),
    backlash=st.floats(0.0, 0.05),
    stiffness=st.none() | st.floats(5.0, 500.0),
)


def spec_of(joints: dict[str, JointCorrection], **changes: Any) -> UnitSpec:
    return UnitSpec(**{"mgs": 1, "unit": "number 7", "robot": "melson", "joints": joints} | changes)


@given(
    row=corrections,
    wanted=st.floats(-1.0, 1.0),
    torque=st.floats(0.1, 2.0) | st.floats(-2.0, -0.1),
)
def test_the_command_brings_the_joint_where_it_should_be(
    row: JointCorrection, wanted: float, torque: float
):
    """The oracle is the law as the module states it, for one joint with a firm load."""
    name, j = "left_knee_pitch", MELSON.joint_names.index("left_knee_pitch")
    unit = unit_of(spec_of({name: row}), MELSON)
    position, load = np.zeros(MELSON.n), np.zeros(MELSON.n)
    position[j], load[j] = wanted, torque
    command = unit.command_for(position, load)
    reached = row.sign * row.scale * command[j] + row.zero_offset
    reached -= torque / row.stiffness if row.stiffness else 0.0
    reached -= np.sign(torque) * row.backlash / 2.0
    assert reached == pytest.approx(wanted, abs=1e-12)
    others = np.delete(np.arange(MELSON.n), j)
    assert np.array_equal(command[others], position[others])
    free = unit.command_for(position)
    assert unit.unloaded(free) == pytest.approx(position, abs=1e-12)


def test_the_side_of_the_teeth_changes_without_a_jump(melson: Robot):
    unit = unit_of(spec_of({"waist_yaw": JointCorrection(backlash=0.01)}), melson)
    j = melson.joint_names.index("waist_yaw")
    torque = np.zeros((2001, melson.n))
    torque[:, j] = np.linspace(-1.5, 1.5, 2001)
    lead = unit.command_for(np.zeros_like(torque), torque)[:, j]
    assert (lead[0], lead[-1]) == pytest.approx((-0.005, 0.005))
    assert np.all(np.diff(lead) >= 0.0)
    # 0.01 rad over 2 % of the stall torque of 1.5 N m, in steps of 1.5 mN m
    assert np.diff(lead).max() == pytest.approx(0.01 * 0.0015 / 0.03, rel=1e-6)


@given(st.dictionaries(st.sampled_from(MELSON.joint_names), corrections, max_size=5))
def test_a_file_reads_back_exactly(joints: dict[str, JointCorrection]):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "unit.yaml"
        spec = spec_of(joints, source="log of 3 May")
        write_unit(spec, path)
        found, made = load_unit(path, MELSON), unit_of(spec, MELSON)
        for name in ("zero_offset", "sign", "scale", "backlash", "compliance"):
            assert np.array_equal(getattr(found, name), getattr(made, name))
        assert yaml.safe_load(path.read_text())["source"] == "log of 3 May"
        with pytest.raises(OutputExistsError):
            write_unit(spec, path)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"robot": "coman"}, "corrections of 'coman', but the motion is of 'melson'"),
        ({"joints": {"neck": {"scale": 1.0}}}, "joints.neck: melson has no such joint"),
        ({"joints": {"waist_yaw": {"scale": 0.0}}}, "waist_yaw.scale: input should be"),
        ({"joints": {"waist_yaw": {"sign": 2}}}, "joints.waist_yaw.sign"),
        (
            {"joints": {"waist_yaw": {"backlash": -0.1}}},
            "waist_yaw.backlash: input should be",
        ),
        (
            {"joints": {"waist_yaw": {"stiffness": 0.0}}},
            "waist_yaw.stiffness: input should be",
        ),
        (
            {"joints": {"waist_yaw": {"zero_offset": 57.0}}},
            "waist_yaw.zero_offset: input should be",
        ),
        ({"colour": "red"}, "colour"),
        ({"mgs": 2}, "mgs"),
    ],
)
def test_a_wrong_file_is_refused_with_file_and_key(
    changes: dict[str, Any], message: str, tmp_path: Path
):
    tree = {"mgs": 1, "unit": "number 7", "robot": "melson", "joints": {}} | changes
    path = tmp_path / "unit.yaml"
    path.write_text(yaml.safe_dump(tree))
    with pytest.raises(ConfigError) as refused:
        load_unit(path, MELSON)
    assert message in str(refused.value)
    assert str(path) in str(refused.value)
