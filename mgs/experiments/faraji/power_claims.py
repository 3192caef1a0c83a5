"""Claims of task G: lateral motion with torso twist, FI III-G and figure 7, with Q = I."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.experiments.claim import Claim
from mgs.experiments.faraji.electric import consumption, fitted_line
from mgs.experiments.faraji.measures import hard_error, horizontal_error, knee_torque
from mgs.experiments.faraji.runs import CROUCHES, FEW, SWAY, Key, Run, Study
from mgs.experiments.faraji.thresholds import HARD, NEARLY_ZERO, NOT_ALTERED, THREE_TIMES

MEASURES = ("electric power", "sum |tau qdot|", "sum tau^2")


def sway_runs(study: Study) -> list[Run]:
    """Runs from stretched legs to the most crouched posture."""
    return [study[Key(SWAY, "ik4", FEW, f"{height:g}")] for height in CROUCHES]


def crouch_deg(study: Study, run: Run) -> float:
    """Mean knee angle that was reached in the window [deg]."""
    return float(np.degrees(run.joints[run.window][:, study.joint("KneeSag")].mean()))


def power_above_quiet(study: Study, run: Run, variant: str = "quiet") -> Array:
    """Measures of power (3,) of a run less those of quiet stance on stretched legs."""
    quiet = study[Key(SWAY, "ik4", FEW, variant)]
    return np.array(consumption(study.robot, run)) - consumption(study.robot, quiet)


def sway_claims(study: Study) -> list[Claim]:
    """Claims on power; torques by inverse dynamics, with the load shared as the ZMP requires."""
    runs = sway_runs(study)
    angles = np.array([crouch_deg(study, run) for run in runs])
    power = np.array([power_above_quiet(study, run) for run in runs])
    slope, _, fit = fitted_line(angles, power[:, 0])
    ratios = power[-1] / power[0]
    ends = [study[Key(SWAY, "ik4", FEW, f"{CROUCHES[i]:g}, weighted")] for i in (0, -1)]
    low, high = (power_above_quiet(study, run, "quiet, weighted") for run in ends)
    quiet = study[Key(SWAY, "ik4", FEW, "quiet")]
    torques = knee_torque(study, quiet), knee_torque(study, runs[-1])
    worst = max(horizontal_error(run) for run in runs), max(hard_error(run) for run in runs)
    table = "; ".join(
        f"{a:.0f} deg: {p[0]:.1f} W, {p[1]:.2f} W, {p[2]:.0f} (N m)^2"
        for a, p in zip(angles, power, strict=True)
    )
    return [
        Claim(
            "G_few",
            f"This scenario is hard because it is asymmetric, but ik4 handles it with n = {FEW}",
            f"horizontal CoM {1e3 * worst[0]:.1f} mm, hard rows {1e3 * worst[1]:.1g} mm",
            worst[0] <= NOT_ALTERED and worst[1] <= HARD,
            "horizontal CoM within 5 mm, hard rows within 0.1 mm, at all heights",
            {"com": worst[0], "hard": worst[1]},
            "FI III-G",
            ("ik4",),
        ),
        Claim(
            "G_line",
            "The power rises steeply with the crouch: the paper fits a line to its measurements",
            f"{slope:.2f} W/deg, coefficient of determination {fit:.2f}",
            slope > 0.0 and fit >= 0.8,
            f"electric power over the mean knee angle reached. By angle: {MEASURES[0]}, "
            f"{MEASURES[1]}, {MEASURES[2]}: {table}; quiet stance on stretched legs is subtracted",
            {"slope": slope, "fit": fit},
            "FI III-G, Fig. 7",
            ("ik4",),
        ),
        Claim(
            "G_power",
            "In the most crouched posture the robot consumes over three times the power of "
            "stretched legs",
            ", ".join(f"{m} {r:.2f} times" for m, r in zip(MEASURES, ratios, strict=True)),
            bool(ratios[0] > THREE_TIMES),
            "judged by the electric power; sum |tau qdot| leaves the losses of the motors out and "
            "counts the sway of hips and ankles, which is equal in all postures. With Q = "
            f"diag(100, 100, 1): {', '.join(f'{r:.2f}' for r in high / low)} times",
            dict(zip(MEASURES, (float(r) for r in ratios), strict=True)),
            "FI III-G, Fig. 7",
            ("ik4",),
        ),
        Claim(
            "G_knee",
            "Knee torques are nearly zero in stretched-leg postures",
            f"{torques[0]:.1f} N m, in the most crouched posture {torques[1]:.1f} N m",
            torques[0] <= NEARLY_ZERO * torques[1],
            "mean of both knees in quiet stance, at most a tenth; margin q_s = 5 deg as in Table I "
            "for the robot",
            {"stretched": torques[0], "crouched": torques[1]},
            "FI III-G",
            ("ik4",),
        ),
    ]
