"""Claims of Mistry et al., compared with our runs; see the package."""

from __future__ import annotations

import numpy as np

from mgs.core.contact import Side
from mgs.experiments.claim import Claim
from mgs.experiments.mistry.runs import (
    ACCELERATION,
    EIGHT,
    PROJECTED,
    SWAY,
    TRACKING,
    VELOCITY,
    WALK,
    Key,
    Study,
    angle_gap,
    base_velocity_gap,
    edge_rows,
    hand_errors,
    horizontal_com_error,
    phases_of,
    sole_error,
    straight_legs,
    swing_switches,
    switch_accelerations,
)
from mgs.ik_solver.floating.constraints import feasibility
from mgs.ik_solver.floating.parts import COM_XY, SOLES
from mgs.ik_solver.floating.tasks import BodyTasks

CRITICAL = 1e-4  # [m] and [rad] largest error of critical tasks
DRIFT = 1e-5  # [m] and [rad] largest drift of the soles
HAND_MET = 1e-3  # [m] largest error of a hand task that is met
SINGULAR = 1e-3  # least singular value of a regular J_A, with rows in m and rad
FORMS = [(s, n) for s in (VELOCITY, ACCELERATION) for n in (TRACKING, PROJECTED)]


def all_claims(study: Study) -> list[Claim]:
    """All claims of the experiment."""
    return [
        *sway_claims(study),
        *eight_claims(study),
        *constraint_claims(study),
        *form_claims(study),
        *walk_claims(study),
    ]


def sway_claims(study: Study) -> list[Claim]:
    """Claims of the experiment on the CoG."""
    runs = {form: study[Key(SWAY, *form)] for form in FORMS}
    com = {form: horizontal_com_error(run) for form, run in runs.items()}
    drift = {form: sole_error(run) for form, run in runs.items()}
    loose = sole_error(study[Key(SWAY, VELOCITY, TRACKING, "no feedback")])
    return [
        Claim(
            "sway_com",
            "the CoG follows a lateral sine without fore-aft motion, with an error below 0.1 mm",
            f"{1e6 * max(com.values()):.2f} um, the largest of both solvers and both forms",
            max(com.values()) <= CRITICAL,
            "on the robot of the paper the CoG lagged; the authors name moderate task-space gains "
            "as a cause",
            {" ".join(form): value for form, value in com.items()},
        ),
        Claim(
            "sway_drift",
            "with feedback on the task error the drift of the constraints stays below 1e-5 at dt "
            "0.01",
            f"soles within {max(drift.values()):.1e} m and rad",
            max(drift.values()) <= DRIFT,
            f"without feedback, but with a Newton step at an error of 5e-5: {loose:.1e}",
            {" ".join(form): value for form, value in drift.items()} | {"no feedback": loose},
        ),
    ]


def eight_claims(study: Study) -> list[Claim]:
    """Claims of the experiment on the hand."""
    runs = {form: study[Key(EIGHT, *form)] for form in FORMS}
    critical = {form: max(horizontal_com_error(r), sole_error(r)) for form, r in runs.items()}
    hand = {form: float(hand_errors(run).max()) for form, run in runs.items()}
    com = horizontal_com_error(runs[VELOCITY, PROJECTED])
    projected, tracked = hand[VELOCITY, PROJECTED], [hand[f] for f in FORMS if f[1] == TRACKING]
    return [
        Claim(
            "eight_critical",
            "critical tasks are met within 1e-4 in both null-space forms",
            f"{max(critical.values()):.1e} m and rad",
            max(critical.values()) <= CRITICAL,
            values={" ".join(form): value for form, value in critical.items()},
        ),
        Claim(
            "eight_projected",
            "with N_A J_B^+ the error of the hand is larger than that of the CoG",
            f"hand {1e3 * projected:.1f} mm, CoG {1e3 * com:.1e} mm",
            projected > com and projected > HAND_MET,
            "the figure is 60 mm wide; N_A removes the part of J_B^+ that would move the soles. "
            f"In the acceleration form the error is {1e3 * hand[ACCELERATION, PROJECTED]:.1f} mm, "
            "because the feedback of the remaining error accumulates",
            {"hand": projected, "com": com},
        ),
        Claim(
            "eight_tracking",
            "with (J_B N_A)^+ the error of the hand is below 1 mm",
            f"{1e3 * max(tracked):.3f} mm",
            max(tracked) <= HAND_MET,
            values={" ".join(form): value for form, value in hand.items()},
        ),
    ]


def constraint_claims(study: Study) -> list[Claim]:
    """Claims on constraints that determine the motion of the base."""
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
    tasks = BodyTasks(robot, (*SOLES, COM_XY))
    tasks.update(straight_legs(robot))
    smallest = float(np.linalg.svd(tasks.J, compute_uv=False)[-1])
    gaps = [
        base_velocity_gap(robot, study[Key(SWAY, VELOCITY, TRACKING, variant)])
        for variant in ("", "fine")
    ]
    return [
        Claim(
            "edges",
            "six constraint rows of two edges that are not collinear determine the base, one edge "
            "does not",
            ", ".join(f"{name}: rank {rank} of 6" for name, rank in ranks.items()),
            ranks == {"two edges": 6, "two edges in line": 5, "one edge": 5},
            "rank of J_C^b for COMAN on the heel of one sole and the toe or heel of the other",
        ),
        Claim(
            "straight_knees",
            "straight knees are not singular for J_A",
            f"smallest singular value {smallest:.3f} with both legs straight",
            smallest > SINGULAR,
            values={"smallest": smallest},
        ),
        Claim(
            "eq_10",
            "eq. (10) gives the base velocity from the joint velocities",
            f"error {gaps[0]:.1e} m/s and rad/s at dt 0.01, {gaps[1]:.1e} at dt 0.001",
            gaps[0] < 1e-3 and gaps[1] < 0.1 * gaps[0],
            "both velocities are finite differences along the sway, so that the error falls with "
            "dt",
            {"dt 0.01": gaps[0], "dt 0.001": gaps[1]},
        ),
    ]


def form_claims(study: Study) -> list[Claim]:
    """Claim on the acceleration form as compared with the velocity form."""
    gaps = [
        angle_gap(
            study[Key(SWAY, VELOCITY, TRACKING, variant)],
            study[Key(SWAY, ACCELERATION, TRACKING, variant)],
        )
        for variant in ("", "fine")
    ]
    return [
        Claim(
            "acceleration",
            "the acceleration form (18) gives the same motion as the velocity form (16)",
            f"joint angles differ by {np.degrees(gaps[0]):.2f} deg at dt 0.01, "
            f"{np.degrees(gaps[1]):.2f} deg at dt 0.001",
            bool(max(gaps) < np.deg2rad(1.0)),
            "the tasks agree within micrometres; the undetermined joint motion differs, because it "
            "has least velocity in one form and least acceleration in the other",
            {"dt 0.01": gaps[0], "dt 0.001": gaps[1]},
        )
    ]


def walk_claims(study: Study) -> list[Claim]:
    """Claims on constraint switching in a walk, which the paper names as future work."""
    smooth = study[Key(WALK)]
    by_form = {
        form: [
            switch_accelerations(study[Key(WALK, VELOCITY, form, variant)])
            for variant in ("", "no handover")
        ]
        for form in (TRACKING, PROJECTED)
    }
    (at_switch, elsewhere), (jump, _) = by_form[PROJECTED]
    tracked = by_form[TRACKING]
    worst = {s: max(sole_error(study[Key(WALK, s)]), horizontal_com_error(study[Key(WALK, s)]))
             for s in (VELOCITY, ACCELERATION)}  # fmt: skip
    kinds = "; ".join(
        f"{p.support}: {p.rows} rows of rank {p.rank}, base {p.base_rank}"
        for p in phases_of(smooth)
    )
    return [
        Claim(
            "walk_tasks",
            "in a walk with changing constraints critical tasks are met within 1e-4",
            f"{max(worst.values()):.1e} m and rad over {swing_switches(smooth)} switches",
            max(worst.values()) <= CRITICAL,
            f"constraints by phase: {kinds}",
            worst,
        ),
        Claim(
            "walk_handover",
            "joint velocities do not jump when the constraints change",
            f"largest joint acceleration at a switch {at_switch:.2f} rad/s^2, elsewhere "
            f"{elsewhere:.2f} rad/s^2",
            at_switch <= elsewhere and tracked[0][0] <= tracked[0][1],
            f"projected form; without handover {jump:.0f} rad/s^2. In the tracking form both sets "
            f"of constraints have the same solution if all tasks can be met: {tracked[0][0]:.2f} "
            f"and {tracked[1][0]:.2f} rad/s^2",
            {"switch": at_switch, "elsewhere": elsewhere, "no handover": jump},
        ),
    ]
