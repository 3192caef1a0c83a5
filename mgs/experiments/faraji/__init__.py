"""The experiments of Faraji and Ijspeert on COMAN's legs: tasks A to H, methods ik1 to ik5.

"Singularity-tolerant inverse kinematics for bipedal robots", section 3, and task H of the two-page
abstract. Both feet fixed, the CoM soft; parameters as in its Table I:

    Q = I, R = 1e-2 I, gamma = 10, n = 15 (and 3), qdot_max = 4 rad/s, q_s = 0

The gaits are those in gaits/coman_legs; amplitudes and periods, which the paper does not state, are
ours. A claim that rests on the iteration limit of the paper's solver is not applicable here.
"""

from __future__ import annotations

from pathlib import Path

from mgs.experiments.claim import Claim, Progress
from mgs.experiments.faraji.claims import all_claims
from mgs.experiments.faraji.runs import solve


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
    from mgs.experiments.faraji import figures  # matplotlib is slow to import

    if folder is not None:
        figures.refuse_existing(folder, force=force)
    study = solve(progress)
    if folder is not None:
        figures.write_figures(study, folder, force=force)
    return all_claims(study)
