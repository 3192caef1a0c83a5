"""The experiments of Mistry et al. on COMAN: CoG sway, and a hand's figure eight over it.

M. Mistry, J. Nakanishi, G. Cheng and S. Schaal, "Inverse kinematics with floating base and
constraints for full body humanoid robot control", Humanoids 2008. Level A soles and horizontal CoM,
B the hand, E torso and CoM height; gaits coman/sway and coman/hand_eight. The paper names
constraint switching as future work: a walk of Melson shows it.
"""

from __future__ import annotations

from pathlib import Path

from mgs.experiments.claim import Claim, Progress
from mgs.experiments.mistry.claims import all_claims
from mgs.experiments.mistry.runs import solve


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
    from mgs.experiments.mistry import figures  # matplotlib is slow to import

    if folder is not None:
        figures.refuse_existing(folder, force=force)
    study = solve(progress)
    if folder is not None:
        figures.write_figures(study, folder, force=force)
    return all_claims(study)
