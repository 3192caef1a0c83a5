"""The papers' experiments and our own studies, as runnable code.

One package each: `solve` makes every run, `all_claims` holds them against what is claimed,
`figures` draws them.
"""

from __future__ import annotations

import importlib
from pathlib import Path

from mgs.core.progress import Progress
from mgs.experiments.claim import Claim

__all__ = ["NAMES", "Claim", "run"]

NAMES = ("melson", "faraji", "mistry", "preview")


def run(
    name: str, folder: Path | None = None, progress: Progress | None = None, *, force: bool = True
) -> list[Claim]:
    """Run one experiment; figures go into `folder` if one is given.

    Args:
        name: one of NAMES.
        folder: made if missing.
        progress: called with runs done and runs in all.
        force: replace existing figures.

    Raises:
        OutputExistsError: a figure is in the way and `force` is not set.
    """
    package = importlib.import_module(f"mgs.experiments.{name}")
    if folder is None:
        return list(package.all_claims(package.solve(progress)))
    from mgs.report.canvas import figure_paths  # matplotlib is slow to import

    figures = importlib.import_module(f"mgs.experiments.{name}.figures")
    figure_paths(folder, figures.NAMES, "png", force=force)  # before the work
    study = package.solve(progress)
    figures.write_figures(study, folder, force=force)
    return list(package.all_claims(study))
