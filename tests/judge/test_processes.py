"""Worker processes: results in order, an end with their parent, and a killed one is told."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

import psutil
import pytest

from mgs.core.errors import MgsError
from mgs.judge.processes import in_order

PARENT = """
import sys, time
sys.path.insert(0, sys.argv[1])
from contextlib import closing
from mgs.judge.processes import in_order
from tests.judge.test_processes import say_and_sleep
if __name__ == "__main__":
    with closing(in_order(say_and_sleep, 600.0, 4, 2)) as results:
        next(results)
"""


def scaled(shared: list[int], number: int) -> int:
    return shared[0] * number


def say_and_sleep(seconds: float, number: int) -> int:
    os.write(1, b"begun\n")
    time.sleep(seconds)
    return number


def die(shared: None, number: int) -> int:
    del shared, number
    os.kill(os.getpid(), signal.SIGKILL)
    return 0


@pytest.mark.parametrize("workers", [1, 2])
def test_results_come_in_the_order_of_their_numbers(workers: int) -> None:
    """What is shared is larger than a pipe holds."""
    shared = [3, *range(100_000)]
    assert list(in_order(scaled, shared, 5, workers)) == [0, 3, 6, 9, 12]


def test_a_killed_worker_is_told_and_does_not_hang() -> None:
    told = "a worker process has ended before its work was done"
    with closing(in_order(die, None, 3, 2)) as results, pytest.raises(MgsError, match=told):
        next(results)


def test_workers_end_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    """And so give back the pipe to which a caller listens."""
    script = tmp_path / "parent.py"
    script.write_text(PARENT)
    root = Path(__file__).parents[2]
    parent = subprocess.Popen([sys.executable, script, root], stdout=subprocess.PIPE, cwd=root)
    assert parent.stdout is not None
    parent.stdout.readline()
    workers = psutil.Process(parent.pid).children(recursive=True)
    parent.kill()
    parent.communicate(timeout=10)  # hangs where a process keeps the other end of the pipe
    psutil.wait_procs(workers, timeout=5)
    assert not [w for w in workers if w.is_running() and w.status() != psutil.STATUS_ZOMBIE]
