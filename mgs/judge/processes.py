"""Equal work on many numbers, in one process or in several, with the results in order.

Worker processes end with the process that started them, however it ends: each one watches a pipe
whose other end only that process holds, and leaves at once when it is closed. What all calls have
in common is handed over in a file without a name, since a pipe that carries much would block this
process for ever if a worker died before it read it.
"""

from __future__ import annotations

import concurrent.futures
import contextlib
import functools
import mmap
import multiprocessing
import multiprocessing.connection
import os
import pickle
import signal
import tempfile
import threading
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.reduction import DupFd
from typing import Any, TypeVar

from mgs.core.errors import MgsError

Shared = TypeVar("Shared")
Result = TypeVar("Result")


def in_order(
    work: Callable[[Shared, int], Result], shared: Shared, n: int, workers: int
) -> Generator[Result, None, None]:
    """Results of work(shared, number) for the numbers 0 to n - 1, in their order.

    Close the iterator where it may not be exhausted, so that its processes end.

    Args:
        work: a function of a module.
        shared: what all calls have in common; each process reads it once.
        n: number of calls.
        workers: number of processes; 1: this one.

    Raises:
        MgsError: a worker process has been killed.
    """
    if workers == 1 or n < 2:
        yield from (work(shared, number) for number in range(n))
        return
    with worker_pool(work, shared, min(workers, n)) as submit:
        futures = [submit(number) for number in range(n)]
        for future in futures:
            yield result_of(future)


@contextlib.contextmanager
def worker_pool(
    work: Callable[..., Result], shared: Shared, workers: int
) -> Iterator[Callable[..., Future[Result]]]:
    """Function that has worker processes call work(shared, ...); they end with the context.

    Args:
        work: a function of a module.
        shared: first argument of all calls; each process reads it once.
        workers: number of processes; 1: calls are made in this one, at once.
    """
    if workers == 1:
        yield functools.partial(_done, work, shared)
        return
    context = multiprocessing.get_context("spawn")  # engines do not survive a fork
    with tempfile.TemporaryFile() as stream:
        pickle.dump((work, shared), stream, protocol=pickle.HIGHEST_PROTOCOL)
        stream.flush()
        watched, held = context.Pipe(duplex=False)
        start = (watched, _File(stream.fileno()))
        pool = concurrent.futures.ProcessPoolExecutor(workers, context, _begin, start)

        def submit(*arguments: object) -> Future[Result]:
            with _no_interrupt():  # a process that is started now inherits it
                return pool.submit(_one, *arguments)

        try:
            yield submit
        finally:
            held.close()
            pool.shutdown(cancel_futures=True)
            watched.close()


def result_of(future: Future[Result]) -> Result:
    """Result of a call, once it is there; raises MgsError if a worker process has been killed."""
    try:
        return future.result()
    except BrokenProcessPool as error:
        raise MgsError(
            "a worker process has ended before its work was done: it was killed, or the memory is "
            "full; try again with fewer workers"
        ) from error


def _done(work: Callable[..., Result], shared: Shared, *arguments: object) -> Future[Result]:
    future: Future[Result] = Future()
    future.set_result(work(shared, *arguments))
    return future


@contextlib.contextmanager
def _no_interrupt() -> Iterator[None]:
    """Hold back Ctrl-C until the context ends; processes that are started inside never see it.

    They are no business of the user, and would print a traceback each.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _File:
    """An open file that a process inherits by its number."""

    def __init__(self, number: int) -> None:
        self.number = number

    def __reduce__(self) -> tuple[Any, ...]:
        return _inherited, (DupFd(self.number),)


def _inherited(duplicate: Any) -> _File:
    return _File(duplicate.detach())


_adopted: list[Any] = []  # work and what it shares, of a process that this module started


def _begin(watched: multiprocessing.connection.Connection, file: _File) -> None:
    """Set up a worker process."""
    threading.Thread(target=_end_with_parent, args=(watched,), daemon=True).start()
    with mmap.mmap(file.number, 0, access=mmap.ACCESS_READ) as content:
        _adopted[:] = pickle.loads(content)


def _end_with_parent(watched: multiprocessing.connection.Connection) -> None:
    multiprocessing.connection.wait([watched])
    os._exit(1)


def _one(*arguments: object) -> Any:
    work, shared = _adopted
    return work(shared, *arguments)
