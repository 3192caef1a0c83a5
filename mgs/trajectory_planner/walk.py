"""Trajectories of a walk or a kick: soles, hands, torso, ZMP and CoM height.

The ZMP rests at one place inside the support sole and moves to the next sole by a minimum-jerk
blend while both soles are down. A swing sole follows the same blend along the ground and a bump of
step_height above it, so that it lifts off and lands without speed or acceleration. With a landing
it arrives above its footstep earlier and comes straight down at the end, by a third of step_height
per single support: a sole that meets the ground too early then neither scuffs nor hits it fast.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.curves import evaluate
from mgs.core.geometry import bump, quat_multiply, quat_xyzw_from_yaw, quintic, rotate_planar
from mgs.motion_planner import Phase, WalkPlan
from mgs.trajectory_planner.com_height import height_within_reach
from mgs.trajectory_planner.task_trajectory import TaskTrajectory

LANDING_SPEED = 1.0 / 3.0  # mean speed of a landing, in step heights per single support


def plan_walk_trajectories(plan: WalkPlan) -> TaskTrajectory:
    """Trajectories of a walk, of stairs or of a kick."""
    n = plan.n_samples
    support, root = np.empty(n, np.int8), np.empty(n, np.int8)
    planar, height = np.empty((n, 2, 3)), np.zeros((n, 2))
    zmp, load_left = np.empty((n, 2)), np.empty(n)
    poses = [np.array([f.x, f.y, f.yaw]) for f in plan.footsteps]
    heights = np.array([f.z for f in plan.footsteps])
    load = 0.5  # at rest each sole carries half of the weight
    for phase, before, following, side in zip(
        plan.phases,
        [None, *plan.phases[:-1]],
        [*plan.phases[1:], None],
        _roots(plan.phases),
        strict=True,
    ):
        span = slice(phase.start, phase.end)
        blend = quintic(np.arange(phase.end - phase.start) / (phase.end - phase.start))
        support[span] = phase.support
        root[span] = side
        planar[span] = np.stack([poses[foot] for foot in phase.feet])
        height[span] = heights[list(phase.feet)]
        if phase.target is not None:
            _swing(plan, phase, poses, planar, height)
        target = _load_at_end(plan, phase, following, load)
        load_left[span] = load + (target - load) * blend
        left, right = (_zmp_way(plan, side, phase, before, following, blend) for side in Side)
        zmp[span] = right + load_left[span, None] * (left - right)
        load = target
    com_height = plan.com_height + _level(plan, heights)
    if plan.reach is not None:
        com_height = height_within_reach(
            com_height,
            zmp,
            np.concatenate([planar, height[..., None]], axis=-1),
            planar[..., 2].mean(axis=1),
            plan.reach,
            plan.dt,
        )
    return TaskTrajectory(
        dt=plan.dt,
        support=support,
        root=root,
        zmp_ref=zmp,
        load_left=load_left,
        soles=_sole_poses(planar, height),
        hands=_hands(plan, planar),
        com_height=com_height,
        torso=_torso(plan, planar),
    )


def _zmp_way(
    plan: WalkPlan,
    side: Side,
    phase: Phase,
    before: Phase | None,
    following: Phase | None,
    blend: Array,
) -> Array:
    """Place of the ZMP if one sole carried the whole weight: (2,), or (k, 2) with travel [m].

    It travels from heel to toe in single support. In double support it stays at the toe of a sole
    that has just carried the robot, at the heel of one that is about to carry it, and in the middle
    of a sole at rest.
    """
    footstep, (forward, inward) = plan.footsteps[phase.feet[side]], plan.zmp_offset
    place = np.array([forward, -side.sign * inward])
    if plan.zmp_travel:
        begin, end = _travelled(side, phase, before, following)
        along = np.zeros((len(blend), 2))
        along[:, 0] = begin + (end - begin) * blend
        place = place + plan.zmp_travel * along
    return np.array([footstep.x, footstep.y]) + rotate_planar(place, footstep.yaw)


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


def _level(plan: WalkPlan, heights: Array) -> Array:
    """Height (N,) of the ground below the CoM [m]: blends between mean heights of the soles."""
    level, now = np.empty(plan.n_samples), float(heights[:2].mean())
    start = 0
    for phase in plan.phases:
        if phase.target is None:
            continue
        begin = phase.start if start == 0 else start  # before the first step nothing changes
        following = float(heights[[phase.target, phase.feet[phase.support - 1]]].mean())
        level[start:begin] = now
        span = np.arange(phase.end - begin) / (phase.end - begin)
        level[begin : phase.end] = now + (following - now) * quintic(span)
        start, now = phase.end, following
    level[start:] = now
    return level


def _roots(phases: tuple[Phase, ...]) -> list[Side]:
    """Sole that inverse kinematics starts from: the one of this or the next single support."""
    roots: list[Side] = []
    upcoming: Side | None = None
    for phase in reversed(phases):
        if phase.support is not Support.DOUBLE:
            upcoming = phase.support.sides[0]
        roots.append(upcoming if upcoming is not None else _last_single(phases))
    return roots[::-1]


def _last_single(phases: tuple[Phase, ...]) -> Side:
    """Support side of the last single support; left where there is none."""
    singles = [p.support.sides[0] for p in phases if p.support is not Support.DOUBLE]
    return singles[-1] if singles else Side.LEFT


def _load_at_end(plan: WalkPlan, phase: Phase, following: Phase | None, load: float) -> float:
    """Share of the weight on the left sole at the end of a phase."""
    if phase.support is not Support.DOUBLE or phase is plan.phases[0]:
        return load
    if following is None or following.support is Support.DOUBLE:
        return 0.5  # the last weight shift leads to the middle, where the lead-out rests
    return 1.0 if following.support is Support.LEFT else 0.0


def _swing(plan: WalkPlan, phase: Phase, poses: list[Array], planar: Array, height: Array) -> None:
    """Fill in planar pose and height of the swing sole over one single support."""
    assert phase.target is not None
    swing = plan.footsteps[phase.target].side
    s = np.arange(phase.end - phase.start) / (phase.end - phase.start)
    if phase.path is not None:
        times = plan.dt * np.arange(phase.end - phase.start)
        planar[phase.start : phase.end, swing] = evaluate(phase.path.planar, times)
        height[phase.start : phase.end, swing] = evaluate(phase.path.height, times)[:, 0]
        return
    start, target = poses[phase.feet[swing]], poses[phase.target]
    over = quintic(s / (1.0 - plan.landing))
    planar[phase.start : phase.end, swing] = start + over[:, None] * (target - start)
    height[phase.start : phase.end, swing] = plan.step_height * _swing_height(s, plan.landing)


def _swing_height(s: Array, landing: float) -> Array:
    """Height (N,) of the swing sole in step heights at parts s (N,) of a single support."""
    if landing == 0.0:
        return bump(s)
    above, low = 1.0 - landing, LANDING_SPEED * landing
    up, down = quintic(2.0 * s / above), quintic(2.0 * s / above - 1.0)
    last = quintic(np.clip(s - above, 0.0, landing) / landing)
    return up - (1.0 - low) * down - low * last


def _sole_poses(planar: Array, height: Array) -> Array:
    """Poses (N, 2, 7) of level soles from x, y, yaw (N, 2, 3) and z (N, 2)."""
    return np.concatenate(
        [planar[..., :2], height[..., None], quat_xyzw_from_yaw(planar[..., 2])], axis=-1
    )


def _hands(plan: WalkPlan, planar: Array) -> Array:
    """Hands (N, 2, 3) at constant offsets from the CoM, turned with the mean yaw of the soles [m].

    With arm swing each hand moves forward and back with the opposite foot.
    """
    heading = planar[..., 2].mean(axis=1)
    hands = np.empty((plan.n_samples, 2, 3))
    hands[..., 2] = plan.hand_offsets[:, 2]
    apart = planar[:, Side.LEFT, :2] - planar[:, Side.RIGHT, :2]
    ahead = rotate_planar(apart, -heading)[:, 0]  # way of the left foot past the right one
    for side in Side:
        offset = np.repeat(plan.hand_offsets[side, None, :2], plan.n_samples, axis=0)
        offset[:, 0] -= 0.5 * side.sign * plan.arm_swing * ahead
        hands[:, side, :2] = rotate_planar(offset, heading)
    return hands


def _torso(plan: WalkPlan, planar: Array) -> Array:
    """Orientation (N, 4) of the torso: that at rest, turned with the mean yaw of the soles."""
    return quat_multiply(quat_xyzw_from_yaw(planar[..., 2].mean(axis=1)), plan.torso)
