"""Closed-loop analysis of the ZMP preview control of stage 3, with Melson's figures.

Poles, gains and Riccati solution against python-control and against derivations that share no code
with ours; the answer to a step of the reference that is known in advance; what the weight of the
jerk costs on fast steps.
"""

from __future__ import annotations

from pathlib import Path

from mgs.experiments.claim import Claim, Progress
from mgs.experiments.preview.study import CLAIMS, solve


def run(
    folder: Path | None = None, progress: Progress | None = None, *, force: bool = True
) -> list[Claim]:
    """Analyse the servo; figures go into `folder` if one is given.

    Args:
        folder: made if missing.
        progress: called with parts done and parts in all.
        force: replace existing figures.

    Raises:
        OutputExistsError: a figure is in the way and `force` is not set.
    """
    from mgs.experiments.preview import figures  # matplotlib is slow to import

    if folder is not None:
        figures.refuse_existing(folder, force=force)
    study = solve()
    claims = []
    for i, part in enumerate(CLAIMS):
        claims.append(part(study))
        if progress is not None:
            progress(i + 1, len(CLAIMS))
    if folder is not None:
        figures.write_figures(study, folder, force=force)
    return claims
