"""Tests of the speed envelope: steps in whole samples, bisection, fastest walk."""

from __future__ import annotations

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from mgs.core.errors import ConfigError
from mgs.gait import parse_gait
from mgs.report import plot_envelope
from mgs.robot import Robot, leg_length, load_robot
from mgs.search import envelope
from mgs.search.envelope import (
    Envelope,
    Probe,
    default_step_times,
    default_walk,
    find_envelope,
    probe,
    with_step,
)

MELSON = load_robot("melson")
WALK = default_walk(MELSON, "melson")


def probe_of(time: float, length: float, *failed: str) -> Probe:
    return Probe(time, length, failed, "", 0.02, 1.0)


def envelope_of(*probes: Probe) -> Envelope:
    return Envelope(WALK, 0.25, ("mujoco",), "ideal", 0.01, probes)


def test_the_leg_length_is_the_sum_of_its_links(melson: Robot):
    """Oracle: heights in the zero posture of the URDF, in which the legs are straight."""
    import numpy as np
    import pinocchio as pin

    data = melson.model.createData()
    pin.framesForwardKinematics(melson.model, data, pin.neutral(melson.model))
    hip = data.oMi[melson.model.getJointId("left_hip_yaw")].translation
    sole = data.oMf[melson.sole_frames[0]].translation
    assert leg_length(melson) == pytest.approx(np.linalg.norm(hip - sole), rel=0.02)


@given(st.floats(0.12, 2.0), st.floats(0.0, 0.3))
def test_steps_have_the_given_duration_and_length(time: float, length: float):
    time = round(time, 2)
    walk = with_step(WALK, time, length).walk
    assert walk.step_length == length
    assert_allclose(walk.single_support + walk.double_support, time, rtol=1e-9)
    samples = walk.single_support / WALK.dt
    assert_allclose(samples, round(samples), atol=1e-6)
    assert walk.double_support >= 0.05 - 1e-9
    if time > 0.3:
        assert abs(walk.single_support - 0.8 * time) <= 0.5 * WALK.dt + 1e-9


def test_no_other_values_of_the_gait_change():
    assert with_step(WALK, 1.0, 0.0) == WALK
    other = with_step(WALK, 0.5, 0.05)
    assert other.com == WALK.com
    assert other.ik == WALK.ik
    assert other.walk.step_height == WALK.walk.step_height


def test_step_times_grow_with_the_root_of_the_leg():
    coman = load_robot("coman")
    ratio = (leg_length(coman) / leg_length(MELSON)) ** 0.5
    small, large = default_step_times(MELSON, 0.01), default_step_times(coman, 0.01)
    assert_allclose(large, [ratio * time for time in small], atol=0.011)


@settings(max_examples=20)
@given(longest=st.integers(0, 40))
def test_bisection_finds_the_longest_step_with_few_probes(longest: int):
    """Oracle: the threshold from which on the simulated probes fail."""
    asked = []

    def fake(robot: Robot, gait, engines, servo) -> Probe:
        length = gait.walk.step_length
        asked.append(length)
        return probe_of(0.5, length, *(() if length <= longest * 0.01 + 1e-9 else ("falls",)))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(envelope, "probe", fake)
        found = find_envelope(MELSON, WALK, [0.5], resolution=0.01, engines=("mujoco",))
    most = round(leg_length(MELSON) / 0.01)
    expected = min(longest, most)
    best = found.limits()[0.5]
    assert (0.0 if best is None else best.step_length) == pytest.approx(expected * 0.01, abs=1e-9)
    assert len(asked) <= 6
    assert len(set(asked)) == len(asked)


def test_the_fastest_walk_is_the_fastest_that_passes():
    slow, quick = probe_of(1.0, 0.10), probe_of(0.5, 0.08)
    found = envelope_of(slow, quick, probe_of(0.5, 0.2, "mujoco_upright"), probe_of(0.3, 0.1, "x"))
    assert found.fastest == quick
    assert found.limits() == {0.3: None, 0.5: quick, 1.0: slow}
    assert found.froude(quick) == pytest.approx(0.16**2 / (9.81 * 0.25))
    gait = found.fastest_gait()
    assert gait is not None
    assert gait.walk.step_length == 0.08
    assert parse_gait(gait.to_yaml(), "fastest.yaml") == gait
    assert envelope_of(probe_of(0.5, 0.1, "x")).fastest_gait() is None


def test_progress_and_kept_results_grow_with_every_step_time(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(
        envelope, "probe", lambda robot, gait, engines, servo: probe_of(
            gait.walk.single_support + gait.walk.double_support, gait.walk.step_length, "x"
        ),
    )  # fmt: skip
    told, kept = [], []
    find_envelope(
        MELSON, WALK, [0.5, 0.6], resolution=0.1, engines=("mujoco",),
        progress=lambda *done: told.append(done), keep=lambda found: kept.append(len(found.probes)),
    )  # fmt: skip
    assert told == [(1, 2), (2, 2)]
    assert kept[0] < kept[1]


def test_a_step_time_without_room_for_a_phase_is_refused():
    with pytest.raises(ConfigError, match=r"--times: 0\.08 s is too short for a step"):
        find_envelope(MELSON, WALK, [0.08], resolution=0.1, engines=("mujoco",))


def test_a_probe_names_its_failed_checks():
    pytest.importorskip("mujoco")
    walk = with_step(WALK, 0.6, 0.04)
    short = walk.model_copy(update={"walk": walk.walk.model_copy(update={"n_steps": 2})})
    good = probe(MELSON, short, ("mujoco",), "ideal")
    assert good.passed
    assert good.zmp_margin is not None and 0.0 < good.zmp_margin < 0.03
    assert good.max_tilt_deg is not None and good.max_tilt_deg < 5.0
    assert good.speed == pytest.approx(0.04 / 0.6)
    long = probe(MELSON, with_step(short, 0.6, 0.28), ("mujoco",), "ideal")
    assert long.failed in (("IkError",), ("JointLimitError",))
    assert "t = " in long.message
    assert (long.zmp_margin, long.max_tilt_deg) == (None, None)
    high = with_step(short, 0.25, 0.1)
    blocks = {
        "walk": high.walk.model_copy(update={"step_height": 0.04}),
        "ik": high.ik.model_copy(update={"on_limit": "record"}),  # the check names the speed
    }
    high = high.model_copy(update=blocks)
    hasty = probe(MELSON, high, ("mujoco",), "ideal")
    assert "joint_speed" in hasty.failed
    assert hasty.max_tilt_deg is None  # what the servos cannot do is not replayed


def test_the_number_of_workers_does_not_change_the_result():
    pytest.importorskip("mujoco")
    short = with_step(WALK, 0.6, 0.04)
    short = short.model_copy(update={"walk": short.walk.model_copy(update={"n_steps": 2})})
    found = [
        find_envelope(
            MELSON, short, [0.6, 0.8], resolution=0.15, engines=("mujoco",), servo="ideal",
            workers=workers,
        )
        for workers in (1, 2)
    ]  # fmt: skip
    rows = [sorted(map(str, f.to_dict()["probes"])) for f in found]  # type: ignore[call-overload]
    assert rows[0] == rows[1]
    assert json.loads(json.dumps(found[0].to_dict(), allow_nan=False))["robot"] == "melson"


def test_the_map_shows_every_probe_near_the_limit():
    found = envelope_of(
        probe_of(0.5, 0.08), probe_of(0.5, 0.1, "mujoco_upright"), probe_of(0.7, 0.1),
        probe_of(0.7, 0.12, "joint_speed"), probe_of(0.9, 0.1, "IkError"),
    )  # fmt: skip
    (axes,) = plot_envelope(found).axes
    labels = axes.get_legend_handles_labels()[1]
    for text in ("passes", "falls", "servo speed or torque too low", "fastest: 0.16 m/s"):
        assert any(text in label for label in labels), text
    shown = {tuple(map(float, xy)) for line in axes.lines for xy in line.get_xydata()}
    assert {(0.5, 0.08), (0.5, 0.1), (0.7, 0.1), (0.7, 0.12)} <= shown


def test_a_map_without_a_passing_walk_can_be_drawn():
    (axes,) = plot_envelope(envelope_of(probe_of(0.5, 0.1, "IkError"))).axes
    assert axes.lines
