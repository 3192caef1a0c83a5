"""Tests of the experiments of Faraji and Ijspeert: claims by id."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from PIL import Image

from mgs.experiments import Claim, run
from mgs.experiments.faraji.runs import ROBOT, Z_MAX, Key, gait_of, run_one
from mgs.robot import load_robot

TASKS = "ABCDEFGH"


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Claim], Path]:
    folder = tmp_path_factory.mktemp("faraji")
    return {claim.id: claim for claim in run("faraji", folder)}, folder


def test_every_claim_that_applies_holds(found: tuple[dict[str, Claim], Path]):
    assert [claim.id for claim in found[0].values() if claim.holds is False] == []


def test_every_task_has_a_claim_that_holds(found: tuple[dict[str, Claim], Path]):
    held = {claim.id[0] for claim in found[0].values() if claim.holds is True}
    assert set(TASKS) <= held


def test_claims_that_depend_on_another_solver_are_not_applicable_with_a_reason(
    found: tuple[dict[str, Claim], Path],
):
    aside = {c.id: c.note for c in found[0].values() if c.holds == "not applicable"}
    assert set(aside) == {"A_ik3_few", "C_ik5_few", "time"}
    assert all("SNOPT" in note or "solver" in note for note in aside.values())


def test_no_bounded_run_violates_limits_or_region(found: tuple[dict[str, Claim], Path]):
    assert found[0]["region"].values["worst"] <= 1e-9


def test_thresholds_are_those_of_the_method(found: tuple[dict[str, Claim], Path]):
    claims = found[0]
    assert claims["A_ik2"].values["ik2"] >= 50.0
    assert min(claims["A_ik4_ik5"].values.values()) >= 30.0
    assert max(claims["B_height"].values.values()) <= 0.7
    assert max(claims["C_com"].values.values()) <= 0.75
    assert min(claims["C_limits"].values.values()) > 10.0
    assert max(claims["C_hard"].values.values()) <= 1e-4
    assert claims["D_horizontal"].values["weighted"] <= 5e-3
    peaks = claims["F_acceleration"].values
    assert peaks["gamma 0"] >= 3.0 * peaks["gamma 10"]
    assert min(claims["G_power"].values.values()) > 3.0


def test_figures_are_written(found: tuple[dict[str, Claim], Path]):
    images = sorted(found[1].glob("*.png"))
    assert len(images) == 8
    for path in images:
        with Image.open(path) as image:
            assert len(image.convert("RGB").getcolors(1 << 24) or []) > 20


def test_z_max_is_the_height_with_straight_legs():
    robot = load_robot(ROBOT)
    q = robot.standing_q.copy()
    q[7:] = 0.0
    data = robot.model.createData()
    com = pin.centerOfMass(robot.model, data, q)
    pin.updateFramePlacements(robot.model, data)
    height = com[2] - data.oMf[robot.sole_frames[0]].translation[2]
    assert height == pytest.approx(Z_MAX, abs=5e-5)


def test_the_slow_twist_is_the_twist_at_a_tenth_of_the_speed():
    fast, slow = gait_of(Key("twist", "ik4")), gait_of(Key("twist", "ik4", variant="slow"))
    for a, b in zip(fast.balance.channels, slow.balance.channels, strict=True):
        assert a.frequency == pytest.approx(10.0 * b.frequency)
    assert slow.balance.duration == pytest.approx(10.0 * fast.balance.duration)
    assert slow.dt == pytest.approx(10.0 * fast.dt)


def test_a_run_is_measured_where_its_channels_have_their_full_amplitude():
    run = run_one(load_robot(ROBOT), Key("squat", "ik4", 3))
    wanted = run.stages.motion.com_ref[run.window, 2]
    assert np.ptp(wanted) == pytest.approx(0.1, abs=1e-4)
    assert wanted.mean() == pytest.approx(Z_MAX - 0.07, abs=5e-4)
