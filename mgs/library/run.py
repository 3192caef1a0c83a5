"""Making a library: Dask's workers make gaits, this process alone writes them.

There is one engine. Without an address it is a cluster of processes on this machine, one thread
each; with one, whatever cluster answers there. Tasks are submitted as others finish, so that no
more than a few are under way and memory does not grow with the library.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib.util
import itertools
import json
import os
import signal
import sqlite3
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import CancelledError
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType

import dask
from dask.system import CPU_COUNT
from distributed import Client, Future, KilledWorker, LocalCluster, wait

import mgs
from mgs.core.atomic_files import replace_file
from mgs.core.errors import ConfigError, MgsError
from mgs.library.lock import locked
from mgs.library.manifest import (
    GAITS_FOLDER,
    LOST,
    MANIFEST,
    Manifest,
    Value,
    holds_gaits,
    is_whole,
    writing,
)
from mgs.library.points import Plan, plain
from mgs.library.worker import GaitWorker, Outcome, Recipe, failure, solver_of, work
from mgs.robot import load_robot
from mgs.sim import EngineName, ServoName

PER_WORKER = 2  # tasks under way: one is made, one waits
CONNECT_TIMEOUT = 10.0  # [s]
RESULT_TIMEOUT = 60.0  # [s] for the bytes of one gait
PULSE = 0.3  # [s] of waiting after which Ctrl-C is heard
LOOK = 2.0  # [s] between looks at how many workers there are
WORKERLESS = 60.0  # [s] after which no worker is waited for
OWN_CLUSTER = {
    "distributed.nanny.pre-spawn-environ": {  # set before a worker imports numpy
        name: 1
        for name in (
            *("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"),
            *("MKL_NUM_THREADS", "BLIS_NUM_THREADS"),
        )
    },
    # whose worker dies is tried again by us, see _outcomes
    "distributed.scheduler.allowed-failures": 0,
    # workers come back; Dask would end for good one that died twice in 15 s
    "distributed.deploy.lost-worker-timeout": "1000 days",
    # samples the working thread a hundred times a second, for a dashboard's page
    "distributed.worker.profile.enabled": False,
}
KILLED = {
    "verdict": LOST,
    "reason": "KilledWorker",
    "message": "its worker died twice, the second time with nothing else to do",
}


@dataclass(eq=False)
class Summary:
    """How far a run is."""

    folder: Path
    n: int  # gaits of the library
    kept: int = 0  # of these, found done by a run that goes on
    done: int = 0  # made by this run
    verdicts: Counter[str] = field(default_factory=Counter)  # of all
    reasons: Counter[str] = field(default_factory=Counter)  # of those without a pass
    workers: int = 0
    dashboard: str | None = None
    seconds: float = 0.0  # since the workers were ready

    @property
    def rate(self) -> float:
        """Gaits per second of this run."""
        return self.done / self.seconds if self.seconds else 0.0

    def to_dict(self) -> dict[str, object]:
        """Convert to plain data."""
        return {
            "folder": str(self.folder),
            "manifest": str(self.folder / MANIFEST),
            "gaits": self.n,
            "kept": self.kept,
            "made": self.done,
            "verdicts": dict(self.verdicts),
            "reasons": dict(self.reasons.most_common()),
            "seconds": self.seconds,
            "gaits_per_second": self.rate,
            "workers": self.workers,
            "dashboard": self.dashboard,
        }


def recipe_of(
    plan: Plan, engines: tuple[EngineName, ...] = (), servo: ServoName = "ideal"
) -> Recipe:
    """What workers need to know of a plan; ConfigError where a robot is broken."""
    robots = {}
    for name in plan.robots:
        robot = load_robot(name)
        robots[name] = robot.yaml, robot.urdf
    return Recipe(str(plan.base), plan.base_text, plan.base.stem, robots, engines, servo)


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
        plan: which gaits.
        recipe: what workers need, of the same plan.
        folder: where the library is, or will be.
        resume: go on with what is there: only what is missing, damaged or lost is made.
        workers: processes on this machine; None: as many as it has processors.
        address: of the scheduler of a running cluster instead, such as tcp://HOST:8786.
        tell: called with the state at the start and after each gait.

    Raises:
        ConfigError: the library there was made from something else.
        MgsError: there is a library and `resume` is not set, another run holds it, nothing can be
            written, or the cluster is lost. Whatever is written by then is whole.
    """
    identity = identity_of(plan, recipe)
    if not resume and holds_gaits(folder):
        raise MgsError(f"{folder}: holds a library; go on with --resume, or use another folder")
    (folder / GAITS_FOLDER).mkdir(parents=True, exist_ok=True)
    summary = Summary(folder, len(plan.points))
    with locked(folder), writing(folder, identity, plan.keys) as manifest:
        _check_same(folder, manifest.identity(), identity)
        todo = _todo(manifest, folder, summary)
        if todo:
            with _cluster(workers, address, len(todo)) as client:
                _make(plan, recipe, client, manifest, todo, summary, tell)
    return summary


def identity_of(plan: Plan, recipe: Recipe) -> dict[str, str]:
    """What decides the content of a library, by the name that messages give it."""
    points = json.dumps([plan.keys, plan.points])
    return {
        "mgs version": mgs.__version__,
        "base gait": plan.base_gait.to_yaml(),
        "gait name": recipe.name,
        "gaits": hashlib.sha256(points.encode()).hexdigest(),
        "keys": json.dumps(plan.keys),
        "number of gaits": str(len(plan.points)),
        "robots": hashlib.sha256(json.dumps(recipe.robots).encode()).hexdigest(),
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
    """Numbers of gaits that are missing, damaged or lost; remains of a killed run are removed."""
    for part in (folder / GAITS_FOLDER).glob(".mgs-*.part"):
        part.unlink(missing_ok=True)
    whole = set()
    for number, verdict, reason, file, sha256 in manifest.states():
        if verdict == LOST or not is_whole(folder, file, sha256):
            continue
        whole.add(number)
        _count(summary, verdict, reason)
    summary.kept = len(whole)
    return [number for number in range(summary.n) if number not in whole]


def _count(summary: Summary, verdict: Value, reason: Value) -> None:
    summary.verdicts[str(verdict)] += 1
    if reason is not None:
        summary.reasons[str(reason)] += 1


def _make(
    plan: Plan,
    recipe: Recipe,
    client: Client,
    manifest: Manifest,
    todo: list[int],
    summary: Summary,
    tell: Callable[[Summary], None] | None,
) -> None:
    summary.dashboard = _dashboard(client)
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
    with _deferred_interrupt() as interrupt:
        for number, outcome in _outcomes(client, name, plan, todo, summary, interrupt):
            try:
                _keep(plan, manifest, summary.folder, number, outcome)
            except (MgsError, sqlite3.OperationalError) as error:
                raise MgsError(f"{error}; make room, then go on with --resume") from error
            _count(summary, outcome.row["verdict"], outcome.row.get("reason"))
            summary.done += 1
            told()
    client.unregister_worker_plugin(name)


@contextlib.contextmanager
def _deferred_interrupt() -> Iterator[Callable[[], None]]:
    """Ctrl-C is heard where the function given is called: in the midst of Dask it would be a mess.

    The second Ctrl-C is heard at once. Other threads than the first hear none, as ever.
    """
    pressed = threading.Event()
    before = signal.getsignal(signal.SIGINT)
    in_charge = threading.current_thread() is threading.main_thread() and callable(before)

    def handle(signum: int, frame: FrameType | None) -> None:
        pressed.set()
        signal.signal(signal.SIGINT, before)

    def raise_if_pressed() -> None:
        if pressed.is_set():
            raise KeyboardInterrupt

    if in_charge:
        signal.signal(signal.SIGINT, handle)
    try:
        yield raise_if_pressed
    finally:
        if in_charge:
            signal.signal(signal.SIGINT, before)


def _keep(plan: Plan, manifest: Manifest, folder: Path, number: int, outcome: Outcome) -> None:
    """File first, then its row: a row without its file is never written."""
    base, point = plan.base_gait, map(plain, plan.points[number])
    row: dict[str, Value] = {"number": number, "robot": base.robot, "motion": base.motion}
    row |= {"ik.solver": solver_of(base), "dt": base.dt}
    row |= dict(zip(plan.keys, point, strict=True)) | outcome.row
    if outcome.content is not None:
        row["file"] = file = f"{GAITS_FOLDER}/{number:06d}.mcap"
        replace_file(folder / file, outcome.content)
    manifest.keep(row)


def _outcomes(
    client: Client,
    name: str,
    plan: Plan,
    todo: list[int],
    summary: Summary,
    interrupt: Callable[[], None],
) -> Iterator[tuple[int, Outcome]]:
    """Every number with its outcome, as they come.

    A worker that dies takes with it the gait that it made and one that waited. Both are made again,
    at the end and alone, so that one that kills its worker again is known to be the one.
    """
    suspects = []
    for number, future in _completed(client, name, plan, todo, summary, interrupt):
        if (outcome := _outcome(future)) is None:
            suspects.append(number)
        else:
            yield number, outcome
    for number in suspects:
        for _, future in _completed(client, name, plan, [number], summary, interrupt, "again"):
            yield number, _outcome(future) or Outcome(dict(KILLED))


def _completed(
    client: Client,
    name: str,
    plan: Plan,
    todo: Iterable[int],
    summary: Summary,
    interrupt: Callable[[], None],
    attempt: str = "first",
) -> Iterator[tuple[int, Future]]:
    """Futures of gaits as they end; few are under way at a time."""
    queue, numbers = iter(todo), dict[Future, int]()
    looked = -LOOK
    while True:
        if time.monotonic() - looked > LOOK:  # workers come and go
            summary.workers, looked = max(1, len(client.nthreads())), time.monotonic()
        for number in itertools.islice(queue, max(0, PER_WORKER * summary.workers - len(numbers))):
            key = f"{name}-{number}-{attempt}"
            future = client.submit(work, name, plan.assignments(number), key=key, pure=False)
            numbers[future] = number
        if not numbers:
            return
        for future in _ended(client, list(numbers), interrupt):
            interrupt()
            yield numbers.pop(future), future
            future.release()


def _ended(client: Client, futures: list[Future], interrupt: Callable[[], None]) -> set[Future]:
    """Those of some futures that have ended, at least one.

    Raises:
        MgsError: nothing ends, since there has been no worker for some time.
    """
    seen = looked = time.monotonic()
    while True:
        with contextlib.suppress(TimeoutError):
            ended: set[Future] = wait(futures, timeout=PULSE, return_when="FIRST_COMPLETED").done
            return ended
        interrupt()
        if time.monotonic() - looked < LOOK:
            continue
        looked = time.monotonic()
        if client.nthreads():
            seen = looked
        elif looked - seen > WORKERLESS:
            raise MgsError(
                f"the cluster has had no workers for {WORKERLESS:g} s; start some, then go on with "
                "--resume"
            )


def _outcome(future: Future) -> Outcome | None:
    """The result of a task, None if its worker died; raises MgsError when the cluster is gone."""
    try:
        result: Outcome = future.result(timeout=RESULT_TIMEOUT)
    except KilledWorker:
        return None
    except (CancelledError, TimeoutError, OSError) as error:
        raise MgsError(f"the cluster is lost: {error}; go on with --resume") from error
    except Exception as error:  # what comes before or after our work: reading arguments and result
        return failure(LOST, error)
    return result


@contextlib.contextmanager
def _cluster(workers: int | None, address: str | None, n_gaits: int) -> Iterator[Client]:
    """Client of a running cluster, or of one of our own that ends with it."""
    if address is not None:
        with _client(address) as client:
            yield client
        return
    with (
        dask.config.set(OWN_CLUSTER),
        LocalCluster(
            n_workers=min(workers or CPU_COUNT, n_gaits),
            threads_per_worker=1,
            processes=True,
            dashboard_address="127.0.0.1:0",
        ) as cluster,
        Client(cluster) as client,
    ):
        try:
            yield client
        except BaseException:
            _kill(cluster)  # what they make is not wanted any more
            raise


def _kill(cluster: LocalCluster) -> None:
    """End workers now, not when their gaits are done."""
    for nanny in cluster.workers.values():
        nanny.auto_restart = False
        if nanny.pid is not None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(nanny.pid, signal.SIGKILL)


@contextlib.contextmanager
def _client(address: str) -> Iterator[Client]:
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT)
    except Exception as error:  # each kind of address fails in its own way
        raise MgsError(f"no Dask scheduler answers at {address}: {error}") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=CONNECT_TIMEOUT)
        except TimeoutError as error:
            raise MgsError(f"{address}: the cluster has no workers") from error
        yield client


def _dashboard(client: Client) -> str | None:
    """Address of the dashboard where there is one; Dask has none where bokeh is missing."""
    has_bokeh = client.run_on_scheduler(lambda: importlib.util.find_spec("bokeh") is not None)
    return client.dashboard_link if has_bokeh else None
