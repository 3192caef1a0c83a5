"""All claims of Faraji and Ijspeert, compared with our runs; see the package."""

from __future__ import annotations

from mgs.experiments.claim import Claim
from mgs.experiments.faraji.asymmetric_claims import asymmetric_claims
from mgs.experiments.faraji.lean_claims import lean_claims, twist_claims
from mgs.experiments.faraji.power_claims import sway_claims
from mgs.experiments.faraji.region_claims import region_claims
from mgs.experiments.faraji.runs import Study
from mgs.experiments.faraji.singular_claims import singular_claims
from mgs.experiments.faraji.squat_claims import squat_claims
from mgs.experiments.faraji.untested_claims import untested_claims


def all_claims(study: Study) -> list[Claim]:
    """All claims, in the order of the tasks."""
    return [
        *squat_claims(study),
        *singular_claims(study),
        *asymmetric_claims(study),
        *lean_claims(study),
        *region_claims(study),
        *sway_claims(study),
        *twist_claims(study),
        *untested_claims(study),
    ]
