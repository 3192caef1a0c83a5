"""The experiments of the Melson paper: secondary tasks S1 to S3, and joint drift over 30 steps.

"Inverse kinematics of a humanoid robot modelled as a tree-shaped manipulator", section 5. Every
run solves one and the same task trajectory; only the null-space gains differ:

    S1  gamma_joint 0      gamma_grav 0
    S2  gamma_joint 1      gamma_grav 0
    S3  gamma_joint 0.35   gamma_grav 1.6
    drift over 30 steps    gamma_joint 0 and 1, gamma_grav 0

No Newton updates are taken, so that the closed-loop IK alone has to meet the tasks.
"""

from __future__ import annotations

from pathlib import Path

from mgs.experiments.claim import Claim, Progress
from mgs.experiments.melson.claims import all_claims
from mgs.experiments.melson.runs import solve


def run(
    folder: Path | None = None, progress: Progress | None = None, *, force: bool = True
) -> list[Claim]:
    """Run all experiments; figures go into `folder` if one is given.

    Args:
        folder: made if missing.
        progress: called with parts done and parts in all.
        force: replace existing figures.

    Raises:
        OutputExistsError: a figure is in the way and `force` is not set.
    """
    from mgs.experiments.melson import figures  # matplotlib is slow to import

    if folder is not None:
        figures.refuse_existing(folder, force=force)
    study = solve(progress)
    if folder is not None:
        figures.write_figures(study, folder, force=force)
    return all_claims(study)
