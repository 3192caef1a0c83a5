"""Claims on whole motions: ZMP, joint limits, integration, and the combination of both goals."""

from __future__ import annotations

import numpy as np

from mgs.experiments.claim import Claim
from mgs.experiments.melson.runs import (
    Study,
    joint_cost,
    limit_distance,
    support_costs,
    tracking_errors,
    zmp_margin,
)
from mgs.experiments.melson.text import show
from mgs.experiments.melson.thresholds import SIGNIFICANT

ALL = ("S1", "S2", "S3")


def zmp_claim(study: Study) -> Claim:
    """Claim: the motions fulfil the ZMP criterion."""
    worst = min(zmp_margin(walk) for walk in study.all_walks)
    return Claim(
        "zmp_criterion",
        "the CoM trajectory ensures that the zero-moment point criterion is fulfilled",
        f"{1e3 * worst:.1f} mm inside the support polygon",
        worst > 0.0,
        f"least distance of the ZMP of the whole robot from the edge, in all {len(study.all_walks)}"
        " runs, by inverse dynamics",
        {"margin": worst},
        "Abstract",
        ALL,
    )


def limits_met_claim(study: Study) -> Claim:
    """Claim: all joints stay within their limits."""
    runs = (study.short, study.longer, study.long)
    found = {
        name: min(limit_distance(walks[name]) for walks in runs if name in walks)
        for name in ("S2", "S3")
    }
    values = {name: distance for name, (distance, _) in found.items()}
    return Claim(
        "joint_limits_met",
        "the method uses the redundancy to fulfil joint position limits",
        show(values, "deg", 1),
        min(values.values()) >= 0.0,
        f"least distance of a joint from its limits, in all walks; joints: {_joints(found)}. S1, "
        "without this goal, fulfils them too, because steps of 5 cm come near no limit",
        values,
        "Abstract",
        ("S2", "S3"),
    )


def away_from_limits_claim(study: Study) -> Claim:
    """Claim: H_joint keeps joints away from their limits, alone and combined with H_grav."""
    found = {name: limit_distance(walk) for name, walk in study.short.items()}
    values = {name: distance for name, (distance, _) in found.items()}
    costs = {name: joint_cost(walk) for name, walk in study.short.items()}
    return Claim(
        "away_from_limits",
        "the first cost function keeps the joint positions away from their limits, the second one "
        "combines this goal with the reduction of torques",
        show(values, "deg", 1),
        all(values[name] > values["S1"] and costs[name] < costs["S1"] for name in ("S2", "S3")),
        f"least distance of a joint from its limits, which has to be larger in S2 and S3 than in "
        f"S1; joints: {_joints(found)}. Mean of H_joint, which has to be lower: "
        f"{show(costs, '', 4).strip()}. In S3 gamma_grav outweighs "
        "gamma_joint",
        values,
        "Section 6",
        ALL,
    )


def _joints(found: dict[str, tuple[float, str]]) -> str:
    return ", ".join(f"{name} {joint}" for name, (_, joint) in found.items())


def integration_claim(study: Study) -> Claim:
    """Claim: the closed loop avoids the drift of numerical integration."""
    values = {}
    for name, walk in study.long.items():
        errors = tracking_errors(walk)
        third = len(errors) // 3
        values[f"{name} first"] = float(errors[:third].max())
        values[f"{name} last"] = float(errors[-third:].max())
    holds = all(
        values[f"{name} last"] <= (1.0 + SIGNIFICANT) * values[f"{name} first"]
        for name in study.long
    )
    return Claim(
        "no_integration_drift",
        "the closed loop avoids the drift associated with the numerical integration",
        ", ".join(
            f"{name} {1e3 * values[f'{name} first']:.4f} and {1e3 * values[f'{name} last']:.4f} mm"
            for name in study.long
        ),
        holds,
        "largest task error of soles, hands and CoM in the first and in the last ten of 30 steps; "
        f"the latter may be {100 * SIGNIFICANT:.0f} % larger",
        values,
        "Section 3.1",
        ("S1", "S2"),
    )


def combination_claim(study: Study) -> Claim:
    """Claim: both goals can be combined."""
    joint = {name: joint_cost(walk) for name, walk in study.short.items()}
    grav = {name: float(np.mean(support_costs(walk))) for name, walk in study.short.items()}
    return Claim(
        "combination",
        "the combination of the two goals is possible and improves the motion",
        f"mean H_joint {show(joint, '', 4).strip()}; mean H_grav {show(grav, '(N m)^2')}",
        joint["S3"] < joint["S1"] and grav["S3"] < grav["S1"],
        "H_joint over the whole motion and H_grav over single support have to be lower in S3 than "
        "in S1, without a secondary task",
        {f"H_joint {k}": v for k, v in joint.items()} | {f"H_grav {k}": v for k, v in grav.items()},
        "Section 6",
        ("S1", "S3"),
    )
