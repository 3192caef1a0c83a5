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
from mgs.experiments import Claim, melson, run
from mgs.experiments.melson.claims import all_claims, drift_claims, task_claims, torque_claims
from mgs.experiments.melson.figures import NAMES, plot_drift, plot_joint
from mgs.experiments.melson.gravity import gravity_cost, gravity_torques
from mgs.experiments.melson.runs import Study, drift_series, is_same_task, solve, tracking_errors
from mgs.gait import load_gait
from mgs.motion.dynamics import place_on_soles
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def study() -> Study:
    calls: list[tuple[int, int]] = []
    study = solve(lambda done, total: calls.append((done, total)))
    assert calls == [(i, 5) for i in range(1, 6)]
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


def test_gravity_torques_are_the_slope_of_potential_energy(study: Study) -> None:
    robot, stages = study.robot, study.scenarios["S3"]
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


@pytest.mark.parametrize("joint", ["hip_roll", "knee_pitch"])
def test_torque_claims_hold_by_potential_energy(
    study: Study, claims: dict[str, Claim], joint: str
) -> None:
    index = study.robot.joint_names.index(f"left_{joint}")
    samples = np.arange(300, 540)  # 3.0 s to 5.4 s: lead-in and weight shift, then single support
    torque = {
        name: slope_of_energy(study.robot, stages, samples, index, Side.LEFT)
        for name, stages in study.scenarios.items()
    }
    for kind, measure in (
        ("peak", lambda x: np.abs(x).max()),
        ("rms", lambda x: np.sqrt(np.mean(x**2))),
    ):
        claim = claims[f"left_{joint}_{kind}_torque"]
        expected = {name: measure(x) for name, x in torque.items()}
        assert claim.values == pytest.approx(expected, abs=1e-6)
        assert claim.holds is True
        assert expected["S3"] < expected["S1"] and expected["S3"] < expected["S2"]


def test_the_mean_cost_falls_by_a_tenth(study: Study, claims: dict[str, Claim]) -> None:
    claim = claims["mean_gravity_cost"]
    single = np.r_[300:540, 660:900]  # both single supports
    for name, torques in study.torques.items():
        expected = 0.5 * np.einsum("kj,kj->k", torques[single], torques[single]).mean()
        assert claim.values[name] == pytest.approx(expected)
    assert claim.holds is True
    assert claim.values["S3"] <= 0.9 * min(claim.values["S1"], claim.values["S2"])


def test_the_ankle_torque_follows_from_the_com_alone(study: Study) -> None:
    """Tau = (c - ankle) x M g about the ankle axis; the support foot itself is not a load."""
    robot, stages = study.robot, study.scenarios["S3"]
    data, joint = robot.model.createData(), robot.model.getJointId("left_ankle_roll")
    foot = robot.model.inertias[joint]
    torques = gravity_torques(robot, stages)[:, robot.joint_names.index("left_ankle_roll")]
    for k in (300, 420, 539):
        pin.forwardKinematics(robot.model, data, stages.motion.q[k])
        ankle = data.oMi[joint]
        arm = robot.mass * (stages.com.position[k] - ankle.translation)
        arm -= foot.mass * (ankle.act(foot.lever) - ankle.translation)
        moment = np.cross(arm, [0.0, 0.0, -9.81])
        # the sole stands still, so that the joint turns the rest of the robot the other way
        assert torques[k] == pytest.approx(ankle.rotation[:, 0] @ moment, abs=1e-4)


def test_drift_is_sampled_once_every_two_steps_at_equal_phases(study: Study) -> None:
    joint = study.robot.joint_names.index("right_hip_roll")
    samples = 300 + 720 * np.arange(15)  # first single support at 3.0 s, a stride takes 7.2 s
    for name, series in drift_series(study).items():
        angles = study.drift[name].joints.angles[samples, joint]
        np.testing.assert_allclose(series, np.degrees(angles))


def test_drift_claims_measure_the_last_ten_steps(study: Study, claims: dict[str, Claim]) -> None:
    joint = study.robot.joint_names.index("right_hip_roll")
    moved = {}
    for name, stages in study.drift.items():
        last = np.degrees(stages.joints.angles[300 + 720 * np.arange(9, 15), joint])
        moved[name] = last.max() - last.min()
    assert claims["drift_stopped"].values == pytest.approx(moved)
    assert claims["drift_stopped"].holds is True and moved["gamma_joint 1"] < 0.1
    assert claims["drift_without_task"].holds is True
    assert moved["gamma_joint 0"] > 10.0 * moved["gamma_joint 1"]


def test_all_runs_meet_the_same_task(study: Study, claims: dict[str, Claim]) -> None:
    assert claims["same_task"].holds is True and claims["task_met"].holds is True
    for stages in (*study.scenarios.values(), *study.drift.values()):
        position, rotation = tracking_errors(stages)
        assert position < 1e-4 and rotation < np.radians(0.01)
    other = run_stages(study.robot, load_gait("melson/walk_5cm", ("walk.step_length=0.04",)))
    assert not is_same_task(study.scenarios["S1"], other)


def test_tracking_errors_include_the_hands(study: Study) -> None:
    stages = study.scenarios["S1"]
    hands = stages.motion.hands.copy()
    hands[700, 1, 2] += 0.003
    motion = dataclasses.replace(stages.motion, hands=hands)
    position, _ = tracking_errors(dataclasses.replace(stages, motion=motion))
    assert position == pytest.approx(0.003, abs=1e-5)
    broken = {**study.scenarios, "S1": dataclasses.replace(stages, motion=motion)}
    assert task_claims(dataclasses.replace(study, scenarios=broken))[1].holds is False


def test_claims_fail_if_the_values_contradict_them(study: Study) -> None:
    swapped = {"S1": study.torques["S3"], "S2": study.torques["S2"], "S3": study.torques["S1"]}
    worse = torque_claims(dataclasses.replace(study, torques=swapped))
    assert [claim.holds for claim in worse] == [False] * 4
    names = ("gamma_joint 0", "gamma_joint 1")
    drift = dict(zip(names, (study.drift[names[1]], study.drift[names[0]]), strict=True))
    stopped, without = drift_claims(dataclasses.replace(study, drift=drift))[:2]
    assert stopped.holds is False and without.holds is False


def test_the_hip_roll_position_claim_reports_both_windows(
    study: Study, claims: dict[str, Claim]
) -> None:
    """The increase stated in the article occurs over the whole motion, not in single support."""
    claim = claims["left_hip_roll_position_peak"]
    index = study.robot.joint_names.index("left_hip_roll")
    angles = {k: np.degrees(s.joints.angles[:, index]) for k, s in study.scenarios.items()}
    inside = {name: np.abs(x[300:540]).max() for name, x in angles.items()}
    whole = {name: np.abs(x).max() for name, x in angles.items()}
    assert claim.values == pytest.approx(inside)
    assert inside["S2"] < inside["S3"] < inside["S1"] and claim.holds is False
    assert whole["S3"] > max(whole["S1"], whole["S2"])
    assert f"S3 {whole['S3']:.1f} deg" in claim.note


def test_claims_are_plain_data(claims: dict[str, Claim]) -> None:
    for claim in claims.values():
        content = json.loads(json.dumps(claim.to_dict(), allow_nan=False))
        assert set(content) >= {"id", "claim", "figure", "holds", "note"}
        assert content["holds"] in (True, False, "not applicable")
        assert isinstance(content["figure"], float | str)


def test_figures_show_the_runs(study: Study) -> None:
    torque, angle = plot_joint(study, "knee_pitch").axes
    index = study.robot.joint_names.index("left_knee_pitch")
    for line in torque.get_lines():
        np.testing.assert_allclose(
            np.asarray(line.get_ydata()), study.torques[str(line.get_label())][:, index]
        )
    for line in angle.get_lines():
        stages = study.scenarios[str(line.get_label())]
        np.testing.assert_allclose(
            np.asarray(line.get_ydata()), np.degrees(stages.joints.angles[:, index])
        )
    sampled = plot_drift(study).axes[1].get_lines()
    for line in sampled:
        expected = drift_series(study)[str(line.get_label())]
        np.testing.assert_allclose(np.asarray(line.get_ydata()), expected)


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
