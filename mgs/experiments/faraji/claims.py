"""All claims of Faraji and Ijspeert, compared with our runs; see the package."""

from __future__ import annotations

from mgs.experiments.claim import Claim
from mgs.experiments.faraji.run_claims import hard_claim, region_claim, time_claim
from mgs.experiments.faraji.runs import Study
from mgs.experiments.faraji.squat_claims import (
    gamma_claims,
    polygon_claim,
    squat_claims,
    stretched_claims,
    tilting_claims,
)
from mgs.experiments.faraji.upper_body_claims import lean_claims, sway_claims, twist_claims


def all_claims(study: Study) -> list[Claim]:
    """All claims, in the order of the tasks."""
    return [
        *squat_claims(study),
        *stretched_claims(study),
        *tilting_claims(study),
        *lean_claims(study),
        polygon_claim(study),
        *gamma_claims(study),
        *sway_claims(study),
        *twist_claims(study),
        region_claim(study),
        hard_claim(study),
        time_claim(study),
    ]
