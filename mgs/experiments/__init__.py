"""Experiments of three papers, and studies of the preview control and of crouched legs.

Each experiment is a package: `solve` makes all runs, `all_claims` compares them with the claims,
and `figures` draws them.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from mgs.core.progress import Progress
from mgs.experiments.claim import Claim

__all__ = ["NAMES", "Claim", "package_of", "run"]

NAMES = ("melson", "faraji", "mistry", "preview", "crouch")


def package_of(name: str) -> Any:
    """Package of an experiment, with `solve`, `all_claims` and `VARIANTS`."""
    return importlib.import_module(f"mgs.experiments.{name}")


def run(
    name: str, folder: Path | None = None, progress: Progress | None = None, *, force: bool = True
) -> list[Claim]:
    """Run one experiment, and write its figures if a folder is given.

    Args:
        name: name of the experiment, one of NAMES.
        folder: folder for the figures, created if missing; None: no figures.
        progress: function that is called with the number of finished runs and of all runs.
        force: replace existing figures.

    Raises:
        OutputExistsError: a figure exists already and `force` is False.
    """
    package = package_of(name)
    if folder is None:
        return list(package.all_claims(package.solve(progress)))
    from mgs.report.canvas import (
        figure_paths,
    )  # imported here, because matplotlib is slow to import

    figures = importlib.import_module(f"mgs.experiments.{name}.figures")
    figure_paths(folder, figures.NAMES, "png", force=force)  # raises before the work starts
    study = package.solve(progress)
    figures.write_figures(study, folder, force=force)
    return list(package.all_claims(study))
