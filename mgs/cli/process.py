"""Settings of the Python process of a command: CPU time of short commands, streams and signals.

Percentages are savings of `mgs generate melson/walk_5cm`, whose times are in docs/benchmarks.md.
"""

from __future__ import annotations

import atexit
import contextlib
import gc
import io
import os
import signal
import sys
import threading

ALLOCATIONS = 100_000  # of objects between two garbage collections; Python's default is 700


def prepare_process() -> None:
    """Set up threads, memory, streams and signals; to be called before NumPy is imported."""
    # Matrices of mgs are too small to share among threads, and waiting threads use CPU time: 3 % on
    # two busy cores, more on idle ones. NumPy reads this on import; a value of the user is kept.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Imports create many objects and little garbage, but each collection searches them all: 6 %.
    gc.set_threshold(ALLOCATIONS)
    # At the end the system takes back all memory; frozen objects are not searched before: 13 %.
    atexit.register(gc.freeze)
    # A name that is not UTF-8 is printed with escapes instead of ending in an error.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            with contextlib.suppress(ValueError):
                stream.reconfigure(errors="backslashreplace")
    # A terminated command cleans up as an interrupted one does; a signal that is ignored stays so.
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(number) is signal.SIG_DFL:
                signal.signal(number, signal.default_int_handler)
