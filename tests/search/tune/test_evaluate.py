"""Tests of the stages of an evaluation: their order, their scores, and what is left out."""

from __future__ import annotations

import dataclasses
import itertools
from types import SimpleNamespace

import numpy as np
import pytest

from mgs.core.errors import InfeasibleGaitError
from mgs.gait import load_gait
from mgs.judge.monte_carlo import monte_carlo
from mgs.judge.motion_checks import Check
from mgs.motion import Motion
from mgs.pipeline import run_stages
from mgs.robot import Robot
from mgs.search.tune import evaluate as module
from mgs.search.tune.evaluate import (
    LEAST_RATE,
    MOST_FAILED,
    STAGES,
    Column,
    evaluate,
    judge_plan,
    promising_rate,
    survival_rate,
    wrong_replays,
)
from mgs.search.tune.objective import foot_clearance, known_score, mean_speed, plan_figures
from mgs.sim import Settings
from tests.search.tune.support import MELSON, easy_task
from tests.support.replays import side_to_side

pytest.importorskip("mujoco")


@pytest.fixture(scope="module")
def walk() -> Motion:
    gait = easy_task().space.gait
    steps = gait.walk.model_copy(update={"n_steps": 3})
    return run_stages(MELSON, gait.model_copy(update={"walk": steps})).motion


def test_speed_and_clearance_of_a_plan_are_those_that_its_gait_asks_for(walk: Motion):
    gait = walk.gait.walk  # type: ignore[union-attr]
    step_time = gait.single_support + gait.double_support
    assert mean_speed(walk) == pytest.approx(gait.step_length / step_time, rel=1e-3)
    assert foot_clearance(walk) == pytest.approx(gait.step_height, rel=1e-2)
    figures = plan_figures(walk)
    mean_square = np.square(walk.torque).sum(axis=1).mean()
    assert figures["torque_rms"] == pytest.approx(np.sqrt(mean_square), rel=0.01)


def test_the_clearance_of_a_rolling_sole_is_that_of_its_lowest_corner():
    gait = load_gait("melson/walk_rolling")
    motion = run_stages(MELSON, gait).motion
    height = gait.walk.step_height  # type: ignore[union-attr]
    assert foot_clearance(motion) == pytest.approx(height, rel=0.05)


def test_scores_rise_with_what_is_wanted():
    figures = {"speed": 0.1, "cost_of_transport": 0.5, "torque_rms": 2.0}
    better = {"speed": 0.2, "cost_of_transport": 0.4, "torque_rms": 1.0}
    for objective in ("speed", "energy", "torque"):
        worse, best = (known_score(objective, f) for f in (figures, better))
        assert worse is not None
        assert best is not None
        assert 0.0 < worse < best
    assert known_score("robust", figures) is None


def test_a_plan_that_shuffles_or_loses_its_margin_fails(walk: Motion):
    task = easy_task()
    good = judge_plan(task, walk)
    assert (good.stage, good.reason) == (STAGES[-1], "")
    flat = np.array(walk.soles)
    flat[..., 2] *= 0.4
    low = judge_plan(task, dataclasses.replace(walk, soles=flat))
    assert "clearance" in low.reason
    strict = dataclasses.replace(task, least_margin=good.figures["zmp_margin"] + 0.01)
    assert judge_plan(strict, walk).reason == "margin asked for"
    same = dataclasses.replace(task, least_margin=good.figures["zmp_margin"])
    assert judge_plan(same, walk).stage == STAGES[-1]
    assert -4.0 < judge_plan(strict, walk).score < -3.0


@pytest.mark.parametrize("margin", [0.0, 5e-5, 0.01])
@pytest.mark.parametrize("outside", [1e-5, 1e-3, 0.5])
def test_a_plan_whose_zmp_leaves_the_polygon_scores_below_every_replay(
    walk: Motion, monkeypatch: pytest.MonkeyPatch, outside: float, margin: float
):
    check = Check("zmp_margin", False, -outside, 0.0, "m", None, "")
    monkeypatch.setattr(module, "check_motion", lambda _: [check])
    found = judge_plan(easy_task(margin=margin), walk)
    assert found.stage == STAGES[1]
    assert -4.0 < found.score < -3.0


class Fakes:
    """Stands for all stages; `fails` names the first check or replay that fails."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, fails: str = "") -> None:
        self.calls: list[str] = []
        self.fails = fails
        monkeypatch.setattr(module, "run_stages", self.plan)
        monkeypatch.setattr(module, "check_motion", lambda _: [self.check("zmp_margin")])
        monkeypatch.setattr(
            module,
            "plan_figures",
            lambda _: {"speed": 0.1, "clearance": 1.0, "cost_of_transport": 0.5, "torque_rms": 2.0},
        )
        monkeypatch.setattr(module, "replay", self.replay)
        monkeypatch.setattr(module, "replay_checks", lambda *_: [])
        monkeypatch.setattr(module, "prepare", lambda motion, engine, settings, servo: servo)
        monkeypatch.setattr(module, "replay_draw", self.draw)

    def plan(self, *_: object) -> object:
        if self.fails == "plan":
            raise InfeasibleGaitError("out of reach")
        return SimpleNamespace(motion=SimpleNamespace(duration=10.0, dt=0.01))

    def check(self, name: str) -> Check:
        return Check(name, self.fails != name, 0.03, 0.02, "", None, "")

    def replay(
        self, _: object, engine: str, settings: object, *, servo: str, assumed_stiffness: float
    ) -> object:
        del settings, assumed_stiffness
        self.calls.append(f"{engine} {servo}")
        return SimpleNamespace(fell=self.fails == f"{engine} {servo}", fall_time=4.0)

    def draw(self, task: object, number: int) -> object:
        servo = task.prepared  # type: ignore[attr-defined]
        self.calls.append(f"draw {servo}")
        fell = self.fails == f"draw {servo}" or (self.fails == "one draw" and number == 1)
        return SimpleNamespace(survived=not fell)


def both(objective: str = "robust", n_draws: int = 2) -> module.TuneTask:
    task = easy_task(objective, margin=0.0)  # type: ignore[arg-type]
    return dataclasses.replace(task, engines=("pybullet", "mujoco"), n_draws=n_draws)


@pytest.mark.parametrize("objective", ["robust", "speed"])
def test_a_walk_is_scored_by_the_stage_that_it_fails(
    monkeypatch: pytest.MonkeyPatch, objective: str
):
    order = ["plan", "zmp_margin", "mujoco pd", "draw model", "pybullet ideal", ""]
    if objective == "robust":
        order.remove("draw model")  # it counts, and is no failure
    scores, stages = [], []
    for fails in order:
        fakes = Fakes(monkeypatch, fails)
        found = evaluate(both(objective), {})
        scores.append(found.score)
        stages.append(found.stage)
        if fails == "zmp_margin":
            assert fakes.calls == []
        if fails in ("mujoco pd", "draw model"):
            assert not any("pybullet" in call for call in fakes.calls)
    assert scores == sorted(scores)
    assert len(set(scores)) == len(order)
    assert scores[-2] < 0.0 < scores[-1]
    expected = [s for s in STAGES if objective == "speed" or s != "random conditions"]
    assert stages == expected


def test_a_later_fall_scores_higher(monkeypatch: pytest.MonkeyPatch):
    scores = []
    for time in (1.0, 9.0):
        fakes = Fakes(monkeypatch)
        fell = SimpleNamespace(fell=True, fall_time=time)
        monkeypatch.setattr(module, "replay", lambda *_, fell=fell, **__: fell)
        scores.append(evaluate(both(), {}).score)
        assert fakes.calls == []
    assert scores[0] < scores[1]


def missing_when(monkeypatch: pytest.MonkeyPatch, fails: set[int]) -> tuple[float, int, str]:
    """Score, number of replays and reason of a walk that falls in some of its first replays."""
    Fakes(monkeypatch)
    n = 0

    def replay(*_: object, **__: object) -> object:
        nonlocal n
        n += 1
        return SimpleNamespace(fell=n in fails, fall_time=5.0)

    monkeypatch.setattr(module, "replay", replay)
    found = evaluate(both("speed"), {})
    return found.score, n, found.reason


def test_the_fewer_replays_a_walk_fails_the_higher_it_scores(monkeypatch: pytest.MonkeyPatch):
    """Wherever they are in the order of the replays."""
    first, last, two, three = (
        missing_when(monkeypatch, fails)[0] for fails in ({1}, {13}, {12, 13}, {1, 2, 3})
    )
    assert first == last > two > three
    assert missing_when(monkeypatch, {3, 13})[2].startswith("mujoco model")


def test_a_walk_that_fails_many_replays_is_given_up(monkeypatch: pytest.MonkeyPatch):
    score, n, _ = missing_when(monkeypatch, set(range(1, 99)))
    assert n == MOST_FAILED
    assert -3.0 < score < missing_when(monkeypatch, {1, 2, 3})[0]
    assert missing_when(monkeypatch, {1, 2, 5, 9})[1] == 9
    in_the_slow_engine = missing_when(monkeypatch, {16, 17})
    assert in_the_slow_engine[1] == 16
    assert -1.0 < in_the_slow_engine[0] < 0.0


def test_a_walk_that_passes_is_replayed_with_all_servos_in_both_engines(
    monkeypatch: pytest.MonkeyPatch,
):
    """At all sags and frictions, and with commands for a stiffness that is wrong."""
    Fakes(monkeypatch)
    swept: list[tuple[str, float, float]] = []
    modelled: list[tuple[str, float]] = []

    def replay(
        _: object, engine: str, settings: Settings, *, servo: str, assumed_stiffness: float
    ) -> object:
        if servo == "pd":
            swept.append((engine, round(np.rad2deg(settings.sag), 9), settings.friction))
        if servo == "model":
            modelled.append((engine, assumed_stiffness))
        return SimpleNamespace(fell=False)

    monkeypatch.setattr(module, "replay", replay)
    assert evaluate(both(), {}).passed
    engines = ("mujoco", "pybullet")
    assert sorted(swept) == sorted(itertools.product(engines, (0.5, 1.0, 2.0), (0.7, 1.0, 1.3)))
    assert sorted(modelled) == sorted(itertools.product(engines, (0.7, 1.0, 1.4)))


def test_servos_without_a_model_have_no_feed_forward_that_could_be_wrong():
    assert wrong_replays(("ideal", "pd")) == []
    assert [str(case) for case in wrong_replays(("ideal", "model"))] == [
        "model, commands for 0.7 times the stiffness",
        "model, commands for 1.4 times the stiffness",
    ]


def test_a_plan_that_cannot_be_the_best_is_not_replayed(monkeypatch: pytest.MonkeyPatch):
    fakes = Fakes(monkeypatch)
    for best in (0.11, 0.0995):  # worse, and better by less than a hundredth
        found = evaluate(both("speed"), {}, best=best)
        assert (found.pruned, found.passed, found.score) == (True, False, 0.1)
    assert fakes.calls == []
    assert evaluate(both("speed"), {}, best=0.09).passed


def test_random_conditions_end_when_the_best_is_out_of_reach(monkeypatch: pytest.MonkeyPatch):
    fakes = Fakes(monkeypatch, "draw ideal")
    found = evaluate(both(n_draws=10), {}, best=0.75)
    assert found.pruned
    assert found.score < 0.75
    assert fakes.calls.count("draw ideal") == 3  # after two falls 0.8 was within reach
    assert "draw model" not in fakes.calls
    fakes = Fakes(monkeypatch, "one draw")
    found = evaluate(both(n_draws=10), {}, best=0.75)
    assert found.passed
    assert found.figures["survival mujoco, ideal servos"] == 0.9
    assert found.score == pytest.approx(0.9)


def test_slow_engines_replay_only_walks_that_are_promising(monkeypatch: pytest.MonkeyPatch):
    fakes = Fakes(monkeypatch, "one draw")
    found = evaluate(both(n_draws=10), {}, promising=0.91)
    assert (found.stage, found.passed) == ("random conditions", False)
    assert -2.0 < found.score < -1.0
    assert not any("pybullet" in call for call in fakes.calls)
    assert evaluate(both(n_draws=10), {}, promising=0.9).passed
    only = dataclasses.replace(both(n_draws=10), engines=("mujoco",))
    assert evaluate(only, {}, promising=0.91).passed  # no slow engine is left out


def test_a_walk_is_promising_that_survives_as_often_as_any_before(
    monkeypatch: pytest.MonkeyPatch,
):
    Fakes(monkeypatch, "one draw")
    task = both(n_draws=4)
    judged = [evaluate(task, {}, promising=rate) for rate in (0.0, 0.9)]
    assert [found.passed for found in judged] == [True, False]
    assert promising_rate(task, judged) == 0.75
    assert promising_rate(task, []) == 0.0
    Fakes(monkeypatch)
    assert promising_rate(task, [evaluate(task, {})]) == LEAST_RATE


def test_without_a_floor_the_rate_is_that_of_monte_carlo(melson: Robot):
    """The same draws, whether they are asked for one by one or all together."""
    task = dataclasses.replace(easy_task(), n_draws=4)
    motion = side_to_side(melson, 0.06, 1.0)
    rate = survival_rate(task, motion, Column("mujoco", "ideal"), 0.0)
    found = monte_carlo(motion, "mujoco", n=4, seed=task.seed, ranges=task.ranges)
    assert rate == found.survived / 4
