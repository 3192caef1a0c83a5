"""Refinement: correction of a motion by the deviations from the plan that its replays show.

This is iterative learning over the motion. The deviation of the CoM from its plan, relative to the
support soles, is averaged over the engines and smoothed, and a part of it is subtracted from the
CoM reference; inverse kinematics gives the next motion. Only slow deviations are used (`SMOOTH`):
deviations faster than the oscillation of the robot on its servos would be amplified instead of
corrected, because a tipping robot is first pushed in the wrong direction.

A motion is kept only if its verdict is better in every engine: the robot stays up longer, fails
fewer checks, or tilts less with the same failed checks. Otherwise the part is halved.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.ndimage import gaussian_filter1d

from mgs.com_generator import ComTrajectory, rest_window
from mgs.core.arrays import Array
from mgs.core.errors import ConfigError, InfeasibleGaitError
from mgs.core.progress import Progress
from mgs.gait import SequenceGait
from mgs.ik_solver import solve_ik
from mgs.judge.motion_checks import check_motion
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.motion.provenance import Corrections
from mgs.pipeline import Stages, assemble, run_stages
from mgs.sim import EngineName, Replay, ServoName, replay
from mgs.sim.measure import Touchdowns, touchdowns

SMOOTH = 0.2  # [s] standard deviation of the smoothing window
BEFORE_FALL = 0.5  # [s] time before a fall whose deviations are ignored
LEAST_PART = 0.05  # least part of the deviation that is tried
LEAST_LOAD = 0.2  # least load on the soles for a defined ZMP, as part of the weight


@dataclass(frozen=True, eq=False)
class Trial:
    """Results of one motion in one engine; smaller values are better."""

    engine: EngineName
    fall_time: float | None  # time of the fall [s]; None if the robot stays up
    failed: tuple[str, ...]  # names of the failed checks of the replay
    tilt_rms_deg: float  # tilt of the torso relative to the plan, RMS [deg]
    com_rms: float  # deviation of the CoM from the plan, RMS [m]
    zmp_rms: float  # deviation of the ZMP from the plan, smoothed, RMS [m]
    touchdown: Touchdowns

    @property
    def score(self) -> tuple[float, int, float]:
        """Score for comparison: time of the fall, number of failed checks, tilt."""
        standing = np.inf if self.fall_time is None else self.fall_time
        return -standing, len(self.failed), self.tilt_rms_deg

    def to_dict(self) -> dict[str, object]:
        """Convert to plain data."""
        return {**dataclasses.asdict(self), "failed": list(self.failed)}


@dataclass(frozen=True, eq=False)
class Attempt:
    """One correction: its part of the deviation, its trials, and whether it was kept."""

    part: float
    trials: tuple[Trial, ...]
    kept: bool
    reason: str  # reason of the rejection

    def to_dict(self) -> dict[str, object]:
        """Convert to plain data."""
        trials = [trial.to_dict() for trial in self.trials]
        return {"part": self.part, "kept": self.kept, "reason": self.reason, "trials": trials}


@dataclass(frozen=True, eq=False)
class Refinement:
    """Best motion, trials of the first motion, and all attempts."""

    motion: Motion
    before: tuple[Trial, ...]
    attempts: tuple[Attempt, ...]

    @property
    def improved(self) -> bool:
        """True if a correction was kept."""
        return any(attempt.kept for attempt in self.attempts)

    @property
    def after(self) -> tuple[Trial, ...]:
        """Trials of the best motion."""
        return next((a.trials for a in reversed(self.attempts) if a.kept), self.before)


def refine(
    motion: Motion,
    engines: tuple[EngineName, ...],
    *,
    servo: ServoName = "model",
    feed_forward: bool | None = None,
    attempts: int = 6,
    part: float = 0.4,
    progress: Progress | None = None,
) -> Refinement:
    """Correct the CoM reference of a motion by its replays, as long as the verdicts improve.

    Args:
        motion: motion of the pipeline; it may have been refined before.
        engines: engines whose verdicts are used.
        servo: "model" or "ideal".
        feed_forward: see `mgs.sim.replay`.
        attempts: largest number of corrections.
        part: part of the deviation that the first correction removes.
        progress: function that is called with the number of finished and of possible replays.

    Raises:
        ConfigError: the motion is a sequence, or was changed by `mgs optimize`.
        SimulationError: an engine is missing, or a simulation diverged.
        InfeasibleGaitError: the gait of the motion can no longer be generated.
    """
    if isinstance(motion.gait, SequenceGait):
        raise ConfigError(
            motion.gait_name, "a sequence cannot be refined as a whole; refine its parts one by one"
        )
    if motion.provenance.optimised is not None:
        raise ConfigError(
            motion.gait_name,
            "mgs optimize changed this motion, and a refinement, which solves the inverse "
            "kinematics anew, would undo that; refine first, and optimize the result",
        )
    stages = run_stages(motion.robot, motion.gait, motion.gait_name)
    com = _shifted(stages.com, motion.com_ref - stages.com.position, motion.dt)
    done, most = 0, (1 + attempts) * len(engines)

    def judge(candidate: Motion) -> tuple[tuple[Trial, ...], Array]:
        nonlocal done
        trials, deviations = [], []
        for engine in engines:
            result = replay(candidate, engine, servo=servo, feed_forward=feed_forward)
            trial, deviation = _trial(candidate, stages.tasks.load_left, result)
            trials.append(trial)
            deviations.append(deviation)
            done += 1
            if progress is not None:
                progress(done, most)
        return tuple(trials), np.asarray(np.mean(deviations, axis=0))

    before, deviation = judge(motion)
    best, trials = motion, before
    n_static = _n_failed(motion)
    tried: list[Attempt] = []
    while len(tried) < attempts and part >= LEAST_PART:
        correction = -part * rest_window(stages.tasks.zmp_ref)[:, None] * deviation
        try:
            next_com = _shifted(com, np.pad(correction, ((0, 0), (0, 1))), motion.dt)
            candidate = _motion_of(stages, next_com)
        except InfeasibleGaitError as error:
            tried.append(Attempt(part, (), False, str(error)))
            part *= 0.5
            continue
        now, next_deviation = judge(candidate)
        reason = _why_not(trials, now)
        if not reason and _n_failed(candidate) > n_static:
            reason = "fails more static checks"
        tried.append(Attempt(part, now, not reason, reason))
        if reason:
            part *= 0.5
            continue
        best, trials, com, deviation = candidate, now, next_com, next_deviation
    if parts := [attempt.part for attempt in tried if attempt.kept]:
        refined = Corrections(tuple(parts), tuple(engines))
        best = dataclasses.replace(
            best, provenance=dataclasses.replace(best.provenance, refined=refined)
        )
    return Refinement(best, before, tuple(tried))


def _motion_of(stages: Stages, com: ComTrajectory) -> Motion:
    motion = stages.motion
    joints = solve_ik(motion.robot, stages.tasks, com, stages.gait.ik)
    name = motion.gait_name
    return assemble(motion.robot, stages.gait, name, stages.plan, stages.tasks, com, joints)


def _shifted(com: ComTrajectory, shift: Array, dt: float) -> ComTrajectory:
    """CoM motion displaced by shift (N, 3) [m], whose derivatives are central differences."""
    velocity = np.gradient(shift, dt, axis=0)
    return dataclasses.replace(
        com,
        position=com.position + shift,
        velocity=com.velocity + velocity,
        acceleration=com.acceleration + np.gradient(velocity, dt, axis=0),
    )


def _trial(motion: Motion, load_left: Array, result: Replay) -> tuple[Trial, Array]:
    """Results of one replay, and the smoothed deviation (N, 2) of the CoM [m]."""
    trace, dt, n = result.trace, motion.dt, motion.n_samples
    end = min(n, len(trace.t))
    if result.fall_time is not None:
        end = min(end, max(1, round((result.fall_time - BEFORE_FALL) / dt)))
    span, window = slice(0, end), SMOOTH / dt
    share = np.stack([load_left[span], 1.0 - load_left[span]], axis=1)[..., None]

    def place(soles: Array) -> Array:
        return np.asarray(np.sum(share * soles[span, :, :2], axis=1))

    model, data = motion.robot.model, motion.robot.model.createData()
    com = np.array([pin.centerOfMass(model, data, q)[:2].copy() for q in trace.q[span]])
    off = (com - place(trace.soles)) - (motion.com[span, :2] - place(motion.soles))
    off -= off[0]  # the deviation at rest belongs to the posture, not to the motion
    deviation = np.zeros((n, 2))
    deviation[span] = off
    load = trace.contacts[span, :, 2].sum(axis=1)
    carried = load > LEAST_LOAD * load.mean()
    zmp = np.zeros((end, 2))
    zmp[carried] = trace.contacts[span][carried, :, 3:].sum(axis=1) / load[carried, None]
    zmp[carried] -= motion.zmp[span][carried]
    trial = Trial(
        engine=result.engine,
        fall_time=result.fall_time,
        failed=tuple(check.name for check in replay_checks(result) if not check.ok),
        tilt_rms_deg=float(np.degrees(np.sqrt(np.mean(np.square(trace.tilt))))),
        com_rms=_rms(off),
        zmp_rms=_rms(gaussian_filter1d(zmp, window, axis=0, mode="nearest")),
        touchdown=touchdowns(trace.contacts[span], motion.support[span], dt),
    )
    return trial, np.asarray(gaussian_filter1d(deviation, window, axis=0, mode="nearest"))


def _why_not(old: tuple[Trial, ...], new: tuple[Trial, ...]) -> str:
    """Reason for a rejection; empty if the verdicts of all engines are better."""
    worse = [b.engine for a, b in zip(old, new, strict=True) if not b.score < a.score]
    return f"no better in {' and '.join(worse)}" if worse else ""


def _n_failed(motion: Motion) -> int:
    return sum(not check.ok for check in check_motion(motion))


def _rms(x: Array) -> float:
    """Root mean square of the lengths of vectors (N, 2)."""
    return float(np.sqrt(np.mean(np.sum(np.square(x), axis=1))))
