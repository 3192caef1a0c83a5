"""Claims of the article on Melson, compared with our runs; see the package."""

from __future__ import annotations

import numpy as np

from mgs.core.contact import Side
from mgs.experiments.claim import Claim
from mgs.experiments.melson.gravity import gravity_cost
from mgs.experiments.melson.runs import (
    DRIFT_JOINT,
    Study,
    angle_of,
    drift_series,
    is_same_task,
    peak,
    rms,
    single_support,
    stride_poses,
    torque_of,
    tracking_errors,
)
from mgs.ik_solver.clik import ClosedLoopReport

COST_REDUCTION = 0.10  # least relative reduction of H_grav
DRIFT_ALLOWED_DEG, DRIFT_RATIO = 0.1, 10.0  # largest drift with gamma_joint 1; least ratio without
LAST_STRIDES = 5  # number of strides at the end that are compared: ten steps
POSE_CHANGE_DEG = 1.0  # [deg] difference of a joint above which two poses count as different
POSITION_TOLERANCE, ROTATION_TOLERANCE_DEG = 1e-4, 0.01  # [m], [deg] of met tasks
SAME_TORQUE = 1e-3  # relative difference below which torques count as equal
# explanations of failed claims on positions, from the trajectories
WHY_NOT = {
    "hip_roll": "To reduce the torque, the null-space motion moves this joint through zero to the "
    "other side, where its magnitude stays below that of S1; it exceeds S1 only afterwards, in "
    "double support, on its way to the peak of the whole motion"
}


def all_claims(study: Study) -> list[Claim]:
    """All claims, in the order of the article."""
    return [
        *task_claims(study),
        *torque_claims(study),
        cost_claim(study),
        position_claim(study, "hip_roll", higher=True),
        position_claim(study, "knee_pitch", higher=True),
        ankle_torque_claim(study),
        position_claim(study, "ankle_roll", higher=False),
        *other_joints(study),
        *drift_claims(study),
    ]


def task_claims(study: Study) -> list[Claim]:
    """Claims on the task trajectory: equal for all runs, and met by all runs."""
    runs = {**study.scenarios, **study.drift}
    groups = (list(study.scenarios.values()), list(study.drift.values()))
    same = all(is_same_task(group[0], other) for group in groups for other in group[1:])
    errors = {name: tracking_errors(stages) for name, stages in runs.items()}
    worst = max(position for position, _ in errors.values())
    turn = np.degrees(max(rotation for _, rotation in errors.values()))
    updates = sum(s.joints.report_of(ClosedLoopReport).newton_updates for s in runs.values())
    return [
        Claim(
            "same_task",
            "all runs of a walk have the same task trajectory",
            "identical" if same else "different",
            same,
            "references of soles, hands and CoM are compared bit by bit",
        ),
        Claim(
            "task_met",
            f"all runs meet their task trajectory within {1e3 * POSITION_TOLERANCE:g} mm "
            f"and {ROTATION_TOLERANCE_DEG:g} deg",
            f"{1e3 * worst:.4f} mm, {turn:.1e} deg",
            bool(worst < POSITION_TOLERANCE and turn < ROTATION_TOLERANCE_DEG and updates == 0),
            f"worst sample of {len(runs)} runs, {updates} Newton updates",
            {name: position for name, (position, _) in errors.items()},
        ),
    ]


def show(values: dict[str, float], unit: str, digits: int = 3) -> str:
    """Text of the values of the scenarios."""
    return ", ".join(f"{name} {value:.{digits}f}" for name, value in values.items()) + f" {unit}"


def torque_claims(study: Study) -> list[Claim]:
    """Claims on the gravity torques of left hip roll and knee: lower in S3."""
    claims = []
    for joint in ("hip_roll", "knee_pitch"):
        series = torque_of(study, Side.LEFT, joint)
        for kind, measure in (("peak", peak), ("RMS", rms)):
            values = {name: measure(torque) for name, torque in series.items()}
            below = {name: 100.0 * (1.0 - values["S3"] / values[name]) for name in ("S1", "S2")}
            note = f"{below['S1']:.1f} % below S1, {below['S2']:.1f} % below S2"
            if kind == "peak" and np.abs(series["S3"]).argmax() == 0:
                note += (
                    "; the peak of S3 is at the first sample of single support, when the gravity "
                    "gain is still near zero and the posture results from the double support "
                    "before"
                )
            claims.append(
                Claim(
                    f"left_{joint}_{kind.lower()}_torque",
                    f"{kind} gravity torque of the left {joint.replace('_', ' ')} in left single "
                    "support is lower in S3 than in S1 and S2",
                    show(values, "N m"),
                    values["S3"] < min(values["S1"], values["S2"]),
                    note,
                    values,
                )
            )
    return claims


def cost_claim(study: Study) -> Claim:
    """Claim on the mean of H_grav over single support: lower in S3."""
    values = {name: float(np.nanmean(gravity_cost(t))) for name, t in study.torques.items()}
    below = {name: 1.0 - values["S3"] / values[name] for name in ("S1", "S2")}
    return Claim(
        "mean_gravity_cost",
        f"mean H_grav over single support is at least {100 * COST_REDUCTION:.0f} % lower in S3 "
        "than in S1 and S2",
        show(values, "(N m)^2"),
        min(below.values()) >= COST_REDUCTION,
        f"{100 * below['S1']:.1f} % below S1, {100 * below['S2']:.1f} % below S2; both single "
        "supports, all joints, W = 1",
        values,
    )


def position_claim(study: Study, joint: str, *, higher: bool) -> Claim:
    """Claim on the position peak of a joint of the left leg: higher, or lower, in S3."""
    window = single_support(study, Side.LEFT)
    angles = angle_of(study, joint)
    values = {name: peak(angle[window]) for name, angle in angles.items()}
    whole = {name: peak(angle) for name, angle in angles.items()}
    others = [values["S1"], values["S2"]]
    holds = values["S3"] > max(others) if higher else values["S3"] < min(others)
    note = f"peaks of the whole motion: {show(whole, 'deg', 1)}"
    if not holds:
        travels = {
            name: f"{name} from {angle[window][0]:.1f} through {angle[window].min():.1f} and "
            f"{angle[window].max():.1f} to {angle[window][-1]:.1f}"
            for name, angle in angles.items()
        }
        note += f"; course in left single support [deg]: {'; '.join(travels.values())}"
        note += f". {WHY_NOT.get(joint, '')}"
    return Claim(
        f"left_{joint}_position_peak",
        f"position peak of the left {joint.replace('_', ' ')} in left single support is "
        f"{'higher' if higher else 'lower'} in S3 than in S1 and S2",
        show(values, "deg", 2),
        bool(holds),
        note,
        values,
    )


def ankle_torque_claim(study: Study) -> Claim:
    """Claim on the gravity torque of the ankle roll: not reduced in S3."""
    values = {k: peak(v) for k, v in torque_of(study, Side.LEFT, "ankle_roll").items()}
    gap = abs(values["S3"] / min(values["S1"], values["S2"]) - 1.0)
    return Claim(
        "left_ankle_roll_torque",
        "gravity torque of the left ankle roll in left single support is not reduced in S3",
        show(values, "N m", 4),
        values["S3"] > (1.0 - SAME_TORQUE) * min(values["S1"], values["S2"]),
        f"relative difference of the peaks {gap:.0e}; the axis is fixed to the support sole, so "
        "that the CoM, which is a task, determines the torque, and no null-space motion can "
        "change it",
        values,
    )


def other_joints(study: Study) -> list[Claim]:
    """Torques of joints without a claim, for information."""
    claims = []
    for side, joint in (
        (Side.LEFT, "hip_pitch"),
        (Side.RIGHT, "hip_roll"),
        (Side.RIGHT, "hip_pitch"),
        (Side.RIGHT, "knee_pitch"),
    ):
        series = torque_of(study, side, joint)
        peaks = {name: peak(torque) for name, torque in series.items()}
        means = {name: rms(torque) for name, torque in series.items()}
        claims.append(
            Claim(
                f"{side.label}_{joint}_torque",
                f"gravity torque of the {side.label} {joint.replace('_', ' ')} in {side.label} "
                "single support, for information",
                f"peak {show(peaks, 'N m')}; RMS {show(means, 'N m')}",
                "not applicable",
                "H_grav is the sum over all joints, so that the torque of a single joint may "
                "increase",
                {
                    **{f"{name} peak": value for name, value in peaks.items()},
                    **{f"{name} rms": value for name, value in means.items()},
                },
            )
        )
    return claims


def drift_claims(study: Study) -> list[Claim]:
    """Claims on joint drift: it occurs without a secondary task, and gamma_joint 1 stops it."""
    moved = {
        name: float(np.ptp(angle[-LAST_STRIDES - 1 :]))
        for name, angle in drift_series(study).items()
    }
    without, with_task = moved["gamma_joint 0"], moved["gamma_joint 1"]
    joint = DRIFT_JOINT.replace("_", " ")
    how = "range of the angles at the starts of left single supports, over the last ten steps"
    return [
        Claim(
            "drift_stopped",
            f"with gamma_joint 1 the {joint} drifts by less than {DRIFT_ALLOWED_DEG} deg over the "
            "last ten of 30 steps",
            f"{with_task:.1e} deg",
            with_task < DRIFT_ALLOWED_DEG,
            how,
            moved,
        ),
        Claim(
            "drift_without_task",
            f"with gamma_joint 0 the {joint} drifts at least {DRIFT_RATIO:g} times as far",
            f"{without:.3f} deg, {without / with_task:.0f} times",
            without >= DRIFT_RATIO * with_task,
            how,
            moved,
        ),
        *pose_claims(study),
    ]


def pose_claims(study: Study) -> list[Claim]:
    """Claims on the pose after 30 steps: it depends on the gain and differs from the first pose."""
    ends = {name: np.degrees(s.joints.angles[[0, -1]]) for name, s in study.drift.items()}
    change = {name: peak(end[1] - end[0]) for name, end in ends.items()}
    moved = {
        name: float(np.ptp(stride_poses(stages)[-LAST_STRIDES - 1 :], axis=0).max())
        for name, stages in study.drift.items()
    }
    apart = ends["gamma_joint 0"][1] - ends["gamma_joint 1"][1]
    joint = study.robot.joint_names[int(np.abs(apart).argmax())].replace("_", " ")
    return [
        Claim(
            "final_poses_differ",
            "the poses after 30 steps with gamma_joint 0 and 1 differ by more than "
            f"{POSE_CHANGE_DEG:g} deg in a joint",
            f"{peak(apart):.1f} deg, {joint}",
            peak(apart) > POSE_CHANGE_DEG,
            "the first poses of both runs are equal",
        ),
        Claim(
            "final_pose_moved",
            "with gamma_joint 0 the last pose differs from the first by more than "
            f"{POSE_CHANGE_DEG:g} deg in a joint",
            f"{change['gamma_joint 0']:.1f} deg",
            change["gamma_joint 0"] > POSE_CHANGE_DEG,
            f"with gamma_joint 1 the difference is {change['gamma_joint 1']:.1f} deg, because the "
            "half-sitting posture is not the minimum of H_joint. But then the posture settles: "
            f"over the last ten steps joints change by up to {moved['gamma_joint 1']:.0e} deg at "
            f"equal phases, with gamma_joint 0 by up to {moved['gamma_joint 0']:.1f} deg",
            change,
        ),
    ]
