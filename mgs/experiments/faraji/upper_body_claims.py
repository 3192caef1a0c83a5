"""The claims on motions of the upper body: leaning (D), swaying (G) and turning (H)."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.experiments.claim import Claim
from mgs.experiments.faraji.runs import (
    CROUCHES,
    FEW,
    LEAN,
    MANY,
    SLOWER,
    SWAY,
    TWIST,
    Key,
    Run,
    Study,
    hard_error,
    knee_difference_deg,
    knee_torque,
    limit_excess_deg,
    power,
)
from mgs.experiments.faraji.thresholds import BROKEN_DEG, HARD, REGION

HORIZONTAL = 5e-3  # [m] largest horizontal CoM error
POWER_RATIO = 3.0
STATIC_TORQUE_RATIO = 0.1  # largest ratio of knee torques, stretched to most crouched
HEIGHT_LAG = 1e-3  # [m] largest CoM height below that of the same motion at a tenth of the speed


def lean_claims(study: Study) -> list[Claim]:
    """Claims of task D: torso leaning forward and backward."""
    hips, knees = study.joint("HipSag"), study.joint("KneeSag")
    ik2, ik4 = study[Key(LEAN, "ik2")], study[Key(LEAN, "ik4")]
    broken = limit_excess_deg(ik2, study.robot, hips)
    held = limit_excess_deg(ik4, study.robot, hips)
    at_limit = ik4.joints[ik4.window][:, hips].max(axis=1) > study.robot.upper[hips[0]] - 1e-3
    bent = float(np.degrees(ik4.joints[ik4.window][at_limit][:, knees].max()))
    horizontal = _horizontal(ik4)
    equal = {m: _horizontal(study[Key(LEAN, m, MANY, "equal weights")]) for m in ("ik2", "ik4")}
    return [
        Claim(
            "D_ik2",
            "torso leaning far backward: ik2 violates the hip-pitch limit",
            f"by {broken:.1f} deg",
            broken > 1.0,
            values={"deg": broken},
        ),
        Claim(
            "D_ik4",
            "torso leaning far backward: ik4 keeps the hip within its limit and bends the knee",
            f"hip {max(held, 0.0):.1g} deg beyond its limit, knee bent by up to {bent:.0f} deg",
            bool(held <= np.degrees(REGION) and bent > BROKEN_DEG),
            values={"hip": held, "knee": bent},
        ),
        Claim(
            "D_horizontal",
            "torso leaning far backward: the CoM deviates in height, its horizontal error stays "
            "below 5 mm",
            f"{1e3 * horizontal:.2f} mm with Q = diag(100, 100, 1)",
            horizontal <= HORIZONTAL,
            f"horizontal error with Q = I: ik4 {1e3 * equal['ik4']:.0f} mm, ik2 "
            f"{1e3 * equal['ik2']:.0f} mm",
            {"weighted": horizontal, **equal},
        ),
    ]


def sway_claims(study: Study) -> list[Claim]:
    """Claims of task G; torques by inverse dynamics, with the load shared as the ZMP requires."""
    runs = {height: study[Key(SWAY, "ik4", FEW, f"{height:g}")] for height in CROUCHES}
    quiet = study[Key(SWAY, "ik4", FEW, "quiet")]
    stretched, crouched = runs[CROUCHES[0]], runs[CROUCHES[-1]]
    torques = knee_torque(study, quiet), knee_torque(study, crouched)
    base = np.array(power(quiet))
    low, high = np.array(power(stretched)) - base, np.array(power(crouched)) - base
    ratios = high / low
    heights = "; ".join(
        f"{1e3 * height:+.0f} mm: {work:.2f} W, {squared:.0f} (N m)^2"
        for height, (work, squared) in ((h, np.array(power(r)) - base) for h, r in runs.items())
    )
    return [
        Claim(
            "G_knee",
            "static knee torque is near zero on stretched legs",
            f"{torques[0]:.1f} N m, in the most crouched posture {torques[1]:.1f} N m",
            torques[0] <= STATIC_TORQUE_RATIO * torques[1],
            "mean of both knees, standing still; safety margin q_s = 5 deg as in Table I for the "
            "robot",
            {"stretched": torques[0], "crouched": torques[1]},
        ),
        Claim(
            "G_power",
            f"sway with twist needs more than {POWER_RATIO:g} times as much power in the most "
            "crouched posture as on stretched legs",
            f"sum |tau qdot| {ratios[0]:.2f} times, sum tau^2 {ratios[1]:.1f} times",
            bool(ratios.min() > POWER_RATIO),
            "the paper does not state the amplitudes; with faster or wider twists the first ratio "
            "decreases to 2. |tau qdot| includes braking, and a large part of it is the sway of "
            "hips and ankles, which is equal in both postures. Values of standing still on "
            f"stretched legs are subtracted. Values by height relative to z_max: {heights}",
            {"work": float(ratios[0]), "squared": float(ratios[1])},
        ),
    ]


def twist_claims(study: Study) -> list[Claim]:
    """Claims of task H; the same motion at a tenth of the speed gives the reachable CoM height."""
    runs = {m: study[Key(TWIST, m)] for m in ("ik1", "ik3", "ik4")}
    slow = study[Key(TWIST, "ik4", MANY, "slow")]
    best = slow.stages.motion.com[slow.window, 2]
    lag = {m: float(np.max(best - run.stages.motion.com[run.window, 2])) for m, run in runs.items()}
    hard = {m: hard_error(run) for m, run in runs.items()}
    knees = study.joint("KneeSag")
    broken = limit_excess_deg(runs["ik1"], study.robot, knees)
    apart = knee_difference_deg(study, runs["ik4"])
    return [
        Claim(
            "H_ik4",
            "yaw of the torso with the CoM reference above reach: ik4 tracks the motion, and the "
            "knees leave the singularity at different times",
            f"hard-row error {1e3 * hard['ik4']:.1e} mm, CoM {1e3 * lag['ik4']:.2f} mm lower than "
            f"in the motion at 1/{SLOWER} of the speed, knee angles differ by up to "
            f"{apart:.1f} deg",
            hard["ik4"] <= HARD and lag["ik4"] <= HEIGHT_LAG and apart > 1.0,
            values={"hard": hard["ik4"], "lag": lag["ik4"], "apart": apart},
        ),
        Claim(
            "H_others",
            "yaw of the torso with the CoM reference above reach: ik1 and ik3 lag or stop; here "
            "they violate joint limits or hard rows, which ik4 keeps",
            f"ik1 violates the knee limits by {broken:.0f} deg; hard-row error of ik3 "
            f"{1e3 * hard['ik3']:.2f} mm",
            broken > BROKEN_DEG and hard["ik3"] > HARD,
            "ik1 has no joint limits and bends the knee in the wrong direction instead of "
            "stopping; the linearized rows of ik3 do not lead out of the stretched posture, and "
            "feet and torso lag behind by the error of one linearization",
            {"ik1": broken, "ik3": hard["ik3"]},
        ),
    ]


def _horizontal(run: Run) -> float:
    error: Array = run.com_error()[:, :2]
    return float(np.linalg.norm(error, axis=1).max())
