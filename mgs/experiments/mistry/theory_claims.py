"""Claims on the kinematics of constrained floating bases, MNCS II."""

from __future__ import annotations

import numpy as np

from mgs.core.contact import Side
from mgs.experiments.claim import Claim
from mgs.experiments.mistry.measures import (
    critical_error,
    edge_rows,
    hand_error,
    phases_of,
    smallest_singular_value,
    sole_error,
    straight_legs,
    switch_accelerations,
)
from mgs.experiments.mistry.runs import (
    EIGHT,
    EQUATION_7,
    EQUATION_16,
    PROJECTED,
    SWAY,
    VELOCITY,
    WALK,
    Key,
    Study,
)
from mgs.experiments.mistry.thresholds import FASTER, MET, SINGULAR
from mgs.ik_solver.floating.constraints import feasibility


def theory_claims(study: Study) -> list[Claim]:
    """Claims on eqs. (7) and (10), the conditions, and constraint switching."""
    return [
        _equation_7_claim(study),
        _edges_claim(study),
        _minimum_claim(study),
        *_switch_claims(study),
        _knees_claim(study),
        _upright_claim(study),
    ]


def _equation_7_claim(study: Study) -> Claim:
    runs = {g: study[Key(g, VELOCITY, EQUATION_7)] for g in (SWAY, EIGHT)}
    values = {
        "hand": hand_error(runs[EIGHT]),
        "CoG": max(critical_error(run) for run in runs.values()),
        "soles": max(sole_error(run) for run in runs.values()),
    }
    return Claim(
        "equation_7",
        "With sufficient constraints, eq. (7) realizes arbitrary end-effector velocities while "
        "the constraints are maintained",
        ", ".join(f"{name} {1e3 * value:.2g} mm" for name, value in values.items()),
        max(values.values()) <= MET,
        "largest errors of sway and figure eight, all tasks in one level; within 0.1 mm",
        values,
        "MNCS II-B",
        ("eq. (7)",),
    )


def _edges_claim(study: Study) -> Claim:
    robot = study.robot
    spec = robot.sole_spec(Side.LEFT)
    x, y = 0.5 * spec.length, 0.5 * spec.width
    heel = edge_rows(robot, Side.LEFT, [(-x, -y), (-x, y)])
    other = edge_rows(robot, Side.RIGHT, [(x, y), (-x, y)])
    first = [heel[0], heel[1][[0, 2]]]  # all rows of one point, two rows of the second point
    ranks = {
        "two edges": feasibility(np.concatenate([*first, other[0][2:]]))[1],
        "two edges in line": feasibility(np.concatenate([*first, other[1][2:]]))[1],
        "one edge": feasibility(np.concatenate(heel))[1],
    }
    return Claim(
        "edges",
        "Two edge contacts are adequate constraints, provided that they are not collinear",
        ", ".join(f"{name}: rank {rank} of 6" for name, rank in ranks.items()),
        ranks == {"two edges": 6, "two edges in line": 5, "one edge": 5},
        "rank of J_C^b for COMAN on the heel of one sole and the toe or heel of the other",
        source="MNCS II-B, Fig. 3, 4",
        methods=("eq. (10)",),
    )


def _minimum_claim(study: Study) -> Claim:
    rows = np.concatenate(edge_rows(study.robot, Side.LEFT, [(0.0, 0.0), (0.05, 0.0)]))[:5]
    five = feasibility(rows)[1]
    phases = {p.support: p.base_rank for p in phases_of(study[Key(WALK, VELOCITY, PROJECTED)])}
    return Claim(
        "minimum",
        "The minimum number of constraints is 6; only with rank 6 the base velocity is unique",
        f"5 rows: rank {five}; walk: "
        + ", ".join(f"{name} support {rank}" for name, rank in phases.items()),
        five < 6 and set(phases.values()) == {6},
        "rank of J_C^b; that eq. (10) gives the base velocity is a test of the code",
        source="MNCS II-B",
        methods=("eq. (10)",),
    )


def _switch_claims(study: Study) -> list[Claim]:
    printed = switch_accelerations(study[Key(WALK, VELOCITY, EQUATION_16)])
    smooth = switch_accelerations(study[Key(WALK, VELOCITY, PROJECTED)])
    return [
        Claim(
            "switch",
            "When constraints change, J_C changes abruptly, which creates undesirable "
            "discontinuities of the joint velocities",
            f"largest joint acceleration at a switch {printed[0]:.0f} rad/s^2, elsewhere "
            f"{printed[1]:.0f} rad/s^2",
            printed[0] >= FASTER * printed[1],
            "eq. (16) as printed in a walk of Melson, dt 0.01",
            {"switch": printed[0], "elsewhere": printed[1]},
            "MNCS II-B",
            ("eq. (16)",),
        ),
        Claim(
            "handover",
            "With the handover of mgs the joint velocities do not jump when the constraints change",
            f"largest joint acceleration at a switch {smooth[0]:.2f} rad/s^2, elsewhere "
            f"{smooth[1]:.2f} rad/s^2",
            smooth[0] <= smooth[1],
            "projected form; the paper refers to another paper for such methods",
            {"switch": smooth[0], "elsewhere": smooth[1]},
            kind="ours",
            methods=("projected",),
        ),
    ]


def _knees_claim(study: Study) -> Claim:
    robot = study.robot
    straight = smallest_singular_value(robot, straight_legs(robot)[None])
    standing = smallest_singular_value(robot, robot.standing_q[None])
    return Claim(
        "straight_knees",
        "Fully extended knees are not a singular configuration of J_A",
        f"smallest singular value {straight:.3f}, in the standing posture {standing:.3f}",
        straight > SINGULAR,
        "rows in m and rad",
        {"straight": straight, "standing": standing},
        "MNCS III",
        ("eq. (12)",),
    )


def _upright_claim(study: Study) -> Claim:
    least = {
        gait: smallest_singular_value(study.robot, study[Key(gait)].motion.q[::10])
        for gait in (SWAY, EIGHT)
    }
    return Claim(
        "upright",
        "As long as the robot is upright, J_A does not reach a singularity",
        ", ".join(f"{gait} {value:.3f}" for gait, value in least.items()),
        min(least.values()) > SINGULAR,
        "smallest singular value along the motions, every tenth sample",
        least,
        "MNCS III",
        ("eq. (12)",),
    )
