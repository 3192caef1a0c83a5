"""The search itself: Optuna proposes values, processes judge walks, a journal file keeps them all.

The sampler is the tree-structured Parzen estimator (J. Bergstra et al., "Algorithms for
hyper-parameter optimization", NIPS 2011) of all parameters together. Before it has enough to go on,
walks are scattered about the start gait. Only this process writes the journal, so that an
interrupted search goes on where it was.
"""

from __future__ import annotations

import concurrent.futures
import hashlib
import json
import math
import time
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import mgs
from mgs.core.errors import InputError, MgsError
from mgs.core.foreign import told_as
from mgs.judge.processes import result_of, worker_pool
from mgs.search.tune.evaluate import (
    LEAST_RATE,
    MOST_FAILED,
    PD_CASES,
    STAGES,
    WRONG_STIFFNESS,
    Found,
    TuneTask,
    evaluate,
    promising_rate,
)
from mgs.search.tune.space import STEP_KEYS, Parameter, Value, quick_steps

N_SCATTERED = 24  # walks about the start gait before the sampler takes over
SCATTER = (0.08, 0.25)  # standard deviations of their parameters, as parts of the bounds
EARLY = 0.4  # part of a search in which only robust walks are replayed in slow engines
LEAST_WALKS = 20  # below, nothing is said of the importance of parameters
IDENTITY = "identity"  # attribute of a study: hash of all that its walks have in common
FOUND = "found"  # attribute of a walk


@dataclass(frozen=True)
class Trial:
    """One walk of a search."""

    number: int
    values: dict[str, Value]
    found: Found
    seconds: float


@dataclass(frozen=True, eq=False)
class Search:
    """All walks of a search, and the importance of each parameter for the score."""

    task: TuneTask
    trials: tuple[Trial, ...]
    importance: dict[str, float]  # sums to 1; empty: too few walks
    seconds: float  # of this run
    interrupted: bool

    @property
    def best(self) -> Trial | None:
        """The best walk that passes; None: there is none."""
        return best_of(self.trials)


def best_of(trials: Iterable[Trial]) -> Trial | None:
    """The best walk that passes; None: there is none."""
    passed = [trial for trial in trials if trial.found.passed]
    return max(passed, key=lambda trial: trial.found.score, default=None)


Tell = Callable[[int, float, "Trial | None"], None]
"""Called with the number of finished walks, the time [s], and the best walk so far."""


def search(
    task: TuneTask,
    journal: Path,
    *,
    trials: int | None,
    minutes: float | None,
    workers: int = 1,
    seed: int = 0,
    tell: Tell | None = None,
) -> Search:
    """Search until the number of walks or the time is reached, or Ctrl-C is pressed.

    Args:
        task: what all walks have in common.
        journal: file that keeps all walks; a search that it contains is continued.
        trials: number of walks, those of the journal included; None: no limit.
        minutes: time of this run [min]; None: no limit.
        workers: number of processes.
        seed: seed of the sampler.
        tell: called after each walk.

    Raises:
        InputError: the journal belongs to another search or is damaged.
        MgsError: Optuna is not installed, or another search writes the journal.
    """
    optuna = _optuna()
    from mgs.search.tune.journal import open_journal  # needs Optuna

    with open_journal(journal) as opened:
        with told_as(lambda what: InputError(f"{journal}: not the journal of a search: {what}")):
            study = _study(optuna, task, opened, str(journal), seed)
            done = _trials(study)
        return _searched(optuna, study, task, done, trials, minutes, workers, tell)


def _searched(
    optuna: Any,
    study: Any,
    task: TuneTask,
    done: list[Trial],
    trials: int | None,
    minutes: float | None,
    workers: int,
    tell: Tell | None,
) -> Search:
    """Continue a study; see `search`."""
    space = _distributions(optuna, task.space.parameters)
    started, interrupted = time.monotonic(), False
    best = best_of(done)
    running: dict[concurrent.futures.Future[tuple[Found, float]], Any] = {}

    def promising() -> float:
        part_of_trials = 0.0 if trials is None else len(done) / trials
        part_of_time = 0.0 if minutes is None else (time.monotonic() - started) / (60.0 * minutes)
        early = max(part_of_trials, part_of_time) < EARLY
        return LEAST_RATE if early else promising_rate(task, [trial.found for trial in done])

    def more() -> bool:
        enough = trials is not None and len(done) + len(running) >= trials
        late = minutes is not None and time.monotonic() - started > 60.0 * minutes
        return not enough and not late

    try:
        with worker_pool(_judge, task, workers) as submit:
            while running or more():
                while more() and len(running) < workers:
                    trial = study.ask(space)
                    score = task.least_score if best is None else best.found.score
                    running[submit(dict(trial.params), score, promising())] = trial
                ended, _ = concurrent.futures.wait(running, return_when="FIRST_COMPLETED")
                for future in ended:
                    trial, (found, seconds) = running.pop(future), result_of(future)
                    trial.set_user_attr(FOUND, {**vars(found), "seconds": seconds})
                    study.tell(trial, found.score)
                    done.append(Trial(trial.number, dict(trial.params), found, seconds))
                    best = best_of(done)
                    if tell is not None:
                        tell(len(done), time.monotonic() - started, best)
    except KeyboardInterrupt:
        interrupted = True
        _cut_off(optuna, study)
    seconds = time.monotonic() - started
    return Search(task, tuple(done), _importance(optuna, study), seconds, interrupted)


def counts(found: Search) -> dict[str, tuple[int, str]]:
    """Number of walks that failed a stage, and the most frequent reason, by stage."""
    reasons: dict[str, Counter[str]] = {}
    for trial in found.trials:
        if not trial.found.passed:
            reasons.setdefault(trial.found.stage, Counter())[trial.found.reason] += 1
    return {stage: (n.total(), n.most_common(1)[0][0]) for stage, n in reasons.items()}


def identity(task: TuneTask) -> str:
    """Hash of all that the walks of a search have in common."""
    space = task.space
    content = {
        "mgs": mgs.__version__,
        "gait": space.gait.model_dump(mode="json"),
        "robot": [task.robot.spec.name, task.robot.n, round(task.robot.mass, 9)],
        "parameters": [vars(parameter) for parameter in space.parameters],
        "speed": space.speed,
        "task": [task.objective, task.engines, task.servos, task.ranges, task.n_draws, task.seed],
        "least": [task.least_margin, task.least_score],
        "judged": [STAGES, PD_CASES, WRONG_STIFFNESS, MOST_FAILED],  # else scores differ
    }
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()


def _optuna() -> Any:
    try:
        import optuna
    except ImportError as error:
        raise MgsError("the search needs Optuna: pip install 'mgs[tune]'") from error
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    return optuna


def _study(optuna: Any, task: TuneTask, journal: Any, name: str, seed: int) -> Any:
    """The study in a journal, made if it is missing; walks cut off are marked as failed."""
    storage = optuna.storages.JournalStorage(journal)
    study = optuna.create_study(
        storage=storage, study_name="mgs tune", direction="maximize", load_if_exists=True
    )
    known = len(study.get_trials(deepcopy=False))
    if not known and IDENTITY not in study.user_attrs:
        study.set_user_attr(IDENTITY, identity(task))
    if study.user_attrs.get(IDENTITY) != identity(task):
        raise InputError(
            f"{name}: belongs to a search with another gait, robot, objective, parameters or "
            "version of mgs; use the same arguments, another output, or --force for a new search"
        )
    for values in scattered(task, seed)[known:]:
        study.enqueue_trial(values)
    _cut_off(optuna, study)
    study.sampler = optuna.samplers.TPESampler(
        seed=seed + len(study.get_trials(deepcopy=False)),  # a continued search does not repeat
        n_startup_trials=N_SCATTERED,
        multivariate=True,
        constant_liar=True,
    )
    return study


def _cut_off(optuna: Any, study: Any) -> None:
    """Mark walks whose judgement was cut off as failed."""
    for trial in study.get_trials(states=(optuna.trial.TrialState.RUNNING,)):
        study.tell(trial.number, state=optuna.trial.TrialState.FAIL)


def scattered(task: TuneTask, seed: int) -> list[dict[str, Value]]:
    """Values of the walks that a search begins with: the start gait, then walks about it.

    Where robustness or speed is sought, half of them are walks about the start gait with quick
    steps. Between slow and quick steps fewer walks survive, so that a search may not get there.
    """
    rng = np.random.default_rng([seed, 1])
    centres = [task.space.start()]
    found = [centres[0]]
    if task.objective in ("robust", "speed"):
        centres.append(_with_quick_steps(task))
    for number in range(1, N_SCATTERED):
        width = SCATTER[number % 2]
        start = centres[number // 2 % len(centres)]
        values: dict[str, Value] = {}
        for parameter in task.space.parameters:
            value = start[parameter.key]
            if parameter.choices:
                other = rng.uniform() < width
                values[parameter.key] = str(rng.choice(parameter.choices)) if other else value
            else:
                place = parameter.place(float(value)) + width * rng.normal()
                values[parameter.key] = parameter.at(float(place))
        found.append(values)
    return found


def _with_quick_steps(task: TuneTask) -> dict[str, Value]:
    """Values of the start gait with quick steps, as far as their keys are varied."""
    values, quick = task.space.start(), quick_steps(task.robot)
    for parameter in task.space.parameters:
        if parameter.key in quick and not parameter.choices:
            value = quick[parameter.key]
            if parameter.key in STEP_KEYS:
                own = float(values[parameter.key])
                value = math.copysign(min(abs(own), value), own)
            values[parameter.key] = min(max(value, parameter.low), parameter.high)
    return values


def _distributions(optuna: Any, parameters: tuple[Parameter, ...]) -> dict[str, Any]:
    made = optuna.distributions
    return {
        p.key: made.CategoricalDistribution(p.choices)
        if p.choices
        else made.FloatDistribution(p.low, p.high, log=p.log)
        for p in parameters
    }


def _trials(study: Any) -> list[Trial]:
    """Walks of a study that were judged to the end."""
    found = []
    for trial in study.get_trials(deepcopy=False):
        if FOUND in trial.user_attrs and trial.value is not None:
            kept = dict(trial.user_attrs[FOUND])
            seconds = kept.pop("seconds")
            found.append(Trial(trial.number, dict(trial.params), Found(**kept), seconds))
    return found


def _importance(optuna: Any, study: Any) -> dict[str, float]:
    """Importance of the parameters by PED-ANOVA; empty if there are too few walks.

    S. Watanabe et al., "PED-ANOVA: Efficiently quantifying hyperparameter importance in arbitrary
    subspaces", IJCAI 2023.
    """
    if len(_trials(study)) < LEAST_WALKS:
        return {}
    evaluator = optuna.importance.PedAnovaImportanceEvaluator()
    return dict(optuna.importance.get_param_importances(study, evaluator=evaluator))


def _judge(
    task: TuneTask, values: dict[str, Value], best: float, promising: float
) -> tuple[Found, float]:
    started = time.perf_counter()
    found = evaluate(task, values, best, promising)
    return found, time.perf_counter() - started
