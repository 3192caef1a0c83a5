"""Servo sweeps: every case is the replay it names, and the figure shows what became of it."""

from __future__ import annotations

import dataclasses
import json
import math

import numpy as np
import pytest

from mgs.cli.verdict_text import servo_sweep as sweep_in_words
from mgs.judge.servo_cases import CASES, Case, Outcome, ServoSweep
from mgs.judge.servo_sweep import sweep_servos
from mgs.judge.verdict import replay_checks
from mgs.report import plot_servo_sweep
from mgs.robot import Robot
from mgs.sim import DEFAULTS, replay
from mgs.sim.replay import replay_prepared
from tests.support.motions import standing
from tests.support.replays import side_to_side

pytest.importorskip("mujoco")


def test_the_cases_are_those_of_the_documentation():
    assert len(CASES) == len(set(CASES)) == 72
    sags = {case.sag_deg for case in CASES}
    assert (min(sags), max(sags)) == (0.25, 10.0)
    assert {case.friction for case in CASES} == {0.7, 1.0, 1.3}
    assert {case.assumed_stiffness for case in CASES} == {None, 0.7, 1.4}


def test_each_outcome_is_that_of_its_replay(melson: Robot):
    motion = side_to_side(melson, 0.06, 0.8)
    motion = dataclasses.replace(motion, torque=np.full((motion.n_samples, melson.n), 0.1))
    cases = (Case(None, 0.7, 0.5), Case(None, 1.0, 40.0), Case(0.7, 1.3, 2.0))
    progress: list[tuple[int, int]] = []
    found = sweep_servos(motion, "mujoco", cases=cases, progress=lambda *at: progress.append(at))
    assert progress == [(1, 3), (2, 3), (3, 3)]
    assert sweep_servos(motion, "mujoco", cases=cases, workers=2) == found
    for case, outcome in zip(cases, found.outcomes, strict=True):
        settings = dataclasses.replace(
            DEFAULTS["mujoco"], friction=case.friction, sag=math.radians(case.sag_deg)
        )
        result = replay(
            motion,
            "mujoco",
            settings,
            servo="pd",
            feed_forward=case.assumed_stiffness is not None,
            assumed_stiffness=case.assumed_stiffness or 1.0,
        )
        failed = [c.name.removeprefix("mujoco_") for c in replay_checks(result) if not c.ok]
        assert outcome == Outcome(case, result.fell, tuple(failed))
    assert [outcome.fell for outcome in found.outcomes] == [False, True, False]
    json.dumps(found.to_dict(), allow_nan=False)
    assert found.to_dict()["passed"] == sum(not outcome.failed for outcome in found.outcomes)


def test_the_damping_time_is_that_of_the_settings(melson: Robot, monkeypatch):
    used = []
    monkeypatch.setattr(
        "mgs.judge.servo_sweep.replay_prepared",
        lambda prepared, **_: used.append(prepared.settings) or replay_prepared(prepared),
    )
    settings = dataclasses.replace(DEFAULTS["mujoco"], damping_time=0.03)
    sweep_servos(standing(melson, 0.1), "mujoco", settings, cases=(Case(None, 1.3, 2.0),))
    (found,) = used
    assert (found.damping_time, found.friction) == (0.03, 1.3)
    assert found.sag == math.radians(2.0)


def made_up(failed: dict[Case, tuple[str, ...]]) -> ServoSweep:
    outcomes = (Outcome(case, "upright" in names, names) for case, names in failed.items())
    return ServoSweep("mujoco", tuple(outcomes))


SWEEP = made_up(
    {
        Case(None, 1.0, 0.25): ("position",),
        Case(None, 1.0, 0.5): (),
        Case(None, 1.0, 1.0): (),
        Case(None, 1.0, 2.0): ("upright",),
        Case(None, 1.0, 4.0): (),
        Case(0.7, 1.0, 1.0): ("upright",),
        Case(0.7, 1.0, 2.0): ("yaw",),
    }
)


def test_passing_sags_are_named_as_ranges():
    assert SWEEP.passing(None, 1.0) == (0.5, 1.0, 4.0)
    assert SWEEP.passing(0.7, 1.0) == ()
    first, second = sweep_in_words(SWEEP)
    assert first.endswith("planned angles, friction 1: passes at sags of 0.5 to 1 and 4 deg")
    assert second.endswith("0.7 times the stiffness, friction 1: passes at no sag from 1 to 2 deg")


def test_the_figure_has_a_mark_for_each_replay():
    figure = plot_servo_sweep([SWEEP], "walk")
    planned, fed_forward = figure.axes
    marks = {line.get_label(): np.asarray(line.get_xdata()).tolist() for line in planned.lines}
    assert marks == {"passes": [0.5, 1.0, 4.0], "stays up, fails a check": [0.25], "falls": [2.0]}
    assert sum(len(line.get_xdata()) for line in fed_forward.lines) == 2
    assert "planned angles" in planned.get_title(loc="left")
    assert "0.7" in fed_forward.get_title(loc="left")
