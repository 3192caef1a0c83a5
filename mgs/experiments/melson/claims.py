"""Claims of the article on Melson in the order of the article; see the package."""

from __future__ import annotations

from mgs.experiments.claim import Claim
from mgs.experiments.melson.drift_claims import drift_claims
from mgs.experiments.melson.motion_claims import (
    away_from_limits_claim,
    combination_claim,
    integration_claim,
    limits_met_claim,
    zmp_claim,
)
from mgs.experiments.melson.position_claims import position_claims
from mgs.experiments.melson.runs import Study
from mgs.experiments.melson.torque_claims import conclusion_claims, leg_claims
from mgs.experiments.melson.untested import untested_claims


def all_claims(study: Study) -> list[Claim]:
    """Claims on every sentence of the article that states a result."""
    untested, positions = untested_claims(), position_claims(study)
    final_poses, *drift, cyclic = drift_claims(study)
    legs = leg_claims(study)
    hips = [claim for claim in legs if "hip" in claim.id]
    knees = [claim for claim in legs if "knee" in claim.id]
    return [
        zmp_claim(study),
        limits_met_claim(study),
        untested["tested_on_robot"],
        integration_claim(study),
        cyclic,
        untested["fewer_operations"],
        *hips,
        positions["hip_roll"],
        *knees,
        positions["knee_pitch"],
        untested["left_ankle_roll_torque"],
        positions["ankle_roll"],
        untested["same_task"],
        final_poses,
        untested["task_met"],
        *drift,
        away_from_limits_claim(study),
        *conclusion_claims(study),
        untested["validated"],
        combination_claim(study),
    ]
