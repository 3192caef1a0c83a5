"""ZMP reference of a walk, and the share of the weight on each sole.

The ZMP rests at one place inside the support sole, or travels there from heel to toe, and moves to
the next sole by a minimum-jerk blend while both soles are down.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.geometry import quintic, rotate_planar
from mgs.motion_planner import Phase, WalkPlan
from mgs.trajectory_planner.foot_roll import edge_ways, rolls_of


def plan_zmp(plan: WalkPlan) -> tuple[Array, Array, Array]:
    """ZMP reference (N, 2) [m], share (N,) of the weight on the left sole, centres of pressure.

    The centres of pressure (N, 2, 3) [m] of the soles are those between which the ZMP moves.
    """
    zmp, load_left = np.empty((plan.n_samples, 2)), np.empty(plan.n_samples)
    pressure = np.empty((plan.n_samples, 2, 3))
    rolls = rolls_of(plan)
    load = 0.5  # at rest each sole carries half of the weight
    earlier, later = [None, *plan.phases[:-1]], [*plan.phases[1:], None]
    for i, (phase, before, following) in enumerate(zip(plan.phases, earlier, later, strict=True)):
        span, n = slice(phase.start, phase.end), phase.end - phase.start
        blend = quintic(np.arange(n) / n)
        target = _load_at_end(plan, phase, following, load)
        load_left[span] = load + (target - load) * blend
        for side in Side:
            place = _place_in_sole(plan, side, phase, before, following, blend)
            if plan.roll is not None and phase.support is Support.DOUBLE:
                place = _on_edge(
                    place, edge_ways(plan, rolls, side, i), plan.roll.sole_lengths[side]
                )
            footstep = plan.footsteps[phase.feet[side]]
            turned = rotate_planar(place, footstep.yaw)
            pressure[span, side, :2] = np.array([footstep.x, footstep.y]) + turned
            pressure[span, side, 2] = footstep.z
        left, right = pressure[span, Side.LEFT, :2], pressure[span, Side.RIGHT, :2]
        zmp[span] = right + load_left[span, None] * (left - right)
        load = target
    return zmp, load_left, pressure


def _load_at_end(plan: WalkPlan, phase: Phase, following: Phase | None, load: float) -> float:
    """Share of the weight on the left sole at the end of a phase."""
    if phase.support is not Support.DOUBLE or phase is plan.phases[0]:
        return load
    if following is None or following.support is Support.DOUBLE:
        return 0.5  # the last weight shift leads to the middle, where the lead-out rests
    return 1.0 if following.support is Support.LEFT else 0.0


def _place_in_sole(
    plan: WalkPlan,
    side: Side,
    phase: Phase,
    before: Phase | None,
    following: Phase | None,
    blend: Array,
) -> Array:
    """Place of the ZMP if one sole carried the whole weight: (2,), or (k, 2) with travel [m].

    From the centre of the sole, in its axes.

    It travels from heel to toe in single support. In double support it stays at the toe of a sole
    that has just carried the robot, at the heel of one that is about to carry it, and in the middle
    of a sole at rest.
    """
    forward, inward = plan.zmp_offset
    place = np.array([forward, -side.sign * inward])
    if plan.zmp_travel:
        begin, end = _travelled(side, phase, before, following)
        along = np.zeros((len(blend), 2))
        along[:, 0] = begin + (end - begin) * blend
        place = place + plan.zmp_travel * along
    return place


def _on_edge(place: Array, way: Array | None, length: float) -> Array:
    """Places (k, 2) in a sole of some length that go to its edges by ways (k,); see `edge_ways`."""
    if way is None:
        return place
    place = np.broadcast_to(place, (len(way), 2)).copy()
    place[:, 0] += np.abs(way) * (np.sign(way) * 0.5 * length - place[:, 0])
    return place


def _travelled(
    side: Side, phase: Phase, before: Phase | None, following: Phase | None
) -> tuple[float, float]:
    """Places of the ZMP in a sole at the start and at the end of a phase.

    The unit is the travel: -1/2 is the heel and 1/2 the toe. At an end where the sole carries no
    weight the place has no effect; there the place of the other end is kept.
    """
    heel, toe, single = -0.5, 0.5, Support.single(side)
    if phase.support is not Support.DOUBLE:
        return (heel, toe) if phase.support is single else (0.0, 0.0)
    begin: float | None = 0.0
    if before is not None and before.support is not Support.DOUBLE:
        begin = toe if before.support is single else None
    end: float | None = 0.0
    if following is not None and following.support is not Support.DOUBLE:
        end = heel if following.support is single else None
    begin = begin if begin is not None else end or 0.0
    return begin, begin if end is None else end
