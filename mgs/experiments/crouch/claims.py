"""Claims of the crouch experiment."""

from __future__ import annotations

import math

import numpy as np

from mgs.experiments.claim import Claim
from mgs.experiments.crouch.runs import (
    COMAN,
    FRACTIONS,
    IDENTIFIED,
    JUDGED,
    MELSON,
    MOTIONS,
    MotionName,
    Run,
    Sweep,
    squared_torques,
)
from mgs.experiments.crouch.study import Study

# Numbers that stand for words.
THREE_TIMES = 3.0  # the paper's own number
FIT = 0.8  # coefficient of determination of a line that fits
ALIKE = 0.2  # relative difference of ratios that agree
SOURCE = "FI III-G, Fig. 7"
IN_WORDS: dict[MotionName, str] = {"stand": "standing", "sway": "swaying", "walk": "walking"}


def all_claims(study: Study) -> list[Claim]:
    """All claims, in the order of the motions."""
    ratios = [ratio_claim(study, motion) for motion in MOTIONS]
    lines = [line_claim(study[COMAN, motion, JUDGED]) for motion in MOTIONS]
    return [
        *ratios,
        *lines,
        walk_joints_claim(study),
        stretched_claim(study),
        walk_height_claim(study),
        work_claim(study),
        losses_claim(study),
        *(engines_claim(study, motion) for motion in MOTIONS[1:]),
    ]


def ratio_claim(study: Study, motion: MotionName) -> Claim:
    """The most crouched posture takes over three times as much as stretched legs."""
    sweeps = study.of(COMAN, motion)
    sweep = study[COMAN, motion, JUDGED]
    paper = motion == "sway"
    judged = sweep.net_ratio if paper else sweep.ratio
    told = ", ".join(f"{s.method} {s.net_ratio if paper else s.ratio:.2f}" for s in sweeps)
    left_out = ": quiet stance on stretched legs is subtracted, as in the paper" if paper else ""
    made = sweep.made
    ends = f"{made[0].knee_deg:.0f} to {made[-1].knee_deg:.0f} deg" if made else "none"
    return Claim(
        f"{motion}_ratio",
        f"In the most crouched posture the robot takes over three times the power of stretched "
        f"legs, {IN_WORDS[motion]}",
        f"{told} times",
        judged > THREE_TIMES,
        f"mean sum of the squared torques{left_out}; feasible runs of {JUDGED}, knees {ends}, by "
        f"mean knee angle: {table(sweep)}{beyond(sweep)}",
        {s.method: s.net_ratio if paper else s.ratio for s in sweeps},
        SOURCE if paper else "",
        (JUDGED,),
        "paper" if paper else "ours",
    )


def line_claim(sweep: Sweep) -> Claim:
    """The power rises along a line."""
    made = sweep.made
    slope, fit = math.nan, math.nan
    if len(made) > 2:
        x, y = np.array([run.knee_deg for run in made]), np.array([run.cost for run in made])
        slope, offset = np.polyfit(x, y, 1)
        fit = 1.0 - np.sum((y - slope * x - offset) ** 2) / np.sum((y - y.mean()) ** 2)
    return Claim(
        f"{sweep.motion}_line",
        f"The power rises steeply with the crouch, along a line, {IN_WORDS[sweep.motion]}",
        f"{slope:.2f} (N m)^2/deg, coefficient of determination {fit:.2f}",
        bool(slope > 0.0 and fit >= FIT),
        "mean sum of the squared torques over the mean knee angle",
        {"slope": float(slope), "fit": float(fit)},
        SOURCE if sweep.motion == "sway" else "",
        (sweep.method,),
        "paper" if sweep.motion == "sway" else "ours",
    )


def walk_joints_claim(study: Study) -> Claim:
    """What is not spared by stretched legs in a walk."""
    made = study[COMAN, "walk", JUDGED].made
    figure, shares, holds = "no two feasible walks", {}, False
    if len(made) > 1:
        knee, roll = (
            [share(run, name) for run in (made[0], made[-1])] for name in ("Knee", "HipLat")
        )
        part = roll[0] / made[0].torque2
        figure = (
            f"hip rolls {roll[0]:.0f} and {roll[1]:.0f}, knees {knee[0]:.0f} and {knee[1]:.0f}, "
            f"all joints {made[0].torque2:.0f} and {made[-1].torque2:.0f} (N m)^2"
        )
        holds = part > 0.5 and roll[1] < roll[0] and knee[1] > THREE_TIMES * knee[0]
        shares = {"part": part, "knee": knee[1] / knee[0], "roll": roll[1] / roll[0]}
    return Claim(
        "walk_joints",
        "A walk on stretched legs takes more than half of its squared torques in the hip rolls, "
        "which hold the trunk on one leg and do not take more on crouched legs; the knees alone "
        "take over three times as much",
        figure,
        holds,
        "mean sums of the squared torques, on the most stretched and on the most crouched legs; "
        "this is why walk_ratio fails",
        shares,
        methods=(JUDGED,),
        kind="ours",
    )


def stretched_claim(study: Study) -> Claim:
    """Which methods stand and sway on the straightest legs."""
    told, feasible = [], {}
    for motion in MOTIONS[:2]:
        for sweep in study.of(COMAN, motion):
            first = sweep.runs[0]
            feasible[f"{motion} {sweep.method}"] = float(first is not None and first.is_feasible)
            if first is None or not first.is_feasible:
                why = "refused" if first is None else first.trouble
                told.append(f"{motion} {sweep.method}: {why}")
    ours = all(
        feasible[f"{motion} {method}"] for motion in MOTIONS[:2] for method in (JUDGED, "ik5")
    )
    return Claim(
        "stretched",
        "ik4 and ik5 stand and sway with the CoM as high as straight legs carry it",
        "; ".join(told) or "so do all methods",
        ours,
        "soles within 0.1 mm, joints within their limits and stall torques; the figure lists the "
        "methods that are not feasible there",
        feasible,
        methods=(JUDGED, "ik5"),
        kind="ours",
    )


def walk_height_claim(study: Study) -> Claim:
    """How high the CoM of a walk can be."""
    highest = {}
    for sweep in study.of(COMAN, "walk"):
        pairs = zip(FRACTIONS, sweep.runs, strict=False)
        able = [f for f, run in pairs if run is not None and run.is_feasible]
        highest[sweep.method] = max(able, default=math.nan)
    told = ", ".join(f"{method} {100 * f:g} %" for method, f in highest.items())
    first = study[COMAN, "walk", JUDGED].runs[0]
    why = "refused" if first is None else first.trouble
    return Claim(
        "walk_height",
        "A walk with level soles and a level CoM cannot have it as high as straight legs carry it, "
        "because the legs are oblique in double support",
        told,
        all(f < 1.0 for f in highest.values()),
        f"largest part of the height on straight legs that is feasible, out of "
        f"{', '.join(f'{100 * f:g}' for f in FRACTIONS)} %; {JUDGED} at 100 %: {why}",
        highest,
        kind="ours",
    )


def work_claim(study: Study) -> Claim:
    """The mechanical power of a walk."""
    made = study[COMAN, "walk", JUDGED].made
    work = {f"{run.knee_deg:.0f} deg": run.work for run in made}
    values = list(work.values())
    return Claim(
        "walk_work",
        "The mechanical power of a walk at constant CoM height is least at a medium crouch, not on "
        "the straightest legs",
        ", ".join(f"{angle} {watt:.1f} W" for angle, watt in work.items()),
        len(values) > 2 and min(values) not in (values[0], values[-1]),
        "mean power that the joints give, by mean knee angle; nearly straight knees move faster "
        "for the same rise of the hip",
        work,
        methods=(JUDGED,),
        kind="ours",
    )


def losses_claim(study: Study) -> Claim:
    """Electric power with measured motors."""
    sweeps = {motion: study[MELSON, motion, JUDGED] for motion in MOTIONS}
    told = ", ".join(f"{IN_WORDS[m]} {s.ratio:.2f} times" for m, s in sweeps.items())
    net = sweeps["sway"].net_ratio
    return Claim(
        "losses",
        "With identified servos, losses of motors and gears included, the most crouched posture "
        "takes over three times the power of stretched legs, swaying",
        f"{told}; swaying without quiet stance {net:.2f} times",
        net > THREE_TIMES,
        f"electric power of Melson with servos {IDENTIFIED}, method {JUDGED}, by mean knee angle: "
        + "; ".join(f"{IN_WORDS[m]}: {table(s)}" for m, s in sweeps.items()),
        {m: s.ratio for m, s in sweeps.items()} | {"net": net},
        methods=(JUDGED,),
        kind="ours",
    )


def engines_claim(study: Study, motion: MotionName) -> Claim:
    """The ratio in physics engines."""
    text = {
        "sway": "Both physics engines measure over three times the squared torques, swaying",
        "walk": "Both physics engines measure the ratio of the plan within 20 %, walking",
    }[motion]
    found = [m for m in study.engines if m.motion == motion]
    if not found:
        note = "no physics engine is installed, or the motion is not feasible"
        return Claim(f"{motion}_engines", text, "none", "not applicable", note, kind="ours")
    told = ", ".join(f"{m.engine} {m.servo} {m.ratio:.2f}{' (falls)' * m.fell}" for m in found)
    sums = "; ".join(
        f"{m.engine}, {m.servo}: {m.measured[0]:.0f} and {m.measured[1]:.0f}" for m in found
    )
    stretched, crouched = found[0].planned
    if motion == "sway":
        holds = all(m.ratio > THREE_TIMES and not m.fell for m in found)
    else:
        holds = all(abs(m.ratio / m.planned_ratio - 1.0) < ALIKE and not m.fell for m in found)
    return Claim(
        f"{motion}_engines",
        text,
        f"{told}, plan {found[0].planned_ratio:.2f} times",
        holds,
        "sum of the squared torques over the whole motion on the most crouched over that on the "
        f"most stretched legs, {JUDGED}, ideal and PD servos. {sums}; plan {stretched:.0f} and "
        f"{crouched:.0f} (N m)^2. While both feet stand, how hard they press against each other is "
        "not determined by the motion: inverse dynamics assumes that they do not, stiff servos in "
        "PyBullet press hard, and others let the floor take a part of the load of bent knees",
        {f"{m.engine} {m.servo}": m.ratio for m in found},
        methods=(JUDGED,),
        kind="ours",
    )


def share(run: Run, name: str) -> float:
    """Mean sum of the squared torques of the joints whose names contain a text [(N m)^2]."""
    joints = [i for i, joint in enumerate(run.motion.robot.joint_names) if name in joint]
    return float(squared_torques(run.motion)[run.window][:, joints].sum(axis=1).mean())


def table(sweep: Sweep) -> str:
    """Cost of every feasible run by its knee angle."""
    unit = "(N m)^2" if sweep.made and sweep.made[0].electric is None else "W"
    return ", ".join(f"{run.knee_deg:.0f} deg {run.cost:.3g} {unit}" for run in sweep.made)


def beyond(sweep: Sweep) -> str:
    """Runs that are not feasible, with their reasons; empty if all are."""
    pairs = zip(FRACTIONS, sweep.runs, strict=False)
    told = [
        f"{100 * f:g} % of the height: {'refused' if run is None else run.trouble}"
        for f, run in pairs
        if run is None or not run.is_feasible
    ]
    return f"; not feasible: {', '.join(told)}" if told else ""
