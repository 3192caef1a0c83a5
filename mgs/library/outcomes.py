"""From the numbers of gaits to their outcomes, through the workers of a Dask cluster.

Gaits are submitted as others finish, so that few are under way at a time and memory does not grow
with the library.
"""

from __future__ import annotations

import contextlib
import itertools
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError
from dataclasses import dataclass

from distributed import Client, Future, KilledWorker, wait

from mgs.core.errors import MgsError
from mgs.core.foreign import told_as
from mgs.library.manifest import LOST
from mgs.library.points import Plan
from mgs.library.summary import Summary
from mgs.library.worker import Outcome, failure, work

PER_WORKER = 2  # gaits under way for each worker: one is being made, one waits
RESULT_TIMEOUT = 60.0  # [s] for the bytes of one gait
PULSE = 0.3  # [s] of waiting after which Ctrl-C is noticed
LOOK = 2.0  # [s] between counts of the workers
WORKERLESS = 60.0  # [s] without any worker after which the run ends
KILLED = "its worker died twice, the second time with nothing else to do"


@dataclass(frozen=True)
class Work:
    """What is to be made, and where."""

    client: Client
    name: str  # of the recipe on the workers
    plan: Plan
    summary: Summary  # its number of workers is kept up to date
    interrupt: Callable[[], None]  # raises KeyboardInterrupt after Ctrl-C
    timeout: float  # [s] after which a worker gives up a gait


def outcomes(task: Work, todo: list[int]) -> Iterator[tuple[int, Outcome]]:
    """Number and outcome of every gait of `todo`, in the order in which they finish.

    A worker that dies takes two gaits with it, the one that it made and one that waited. Both are
    made again, at the end and one at a time, so that a gait that kills its worker again is found.

    Raises:
        MgsError: the cluster is lost or has had no workers for some time.
        KeyboardInterrupt: Ctrl-C was pressed.
    """
    with told_as(lambda what: MgsError(f"the cluster is lost: {what}; continue with --resume")):
        suspects = []
        for number, future in _completed(task, todo):
            if (outcome := _outcome(future)) is None:
                suspects.append(number)
            else:
                yield number, outcome
        for number in suspects:
            began = time.monotonic()
            for _, future in _completed(task, [number], "again"):
                yield number, _outcome(future) or _killed(task, time.monotonic() - began)


def _killed(task: Work, seconds: float) -> Outcome:
    """Outcome of a gait that has ended its worker again after some time [s], alone there."""
    reason, message = "KilledWorker", KILLED
    if seconds >= task.timeout:
        reason, message = "Timeout", f"took longer than the time limit of {task.timeout:g} s"
    return Outcome({"verdict": LOST, "reason": reason, "message": message})


def _completed(
    task: Work, todo: Iterable[int], attempt: str = "first"
) -> Iterator[tuple[int, Future]]:
    """Futures of gaits in the order in which they finish; few are under way at a time."""
    queue, numbers = iter(todo), dict[Future, int]()
    looked = -LOOK
    while True:
        if time.monotonic() - looked > LOOK:  # workers come and go
            n_workers = len(task.client.nthreads())
            task.summary.workers, looked = max(1, n_workers), time.monotonic()
        free = max(0, PER_WORKER * task.summary.workers - len(numbers))
        for number in itertools.islice(queue, free):
            numbers[_submit(task, number, attempt)] = number
        if not numbers:
            return
        for future in _ended(task, list(numbers)):
            task.interrupt()
            yield numbers.pop(future), future
            future.release()


def _submit(task: Work, number: int, attempt: str) -> Future:
    key = f"{task.name}-{number}-{attempt}"
    assignments = task.plan.assignments(number)
    return task.client.submit(work, task.name, assignments, key=key, pure=False)


def _ended(task: Work, futures: list[Future]) -> set[Future]:
    """The futures that have ended, at least one of them.

    Raises:
        MgsError: nothing ends because there has been no worker for some time.
    """
    seen = looked = time.monotonic()
    while True:
        with contextlib.suppress(TimeoutError):
            ended: set[Future] = wait(futures, timeout=PULSE, return_when="FIRST_COMPLETED").done
            return ended
        task.interrupt()
        if time.monotonic() - looked < LOOK:
            continue
        looked = time.monotonic()
        if task.client.nthreads():
            seen = looked
        elif looked - seen > WORKERLESS:
            raise MgsError(
                f"the cluster has had no workers for {WORKERLESS:g} s; start some, then continue "
                "with --resume"
            )


def _outcome(future: Future) -> Outcome | None:
    """The result of a gait, None if its worker died; raises MgsError if the cluster is lost."""
    try:
        result: Outcome = future.result(timeout=RESULT_TIMEOUT)
    except KilledWorker:
        return None
    except (CancelledError, TimeoutError, OSError) as error:
        raise MgsError(f"the cluster is lost: {error}; continue with --resume") from error
    except Exception as error:  # outside our work: while arguments or result are transferred
        return failure(LOST, error)
    return result
