"""Tests of refinement: touchdown times, acceptance of corrections, and a correction that helps."""

from __future__ import annotations

import dataclasses
from dataclasses import asdict

import numpy as np
import pytest
from numpy.testing import assert_allclose

import mgs.search.refine
from mgs.core.contact import Side, Support
from mgs.gait import load_gait
from mgs.judge.motion_checks import check_motion
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.motion_file import read_motion, write_motion
from mgs.pipeline import run_stages
from mgs.robot import Robot
from mgs.search.refine import Trial, refine
from mgs.sim import replay
from mgs.sim.measure import Touchdowns, touchdowns

SHORT = ("walk.n_steps=3", "com.preview=0.8", "walk.lead_in=0.8", "walk.lead_out=0.8")
DT = 0.01


@pytest.fixture(scope="module")
def short_walk(melson: Robot) -> Motion:
    return run_stages(melson, load_gait("melson/walk_practical", SHORT), "short").motion


# --- touchdowns -------------------------------------------------------------------------------


def steps(*offsets: int) -> tuple[np.ndarray, np.ndarray]:
    """Contacts and planned support of alternating steps of 40 samples with given delays."""
    support = [Support.DOUBLE] * 20
    loads = [[0.5, 0.5]] * 20
    for i, late in enumerate(offsets):
        standing = Side(i % 2)
        support += [Support.single(standing)] * 40 + [Support.DOUBLE] * 20
        step = np.zeros((60, 2))
        step[:, standing] = 1.0
        step[40 + late :, standing.other] = 0.5
        loads += step.tolist()
    contacts = np.zeros((len(loads), 2, 5))
    contacts[:, :, 2] = 25.0 * np.array(loads)
    return contacts, np.array(support, dtype=np.int8)


@pytest.mark.parametrize("late", [(0, 0, 0), (3, -2, 0), (-10, 5, 7), (0, 15, -15)])
def test_touchdowns_have_their_simulated_delays(late: tuple[int, ...]):
    found = touchdowns(*steps(*late), DT)
    assert found.n == len(late)
    assert_allclose([found.earliest, found.latest], [DT * min(late), DT * max(late)], atol=1e-12)


def test_a_sole_that_never_lands_has_the_largest_delay():
    contacts, support = steps(0, 0, 0)
    contacts[:, 1] = [0.0, 0.0, 0.0, 0.0, 0.0]
    found = touchdowns(contacts, support, DT)
    assert found.latest > 0.4
    assert touchdowns(contacts[:30], support[:30], DT) == Touchdowns(0)


# --- what is kept -----------------------------------------------------------------------------


def trial(engine: str, tilt: float, fall_time: float | None = None, *failed: str) -> Trial:
    return Trial(engine, fall_time, failed, tilt, 0.0, 0.0, Touchdowns(0))  # type: ignore[arg-type]


def test_scores_compare_falls_then_checks_then_tilt():
    worst_first = [
        trial("mujoco", 1.0, 2.0),
        trial("mujoco", 9.0, 5.0),
        trial("mujoco", 1.0, None, "mujoco_yaw", "mujoco_position"),
        trial("mujoco", 3.0, None, "mujoco_yaw"),
        trial("mujoco", 3.0),
        trial("mujoco", 2.9),
    ]
    scores = [t.score for t in worst_first]
    assert scores == sorted(scores, reverse=True)
    assert len(set(scores)) == len(scores)


@pytest.mark.parametrize(
    ("tilts", "kept", "parts"),
    [
        # per motion the tilts in both engines; the first is the motion as planned
        ([(2, 2), (1, 1), (0.5, 0.5)], [True, True], [0.4, 0.4]),
        ([(2, 2), (1, 3), (1, 1)], [False, True], [0.4, 0.2]),  # better in both, or not at all
        ([(2, 2), (3, 3), (3, 3), (3, 3), (3, 3)], [False] * 4, [0.4, 0.2, 0.1, 0.05]),
    ],
)
def test_a_correction_is_kept_if_it_is_better_in_every_engine(
    short_walk: Motion, monkeypatch: pytest.MonkeyPatch, tilts, kept, parts
):
    told = iter([tilt for pair in tilts for tilt in pair])

    def fake(motion: Motion, load_left, result):
        return trial(result, next(told)), np.full((motion.n_samples, 2), 1e-4)

    monkeypatch.setattr(mgs.search.refine, "replay", lambda motion, engine, **_: engine)
    monkeypatch.setattr(mgs.search.refine, "_trial", fake)
    progress = []
    found = refine(
        short_walk, ("pybullet", "mujoco"), attempts=len(tilts) - 1,
        progress=lambda *done: progress.append(done),
    )  # fmt: skip
    assert [attempt.kept for attempt in found.attempts] == kept
    assert [attempt.part for attempt in found.attempts] == parts
    assert found.improved == any(kept)
    assert progress[-1] == (2 * len(tilts), 2 * len(tilts))
    if found.improved:
        # what is off is taken off the CoM reference, by the parts that were kept
        taken = sum(part for part, keep in zip(parts, kept, strict=True) if keep) * 1e-4
        middle = short_walk.n_samples // 2
        shift = found.motion.com_ref[middle] - short_walk.com_ref[middle]
        assert_allclose(shift, [-taken, -taken, 0.0], atol=1e-9)
        assert_allclose(found.motion.com_ref[[0, -1]], short_walk.com_ref[[0, -1]], atol=1e-12)
        assert all(check.ok for check in check_motion(found.motion))
    else:
        assert found.motion is short_walk
        assert found.after is found.before


def test_a_refined_motion_is_marked_and_can_be_refined_again(
    short_walk: Motion, monkeypatch: pytest.MonkeyPatch, tmp_path
):
    told = iter([2.0, 1.0, 1.0, 0.5])

    def fake(motion: Motion, load_left, result):
        return trial(result, next(told)), np.full((motion.n_samples, 2), 1e-4)

    monkeypatch.setattr(mgs.search.refine, "replay", lambda motion, engine, **_: engine)
    monkeypatch.setattr(mgs.search.refine, "_trial", fake)
    once = refine(short_walk, ("mujoco",), attempts=1).motion
    assert once.provenance.refined is not None
    assert asdict(once.provenance.refined) == {"parts": (0.4,), "engines": ("mujoco",)}
    write_motion(once, tmp_path / "once.mcap")
    again = refine(read_motion(tmp_path / "once.mcap"), ("mujoco",), attempts=1).motion
    middle = short_walk.n_samples // 2
    shift = again.com_ref[middle] - short_walk.com_ref[middle]
    assert_allclose(shift, [-0.8e-4, -0.8e-4, 0.0], atol=1e-9)


def test_deviations_are_relative_to_the_support_soles(short_walk: Motion):
    """The plan is displaced by 3 mm, so that the deviation of the CoM is 3 mm."""
    pytest.importorskip("mujoco")
    result = replay(short_walk, "mujoco")
    tasks = run_stages(short_walk.robot, short_walk.gait).tasks
    honest, deviation = mgs.search.refine._trial(short_walk, tasks.load_left, result)
    assert honest.com_rms < 1e-3
    assert np.abs(deviation).max() < 1e-3
    n = short_walk.n_samples
    ramp = np.outer(np.linspace(0.0, 1.0, n), [0.003, -0.002, 0.0])
    shifted = dataclasses.replace(short_walk, com=short_walk.com - ramp)
    _, seen = mgs.search.refine._trial(shifted, tasks.load_left, result)
    middle = slice(n // 4, 3 * n // 4)
    assert_allclose((seen - deviation)[middle], ramp[middle, :2], atol=1e-5)


@pytest.mark.slow
def test_refinement_makes_a_failing_walk_without_feed_forward_pass_in_both_engines(melson: Robot):
    for name in ("pybullet", "mujoco"):
        pytest.importorskip(name)
    motion = run_stages(melson, load_gait("melson/walk_practical"), "walk_practical").motion
    found = refine(motion, ("pybullet", "mujoco"), feed_forward=False)
    assert all(t.failed for t in found.before)  # a fall is a failed check
    assert not any(t.failed for t in found.after)
    for engine in ("pybullet", "mujoco"):  # as validate would see it
        again = replay(found.motion, engine, servo="model", feed_forward=False)
        assert all(check.ok for check in replay_checks(again))
    assert all(check.ok for check in check_motion(found.motion))
