"""Claims of Mistry et al., compared with our runs; see the package."""

from __future__ import annotations

from mgs.experiments.claim import Claim
from mgs.experiments.mistry.control_claims import control_claims
from mgs.experiments.mistry.runs import Study
from mgs.experiments.mistry.theory_claims import theory_claims
from mgs.experiments.mistry.tracking_claims import tracking_claims


def all_claims(study: Study) -> list[Claim]:
    """All claims of the experiment, in the order of the paper."""
    return [*theory_claims(study), *control_claims(study), *tracking_claims(study)]
