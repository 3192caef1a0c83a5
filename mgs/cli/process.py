"""Settings of the Python process of a command that lower the CPU time of short commands.

Shares are those of `mgs generate melson/walk_5cm`; docs/benchmarks.md tells how they were measured.
"""

from __future__ import annotations

import atexit
import gc
import os

ALLOCATIONS = 100_000  # of objects between two garbage collections; Python's default is 700


def prepare_process() -> None:
    """Set up threads and garbage collection; to be called before NumPy is imported."""
    # Matrices of mgs are too small to share among threads, and waiting threads use CPU time: up to
    # a quarter. OpenBLAS reads the variable when NumPy is imported; a value of the user is kept.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Imports create many objects and no garbage, which the collector searches again and again: 4 %.
    gc.set_threshold(ALLOCATIONS)
    # When a process ends, the system takes back its memory. Frozen objects are not searched: 9 %.
    atexit.register(gc.freeze)
