"""Tests of the experiments on Melson: measures against independent ones, and figures as numbers.

Some sentences of the article do not hold in our runs. The tests pin what was measured, so that a
change of the figures is noticed; none asserts that all claims hold.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from mgs.core.contact import Side, Support
from mgs.core.errors import OutputExistsError
from mgs.core.geometry import rotation_angles
from mgs.experiments import Claim, melson, run
from mgs.experiments.melson.claims import all_claims
from mgs.experiments.melson.drift_claims import drift_claims, drift_series
from mgs.experiments.melson.figures import NAMES, plot_drift, plot_joint
from mgs.experiments.melson.gravity import gravity_cost, gravity_torques
from mgs.experiments.melson.position_claims import is_so
from mgs.experiments.melson.runs import (
    Study,
    Walk,
    limit_distance,
    settings_of,
    solve,
    support_costs,
    tracking_errors,
    zmp_margin,
)
from mgs.experiments.melson.torque_claims import leg_claims
from mgs.experiments.variant import Variant
from mgs.gait import load_gait
from mgs.ik_solver.clik import ClosedLoopReport
from mgs.motion.dynamics import place_on_soles
from mgs.pipeline import Stages
from mgs.robot import Robot

Array = NDArray[np.float64]
FIRST, SECOND = np.arange(300, 540), np.arange(660, 900)  # samples of both single supports
STRIDES = 300 + 720 * np.arange(15)  # first single support at 3.0 s, a stride takes 7.2 s


@pytest.fixture(scope="module")
def study() -> Study:
    calls: list[tuple[int, int]] = []
    study = solve(lambda done, total: calls.append((done, total)))
    assert calls == [(i, 8) for i in range(1, 9)]
    return study


@pytest.fixture(scope="module")
def claims(study: Study) -> dict[str, Claim]:
    return {claim.id: claim for claim in all_claims(study)}


def energy(robot: Robot, joints: Array, side: Side, sole: Array) -> Array:
    """Potential energy (m,) [J] at joint angles (m, n) with a fixed sole (7,).

    Floating-base kinematics only; no support tree.
    """
    soles, root = np.tile(sole, (len(joints), 2, 1)), np.full(len(joints), side, dtype=np.int8)
    q = place_on_soles(robot, joints, root, soles)
    data = robot.model.createData()
    heights = [pin.centerOfMass(robot.model, data, row)[2] for row in q]
    return robot.mass * 9.81 * np.array(heights)


def slope_of_energy(robot: Robot, stages: Stages, samples: Array, joint: int, side: Side) -> Array:
    """Gravity torque (m,) [N m] of a joint at samples (m,), by central differences of energy."""
    step, out = 1e-5, np.empty(len(samples))
    for row, k in enumerate(samples):
        moved = np.tile(stages.joints.angles[k], (2, 1))
        moved[:, joint] += [step, -step]
        high, low = energy(robot, moved, side, stages.tasks.soles[k, side])
        out[row] = (high - low) / (2.0 * step)
    return out


# --- measures ---------------------------------------------------------------------------------


def test_gravity_torques_are_the_slope_of_potential_energy(study: Study) -> None:
    robot, stages = study.robot, study.short["S3"].stages
    torques = gravity_torques(robot, stages)
    for side in Side:
        samples = np.flatnonzero(stages.tasks.support == Support.single(side))[[0, 77, -1]]
        for joint in range(robot.n):
            expected = slope_of_energy(robot, stages, samples, joint, side)
            np.testing.assert_allclose(torques[samples, joint], expected, atol=1e-7)
    assert np.isnan(torques[stages.tasks.support == Support.DOUBLE]).all()


def test_gravity_cost_is_half_the_sum_of_squares() -> None:
    torques = np.array([[1.0, -2.0, 2.0], [np.nan] * 3])
    np.testing.assert_allclose(gravity_cost(torques), [4.5, np.nan])


def test_costs_of_single_supports_are_means_over_their_samples(study: Study) -> None:
    walk = study.short["S2"]
    for samples, found in zip((FIRST, SECOND), support_costs(walk), strict=True):
        rows = walk.gravity[samples]
        assert found == pytest.approx(0.5 * np.einsum("kj,kj->k", rows, rows).mean())


def test_a_walk_of_eight_steps_has_eight_single_supports_on_alternate_sides(study: Study) -> None:
    sides = [side for side, _ in study.longer["S1"].supports]
    assert sides == [Side.LEFT, Side.RIGHT] * 4


def test_the_ankle_torque_follows_from_the_com_alone(study: Study) -> None:
    """Tau = (c - ankle) x M g about the ankle axis; the support foot itself is not a load.

    The CoM is a task. Therefore no null-space motion changes this torque, and the sentence of the
    article that scenario 3 does not reduce it cannot fail.
    """
    robot, stages = study.robot, study.short["S3"].stages
    data, joint = robot.model.createData(), robot.model.getJointId("left_ankle_roll")
    foot = robot.model.inertias[joint]
    column = robot.joint_names.index("left_ankle_roll")
    for k in (300, 420, 539):
        pin.forwardKinematics(robot.model, data, stages.motion.q[k])
        ankle = data.oMi[joint]
        arm = robot.mass * (stages.com.position[k] - ankle.translation)
        arm -= foot.mass * (ankle.act(foot.lever) - ankle.translation)
        moment = np.cross(arm, [0.0, 0.0, -9.81])
        # the sole stands still, so that the joint turns the rest of the robot the other way
        expected = ankle.rotation[:, 0] @ moment
        for walk in study.short.values():
            assert walk.gravity[k, column] == pytest.approx(expected, abs=1e-4)


def test_all_runs_of_a_length_have_the_same_task_and_meet_it(study: Study) -> None:
    for walks in (study.short, study.longer, study.long):
        first, *others = walks.values()
        for other in others:
            for product in ("tasks", "com"):
                a, b = getattr(first.stages, product), getattr(other.stages, product)
                for field in dataclasses.fields(a):
                    assert np.array_equal(getattr(a, field.name), getattr(b, field.name))
    for walk in study.all_walks:
        motion = walk.stages.motion
        turns = rotation_angles(motion.soles[..., 3:], motion.soles_ref[..., 3:])
        assert tracking_errors(walk).max() < 1e-4 and turns.max() < np.radians(0.01)
        assert walk.stages.joints.report_of(ClosedLoopReport).newton_updates == 0


def test_tracking_errors_include_the_hands(study: Study) -> None:
    stages = study.short["S1"].stages
    hands = stages.motion.hands.copy()
    hands[700, 1, 2] += 0.003
    motion = dataclasses.replace(stages.motion, hands=hands)
    walk = Walk(study.robot, dataclasses.replace(stages, motion=motion))
    assert tracking_errors(walk)[700] == pytest.approx(0.003, abs=1e-5)


def test_the_margin_of_the_zmp_is_negative_outside_the_sole(study: Study) -> None:
    stages = study.short["S1"].stages
    assert zmp_margin(study.short["S1"]) == pytest.approx(0.029, abs=0.001)
    zmp = stages.motion.zmp.copy()
    zmp[400] = stages.motion.soles[400, Side.LEFT, :2] + [0.0, 0.04]  # sole of 60 mm width
    moved = dataclasses.replace(stages, motion=dataclasses.replace(stages.motion, zmp=zmp))
    assert zmp_margin(Walk(study.robot, moved)) == pytest.approx(-0.01, abs=1e-6)


def test_the_distance_from_the_limits_names_the_joint(study: Study) -> None:
    stages = study.short["S1"].stages
    angles = stages.joints.angles.copy()
    angles[5, study.robot.joint_names.index("left_knee_pitch")] = np.radians(129.0)
    joints = dataclasses.replace(stages.joints, angles=angles)
    walk = Walk(study.robot, dataclasses.replace(stages, joints=joints))
    distance, joint = limit_distance(walk)
    assert (distance, joint) == (
        pytest.approx(1.0, abs=0.01),
        "left_knee_pitch",
    )  # a limit of 2.269 rad


def test_drift_is_sampled_once_every_two_steps_at_equal_phases(study: Study) -> None:
    joint = study.robot.joint_names.index("right_hip_roll")
    for name, series in drift_series(study).items():
        angles = study.long[name].stages.joints.angles[STRIDES, joint]
        np.testing.assert_allclose(series, np.degrees(angles))


# --- variants ---------------------------------------------------------------------------------


def test_settings_of_a_variant_change_the_scenario() -> None:
    everything = Variant(
        "all", ("walk.first_support=right",), amplitude=1.5, speed=0.5, gains=2.0
    )  # fmt: skip
    gait = load_gait("melson/s3", settings_of("melson/s3", 8, everything))
    assert gait.walk.n_steps == 8 and gait.walk.first_support == "right"
    assert gait.walk.step_length == pytest.approx(0.075)
    assert gait.walk.double_support == pytest.approx(2.4)
    assert gait.walk.single_support == pytest.approx(4.8)
    assert (gait.ik.gamma_joint, gait.ik.gamma_grav) == pytest.approx((0.7, 3.2))
    plain = load_gait("melson/s3", settings_of("melson/s3", 2, Variant("none")))
    assert plain == load_gait("melson/s3", ("ik.on_limit=record",))


# --- claims -----------------------------------------------------------------------------------


@pytest.mark.parametrize("joint", ["hip_roll", "knee_pitch"])
def test_peak_torques_by_potential_energy(
    study: Study, claims: dict[str, Claim], joint: str
) -> None:
    index = study.robot.joint_names.index(f"left_{joint}")
    torque = {
        name: slope_of_energy(study.robot, walk.stages, FIRST[::3], index, Side.LEFT)
        for name, walk in study.short.items()
    }
    expected = {name: np.abs(x).max() for name, x in torque.items()}
    assert claims[f"left_{joint}_peak_torque"].values == pytest.approx(expected, abs=1e-3)


def test_torques_of_the_hip_and_what_the_article_says(claims: dict[str, Claim]) -> None:
    """Section 5: significantly reduced. The RMS is, by a quarter; the peak is not."""
    peak, rms = claims["left_hip_roll_peak_torque"], claims["left_hip_roll_rms_torque"]
    assert peak.values == pytest.approx({"S1": 1.279, "S2": 1.243, "S3": 1.238}, abs=0.01)
    assert rms.values == pytest.approx({"S1": 1.218, "S2": 1.181, "S3": 0.899}, abs=0.01)
    assert (peak.holds, rms.holds) == (False, True)
    whole = claims["left_hip_roll_whole_torque"]
    assert whole.values == pytest.approx({"S1": 1.278, "S2": 1.242, "S3": 1.244}, abs=0.01)
    assert whole.holds is False
    every = claims["hip_roll_every_support"]
    assert len(every.values) == 10 and every.figure == "lower in 3 of 10 phases"
    assert max(every.values.values()) == pytest.approx(0.249, abs=0.02)


def test_torques_of_the_knee_and_what_the_article_says(claims: dict[str, Claim]) -> None:
    """Section 5: the peak is reduced. It is, in every single support of both legs."""
    peak = claims["left_knee_pitch_peak_torque"]
    assert peak.values == pytest.approx({"S1": 1.173, "S2": 1.124, "S3": 1.005}, abs=0.01)
    assert claims["knee_pitch_every_support"].figure == "lower in 10 of 10 phases"


def test_positions_over_the_whole_motion_and_what_the_article_says(
    study: Study, claims: dict[str, Claim]
) -> None:
    """Section 5: hip higher, knee slightly higher, ankle lower. Only the first one is so."""
    expected = {
        "hip_roll": ({"S1": 10.22, "S2": 9.85, "S3": 26.65}, True),
        "knee_pitch": ({"S1": 57.63, "S2": 57.89, "S3": 56.35}, False),
        "ankle_roll": ({"S1": 14.25, "S2": 13.87, "S3": 18.24}, False),
    }
    for joint, (values, holds) in expected.items():
        claim = claims[f"left_{joint}_position_peak"]
        assert claim.values == pytest.approx(values, abs=0.2) and claim.holds is holds
        index = study.robot.joint_names.index(f"left_{joint}")
        for name, walk in study.short.items():
            angle = np.degrees(walk.stages.joints.angles[:, index])
            assert claim.values[name] == pytest.approx(np.abs(angle).max())
            assert f"{name} {np.abs(angle[FIRST]).max():.2f}" in claim.note


def test_the_cost_of_gravity_falls_and_that_of_joint_limits_rises(claims: dict[str, Claim]) -> None:
    cost = claims["single_support_cost"]
    assert cost.values == pytest.approx({"S1": 1.359, "S2": 1.254, "S3": 1.127}, abs=0.01)
    assert cost.figure.startswith("lower in 10 of 10 phases") and cost.holds is True
    both = claims["combination"]
    assert both.values["H_joint S3"] == pytest.approx(0.184, abs=0.005)
    assert both.values["H_joint S1"] == pytest.approx(0.151, abs=0.005)
    assert both.holds is False


def test_the_drift_of_the_long_walk(study: Study, claims: dict[str, Claim]) -> None:
    joint = study.robot.joint_names.index("right_hip_roll")
    moved = {
        name: np.ptp(np.degrees(walk.stages.joints.angles[STRIDES[9:], joint]))
        for name, walk in study.long.items()
    }
    assert claims["drift_visible"].values["last"] == pytest.approx(moved["S1"])
    assert claims["drift_absent"].values["last"] == pytest.approx(moved["S2"])
    assert moved["S1"] == pytest.approx(0.354, abs=0.01)  # [deg]
    assert moved["S2"] < 1e-3 and claims["cyclic"].values["last"] < 1e-3


def test_words_become_comparisons() -> None:
    assert is_so("hip_roll", {"S1": 1.0, "S2": 1.1, "S3": 1.2})
    assert not is_so("hip_roll", {"S1": 1.0, "S2": 1.1, "S3": 1.05})
    assert is_so("knee_pitch", {"S1": 1.0, "S2": 1.0, "S3": 1.05})
    assert not is_so("knee_pitch", {"S1": 1.0, "S2": 1.0, "S3": 1.2})  # not slightly
    assert is_so("ankle_roll", {"S1": 1.0, "S2": 1.1, "S3": 0.9})
    assert not is_so("ankle_roll", {"S1": 1.0, "S2": 1.1, "S3": 1.05})


def test_claims_fail_if_the_runs_contradict_them(study: Study) -> None:
    swapped = {"S1": study.short["S3"], "S2": study.short["S2"], "S3": study.short["S1"]}
    worse = leg_claims(dataclasses.replace(study, short=swapped))
    assert [claim.holds for claim in worse] == [False] * len(worse)
    long = {"S1": study.long["S2"], "S2": study.long["S1"]}
    _, visible, absent, cyclic = drift_claims(dataclasses.replace(study, long=long))
    assert (visible.holds, absent.holds, cyclic.holds) == (False, False, False)


def test_every_claim_has_its_place_in_the_article(claims: dict[str, Claim]) -> None:
    for claim in claims.values():
        content = json.loads(json.dumps(claim.to_dict(), allow_nan=False))
        assert content["source"].startswith(("Section", "Abstract")) and content["note"]
        assert content["class"] == "paper"
        assert (content["holds"] == "not applicable") == (content["figure"] == "")
        if content["figure"]:
            assert set(content["methods"]) <= {"S1", "S2", "S3"} and content["methods"]


# --- figures ----------------------------------------------------------------------------------


def test_figures_show_the_runs(study: Study) -> None:
    torque, _, angle = plot_joint(study, 4).axes
    index = study.robot.joint_names.index("left_knee_pitch")
    for line in torque.get_lines():
        walk = study.short[str(line.get_label())]
        np.testing.assert_allclose(np.asarray(line.get_ydata()), walk.gravity[:, index])
    for line in angle.get_lines():
        expected = np.degrees(study.short[str(line.get_label())].stages.joints.angles[:, index])
        np.testing.assert_allclose(np.asarray(line.get_ydata()), expected)
    sampled = plot_drift(study).axes[1].get_lines()
    for line, expected in zip(sampled, drift_series(study).values(), strict=True):
        np.testing.assert_allclose(np.asarray(line.get_ydata()), expected)


@pytest.mark.slow
def test_run_writes_every_figure(
    study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(melson, "solve", lambda progress: study)
    claims = run("melson", tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(f"{n}.png" for n in NAMES)
    assert len({claim.id for claim in claims}) == len(claims)
    monkeypatch.setattr(melson, "solve", lambda progress: pytest.fail("work before the check"))
    with pytest.raises(OutputExistsError):
        run("melson", tmp_path, force=False)
