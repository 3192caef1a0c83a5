"""Two steps of a steady walk, made exactly periodic.

Between samples k and k + P, two steps apart, joints should not differ. What they do differ by, d in
position and e in velocity, is mostly motion that no task asks for; it is taken off along the cycle,
at s = j / P of it:

    q_cycle[j] = q[k + j] - d s - e P dt (s^2 - s) / 2

so that the cycle begins where the walk is at sample k, and ends as it begins. k is the sample with
the least difference, of all whose step is neither the first nor the last. The base is treated alike
(`mgs.motion.cycle_base`): after a cycle it is where it was, moved by the displacement.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Support
from mgs.core.errors import CycleError
from mgs.core.geometry import compose_planar, planar_inverse, planar_middle
from mgs.core.short_repr import short_repr
from mgs.core.spans import span_starts
from mgs.gait.remedies import remedies_for
from mgs.motion.cycle_base import Advance, made_periodic, periodic_base
from mgs.motion.motion import Motion

JOINT_TOLERANCE = 0.02  # [rad], about 1 mm at a sole
SPEED_TOLERANCE = 0.1  # [rad/s]
SPEED_TIME = 0.1  # [s] that weighs a difference of speed against one of position
STEADY = 1  # samples that strides in a row may differ by, which is what rounding does


@dataclass(frozen=True, eq=False)
class Cycle:
    """Two steps; the sample after the last one is the first one again, displaced."""

    start: int  # sample of the motion at which it begins
    position: Array  # (P, n) joint angles [rad]
    velocity: Array  # (P, n) central differences across the wrap [rad/s]
    base: Array  # (P, 7) pose of the base, seen from the middle of the soles at its beginning
    displacement: Array  # (3,) of the middle of the soles in its own frame: x, y [m], yaw [rad]
    rise: float  # of the middle of the soles [m], on stairs
    mismatch: float  # d, largest of a joint [rad]
    joint: str  # that it is of

    __repr__ = short_repr

    @property
    def n_samples(self) -> int:
        """Number of samples P of one period."""
        return len(self.position)


def find_cycle(motion: Motion, begins: Support | None = None) -> Cycle:
    """The two steps of a walk that differ least from those that follow.

    Args:
        motion: the walk.
        begins: single support with whose first sample the cycle begins, so that the cycles of
            several walks have the same phase; None: it begins where the difference is least.

    Raises:
        CycleError: there are too few steps, or they differ too much.
    """
    candidates = [
        (k, period)
        for start, end, period in _windows(motion)
        if begins is None or motion.support[start] == begins
        for k in range(start, end if begins is None else start + 1)
    ]
    if not candidates:
        raise CycleError(
            f"{motion.gait_name}: no two steps in its middle that could be repeated; that takes "
            "a walk of at least 5 equal steps"
        )
    k, period = min(candidates, key=lambda pair: _cost(motion, *pair))
    d, e = _differences(motion, k, period)
    worst, fastest = int(np.argmax(np.abs(d))), int(np.argmax(np.abs(e)))
    with remedies_for(motion.gait):
        _refuse(motion, worst, abs(float(d[worst])), "rad", JOINT_TOLERANCE)
        _refuse(motion, fastest, abs(float(e[fastest])), "rad/s", SPEED_TOLERANCE)
    joints = motion.q[k : k + period, FLOATING_BASE_NQ:]
    position = made_periodic(joints, d, e, motion.dt)
    ahead, behind = np.roll(position, -1, axis=0), np.roll(position, 1, axis=0)
    soles = motion.soles_ref[[k, k + period]]
    middle, heights = planar_middle(soles), soles[:, :, 2].mean(axis=1)
    displacement = compose_planar(planar_inverse(middle[0]), middle[1])
    rise = float(heights[1] - heights[0])
    start = np.array([*middle[0, :2], heights[0]]), float(middle[0, 2])
    return Cycle(
        start=k,
        position=position,
        velocity=(ahead - behind) / (2.0 * motion.dt),
        base=periodic_base(motion, slice(k, k + period), start, Advance(displacement, rise)),
        displacement=displacement,
        rise=rise,
        mismatch=abs(float(d[worst])),
        joint=motion.robot.joint_names[worst],
    )


def _windows(motion: Motion) -> list[tuple[int, int, int]]:
    """First sample, end and period of where a cycle may begin: steps between equal strides."""
    support = motion.support
    lifts = np.array(span_starts(support)[1:], dtype=np.intp)
    lifts = lifts[support[lifts] != Support.DOUBLE]
    strides, sides = lifts[2:] - lifts[:-2], support[lifts]
    return [
        (int(lifts[i]), int(lifts[i + 1]), int(strides[i]))
        for i in range(1, len(strides) - 1)
        if np.abs(strides[[i - 1, i + 1]] - strides[i]).max() <= STEADY
        and sides[i] == sides[i + 2] != sides[i + 1]
    ]


def _differences(motion: Motion, k: int, period: int) -> tuple[Array, Array]:
    """Joint angles and velocities (n,) at sample k + period less those at k."""
    q, v = motion.q[:, FLOATING_BASE_NQ:], motion.v[:, FLOATING_BASE_NV:]
    return q[k + period] - q[k], v[k + period] - v[k]


def _cost(motion: Motion, k: int, period: int) -> float:
    d, e = _differences(motion, k, period)
    return float(np.abs(d).max() + SPEED_TIME * np.abs(e).max())


def _refuse(motion: Motion, joint: int, size: float, unit: str, tolerance: float) -> None:
    if not size <= tolerance:
        raise CycleError(
            f"{motion.gait_name}: from one cycle to the next {motion.robot.joint_names[joint]} "
            f"differs by {size:.3g} {unit} at best, {tolerance:g} {unit} allowed"
        )
