"""Measurements on the runs of the experiments of Faraji and Ijspeert."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.contact import Support
from mgs.core.geometry import polygon_margins
from mgs.experiments.faraji.runs import STRETCHED, Key, Run, Study
from mgs.ik_solver.floating.hard_soft_report import FarajiReport
from mgs.ik_solver.floating.safety_region import SafetyRegion
from mgs.robot import Robot
from mgs.robot.support_polygon import support_polygon

BENT_DEG = 15.0  # [deg] knee angle from which on the knee has left the stretched posture
WELL_BENT_DEG = 30.0  # [deg] knee angle from which on the knee returns to its reference
SURVIVES_LIMIT_DEG, SURVIVES_HARD = 0.5, 1e-3  # [deg], [m] and [rad]
STILL = 0.05  # [rad/s] speed below which a change of sign is no reversal


def report_of(run: Run) -> FarajiReport:
    """Report of the solver."""
    return run.stages.joints.report_of(FarajiReport)


def hard_error(run: Run) -> float:
    """Largest error of a hard row [m] or [rad], as reported by the solver."""
    return report_of(run).hard_error


def mean_error(run: Run) -> float:
    """Mean distance of the CoM from its reference in the window [m]."""
    return float(np.linalg.norm(run.com_error(), axis=1).mean())


def height_error(run: Run) -> float:
    """Mean height error of the CoM in the window [m]."""
    return float(np.abs(run.com_error()[:, 2]).mean())


def horizontal_error(run: Run) -> float:
    """Largest horizontal CoM error in the window [m]."""
    return float(np.linalg.norm(run.com_error()[:, :2], axis=1).max())


def mean_seconds(run: Run) -> float:
    """Median CPU time of a solve in the window [s]."""
    return float(np.median(report_of(run).seconds[run.window]))


def mean_iterations(run: Run) -> float:
    """Mean number of iterations of a sample in the window, until a step is below 1e-7."""
    return float(report_of(run).iterations[run.window].mean())


def region_excess(study: Study, run: Run) -> float:
    """Largest violation of joint limits [rad] or safety region [-]; 0 or less if there is none."""
    robot, joints = study.robot, run.joints
    region = SafetyRegion.of_robot(robot, run.stages.gait.ik.faraji, run.dt)
    outside = np.maximum(robot.lower - joints, joints - robot.upper).max()
    return float(max(region.excess(joints[:-1], joints[1:]).max(), outside))


def limit_excess_deg(run: Run, robot: Robot, joints: list[int]) -> float:
    """Largest violation of the limits of some joints [deg]; negative: least distance from them."""
    angles = run.joints[run.window][:, joints]
    excess = np.maximum(robot.lower[joints] - angles, angles - robot.upper[joints])
    return float(np.degrees(excess.max()))


@dataclass(frozen=True)
class Survival:
    """Whether a motion can be executed: joint limits, feet in place, CoM above the soles."""

    limit_deg: float  # largest violation of a joint limit [deg]
    hard: float  # largest error of soles and torso [m] or [rad]
    outside: float  # largest distance of the CoM outside the support polygon [m]

    @property
    def survives(self) -> bool:
        """True if nothing is violated."""
        return (
            self.limit_deg <= SURVIVES_LIMIT_DEG
            and self.hard <= SURVIVES_HARD
            and self.outside <= 0.0
        )

    def __str__(self) -> str:
        if self.survives:
            return "feasible"
        parts = []
        if self.limit_deg > SURVIVES_LIMIT_DEG:
            parts.append(f"{self.limit_deg:.0f} deg beyond a joint limit")
        if self.hard > SURVIVES_HARD:
            parts.append(f"feet or torso {1e3 * self.hard:.1f} mm (mrad) off")
        if self.outside > 0.0:
            parts.append(f"CoM {1e3 * self.outside:.0f} mm outside the soles")
        return " and ".join(parts)


def survival(study: Study, run: Run) -> Survival:
    """Feasibility of a run in its window."""
    robot, motion = study.robot, run.stages.motion
    polygon = support_polygon(robot, motion.soles_ref[0], Support.DOUBLE)
    outside = -polygon_margins(motion.com[run.window, :2], polygon).min()
    joints = list(range(robot.n))
    excess = max(0.0, limit_excess_deg(run, robot, joints))
    return Survival(excess, hard_error(run), max(0.0, float(outside)))


def escape_delay(study: Study, run: Run, bent_deg: float = BENT_DEG) -> float:
    """Mean delay [s] with which the left knee is bent by an angle after it was stretched.

    The delay is relative to the reference: an exact solution has this angle when the reference
    falls to the CoM height that belongs to the angle, taken from ik4. Both times are interpolated
    between samples. A knee that bends the wrong way has left the posture as well. NaN: ik4 or
    the run itself is never stretched, or the reference never falls below that height.
    """
    left = study.joint("KneeSag")[0]
    knee, bent = np.abs(run.joints[:, left]), np.deg2rad(bent_deg)
    exact = study[Key(STRETCHED, "ik4")]
    height = _height_of_knee(exact, exact.joints[:, left], bent)
    wanted, delays = run.stages.motion.com_ref[:, 2], []
    for k in range(run.window.start + 1, run.window.stop):
        if not wanted[k - 1] > height >= wanted[k]:
            continue
        asked = k - 1 + (wanted[k - 1] - height) / (wanted[k - 1] - wanted[k])
        first = k  # the last sample at which the knee is less bent
        if knee[k] >= bent:  # it was faster than the reference
            straighter = np.flatnonzero(knee[:k] < bent)
            if not len(straighter):
                return float("nan")
            first = int(straighter[-1])
        later = first + 1 + np.flatnonzero(knee[first + 1 :] >= bent)
        if len(later):
            j = int(later[0])
            found = j - (knee[j] - bent) / (knee[j] - knee[j - 1])
        else:
            found = float(len(knee))
        delays.append((found - asked) * run.dt)
    return float(np.mean(delays)) if delays else float("nan")


def _height_of_knee(run: Run, knee: Array, angle: float) -> float:
    """CoM height [m] at which the knee has an angle, interpolated from the samples of the run.

    NaN: the knee does not have this angle in the window.
    """
    z, angles = run.stages.motion.com[run.window, 2], knee[run.window]
    if not angles.min() <= angle <= angles.max():
        return float("nan")
    order = np.argsort(angles)
    return float(np.interp(angle, angles[order], z[order]))


def reversals(study: Study, run: Run) -> float:
    """Reversals of the left knee per period of the squat, less the two of a smooth motion."""
    speed = run.speeds()[:, study.joint("KneeSag")[0]]
    moving = speed[np.abs(speed) > STILL]
    turns = int(np.sum(np.sign(moving[1:]) != np.sign(moving[:-1])))
    wanted = run.stages.motion.com_ref[run.window, 2]
    falls = np.diff(wanted)
    periods = max(1.0, 0.5 * np.sum(np.sign(falls[1:]) * np.sign(falls[:-1]) < 0))
    return float(turns / periods - 2.0)


def peak_speed(run: Run) -> float:
    """Largest joint speed in the window [rad/s]."""
    return float(np.abs(run.speeds()).max())


def rejoining_acceleration(study: Study, run: Run) -> float:
    """Largest acceleration of a well-bent knee on its way back to the reference [rad/s^2]."""
    knees = study.joint("KneeSag")
    bent = run.joints[run.window][1:-1, knees] > np.deg2rad(WELL_BENT_DEG)
    return float(np.abs(run.accelerations()[:, knees][bent]).max(initial=0.0))


def knee_range_deg(study: Study, run: Run) -> float:
    """Difference between the largest and the least angle of the left knee in the window [deg]."""
    return float(np.degrees(np.ptp(run.joints[run.window, study.joint("KneeSag")[0]])))


def knee_difference_deg(study: Study, run: Run) -> float:
    """Largest difference between the two knee angles in the window [deg]."""
    left, right = study.joint("KneeSag")
    angles = run.joints[run.window]
    return float(np.degrees(np.abs(angles[:, left] - angles[:, right]).max()))


def knee_torque(study: Study, run: Run) -> float:
    """Mean magnitude [N m] of both knee torques in the window."""
    return float(np.abs(run.stages.motion.torque[run.window][:, study.joint("KneeSag")]).mean())


def ratio(a: float, b: float) -> float:
    """Quotient a / b; infinite if b is zero."""
    return a / b if b else float("inf")


def speeds_of_joints(run: Run) -> Array:
    """Joint velocities (m, n) of the motion in the window [rad/s]."""
    return np.asarray(run.stages.motion.v[run.window, FLOATING_BASE_NV:])
