"""Claims on the shape of the safety region (E) and on gamma (F), FI III-E and III-F, on task B."""

from __future__ import annotations

import numpy as np

from mgs.experiments.claim import Claim
from mgs.experiments.faraji.electric import current_of_joints
from mgs.experiments.faraji.measures import (
    WELL_BENT_DEG,
    escape_delay,
    height_error,
    rejoining_acceleration,
    reversals,
    survival,
)
from mgs.experiments.faraji.runs import (
    LEAN,
    MANY,
    SQUAT,
    STRETCHED,
    TILTING,
    TWIST,
    Key,
    Run,
    Study,
)
from mgs.experiments.faraji.thresholds import DRASTIC, FASTER, VIBRATION

DESCENT = 0.5  # [s] from leaving the singular posture to the deepest point of the squat
AFTER = 0.15  # [s] after a knee has left the singular posture
STRAIGHT_DEG = 5.0  # [deg] knee angle below which a leg is in the singular posture


def region_claims(study: Study) -> list[Claim]:
    """Claims on region and gamma."""
    return [
        _polygon_claim(study),
        *_gamma_claims(study),
        *_large_gamma_claims(study),
        *_current_claims(study),
    ]


def _polygon_claim(study: Study) -> Claim:
    runs = {
        "polygon": study[Key(STRETCHED, "ik4", MANY, "polygon")],
        "ellipse": study[Key(STRETCHED, "ik4")],
    }
    delays = {name: escape_delay(study, run) for name, run in runs.items()}
    later = {name: escape_delay(study, run, WELL_BENT_DEG) for name, run in runs.items()}
    errors = {name: height_error(run) for name, run in runs.items()}
    return Claim(
        "E_polygon",
        "A polygon as safety region adds a delay when a joint leaves the singularity, compared "
        "with a circular one",
        " and ".join(f"{1e3 * delay:.0f} ms with the {name}" for name, delay in delays.items()),
        delays["polygon"] >= FASTER * delays["ellipse"],
        "delay of the knee at 15 deg, ik4, later by 10 % at least; at 30 deg "
        f"{1e3 * later['polygon']:.0f} and {1e3 * later['ellipse']:.0f} ms; mean height errors "
        f"{1e3 * errors['polygon']:.1f} and {1e3 * errors['ellipse']:.1f} mm. The paper gives no "
        "dimensions of its polygon; ours reaches from qdot_max in mid-range to 0.02 rad/s at the "
        "limits",
        delays,
        "FI III-E, Fig. 5",
        ("ik4",),
    )


def _gamma_claims(study: Study) -> list[Claim]:
    runs = {
        "gamma 0": study[Key(STRETCHED, "ik4", MANY, "gamma 0")],
        "gamma 10": study[Key(STRETCHED, "ik4")],
    }
    delays = {name: escape_delay(study, run) for name, run in runs.items()}
    first = {name: escape_delay(study, run, STRAIGHT_DEG) for name, run in runs.items()}
    peaks = {name: rejoining_acceleration(study, run) for name, run in runs.items()}
    return [
        Claim(
            "F_escape",
            "With gamma = 0 the joint leaves the singularity with more delay",
            " and ".join(f"{1e3 * delay:.0f} ms with {name}" for name, delay in delays.items()),
            delays["gamma 0"] >= FASTER * delays["gamma 10"],
            "delay of the knee at 15 deg, ik4",
            delays,
            "FI III-F, Fig. 5; FI-abstract 4",
            ("ik4",),
        ),
        Claim(
            "F_advance",
            "With the task velocity in the objective the knee starts to flex in advance, while the "
            "task is yet infeasible",
            f"knee at 5 deg {1e3 * first['gamma 10']:.0f} ms after the reference, with gamma = 0 "
            f"{1e3 * first['gamma 0']:.0f} ms",
            first["gamma 10"] < 0.0,
            "negative: before the reference of the height becomes reachable with 5 deg of bend",
            first,
            "FI-abstract 4, FI II-E",
            ("ik4",),
        ),
        Claim(
            "F_jump",
            "With gamma = 0 the knee suddenly changes its velocity when it reaches its trajectory; "
            "gamma smooths this transition",
            " and ".join(f"{peak:.0f} rad/s^2 with {name}" for name, peak in peaks.items()),
            peaks["gamma 0"] >= FASTER * peaks["gamma 10"],
            "largest acceleration of a knee that is bent by more than 30 deg, ik4",
            peaks,
            "FI III-F, Fig. 5C",
            ("ik4",),
        ),
    ]


def _large_gamma_claims(study: Study) -> list[Claim]:
    tasks = {
        "A": study[Key(SQUAT, "ik4")],
        "B": study[Key(STRETCHED, "ik4")],
        "C": study[Key(TILTING, "ik4")],
        "D": study[Key(LEAN, "ik4")],
        "H": study[Key(TWIST, "ik4")],
    }
    found = {name: survival(study, run) for name, run in tasks.items()}
    names = [(m, x) for x in ("", ", fast") for m in ("ik4", "ik5")]
    turns = {
        f"{m}{x}": reversals(study, study[Key(STRETCHED, m, MANY, f"gamma 100{x}")])
        for m, x in names
    }
    fast = [turns[f"{m}, fast"] for m in ("ik4", "ik5")]
    return [
        Claim(
            "F_enough",
            "gamma = 10 is enough to cover all simulations",
            ", ".join(f"{name} {s}" for name, s in found.items()),
            all(s.survives for s in found.values()),
            "ik4: joint limits, feet and torso in place, CoM above the soles",
            source="FI III-F",
            methods=("ik4",),
        ),
        Claim(
            "F_unstable",
            "Larger gamma makes ik4 and ik5 unstable in very fast motions",
            ", ".join(f"{name} {value:.1f}" for name, value in turns.items()),
            min(fast) > VIBRATION,
            "additional reversals of the knee per period with gamma = 100, squat at 1 Hz and (fast)"
            " at 2 Hz; the paper states neither gamma nor speed",
            turns,
            "FI III-F, Table I",
            ("ik4", "ik5"),
        ),
        Claim(
            "F_slower",
            "Slower tasks might still be stable with larger gamma",
            f"ik4 {turns['ik4']:.1f}, ik5 {turns['ik5']:.1f}",
            max(turns["ik4"], turns["ik5"]) <= VIBRATION,
            "additional reversals of the knee per period with gamma = 100, squat at 1 Hz",
            {m: turns[m] for m in ("ik4", "ik5")},
            "FI III-F, Table I",
            ("ik4", "ik5"),
        ),
    ]


def _current_claims(study: Study) -> list[Claim]:
    plain, without = (study[Key(STRETCHED, "ik4", MANY, v)] for v in ("", "gamma 0"))
    j = study.joint("KneeSag")[0]
    angle = np.degrees(plain.joints[plain.window, j])
    torque = np.abs(plain.stages.motion.torque[plain.window, j])
    low, high = torque[angle < STRAIGHT_DEG], torque[angle > WELL_BENT_DEG]
    drop = float(np.median(low) / np.median(high)) if len(low) and len(high) else float("nan")
    peaks = {
        "gamma 0": _peak_after_escape(study, without, j),
        "gamma 10": _peak_after_escape(study, plain, j),
    }
    back = _least_after_escape(study, plain, j)
    arrival = _arrival(study, plain, j)
    return [
        Claim(
            "F_drop",
            "Current and joint torque decrease drastically in the singular position",
            f"{drop:.2f} times",
            drop <= DRASTIC,
            "median knee torque below 5 deg of bend relative to that above 30 deg; the current of "
            "the motor model is proportional to the torque",
            {"ratio": drop},
            "FI Fig. 6",
            ("ik4",),
        ),
        Claim(
            "F_safe",
            "Thanks to the circular region the knee does not hit its limit with high current",
            f"{arrival:.2f} of the largest current",
            arrival <= DRASTIC,
            "largest current of the knee while it closes below 5 deg, relative to its largest "
            "current of all",
            {"ratio": arrival},
            "FI Fig. 6",
            ("ik4",),
        ),
        Claim(
            "F_peak",
            "Coming out of the singularity without gamma causes a momentary peak of the current, "
            "which gamma decreases",
            " and ".join(f"{peak:.2f} A with {name}" for name, peak in peaks.items()),
            peaks["gamma 0"] >= FASTER * peaks["gamma 10"],
            "largest current of the knee on the way down, motor model at 24 V with the inertia of "
            "the rotor",
            peaks,
            "FI Fig. 6",
            ("ik4",),
        ),
        Claim(
            "F_negative",
            "The joint produces negative current directly after leaving the singularity",
            f"{back:.2f} A",
            back < 0.0,
            f"least current of the knee in the {1e3 * AFTER:.0f} ms after leaving; negative: the "
            "motor brakes while the robot lowers its weight",
            {"least": back},
            "FI Fig. 6",
            ("ik4",),
        ),
    ]


def _arrival(study: Study, run: Run, j: int) -> float:
    """Largest current of a knee that closes near its limit, relative to the largest of all."""
    current = np.abs(current_of_joints(study.robot, run)[1:-1, j])
    angle, speed = np.degrees(run.joints[run.window, j])[1:-1], run.speeds()[:, j]
    # a torque rests on the steps before and after its sample
    closing = (angle < STRAIGHT_DEG) & (speed[:-1] < 0.0) & (speed[1:] < 0.0)
    return float(current[closing].max(initial=0.0) / current.max())


def _windows(study: Study, run: Run, j: int, seconds: float) -> list[slice]:
    """Samples of the window that follow each escape of a knee from the singular posture."""
    bent = np.abs(run.joints[run.window, j]) > np.deg2rad(STRAIGHT_DEG)
    starts = np.flatnonzero(bent[1:] & ~bent[:-1]) + 1
    return [slice(k, k + round(seconds / run.dt)) for k in starts]


def _peak_after_escape(study: Study, run: Run, j: int) -> float:
    current = np.abs(current_of_joints(study.robot, run)[:, j])
    peaks = [current[w].max() for w in _windows(study, run, j, DESCENT)]
    return float(np.mean(peaks)) if peaks else float("nan")


def _least_after_escape(study: Study, run: Run, j: int) -> float:
    current = current_of_joints(study.robot, run)[:, j]
    least = [current[w].min() for w in _windows(study, run, j, AFTER)]
    return float(np.mean(least)) if least else float("nan")
