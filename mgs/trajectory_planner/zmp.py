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
from mgs.trajectory_planner.foot_roll import edge_ways, parts_of_longest, rolls_of


def plan_zmp(plan: WalkPlan) -> tuple[Array, Array, Array]:
    """ZMP reference (N, 2) [m], share (N,) of the weight on the left sole, centres of pressure.

    The centres of pressure (N, 2, 3) [m] of the soles are those between which the ZMP moves.
    """
    zmp, load_left = np.empty((plan.n_samples, 2)), np.empty(plan.n_samples)
    pressure = np.empty((plan.n_samples, 2, 3))
    rolls, travels = rolls_of(plan), _travels_of(plan)
    load = 0.5  # at rest each sole carries half of the weight
    for i, phase in enumerate(plan.phases):
        following = plan.phases[i + 1] if i + 1 < len(plan.phases) else None
        span, n = slice(phase.start, phase.end), phase.end - phase.start
        blend = quintic(np.arange(n) / n)
        target = _load_at_end(plan, phase, following, load)
        load_left[span] = load + (target - load) * blend
        for side in Side:
            place = _place_in_sole(plan, side, i, travels, blend)
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


def _travels_of(plan: WalkPlan) -> Array:
    """Places of the ZMP in the standing sole at the start and end of each of K phases (K, 2).

    Distances ahead of its place without travel [m]. Where soles roll, the ZMP goes as far towards
    heel and toe as the other sole is behind and ahead, in proportion to the longest step, like the
    pitch of the soles: in short steps it does not get near to the heel, over which a robot falls.
    """
    parts = parts_of_longest(plan) if plan.roll is not None else np.ones((len(plan.phases), 2))
    return plan.zmp_travel * parts * [-0.5, 0.5]


def _place_in_sole(plan: WalkPlan, side: Side, i: int, travels: Array, blend: Array) -> Array:
    """Place of the ZMP in phase `i` if one sole carried the whole weight: (2,), or (k, 2) [m].

    From the centre of the sole, in its axes.

    It travels from heel to toe in single support. In double support it stays where it was in a sole
    that has just carried the robot, is where it will be in one that is about to carry it, and in
    the middle of a sole at rest.
    """
    forward, inward = plan.zmp_offset
    place = np.array([forward, -side.sign * inward])
    if plan.zmp_travel:
        begin, end = _travelled(plan, side, i, travels)
        along = np.zeros((len(blend), 2))
        along[:, 0] = begin + (end - begin) * blend
        place = place + along
    return place


def _on_edge(place: Array, way: Array | None, length: float) -> Array:
    """Places (k, 2) in a sole of some length that go to its edges by ways (k,); see `edge_ways`."""
    if way is None:
        return place
    place = np.broadcast_to(place, (len(way), 2)).copy()
    place[:, 0] += np.abs(way) * (np.sign(way) * 0.5 * length - place[:, 0])
    return place


def _travelled(plan: WalkPlan, side: Side, i: int, travels: Array) -> tuple[float, float]:
    """Places of the ZMP in a sole at the start and at the end of phase `i` [m].

    At an end where the sole carries no weight the place has no effect; there the place of the other
    end is kept.
    """
    phases, single = plan.phases, Support.single(side)
    if phases[i].support is not Support.DOUBLE:
        return (travels[i, 0], travels[i, 1]) if phases[i].support is single else (0.0, 0.0)
    begin: float | None = 0.0
    if i > 0 and phases[i - 1].support is not Support.DOUBLE:
        begin = travels[i - 1, 1] if phases[i - 1].support is single else None
    end: float | None = 0.0
    if i + 1 < len(phases) and phases[i + 1].support is not Support.DOUBLE:
        end = travels[i + 1, 0] if phases[i + 1].support is single else None
    begin = begin if begin is not None else end or 0.0
    return begin, begin if end is None else end
