"""How long work tells how far it is."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TypeAlias

Progress: TypeAlias = Callable[[int, int], None]
"""Called with the work done and the work in all, in any unit: samples, passes, files."""

StepProgress: TypeAlias = Callable[[str, int, int], None]
"""Called with the name of a step, and the work done and the work in all of this step."""


def progress_of_step(progress: StepProgress | None, step: str) -> Progress | None:
    """Progress of one step, told under its name; None where nobody listens."""
    return None if progress is None else functools.partial(progress, step)
