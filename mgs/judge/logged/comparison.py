"""A motion compared with a log of the robot that executed it: delay, zero, play and droop."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.errors import ConfigError, LogError
from mgs.core.short_repr import short_repr
from mgs.judge.logged.clock import LEAST_SAMPLES, Start, find_start, refuse_poor
from mgs.judge.logged.fit import STIFFNESS, Curves, JointFit, Prior, fit_joint
from mgs.judge.logged.load import carried, loads
from mgs.motion import Motion
from mgs.motion.goals import GoalKind, Goals, goals_along
from mgs.motion_file.joint_log import JointLog
from mgs.robot import is_modelled, servos_of
from mgs.robot.unit import SLACK, JointCorrection, Unit, UnitSpec

AROUND = 1.0  # [s] before and after a motion in which the robot rests
FAR = np.radians(1.0)  # [rad] RMS between what a log says that joints were told, and these goals
SAG = np.radians(5.0)  # [rad] at stall torque, uncertainty of the compliance of an unknown servo
RIGID = 1e6  # [N m/rad] the largest stiffness of a file of a physical robot
LARGEST = {"zero_offset": 1.0, "backlash": 0.5}  # [rad] of a file of a physical robot


@dataclass(frozen=True)
class JointComparison:
    """One joint; angles [rad], times [s]."""

    name: str
    fit: JointFit
    described_stiffness: float | None  # [N m/rad]
    rms_before: float  # of measured against planned angles, at the delay
    rms_after: float  # of what the figures do not explain
    bias: float  # mean of measured minus planned angles

    @property
    def stiffness(self) -> float | None:
        """Stiffness that was measured [N m/rad]; None: the log says too little of it."""
        if not self.fit.knows_compliance:
            return None
        return 1.0 / max(self.fit.compliance, 1.0 / RIGID)

    @property
    def stiffness_error(self) -> float | None:
        """Standard error of the measured stiffness [N m/rad]; None: the joint may be rigid."""
        stiffness = self.stiffness
        if stiffness is None or self.fit.compliance <= 2.0 * self.fit.compliance_error:
            return None
        return self.fit.compliance_error * stiffness**2

    def to_dict(self) -> dict[str, Any]:
        """Plain dict for JSON, angles in degrees."""
        fit = self.fit
        return {
            "joint": self.name,
            "samples": fit.samples,
            "sign": fit.sign,
            "delay": fit.delay,
            "delay_at_edge": fit.delay_at_edge,
            "zero_offset_deg": float(np.degrees(fit.zero_offset)),
            "backlash_deg": float(np.degrees(fit.backlash)) if fit.knows_backlash else None,
            "backlash_error_deg": float(np.degrees(fit.backlash_error)),
            "stiffness": self.stiffness,
            "stiffness_error": self.stiffness_error,
            "described_stiffness": self.described_stiffness,
            "bias_deg": float(np.degrees(self.bias)),
            "rms_before_deg": float(np.degrees(self.rms_before)),
            "rms_after_deg": float(np.degrees(self.rms_after)),
        }


@dataclass(frozen=True, eq=False)
class Comparison:
    """A motion against a log."""

    goals: GoalKind
    unit: str | None  # whose corrections the goals had already
    start: float  # of the motion on the clock of the log [s]
    found: Start | None  # how it was found; None: it was given
    hung: bool
    joints: tuple[JointComparison, ...]
    without_log: tuple[str, ...]  # joints of the robot that the log lacks
    unknown: tuple[str, ...]  # names in the log that are no joints
    times: Array  # (M,) on the clock of the motion [s]
    before: Array  # (M, j) measured minus planned angles [rad]; NaN: not read
    after: Array  # (M, j) what the figures do not explain [rad]

    __repr__ = short_repr

    def rms(self, errors: Array) -> float:
        """RMS of all errors (M, j) that were read [rad]."""
        return float(np.sqrt(np.nanmean(errors**2)))

    def to_dict(self) -> dict[str, Any]:
        """Plain dict of all figures for JSON."""
        return {
            "goals": self.goals,
            "unit": self.unit,
            "start": self.start,
            "start_found": None if self.found is None else dataclasses.asdict(self.found),
            "delays_are_relative": self.found is not None,
            "hung": self.hung,
            "rms_before_deg": float(np.degrees(self.rms(self.before))),
            "rms_after_deg": float(np.degrees(self.rms(self.after))),
            "joints": [joint.to_dict() for joint in self.joints],
            "without_log": list(self.without_log),
            "unknown": list(self.unknown),
        }


def compare_log(
    motion: Motion,
    log: JointLog,
    *,
    kind: GoalKind | None = None,
    unit: Unit | None = None,
    start: float | None = None,
    hung: bool = False,
) -> Comparison:
    """Compare what joints did with what they were told.

    Args:
        motion: the plan.
        log: what the joints did.
        kind: what they were told: "commanded" or "planned" angles; None: commanded if robot.yaml
            describes the servos, as `mgs play` does.
        unit: corrections that the goals had; None: none.
        start: when the motion began on the clock of the log [s]; None: it is found, and delays are
            then relative to the median joint.
        hung: the robot was hung up, its feet free.

    Raises:
        LogError: the log is too short, too coarse or ambiguous, or shows something else.
        ConfigError: the log has no joint of the robot.
    """
    names = motion.robot.joint_names
    read = dict(zip(log.names, np.isfinite(log.position).sum(axis=0).tolist(), strict=True))
    used = [name for name in names if read.get(name, 0) >= LEAST_SAMPLES]
    if not set(names) & set(log.names):
        raise ConfigError(
            log.source,
            f"has no joint of {motion.robot.spec.name}: it has {', '.join(log.names[:5])}; the "
            f"robot has {', '.join(names[:5])} and others",
        )
    if not used:
        refuse_poor(log.times, log.position)
    own = [names.index(name) for name in used]
    theirs = [log.names.index(name) for name in used]
    goals = goals_along(carried(motion, hung), None, kind, unit)
    told, y = goals.position[:, own], log.position[:, theirs]
    found = None
    if start is not None and not log.times[0] - motion.duration < start < log.times[-1]:
        raise LogError(
            f"the motion did not begin at {start:.10g} s: the clock of the log goes from "
            f"{log.times[0]:.10g} to {log.times[-1]:.10g} s"
        )
    if start is None and log.is_motion_time:
        start = 0.0
    if start is None:
        found = find_start(log.times, y, told, motion.dt)
        start = found.time
    times = log.times - start
    y = np.where(((times > -AROUND) & (times < motion.duration + AROUND))[:, None], y, np.nan)
    refuse_poor(log.times, y)
    if log.command is not None:
        _refuse_other_goals(times, log.command[:, theirs], goals, own)
    fits, curves = _fit_all(motion, times, y, told, own, hung)
    if found is not None:
        delays = [fit.delay for fit in fits if fit.delay is not None]
        middle = float(np.median(delays)) if delays else 0.0
        fits = [
            fit if fit.delay is None else dataclasses.replace(fit, delay=fit.delay - middle)
            for fit in fits
        ]
        times, start = times - middle, start + middle
    return _comparison(motion, log, goals, own, times, y, fits, curves, found, start, hung)


def unit_spec(comparison: Comparison, motion: Motion, name: str, source: str) -> UnitSpec:
    """Corrections of the physical robot that a log shows.

    Args:
        comparison: from `compare_log`.
        motion: the plan.
        name: of the physical robot.
        source: what the figures were measured from, in words.

    Raises:
        LogError: the goals had corrections already, or a figure is larger than such a file allows.
    """
    if comparison.unit is not None:
        raise LogError(
            f"the goals were corrected for {comparison.unit!r} already, so that the log shows what "
            "is left; log a motion that was played without --unit"
        )
    joints = {}
    for joint in comparison.joints:
        fit = joint.fit
        values = {"zero_offset": fit.zero_offset, "backlash": fit.backlash}
        for key, value in values.items():
            if abs(value) > LARGEST[key]:
                raise LogError(
                    f"joint {joint.name}: {key} would be {value:.2f} rad, at most "
                    f"{LARGEST[key]:g} rad are allowed; check the motors of robot.yaml"
                )
        joints[joint.name] = JointCorrection(
            zero_offset=round(fit.zero_offset, 6),
            sign=-1 if fit.sign < 0 else 1,
            backlash=round(fit.backlash, 6),
            stiffness=None if joint.stiffness is None else float(f"{joint.stiffness:.5g}"),
        )
    return UnitSpec(mgs=1, unit=name, robot=motion.robot.spec.name, source=source, joints=joints)


def _fit_all(
    motion: Motion, times: Array, y: Array, told: Array, own: list[int], hung: bool
) -> tuple[list[JointFit], list[Curves]]:
    """Fits of all joints; one that moves too little has the median delay of the others."""
    torque, load = loads(motion, hung)
    side = np.clip(torque / (SLACK * motion.robot.torque_limit), -1.0, 1.0)
    curves = [Curves(motion.dt, told[:, i], load[:, j], side[:, j]) for i, j in enumerate(own)]
    priors = _priors(motion)
    read = [np.isfinite(y[:, i]) for i in range(len(own))]
    fits = [
        fit_joint(times[r], y[r, i], curves[i], priors[j])
        for i, (j, r) in enumerate(zip(own, read, strict=True))
    ]
    delays = [fit.delay for fit in fits if fit.delay is not None]
    middle = float(np.median(delays)) if delays else 0.0
    for i, (j, r) in enumerate(zip(own, read, strict=True)):
        if fits[i].delay is None:
            again = fit_joint(times[r], y[r, i], curves[i], priors[j], middle)
            fits[i] = dataclasses.replace(again, delay=None)
    return fits, curves


def _priors(motion: Motion) -> list[Prior]:
    robot = motion.robot
    if not is_modelled(robot):
        return [Prior(0.0, float(SAG / limit)) for limit in robot.torque_limit]
    compliance = 1.0 / servos_of(robot).stiffness
    return [Prior(float(value), STIFFNESS * float(value)) for value in compliance]


def _refuse_other_goals(times: Array, command: Array, goals: Goals, own: list[int]) -> None:
    """Raise LogError if the log says that joints were told something else."""
    told = np.stack([np.interp(times, goals.times, goals.position[:, j]) for j in own], axis=1)
    apart = float(np.sqrt(np.nanmean((command - told) ** 2)))
    if apart > FAR:
        raise LogError(
            f"the joints were told something else: the goals in the log differ by "
            f"{np.degrees(apart):.1f} deg RMS from the {goals.kind} angles of this motion; give "
            "--goals and --unit as they were played"
        )


def _comparison(
    motion: Motion,
    log: JointLog,
    goals: Goals,
    own: list[int],
    times: Array,
    y: Array,
    fits: list[JointFit],
    curves: list[Curves],
    found: Start | None,
    start: float,
    hung: bool,
) -> Comparison:
    robot = motion.robot
    planned = motion.q[:, FLOATING_BASE_NQ:]
    stiffness = servos_of(robot).stiffness if is_modelled(robot) else None
    middle = 0.0 if found is not None else _median_delay(fits)
    before, after = np.full(y.shape, np.nan), np.full(y.shape, np.nan)
    joints = []
    for i, (j, fit) in enumerate(zip(own, fits, strict=True)):
        delay = middle if fit.delay is None else fit.delay
        own_times = np.clip(times - delay, 0.0, motion.duration)
        before[:, i] = y[:, i] - np.interp(own_times, motion.times, planned[:, j])
        command, load, side = curves[i].at(times - delay)
        law = fit.sign * command + fit.zero_offset - load * fit.compliance
        after[:, i] = y[:, i] - (law - 0.5 * fit.backlash * side)
        joints.append(
            JointComparison(
                name=robot.joint_names[j],
                fit=fit,
                described_stiffness=None if stiffness is None else float(stiffness[j]),
                rms_before=float(np.sqrt(np.nanmean(before[:, i] ** 2))),
                rms_after=float(np.sqrt(np.nanmean(after[:, i] ** 2))),
                bias=float(np.nanmean(before[:, i])),
            )
        )
    names = {robot.joint_names[j] for j in own}
    return Comparison(
        goals=goals.kind,
        unit=goals.unit,
        start=start,
        found=found,
        hung=hung,
        joints=tuple(joints),
        without_log=tuple(name for name in robot.joint_names if name not in names),
        unknown=tuple(name for name in log.names if name not in robot.joint_names),
        times=times,
        before=before,
        after=after,
    )


def _median_delay(fits: list[JointFit]) -> float:
    delays = [fit.delay for fit in fits if fit.delay is not None]
    return float(np.median(delays)) if delays else 0.0
