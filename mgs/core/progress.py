"""How long work tells how far it is."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from typing import TypeAlias

N_REPORTS = 50

Progress: TypeAlias = Callable[[int, int], None]
"""Called with the work done and the work in all, in any unit: samples, passes, files."""

StepProgress: TypeAlias = Callable[[str, int, int], None]
"""Called with the name of a step, and the work done and the work in all of this step."""


def progress_of_step(progress: StepProgress | None, step: str) -> Progress | None:
    """Progress of one step, told under its name; None where nobody listens."""
    return None if progress is None else functools.partial(progress, step)


def samples_reported(n: int, progress: Progress | None, first: int = 0) -> Iterator[int]:
    """The samples from `first` to n - 1; `progress` is called `N_REPORTS` times on the way."""
    every = max(1, n // N_REPORTS)
    for k in range(first, n):
        yield k
        if progress is not None and (k + 1) % every == 0:
            progress(k + 1, n)
