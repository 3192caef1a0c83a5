"""The base along a cycle, made periodic up to the displacement of the cycle.

After a cycle the base should be where it was at its beginning, moved by the displacement D. What it
differs by, in position d and velocity e, is taken off along the cycle as it is of the joints; of
its orientation, the rotation vector of the difference, in the frame of the base.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.geometry import (
    quat_conjugate,
    quat_multiply,
    quat_xyzw_from_rotvec,
    quat_xyzw_from_yaw,
    rotate,
    rotvec_from_quat_xyzw,
)
from mgs.core.short_repr import short_repr
from mgs.motion.motion import Motion


@dataclass(frozen=True, eq=False)
class Advance:
    """How far a robot comes in a cycle, seen from the middle of its soles at the beginning."""

    displacement: Array  # (3,) x, y [m], yaw [rad]
    rise: float  # [m]

    __repr__ = short_repr

    def moved(self, poses: Array, times: int) -> Array:
        """Poses (N, 7), seen from that middle, as they are some cycles later (or before)."""
        yaw = self.displacement[2]
        step = np.array([*self.displacement[:2], self.rise])
        out = poses.copy()
        for _ in range(abs(times)):
            if times > 0:
                out[:, :3] = rotate(quat_xyzw_from_yaw(yaw), out[:, :3]) + step
            else:
                out[:, :3] = rotate(quat_xyzw_from_yaw(-yaw), out[:, :3] - step)
        out[:, 3:] = quat_multiply(quat_xyzw_from_yaw(times * yaw), out[:, 3:])
        return out


def made_periodic(values: Array, d: Array, e: Array, dt: float) -> Array:
    """Values (P, n) along a cycle, less what makes its end differ from its beginning.

    Args:
        values: at the P samples of the cycle.
        d: by how much its end differs from its beginning (n,).
        e: by how much the rates there differ (n,) [1/s].
        dt: sampling period [s].
    """
    period = len(values)
    s = (np.arange(period) / period)[:, None]
    return np.asarray(values - d * s - e * (0.5 * period * dt) * (s**2 - s))


def periodic_base(
    motion: Motion, samples: slice, start: tuple[Array, float], advance: Advance
) -> Array:
    """Poses (P, 7) of the base along a cycle, seen from the middle of the soles at its beginning.

    Args:
        motion: what the cycle is of.
        samples: its samples k to k + P.
        start: position (3,) and heading of that middle in the world.
        advance: how far it comes.
    """
    position, yaw = start
    k, end = samples.start, samples.stop
    back = quat_xyzw_from_yaw(-yaw)
    q, v = motion.q[k : end + 1, :7], motion.v[[k, end]]
    base = np.hstack([rotate(back, q[:, :3] - position), quat_multiply(back, q[:, 3:])])
    linear = rotate(base[[0, -1], 3:], v[:, :3])
    target = advance.moved(base[:1], 1)[0]
    turned = rotate(quat_xyzw_from_yaw(advance.displacement[2]), linear[0])
    turn = rotvec_from_quat_xyzw(quat_multiply(quat_conjugate(target[3:]), base[-1, 3:]))
    still = np.zeros((end - k, 3))
    turn_off = made_periodic(still, turn, v[1, 3:6] - v[0, 3:6], motion.dt)
    out = base[:-1].copy()
    out[:, :3] = made_periodic(out[:, :3], base[-1, :3] - target[:3], linear[1] - turned, motion.dt)
    out[:, 3:] = quat_multiply(out[:, 3:], quat_xyzw_from_rotvec(turn_off))
    return out
