"""Claims of Faraji and Ijspeert, compared with our runs; see the package."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.experiments.claim import Claim
from mgs.experiments.faraji.runs import (
    BOUNDED,
    CROUCHES,
    FEW,
    LEAN,
    MANY,
    SLOWER,
    SQUAT,
    STRETCHED,
    SWAY,
    TILTING,
    TWIST,
    Key,
    Run,
    Study,
    escape_delay,
    hard_error,
    knee_difference_deg,
    knee_torque,
    limit_excess_deg,
    power,
    region_excess,
    rejoining_acceleration,
)

SPEED_MAX = 4.0  # [rad/s] limit of the joint speeds
IK2_GAIN, IK4_GAIN = 50.0, 30.0  # error of ik1 divided by the error of the method
LITTLE = 2.0  # largest ratio of the errors of ik4 with few and with many iterations
HEIGHT_RATIO, COM_RATIO = 0.7, 0.75  # largest ratio to the error of ik3
BROKEN_DEG = 10.0  # [deg] least violation of a joint limit
HARD = 1e-4  # [m] and [rad] largest error of hard rows
HORIZONTAL = 5e-3  # [m] largest horizontal CoM error
ACCELERATION_RATIO, POWER_RATIO = 3.0, 3.0
STATIC_TORQUE_RATIO = 0.1  # largest ratio of knee torques, stretched to most crouched
HEIGHT_LAG = 1e-3  # [m] largest CoM height below that of the same motion at a tenth of the speed
REGION = 1e-9
SNOPT = (
    "the claim depends on the limit of major iterations of the solver SNOPT; here each iteration "
    "is "
    "an exact QP, and {}"
)


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


def squat_claims(study: Study) -> list[Claim]:
    """Claims of task A: squat without singularity."""
    fine = {(m, n): mean_error(study[Key(SQUAT, m, n, "fine")]) for m, n in _all()}
    coarse = {(m, n): mean_error(study[Key(SQUAT, m, n)]) for m, n in _all()}
    gains = {m: fine["ik1", MANY] / fine[m, MANY] for m in ("ik2", "ik4", "ik5")}
    few = {m: fine[m, FEW] / fine[m, MANY] for m in ("ik2", "ik4", "ik5")}
    at_coarse = ", ".join(f"{m} {1e3 * coarse[m, MANY]:.3f}" for m in ("ik1", "ik2", "ik4", "ik5"))
    note = f"mean CoM error at dt 0.002: ik1 {1e3 * fine['ik1', MANY]:.3f} mm; "
    note += f"at dt 0.01: {at_coarse} mm, n = {MANY}"
    return [
        Claim(
            "A_ik2",
            f"squat without singularity: the error of ik1 is at least {IK2_GAIN:g} times that of "
            "ik2",
            f"{gains['ik2']:.0f} times",
            gains["ik2"] >= IK2_GAIN,
            note,
            {"ik2": gains["ik2"]},
        ),
        Claim(
            "A_ik4_ik5",
            f"squat without singularity: the error of ik1 is at least {IK4_GAIN:g} times those of "
            "ik4 "
            "and ik5",
            f"ik4 {gains['ik4']:.0f} times, ik5 {gains['ik5']:.0f} times",
            min(gains["ik4"], gains["ik5"]) >= IK4_GAIN,
            "the remaining error is of second order in the step: the gamma term is linearized",
            {"ik4": gains["ik4"], "ik5": gains["ik5"]},
        ),
        Claim(
            "A_few",
            f"with n = {FEW} instead of {MANY} the error of ik2 grows much, that of ik4 little",
            f"ik2 {few['ik2']:.1f} times, ik4 {few['ik4']:.2f} times",
            few["ik2"] > LITTLE >= few["ik4"],
            f"ik5 {few['ik5']:.0f} times: its weight relative to the damping is (1 + gamma) times "
            "smaller",
            few,
        ),
        Claim(
            "A_ik3_few",
            f"with n = {FEW} instead of {MANY} the error of ik3 grows",
            "ik3 solves one QP for any n",
            "not applicable",
            SNOPT.format("ik3 has a single iteration"),
        ),
    ]


def stretched_claims(study: Study) -> list[Claim]:
    """Claims of task B: squat above reach."""
    runs = {(m, n): study[Key(STRETCHED, m, n)] for m, n in _all()}
    speeds = {m: float(np.abs(runs[m, MANY].speeds()).max()) for m in ("ik1", "ik3", "ik4", "ik5")}
    delays = {m: escape_delay(study, runs[m, MANY]) for m in speeds}
    errors = {key: height_error(run) for key, run in runs.items()}
    ratios = {f"{m}, n = {n}": errors[m, n] / errors["ik3", MANY] for m, n in _iterated()}
    return [
        Claim(
            "B_speed",
            f"squat above reach: joint speeds of ik1 exceed {SPEED_MAX:g} rad/s, those of ik3 to "
            "ik5 do "
            "not",
            f"ik1 {speeds['ik1']:.2f}, ik3 {speeds['ik3']:.2f}, ik4 {speeds['ik4']:.2f} rad/s",
            speeds["ik1"] > SPEED_MAX >= max(speeds[m] for m in BOUNDED) - REGION,
            values=speeds,
        ),
        Claim(
            "B_late",
            "squat above reach: ik1 and ik3 leave the singular posture later than ik4 and ik5",
            ", ".join(f"{m} {1e3 * delay:.0f} ms" for m, delay in delays.items()),
            min(delays["ik1"], delays["ik3"]) > max(delays["ik4"], delays["ik5"]),
            "delay relative to the reference when the knee is bent by 15 deg",
            delays,
        ),
        Claim(
            "B_height",
            f"squat above reach: the mean height errors of ik4 and ik5 with n = {MANY} and {FEW} "
            "are "
            f"at most {HEIGHT_RATIO:g} of that of ik3",
            ", ".join(f"{label}: {ratio:.2f}" for label, ratio in ratios.items()),
            max(ratios.values()) <= HEIGHT_RATIO,
            f"mean height error of ik3 {1e3 * errors['ik3', MANY]:.1f} mm; all errors include the "
            "part of the reference that is out of reach",
            ratios,
        ),
    ]


def tilting_claims(study: Study) -> list[Claim]:
    """Claims of task C: squat above reach with roll and pitch of the torso."""
    runs = {(m, n): study[Key(TILTING, m, n)] for m, n in _all()}
    knees = study.joint("KneeSag")
    broken = {m: limit_excess_deg(runs[m, MANY], study.robot, knees) for m in ("ik1", "ik2")}
    hard = {n: hard_error(runs["ik4", n]) for n in (MANY, FEW)}
    errors = {key: mean_error(run) for key, run in runs.items()}
    ratios = {n: errors["ik4", n] / errors["ik3", MANY] for n in (MANY, FEW)}
    elastic = runs["ik3", MANY].stages.joints.report["elastic_samples"]
    return [
        Claim(
            "C_limits",
            "squat with torso roll and pitch: ik1 and ik2 violate the knee limits by more than "
            f"{BROKEN_DEG:g} deg",
            ", ".join(f"{m} {excess:.0f} deg" for m, excess in broken.items()),
            min(broken.values()) > BROKEN_DEG,
            values=broken,
        ),
        Claim(
            "C_hard",
            "squat with torso roll and pitch: the hard-row errors of ik4 stay below 0.1 mm with "
            f"n = {MANY} and n = {FEW}",
            f"{1e3 * hard[MANY]:.1e} and {1e3 * hard[FEW]:.1e} mm",
            max(hard.values()) <= HARD,
            values={f"n = {n}": value for n, value in hard.items()},
        ),
        Claim(
            "C_com",
            "squat with torso roll and pitch: the mean CoM error of ik4 is at most "
            f"{COM_RATIO:g} of that of ik3",
            f"{ratios[MANY]:.2f} with n = {MANY}, {ratios[FEW]:.2f} with n = {FEW}",
            max(ratios.values()) <= COM_RATIO,
            f"mean CoM error of ik3 {1e3 * errors['ik3', MANY]:.0f} mm; at {elastic} samples its "
            "only "
            "QP is infeasible, and the CoM deviates so that the errors of the feet stay as small "
            "as "
            "possible; with equal weights of CoM and feet at these samples the error would be 30 "
            "mm "
            "and the ratio 0.6",
            {f"n = {n}": ratio for n, ratio in ratios.items()},
        ),
        Claim(
            "C_ik5_few",
            f"squat with torso roll and pitch: ik5 stops moving with n = {FEW}",
            f"mean CoM error {1e3 * errors['ik5', FEW]:.1f} mm, {1e3 * errors['ik5', MANY]:.1f} mm "
            f"with n = {MANY}",
            "not applicable",
            SNOPT.format("ik5 has the same solution as ik4 and keeps moving"),
        ),
    ]


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
            "below "
            "5 mm",
            f"{1e3 * horizontal:.2f} mm with Q = diag(100, 100, 1)",
            horizontal <= HORIZONTAL,
            f"horizontal error with Q = I: ik4 {1e3 * equal['ik4']:.0f} mm, ik2 "
            f"{1e3 * equal['ik2']:.0f} mm",
            {"weighted": horizontal, **equal},
        ),
    ]


def polygon_claim(study: Study) -> Claim:
    """Claim of task E: shape of the safety region."""
    runs = {
        "ellipse": study[Key(STRETCHED, "ik4")],
        "polygon": study[Key(STRETCHED, "ik4", MANY, "polygon")],
    }
    delays = {name: escape_delay(study, run, 30.0) for name, run in runs.items()}
    errors = {name: height_error(run) for name, run in runs.items()}
    return Claim(
        "E_polygon",
        "with a polygon as safety region the robot leaves the singularity later than with the "
        "ellipse",
        f"delay {1e3 * delays['polygon']:.0f} ms with the polygon, "
        f"{1e3 * delays['ellipse']:.0f} ms with the ellipse",
        delays["polygon"] > delays["ellipse"],
        "delay relative to the reference when the knee is bent by 30 deg; mean height errors "
        f"{1e3 * errors['polygon']:.1f} and {1e3 * errors['ellipse']:.1f} mm",
        delays,
    )


def gamma_claims(study: Study) -> list[Claim]:
    """Claims of task F: gamma = 0 compared with gamma = 10."""
    runs = {
        "gamma 10": study[Key(STRETCHED, "ik4")],
        "gamma 0": study[Key(STRETCHED, "ik4", MANY, "gamma 0")],
    }
    delays = {name: escape_delay(study, run) for name, run in runs.items()}
    peaks = {name: rejoining_acceleration(study, run) for name, run in runs.items()}
    ratio = peaks["gamma 0"] / peaks["gamma 10"]
    return [
        Claim(
            "F_escape",
            "with gamma = 0 the robot leaves the singularity later than with gamma = 10",
            f"{1e3 * delays['gamma 0']:.0f} ms and {1e3 * delays['gamma 10']:.0f} ms",
            delays["gamma 0"] > delays["gamma 10"],
            "delay relative to the reference when the knee is bent by 15 deg",
            delays,
        ),
        Claim(
            "F_acceleration",
            "with gamma = 0 the knee returns to its reference with at least "
            f"{ACCELERATION_RATIO:g} times the acceleration",
            f"{ratio:.1f} times: {peaks['gamma 0']:.0f} and {peaks['gamma 10']:.0f} rad/s^2",
            ratio >= ACCELERATION_RATIO,
            "largest acceleration with the knee bent by more than 30 deg",
            peaks,
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
            "crouched "
            "posture as on stretched legs",
            f"sum |tau qdot| {ratios[0]:.2f} times, sum tau^2 {ratios[1]:.1f} times",
            bool(ratios.min() > POWER_RATIO),
            "the paper does not state the amplitudes; with faster or wider twists the first ratio "
            "decreases to 2. |tau qdot| includes braking, and a large part of it is the sway of "
            "hips "
            "and ankles, which is equal in both postures. Values of standing still on stretched "
            "legs "
            f"are subtracted. Values by height relative to z_max: {heights}",
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
            "in "
            f"the motion at 1/{SLOWER} of the speed, knee angles differ by up to {apart:.1f} deg",
            hard["ik4"] <= HARD and lag["ik4"] <= HEIGHT_LAG and apart > 1.0,
            values={"hard": hard["ik4"], "lag": lag["ik4"], "apart": apart},
        ),
        Claim(
            "H_others",
            "yaw of the torso with the CoM reference above reach: ik1 and ik3 lag or stop; here "
            "they "
            "violate joint limits or hard rows, which ik4 keeps",
            f"ik1 violates the knee limits by {broken:.0f} deg; hard-row error of ik3 "
            f"{1e3 * hard['ik3']:.2f} mm",
            broken > BROKEN_DEG and hard["ik3"] > HARD,
            "ik1 has no joint limits and bends the knee in the wrong direction instead of "
            "stopping; "
            "the linearized rows of ik3 do not lead out of the stretched posture, and feet and "
            "torso "
            "lag behind by the error of one linearization",
            {"ik1": broken, "ik3": hard["ik3"]},
        ),
    ]


def region_claim(study: Study) -> Claim:
    """Claim on joint limits and safety region, for all samples of all runs of ik3 to ik5."""
    found = {k: region_excess(study, run) for k, run in study.runs.items() if k.method in BOUNDED}
    worst = max(found.values())
    recovering = sum(int(str(study[k].stages.joints.report["recovering_samples"])) for k in found)
    return Claim(
        "region",
        "ik3 to ik5 keep joint limits and safety region at all samples of all runs, with a "
        "tolerance of 1e-9",
        f"{max(worst, 0.0):.1e} in {len(found)} runs",
        worst <= REGION and recovering == 0,
        "limits in rad, region by eq. (6)",
        {"worst": worst},
    )


def hard_claim(study: Study) -> Claim:
    """Claim on the hard rows of ik4; the note lists runs with infeasible QPs."""
    runs = {k: run for k, run in study.runs.items() if k.method == "ik4"}
    worst = max(runs, key=lambda k: hard_error(runs[k]))
    elastic = {
        f"{k.gait} {k.label} {k.variant}".strip(): int(
            str(run.stages.joints.report["elastic_samples"])
        )
        for k, run in runs.items()
    }
    named = ", ".join(f"{name}: {count}" for name, count in elastic.items() if count)
    return Claim(
        "hard",
        "the hard-row errors of ik4 stay below 0.1 mm in all runs",
        f"{1e3 * hard_error(runs[worst]):.1e} mm ({worst.gait})",
        hard_error(runs[worst]) <= HARD,
        f"number of samples whose last QP was infeasible and solved elastically: {named or 'none'}",
    )


def time_claim(study: Study) -> Claim:
    """Mean time of a solve; the benchmarks measure it more precisely."""
    times = {
        run.stages.gait.ik.solver + f", n = {k.n}": 1e6 * run.seconds_per_solve
        for k, run in study.runs.items()
        if k.gait == STRETCHED and not k.variant
    }
    ik4 = times[f"ik4, n = {FEW}"]
    return Claim(
        "time",
        "ik4 with n = 3 needs about 2 ms per solve (C++, SNOPT, 1.7 GHz)",
        f"{ik4:.0f} us",
        "not applicable",
        "solver, language and machine differ from the paper; mean time per sample of task B [us]: "
        + ", ".join(f"{label}: {t:.0f}" for label, t in times.items()),
        times,
    )


def mean_error(run: Run) -> float:
    """Mean distance of the CoM from its reference in the window [m]."""
    return float(np.linalg.norm(run.com_error(), axis=1).mean())


def height_error(run: Run) -> float:
    """Mean height error of the CoM in the window [m]."""
    return float(np.abs(run.com_error()[:, 2]).mean())


def _horizontal(run: Run) -> float:
    error: Array = run.com_error()[:, :2]
    return float(np.linalg.norm(error, axis=1).max())


def _all() -> list[tuple[str, int]]:
    iterated = [(m, n) for m in ("ik2", "ik4", "ik5") for n in (MANY, FEW)]
    return [("ik1", MANY), ("ik3", MANY), *iterated]


def _iterated() -> list[tuple[str, int]]:
    return [(m, n) for m in ("ik4", "ik5") for n in (MANY, FEW)]
