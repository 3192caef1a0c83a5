"""Making a gait library: Dask's workers make the gaits, and this process alone writes them."""

from __future__ import annotations

import hashlib
import json
import sqlite3
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from distributed import Client

import mgs
from mgs.core.atomic_files import replace_file
from mgs.core.errors import ConfigError, MgsError
from mgs.library.cluster import cluster, dashboard_of
from mgs.library.interrupt import deferred_interrupt, interrupts_told_as_such
from mgs.library.lock import locked
from mgs.library.manifest import (
    GAITS_FOLDER,
    LOST,
    Manifest,
    Value,
    holds_gaits,
    is_whole,
    writing,
)
from mgs.library.new_folder import library_folder
from mgs.library.outcomes import Work, outcomes
from mgs.library.points import Plan, plain
from mgs.library.summary import Summary
from mgs.library.worker import TIMEOUT, GaitWorker, Outcome, Recipe, solver_of
from mgs.robot import load_robot
from mgs.sim import EngineName, ServoName


def recipe_of(
    plan: Plan,
    engines: tuple[EngineName, ...] = (),
    servo: ServoName = "ideal",
    timeout: float = TIMEOUT,
) -> Recipe:
    """Everything that workers need to make the gaits of a plan.

    A gait that takes longer than `timeout` [s] is given up.

    Raises:
        ConfigError: a robot is missing or malformed.
    """
    robots = {}
    for name in plan.robots:
        robot = load_robot(name)
        robots[name] = robot.yaml, robot.urdf
    name = plan.base.stem.encode("utf-8", "replace").decode()  # a file name may be no text
    return Recipe(str(plan.base), plan.base_text, name, robots, engines, servo, timeout)


def run_batch(
    plan: Plan,
    recipe: Recipe,
    folder: Path,
    *,
    resume: bool = False,
    workers: int | None = None,
    address: str | None = None,
    tell: Callable[[Summary], None] | None = None,
) -> Summary:
    """Make the library of a plan.

    Args:
        plan: the gaits to make.
        recipe: everything that workers need, made from the same plan.
        folder: folder of the library; made if missing.
        resume: continue an earlier run: make only gaits that are missing, damaged or lost.
        workers: number of processes on this machine; None: one for each processor.
        address: address of the scheduler of a running cluster, such as tcp://HOST:8786, which is
            then used instead of processes of our own.
        tell: called with the summary at the start and after each gait.

    Raises:
        ConfigError: the library in the folder was made from something else.
        MgsError: the folder holds a library and `resume` is not set, another run is writing it,
            nothing can be written, or the cluster is lost. All files written until then are whole.
    """
    identity = identity_of(plan, recipe)
    if not resume and holds_gaits(folder):
        raise MgsError(
            f"{folder}: holds a library; continue it with --resume, or use another folder"
        )
    summary = Summary(folder, len(plan.points))
    with library_folder(folder), locked(folder), writing(folder, identity, plan.keys) as manifest:
        _check_same(folder, manifest.identity(), identity)
        todo = _todo(manifest, folder, summary)
        if todo:
            with interrupts_told_as_such(), cluster(workers, address, len(todo)) as client:
                _make(plan, recipe, client, manifest, todo, summary, tell)
    return summary


def identity_of(plan: Plan, recipe: Recipe) -> dict[str, str]:
    """Everything that the content of a library depends on, by the name that messages use."""
    points = json.dumps([plan.keys, plan.points], allow_nan=False)
    return {
        "mgs version": mgs.__version__,
        "base gait": plan.base_gait.to_yaml(),
        "gait name": recipe.name,
        "gaits": hashlib.sha256(points.encode()).hexdigest(),
        "keys": json.dumps(plan.keys, allow_nan=False),
        "number of gaits": str(len(plan.points)),
        "robots": hashlib.sha256(json.dumps(recipe.robots, allow_nan=False).encode()).hexdigest(),
        "physics": ",".join(recipe.engines) or "none",
        "servo": recipe.servo,
    }


def _check_same(folder: Path, found: Mapping[str, str], asked: Mapping[str, str]) -> None:
    differ = [name for name in asked if found.get(name) != asked[name]]
    if differ:
        raise ConfigError(
            folder,
            f"holds a library that was made from something else ({', '.join(differ)} differ); use "
            "another folder, or the sweep, gait, robot and options that it was made from",
        )


def _todo(manifest: Manifest, folder: Path, summary: Summary) -> list[int]:
    """Numbers of the gaits to make: missing, damaged or lost; removes remains of a killed run."""
    for part in (folder / GAITS_FOLDER).glob(".mgs-*.part"):
        part.unlink(missing_ok=True)
    whole = set()
    for number, verdict, reason, file, sha256 in manifest.states():
        if verdict == LOST or not is_whole(folder, file, sha256):
            continue
        whole.add(number)
        summary.count(verdict, reason)
    summary.kept = len(whole)
    return [number for number in range(summary.n) if number not in whole]


def _make(
    plan: Plan,
    recipe: Recipe,
    client: Client,
    manifest: Manifest,
    todo: list[int],
    summary: Summary,
    tell: Callable[[Summary], None] | None,
) -> None:
    """Bring the recipe to the workers, and write every gait that they make."""
    summary.dashboard = dashboard_of(client)
    name = f"mgs-{client.id}"
    try:
        client.register_plugin(GaitWorker(name, recipe), name=name)
    except Exception as error:
        raise MgsError(
            f"the workers cannot make gaits: {error}; is this version of mgs installed there?"
        ) from error
    started = time.monotonic()

    def told() -> None:
        summary.seconds = time.monotonic() - started
        if tell is not None:
            tell(summary)

    told()
    with deferred_interrupt() as interrupt:
        task = Work(client, name, plan, summary, interrupt, recipe.timeout)
        for number, outcome in outcomes(task, todo):
            try:
                _keep(plan, manifest, summary.folder, number, outcome)
            except (MgsError, sqlite3.OperationalError) as error:
                raise MgsError(f"{error}; make room, then continue with --resume") from error
            summary.count(outcome.row["verdict"], outcome.row.get("reason"))
            summary.done += 1
            told()
    client.unregister_worker_plugin(name)


def _keep(plan: Plan, manifest: Manifest, folder: Path, number: int, outcome: Outcome) -> None:
    """Write a gait: first its file, then its row, so that there is no row without its file."""
    base, point = plan.base_gait, map(plain, plan.points[number])
    row: dict[str, Value] = {"number": number, "robot": base.robot, "motion": base.motion}
    row |= {"ik.solver": solver_of(base), "dt": base.dt}
    row |= dict(zip(plan.keys, point, strict=True)) | outcome.row
    if outcome.content is not None:
        row["file"] = file = f"{GAITS_FOLDER}/{number:06d}.mcap"
        replace_file(folder / file, outcome.content)
    manifest.keep(row)
