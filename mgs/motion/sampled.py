"""A motion, or a cycle of one, at the rate that somebody else's program wants.

At the planned rate positions and velocities are those of the motion. At any other rate that is
asked for they are those of one curve: the cubic spline through the planned samples that is at rest
at both ends (`mgs.core.spline`), in the position of the base, its quaternion p, and the joints. The
orientation is p / |p|, and its angular velocity in the frame of the base follows from the same
curve:

    (w, 0) = 2 conj(p) dp/dt / |p|^2        without the scalar part, which is |p|'s own change

so that the velocities are the derivatives of the positions, and are zero at the first and the last
frame. Both ends of the motion are kept: the last frame is the first one at or after the end, where
the robot stands still. A cycle takes a whole number of frames.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.errors import ConfigError
from mgs.core.geometry import quat_conjugate, quat_multiply, rotate, rotvec_from_quat_xyzw
from mgs.core.limits import MAX_RATE, MAX_SAMPLES
from mgs.core.short_repr import short_repr
from mgs.core.spline import evaluate, spline_at_rest
from mgs.motion.cycle import Cycle
from mgs.motion.cycle_base import Advance
from mgs.motion.dynamics import align_quaternion_signs
from mgs.motion.motion import Motion
from mgs.robot import Robot

SAME = 1e-6  # of a frame: times that are equal but for rounding


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """Frames of a motion at equal intervals; world frame, SI units, first axis time.

    A cycle is seen from the middle of the soles at its beginning, and the frame after its last one
    is its first one again, moved by the displacement; unless it is closed, which means that this
    frame is in it.
    """

    motion: Motion  # what it is of
    cycle: Cycle | None  # of the motion, if it is not of all of it
    closed: bool  # True if the last frame of a cycle is its first one again
    fps: float  # frames per second [Hz]
    interval: float  # between two frames [s]
    times: Array  # (T,) of the frames [s]
    q: Array  # (T, 7 + n) base position, base quaternion xyzw, joint angles
    v: Array  # (T, 6 + n) base twist in the base frame, joint velocities
    joint_acceleration: Array  # (T, n) [rad/s^2]
    support: NDArray[np.int8]  # (T,) values of Support
    plan: SampledMotion | None = None  # what it was before its joints became commands

    __repr__ = short_repr

    @property
    def robot(self) -> Robot:
        """The robot that moves."""
        return self.motion.robot

    @property
    def n_frames(self) -> int:
        """Number of frames T."""
        return len(self.q)

    @property
    def joints(self) -> Array:
        """Joint angles (T, n) [rad]."""
        return self.q[:, FLOATING_BASE_NQ:]

    @property
    def joint_velocity(self) -> Array:
        """Joint velocities (T, n) [rad/s]."""
        return self.v[:, FLOATING_BASE_NV:]

    @property
    def base_position(self) -> Array:
        """Positions (T, 3) of the origin of the root link [m]."""
        return self.q[:, :3]

    @property
    def base_quat_xyzw(self) -> Array:
        """Orientations (T, 4) of the root link, neighbours in one half space."""
        return self.q[:, 3:FLOATING_BASE_NQ]

    @property
    def base_linear_velocity(self) -> Array:
        """Velocities (T, 3) of the origin of the root link, in the world [m/s]."""
        return rotate(self.base_quat_xyzw, self.v[:, :3])

    @property
    def base_angular_velocity(self) -> Array:
        """Angular velocities (T, 3) of the root link, in the world [rad/s]."""
        return rotate(self.base_quat_xyzw, self.v[:, 3:FLOATING_BASE_NV])


def sample(
    motion: Motion,
    fps: float | None = None,
    cycle: Cycle | None = None,
    *,
    closed: bool = False,
    nearest: bool = False,
) -> SampledMotion:
    """Frames of a motion.

    Args:
        motion: what to sample.
        fps: frames per second [Hz]; None: the planned samples as they are.
        cycle: of this motion; None: all of it.
        closed: end a cycle with its first frame, moved by the displacement.
        nearest: a cycle takes the nearest rate at which it is a whole number of frames; False: a
            rate at which it is none is refused.

    Raises:
        ConfigError: the rate is out of range, or does not fit the cycle.
    """
    if fps is None:
        q, v, acceleration = _planned(motion, cycle)
        rate, interval, at = 1.0 / motion.dt, motion.dt, np.arange(len(q))
    else:
        rate, times = _frame_times(motion, cycle, fps, nearest)
        q, v, acceleration = _resampled(motion, cycle, times)
        interval, at = 1.0 / rate, np.floor(times / motion.dt + SAME).astype(np.intp)
    start, n = (0, motion.n_samples) if cycle is None else (cycle.start, cycle.n_samples)
    support = motion.support[start + np.minimum(at, n - 1)]
    if closed and cycle is not None:
        again = Advance(cycle.displacement, cycle.rise).moved(q[:1, :FLOATING_BASE_NQ], 1)
        q = np.vstack([q, np.hstack([again, q[:1, FLOATING_BASE_NQ:]])])
        v, acceleration = np.vstack([v, v[:1]]), np.vstack([acceleration, acceleration[:1]])
        support = np.append(support, support[:1])
        align_quaternion_signs(q[:, 3:FLOATING_BASE_NQ])
    return SampledMotion(
        motion=motion,
        cycle=cycle,
        closed=closed and cycle is not None,
        fps=rate,
        interval=interval,
        times=interval * np.arange(len(q), dtype=np.float64),
        q=q,
        v=v,
        joint_acceleration=acceleration,
        support=support,
    )


def _frame_times(
    motion: Motion, cycle: Cycle | None, fps: float, nearest: bool
) -> tuple[float, Array]:
    """Rate [Hz] and times (T,) of the frames [s]."""
    if not (math.isfinite(fps) and 0.0 < fps <= MAX_RATE):
        raise ConfigError("fps", f"{fps:g} Hz is out of range; use more than 0 and <= {MAX_RATE}")
    duration = motion.duration if cycle is None else cycle.n_samples * motion.dt
    n = duration * fps
    if n > MAX_SAMPLES:
        raise ConfigError("fps", f"{fps:g} Hz makes {n:.0f} frames; at most {MAX_SAMPLES} allowed")
    if cycle is None:
        return fps, np.arange(math.ceil(n - SAME) + 1) / fps
    whole = max(1, round(n))
    if abs(n - whole) > SAME and not nearest:
        raise ConfigError(
            "fps",
            f"a cycle of {duration:g} s is {n:.3f} frames at {fps:g} Hz, not a whole number; use "
            f"{whole / duration:.10g}",
        )
    rate = fps if abs(n - whole) <= SAME else whole / duration
    return rate, np.arange(whole) / rate


def _planned(motion: Motion, cycle: Cycle | None) -> tuple[Array, Array, Array]:
    """Positions, velocities and joint accelerations at the planned samples."""
    dt = motion.dt
    if cycle is None:
        joints = motion.q[:, FLOATING_BASE_NQ:]
        steps = np.diff(joints, axis=0, prepend=joints[:1], append=joints[-1:]) / dt
        return motion.q, motion.v, np.diff(steps, axis=0) / dt
    around = _three_cycles(motion, cycle)
    n = cycle.n_samples
    before, here, after = (around[n + j : 2 * n + j] for j in (-1, 0, 1))
    linear = rotate(quat_conjugate(here[:, 3:7]), after[:, :3] - before[:, :3])
    turn = rotvec_from_quat_xyzw(quat_multiply(quat_conjugate(before[:, 3:7]), after[:, 3:7]))
    twist = np.hstack([linear, turn]) / (2.0 * dt)
    second = (after - 2.0 * here + before)[:, FLOATING_BASE_NQ:] / dt**2
    return here, np.hstack([twist, cycle.velocity]), second


def _three_cycles(motion: Motion, cycle: Cycle) -> Array:
    """Positions (3 P, 7 + n) from a cycle before its beginning to a cycle after its end."""
    advance = Advance(cycle.displacement, cycle.rise)
    bases = np.vstack([advance.moved(cycle.base, times) for times in (-1, 0, 1)])
    align_quaternion_signs(bases[:, 3:])
    return np.hstack([bases, np.tile(cycle.position, (3, 1))])


def _resampled(motion: Motion, cycle: Cycle | None, times: Array) -> tuple[Array, Array, Array]:
    """Positions, velocities and joint accelerations on the spline, at times (T,) [s].

    A cycle lies between two more of them, at whose far ends the spline is at rest: each sample on
    the way takes off all but 27 % of what that changes, so that nothing of it arrives.
    """
    if cycle is None:
        values, offset = motion.q, 0.0
    else:
        values, offset = _three_cycles(motion, cycle), cycle.n_samples * motion.dt
    q, rate, second = evaluate(spline_at_rest(values, motion.dt), times + offset)
    p = q[:, 3:FLOATING_BASE_NQ].copy()
    size = np.linalg.norm(p, axis=1, keepdims=True)
    q[:, 3:FLOATING_BASE_NQ] = p / size
    v = np.empty((len(q), q.shape[1] - 1))
    v[:, :3] = rotate(quat_conjugate(p / size), rate[:, :3])
    turn = quat_multiply(quat_conjugate(p), rate[:, 3:FLOATING_BASE_NQ])
    v[:, 3:FLOATING_BASE_NV] = 2.0 * turn[:, :3] / size**2
    v[:, FLOATING_BASE_NV:] = rate[:, FLOATING_BASE_NQ:]
    return q, v, second[:, FLOATING_BASE_NQ:]
