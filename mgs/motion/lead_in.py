"""A way to the first frame of a motion, since a robot rarely stands in it when playback begins.

All joints move in step with minimum jerk from a posture at rest to the first frame. The base is
where it is if the left sole stands still; nothing is planned about balance.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError
from mgs.core.geometry import quintic
from mgs.motion.dynamics import align_quaternion_signs, differentiate, place_on_soles
from mgs.motion.sampled import SampledMotion

PEAK_SPEED = 1.875  # of a motion with minimum jerk, relative to its mean


def with_lead_in(
    sampled: SampledMotion, seconds: float, start: Array, commands: Array | None = None
) -> SampledMotion:
    """The frames, and before them those of the way to the first one.

    Args:
        sampled: frames of a whole motion.
        seconds: duration of the way [s]; it takes the next whole number of frames.
        start: joint angles (n,) at its beginning [rad].
        commands: joint angles (n,) that servos are told there, if the frames are commands [rad];
            None: `start`.

    Raises:
        ConfigError: the frames are a cycle, or a joint would have to move too fast.
    """
    if sampled.cycle is not None:
        raise ConfigError("lead_in", "a cycle has no beginning; leave out either of the two")
    plan = sampled.plan or sampled
    _refuse_speed(plan, seconds, start)
    n = max(1, math.ceil(seconds / sampled.interval - 1e-9))
    ahead = _way(plan, n, start)
    if sampled.plan is None:
        return ahead
    own = _way(sampled, n, start if commands is None else commands)
    base_q, base_v = ahead.q[:n, :FLOATING_BASE_NQ], ahead.v[:n, :FLOATING_BASE_NV]
    own.q[:n, :FLOATING_BASE_NQ], own.v[:n, :FLOATING_BASE_NV] = base_q, base_v
    return dataclasses.replace(own, plan=ahead)


def _refuse_speed(plan: SampledMotion, seconds: float, start: Array) -> None:
    robot = plan.robot
    least = PEAK_SPEED * np.abs(plan.joints[0] - start) / robot.speed_limit
    slowest = int(np.argmax(least))
    if least[slowest] > seconds:
        raise ConfigError(
            "lead_in",
            f"{seconds:g} s is too short: {robot.joint_names[slowest]} would exceed "
            f"{robot.speed_limit[slowest]:g} rad/s; use at least {least[slowest]:.2f} s",
        )


def _way(sampled: SampledMotion, n: int, start: Array) -> SampledMotion:
    """The frames with n more before them, whose joints begin at `start` (n,)."""
    robot, motion, dt = sampled.robot, sampled.motion, sampled.interval
    s = (np.arange(n) / n)[:, None]
    step = sampled.joints[0] - start
    joints = start + quintic(s) * step
    rates = 30.0 * (s * (1.0 - s)) ** 2 * step / (n * dt)
    second = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) * step / (n * dt) ** 2
    left = np.full(n, Side.LEFT, np.int8)
    soles = np.tile(motion.soles_ref[0], (n, 1, 1))
    q = np.vstack([place_on_soles(robot, joints, left, soles), sampled.q])
    align_quaternion_signs(q[:, 3:FLOATING_BASE_NQ])
    base = differentiate(robot, q[: n + 1], dt)[0][:n, :FLOATING_BASE_NV]
    v = np.vstack([np.hstack([base, rates]), sampled.v])
    return dataclasses.replace(
        sampled,
        times=dt * np.arange(len(q), dtype=np.float64),
        q=q,
        v=v,
        joint_acceleration=np.vstack([second, sampled.joint_acceleration]),
        support=np.concatenate([np.full(n, Support.DOUBLE, np.int8), sampled.support]),
    )
