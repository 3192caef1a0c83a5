"""Equal work on many numbers, in one process or in several, with the results in order."""

from __future__ import annotations

import concurrent.futures
import multiprocessing
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

Shared = TypeVar("Shared")
Result = TypeVar("Result")


def in_order(
    work: Callable[[Shared, int], Result], shared: Shared, n: int, workers: int
) -> Iterator[Result]:
    """Results of work(shared, number) for the numbers 0 to n - 1, in their order.

    Args:
        work: a function of a module.
        shared: what all calls have in common; each process is sent it once.
        n: number of calls.
        workers: number of processes; 1: this one.
    """
    if workers == 1 or n < 2:
        yield from (work(shared, number) for number in range(n))
        return
    context = multiprocessing.get_context("spawn")  # engines do not survive a fork
    with concurrent.futures.ProcessPoolExecutor(
        min(workers, n), context, initializer=_adopt, initargs=(work, shared)
    ) as pool:
        yield from pool.map(_one, range(n))


_adopted: list[Any] = []  # work and what it shares, of a process that this module started


def _adopt(work: Callable[[Any, int], Any], shared: Any) -> None:
    _adopted[:] = [work, shared]


def _one(number: int) -> Any:
    work, shared = _adopted
    return work(shared, number)
