"""Tests of the search: it finds an optimum, goes on where it was cut off, and repeats itself."""

from __future__ import annotations

import dataclasses
import json
import os
from pathlib import Path

import numpy as np
import pytest

from mgs.core.constants import GRAVITY
from mgs.core.errors import InputError, MgsError
from mgs.gait import WalkGait, load_gait
from mgs.robot import leg_length
from mgs.search.tune import study
from mgs.search.tune.evaluate import LEAST_RATE, PD_CASES, STAGES, Found
from mgs.search.tune.objective import ObjectiveName
from mgs.search.tune.setup import make_task
from mgs.search.tune.study import N_SCATTERED, Trial, counts, identity, scattered, search
from tests.search.tune.support import BEST, MELSON, by_formula, easy_task

pytest.importorskip("optuna")
pytest.importorskip("mujoco")


@pytest.fixture(autouse=True)
def _formula(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "evaluate", by_formula)


def run(path: Path, trials: int, **options: int) -> study.Search:
    return search(easy_task(), path / "a.journal", trials=trials, minutes=None, **options)


def test_the_search_beats_chance_and_names_the_parameters_that_matter(tmp_path: Path):
    """Chance: as many walks anywhere between the bounds, ten times over."""
    n = 150
    found = run(tmp_path, n)
    task, rng = found.task, np.random.default_rng(0)
    assert found.best is not None
    by_chance = []
    for _ in range(10):
        numbers = [p for p in task.space.parameters if not p.choices]
        walks = ({p.key: p.at(rng.uniform()) for p in numbers} for _ in range(n))
        by_chance.append(max(by_formula(task, values).score for values in walks))
    assert found.best.found.score > max(by_chance)
    by_importance = sorted(found.importance, key=lambda key: found.importance[key])
    assert set(by_importance[-len(BEST) :]) == set(BEST)
    assert sum(found.importance.values()) == pytest.approx(1.0)


def test_the_same_seed_gives_the_same_walks(tmp_path: Path):
    first, second = (run(tmp_path / str(i), N_SCATTERED + 6, seed=3) for i in range(2))
    other = run(tmp_path / "other", N_SCATTERED + 6, seed=4)
    assert [t.values for t in first.trials] == [t.values for t in second.trials]
    assert [t.values for t in first.trials[1:]] != [t.values for t in other.trials[1:]]
    assert first.trials[0].values == other.trials[0].values == first.task.space.start()


def test_a_search_that_was_cut_off_is_continued(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    calls: list[float] = []

    def cut_off(task: object, values: object, best: float, _promising: float) -> Found:
        calls.append(best)
        if len(calls) == 5:
            raise KeyboardInterrupt
        return by_formula(task, values, best)  # type: ignore[arg-type]

    monkeypatch.setattr(study, "evaluate", cut_off)
    first = run(tmp_path, 12)
    assert first.interrupted
    assert len(first.trials) == 4
    passing = [trial.found.score for trial in first.trials if trial.found.passed]
    second = run(tmp_path, 12)
    assert not second.interrupted
    assert [t.values for t in second.trials[:4]] == [t.values for t in first.trials]
    assert [t.found for t in second.trials[:4]] == [t.found for t in first.trials]
    assert len(second.trials) == 12
    assert calls[5] == max(passing, default=0.0)  # the best of the first run is not forgotten
    assert run(tmp_path, 12).trials == second.trials  # nothing is left to do


def test_the_journal_of_another_search_is_refused(tmp_path: Path):
    run(tmp_path, 2)
    with pytest.raises(InputError, match="another gait, robot, objective"):
        search(easy_task(seed=1), tmp_path / "a.journal", trials=3, minutes=None)
    for text in ("no journal\n", "no journal"):
        (tmp_path / "b.journal").write_text(text)
        with pytest.raises(InputError, match="not the journal of a search"):
            search(easy_task(), tmp_path / "b.journal", trials=3, minutes=None)
        assert (tmp_path / "b.journal").read_text() == text


def test_a_line_that_was_cut_off_is_removed_and_the_search_goes_on(tmp_path: Path):
    """As SIGKILL leaves it, at every place of the last two lines."""
    first = run(tmp_path, 3)
    journal = tmp_path / "a.journal"
    whole = journal.read_bytes()
    last = len(whole.rstrip(b"\n").rpartition(b"\n")[0])
    for cut in (*range(last - 5, last + 9), len(whole) - 1):
        journal.write_bytes(whole[:cut])
        again = run(tmp_path, 4)
        assert len(again.trials) == 4
        assert [t.values for t in again.trials[:2]] == [t.values for t in first.trials[:2]]
        for line in journal.read_bytes().splitlines():
            json.loads(line)


@pytest.mark.parametrize("line", ["[1]", "{}", '{"op_code": 99}', '{"op_code": 4}', "[" * 99_999])
def test_a_journal_that_nobody_wrote_is_refused(line: str, tmp_path: Path):
    (tmp_path / "a.journal").write_text(f"{line}\n")
    with pytest.raises(InputError, match="not the journal of a search"):
        run(tmp_path, 2)


def test_two_searches_do_not_share_a_journal(tmp_path: Path):
    from mgs.search.tune.journal import open_journal  # needs Optuna

    path = tmp_path / "a.journal"
    with open_journal(path), pytest.raises(MgsError, match="another search is writing"):
        run(tmp_path, 2)


def test_a_pipe_or_a_link_is_no_journal(tmp_path: Path):
    journal, precious = tmp_path / "a.journal", tmp_path / "precious"
    os.mkfifo(journal)
    with pytest.raises(MgsError, match="a device or a pipe"):
        run(tmp_path, 2)
    journal.unlink()
    precious.write_text("")
    journal.symlink_to(precious)
    with pytest.raises(MgsError, match="a link, which is never replaced"):
        run(tmp_path, 2)
    assert precious.read_text() == ""


def test_the_identity_of_a_search_depends_on_all_that_its_walks_have_in_common():
    task = easy_task()
    others = [
        dataclasses.replace(task, n_draws=3),
        dataclasses.replace(task, ranges="lab"),
        dataclasses.replace(task, objective="torque"),
        dataclasses.replace(task, least_margin=0.01),
        dataclasses.replace(task, space=dataclasses.replace(task.space, speed=0.07)),
    ]
    assert identity(task) == identity(easy_task())
    assert len({identity(other) for other in [task, *others]}) == 1 + len(others)


def test_a_search_with_fewer_servos_to_pass_is_another_one(monkeypatch: pytest.MonkeyPatch):
    before = identity(easy_task())
    monkeypatch.setattr(study, "PD_CASES", PD_CASES[:3])
    assert identity(easy_task()) != before


def test_the_first_walks_lie_about_the_start_gait_and_inside_the_bounds():
    task = easy_task()
    walks = scattered(task, 7)
    assert walks[0] == task.space.start()
    assert len(walks) == N_SCATTERED
    for parameter in task.space.parameters:
        if parameter.choices:
            assert {walk[parameter.key] for walk in walks} <= set(parameter.choices)
            continue
        values = np.array([float(walk[parameter.key]) for walk in walks])
        assert (values >= parameter.low).all()
        assert (values <= parameter.high).all()
        assert np.ptp(values) > 0.0


def n_quick(task: study.TuneTask) -> int:
    """How many of the first walks take a step in less than three time constants of a fall."""
    limit = 3.0 * np.sqrt(leg_length(task.robot) / GRAVITY)
    keys = ("walk.single_support", "walk.double_support")
    return sum(sum(float(walk[key]) for key in keys) < limit for walk in scattered(task, 7))


@pytest.mark.parametrize("objective", ["robust", "speed"])
def test_searches_for_robustness_and_speed_begin_with_quick_steps_too(objective: ObjectiveName):
    assert 8 <= n_quick(easy_task(objective)) <= N_SCATTERED - 8


def test_other_searches_begin_about_the_start_gait_alone():
    assert n_quick(easy_task("energy")) <= 3


def test_quick_steps_are_short_and_lead_where_the_start_gait_leads():
    leg, gait = leg_length(MELSON), load_gait("melson/walk_practical")
    assert isinstance(gait, WalkGait)
    for length, expected in ((0.1, 0.1 * leg), (-0.1, -0.1 * leg), (0.02, 0.02)):
        walk = gait.walk.model_copy(update={"step_length": length})
        start = gait.model_copy(update={"walk": walk})
        task = make_task(MELSON, start, "speed", engines=("mujoco",))
        quick = study._with_quick_steps(task)
        assert quick["walk.step_length"] == pytest.approx(expected)


def test_failed_walks_are_counted_by_stage():
    fates = [("checks", "joint_speed"), ("checks", "rest"), ("checks", "rest"), ("plan", "limit")]
    trials = tuple(
        Trial(i, {}, Found(-3.0, stage, reason), 1.0) for i, (stage, reason) in enumerate(fates)
    )
    passes = Trial(4, {}, Found(1.0, STAGES[-1]), 1.0)
    found = study.Search(easy_task(), (*trials, passes), {}, 1.0, False)
    assert counts(found) == {"checks": (3, "rest"), "plan": (1, "limit")}


def test_early_in_a_search_only_robust_walks_are_promising(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    asked: list[float] = []

    def judged(task: object, values: object, best: float, promising: float) -> Found:
        asked.append(promising)
        figures = {"survival mujoco, ideal servos": 0.3 + 0.01 * len(asked)}
        return dataclasses.replace(by_formula(task, values, best), figures=figures)  # type: ignore[arg-type]

    monkeypatch.setattr(study, "evaluate", judged)
    run(tmp_path, 10)
    assert asked[:4] == [LEAST_RATE] * 4
    assert asked[4:] == pytest.approx([0.3 + 0.01 * n for n in range(4, 10)])
