"""Settings of the Python process of a command that lower the CPU time of short commands.

Percentages are savings of `mgs generate melson/walk_5cm`, whose times are in docs/benchmarks.md.
"""

from __future__ import annotations

import atexit
import gc
import os

ALLOCATIONS = 100_000  # of objects between two garbage collections; Python's default is 700


def prepare_process() -> None:
    """Set up threads and garbage collection; to be called before NumPy is imported."""
    # Matrices of mgs are too small to share among threads, and waiting threads use CPU time: 3 % on
    # two busy cores, more on idle ones. NumPy reads this on import; a value of the user is kept.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Imports create many objects and little garbage, but each collection searches them all: 6 %.
    gc.set_threshold(ALLOCATIONS)
    # At the end the system takes back all memory; frozen objects are not searched before: 13 %.
    atexit.register(gc.freeze)
