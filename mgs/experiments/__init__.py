"""The papers' experiments and our own studies, as runnable code."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from mgs.experiments.claim import Claim, Progress

__all__ = ["EXPERIMENTS", "Claim", "Experiment"]

# folder for figures or None, progress or None -> what was found
Experiment = Callable[[Path | None, Progress | None], list[Claim]]


def _melson(folder: Path | None, progress: Progress | None) -> list[Claim]:
    from mgs.experiments.melson import run

    return run(folder, progress)


def _preview(folder: Path | None, progress: Progress | None) -> list[Claim]:
    from mgs.experiments.preview import run

    return run(folder, progress)


def _faraji(folder: Path | None, progress: Progress | None) -> list[Claim]:
    from mgs.experiments.faraji import run

    return run(folder, progress)


def _mistry(folder: Path | None, progress: Progress | None) -> list[Claim]:
    from mgs.experiments.mistry import run

    return run(folder, progress)


EXPERIMENTS: dict[str, Experiment] = {
    "melson": _melson,
    "faraji": _faraji,
    "mistry": _mistry,
    "preview": _preview,
}
