"""Monte Carlo runs: the same whatever the workers, and statistics against closed forms."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binomtest, mannwhitneyu

from mgs.judge.monte_carlo import (
    Draw,
    Robustness,
    monte_carlo,
    offenders,
    summary,
    survival_check,
    wilson,
)
from mgs.judge.verdict import replay_checks
from mgs.robot import Robot
from mgs.sim import DEFAULTS, replay
from mgs.sim.conditions import RANGES, draw
from mgs.sim.settings import settings_of_draws
from tests.support.motions import standing
from tests.support.replays import side_to_side

pytest.importorskip("mujoco")


@given(st.integers(1, 500), st.data())
def test_the_interval_is_wilsons(n: int, data: st.DataObject):
    k = data.draw(st.integers(0, n))
    expected = binomtest(k, n).proportion_ci(method="wilson")
    assert wilson(k, n) == pytest.approx((expected.low, expected.high), abs=1e-6)


def made_up(survived: list[bool], values: dict[str, list[float]]) -> tuple[Draw, ...]:
    return tuple(
        Draw(
            number=i,
            engine="mujoco",
            survived=alive,
            failed=() if alive else ("mujoco_upright",),
            fall_time=None if alive else 1.0,
            max_tilt_deg=1.0,
            figures={name: column[i] for name, column in values.items()},
        )
        for i, alive in enumerate(survived)
    )


def test_offenders_are_those_that_separate_falls_from_survivals():
    rng = np.random.default_rng(0)
    friction, supply, noise = rng.uniform(size=(3, 60))
    slope = rng.uniform(-1.0, 1.0, 60)
    survived = (friction > 0.3) & (np.abs(slope) < 0.8)
    values = {"friction": friction, "slope_x_deg": slope, "supply": supply, "noise": noise}
    draws = made_up(survived.tolist(), {k: v.tolist() for k, v in values.items()})
    found = {str(o["parameter"]): o["probability"] for o in offenders(draws)}
    assert set(list(found)[:2]) == {"friction", "slope_x_deg"}
    assert found["friction"] < 0.3
    assert found["slope_x_deg"] > 0.6
    u = mannwhitneyu(friction[~survived], friction[survived]).statistic
    assert found["friction"] == pytest.approx(u / ((~survived).sum() * survived.sum()))


def test_of_few_falls_nothing_is_said():
    assert offenders(made_up([True] * 8 + [False] * 2, {"friction": [0.1] * 10})) == []


def test_any_number_of_workers_gives_the_same_draws(melson: Robot):
    motion = standing(melson, 1.0)
    runs = [monte_carlo(motion, "mujoco", n=3, seed=5, workers=w) for w in (1, 2)]
    assert runs[0].to_dict() == runs[1].to_dict()
    assert [d.figures for d in runs[0].draws] == [
        draw(motion, RANGES["wide"], 5, k).figures() for k in range(3)
    ]
    assert runs[0].survived == 3


def test_a_draw_is_the_single_replay_under_its_conditions(melson: Robot):
    """With PD servos, whose sag is part of the draw, and with the longer step of all draws."""
    motion = side_to_side(melson, 0.05, 1.0)
    settings = dataclasses.replace(DEFAULTS["mujoco"], sag=0.05)
    of_draws = settings_of_draws("mujoco", "pd", settings)
    assert of_draws.dt == 2.0 * settings.dt
    found = monte_carlo(motion, "mujoco", n=3, seed=1, servo="pd", settings=settings, workers=2)
    assert found.to_dict()["servo"] == "pd"
    for drawn in found.draws:
        conditions = draw(motion, RANGES["wide"], 1, drawn.number)
        alone = replay(motion, "mujoco", of_draws, servo="pd", conditions=conditions)
        assert drawn.figures == conditions.figures("pd")
        assert alone.settings.sag == 0.05 * drawn.figures["sag"]
        assert drawn.max_tilt_deg == alone.max_tilt_deg
        assert drawn.fall_time == alone.fall_time
        assert drawn.failed == tuple(c.name for c in replay_checks(alone) if not c.ok)


def test_the_sag_says_something_of_pd_servos_alone(melson: Robot):
    conditions = draw(standing(melson, 0.1), RANGES["lab"], 0, 0)
    assert 0.5 <= conditions.figures("pd")["sag"] <= 2.0
    assert "sag" not in conditions.figures("ideal") | conditions.figures("model")


def test_progress_counts_the_draws(melson: Robot):
    seen: list[tuple[int, int]] = []
    monte_carlo(standing(melson, 1.0), "mujoco", n=2, progress=lambda *at: seen.append(at))
    assert seen == [(1, 2), (2, 2)]


def test_the_summary_is_of_the_worse_engine_and_plain_data():
    good = Robustness("pybullet", "ideal", "wide", 0, made_up([True] * 20, {}))
    bad = Robustness("mujoco", "ideal", "wide", 0, made_up([True] * 18 + [False] * 2, {}))
    figures = summary([good, bad])
    assert figures is not None
    assert (figures["n"], figures["survived"], figures["survival_rate"]) == (20, 18, 0.9)
    json.dumps(figures, allow_nan=False)
    assert summary([]) is None
    assert survival_check(good).ok
    check = survival_check(bad)
    assert not check.ok
    assert "18, 19" in check.where
