"""Rolling feet: heels that rise before lift-off, and soles that land on their heels.

In the first third of a double support the sole that has landed comes down about its heel; then the
other one rises about its toe. A sole that comes down alone takes two thirds. So at every time one
sole is level, and inverse kinematics starts from it. In the air the sole turns level again, and
raises its toe as it gets ahead. It turns about the edge that touches the ground before or after, so
that its lowest point is as high as a level sole would be.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.geometry import quat_multiply, quat_xyzw_from_yaw, quintic, rotate_planar
from mgs.motion_planner import FootRoll, Phase, WalkPlan

LANDING_SHARE = 1.0 / 3.0  # of a double support, in which the sole that has landed comes down
LANDING_ALONE = 2.0 / 3.0  # the same where no heel rises; then the pressure leaves the heel
LEVEL_AT = 0.4  # of the time to get above the footstep, at which a swing sole is level
NO_ROLL = 1e-3  # [rad]; a sole that turns by less stays level


def sole_pitch(plan: WalkPlan) -> Array:
    """Pitch (N, 2) of the soles [rad]: positive while the heel is up, negative with the toe up."""
    pitch = np.zeros((plan.n_samples, 2))
    rolls = rolls_of(plan)
    for i, (toe_off, heel_strike) in enumerate(rolls):
        phase = plan.phases[i]
        if phase.target is None:
            continue
        side = plan.footsteps[phase.target].side
        rise, land = _turn(plan, rolls, i - 1), _turn(plan, rolls, i + 1)
        lift, touch = phase.start, phase.end
        way = round((1.0 - plan.landing) * (touch - lift))
        level, toe_up = lift + round(LEVEL_AT * way), lift + way
        pitch[rise:lift, side] += toe_off * _blend(lift - rise)
        pitch[lift:level, side] += toe_off * (1.0 - _blend(level - lift))
        pitch[level:toe_up, side] -= heel_strike * _blend(toe_up - level)
        pitch[toe_up:touch, side] = -heel_strike
        pitch[touch:land, side] -= heel_strike * (1.0 - _blend(land - touch))
    return pitch


def rolls_of(plan: WalkPlan) -> Array:
    """Pitch of the swing sole of each of K phases (K, 2) [rad]: up to lift-off, and at touch-down.

    The second one, with the toe up, has the opposite sign. Both are in proportion to how far the
    sole is behind, or ahead of, the one that stands: the first step has no toe-off, and the step
    that closes the feet has no heel strike.
    """
    parts = parts_of_longest(plan)
    if plan.roll is None:
        return np.zeros_like(parts)
    rolls = parts * [plan.roll.toe_off, plan.roll.heel_strike]
    return np.where(rolls > NO_ROLL, rolls, 0.0)


def parts_of_longest(plan: WalkPlan) -> Array:
    """How far the swing sole is behind the standing one at first, and ahead of it at last: (K, 2).

    For each of K phases, as parts of the longest of these ways; 0 where the sole goes backward.
    """
    ways = np.maximum([_apart(plan, phase) for phase in plan.phases], 0.0)
    return ways / ways.max() if ways.any() else ways


def rolled_soles(roll: FootRoll, planar: Array, height: Array, pitch: Array) -> Array:
    """Poses (N, 2, 7) of soles that turn about their toes or heels.

    Args:
        roll: says how long the soles are.
        planar: x, y [m] and yaw [rad] (N, 2, 3) of the soles, were they level.
        height: (N, 2) of their lowest point [m].
        pitch: (N, 2) [rad].
    """
    half = 0.5 * np.array(roll.sole_lengths)
    edge = np.sign(pitch) * half  # about which the sole turns, ahead of its centre
    poses = np.empty((*pitch.shape, 7))
    ahead = np.stack([edge * (1.0 - np.cos(pitch)), np.zeros_like(pitch)], axis=-1)
    poses[..., :2] = planar[..., :2] + rotate_planar(ahead, planar[..., 2])
    poses[..., 2] = height + edge * np.sin(pitch)
    tilt = np.zeros((*pitch.shape, 4))
    tilt[..., 1], tilt[..., 3] = np.sin(0.5 * pitch), np.cos(0.5 * pitch)
    poses[..., 3:] = quat_multiply(quat_xyzw_from_yaw(planar[..., 2]), tilt)
    return poses


def edge_ways(plan: WalkPlan, rolls: Array, side: Side, i: int) -> Array | None:
    """Ways (k,) of the centre of pressure of a sole in double support `i`; None: the sole is level.

    They are forward of the sole's centre as a part of its half length, 1 at the toe and -1 at the
    heel. Before the heel rises the pressure goes to the toe; after the toe has come down it leaves
    the heel. `rolls` is from `rolls_of`.
    """
    phase = plan.phases[i]
    n, down = phase.end - phase.start, _turn(plan, rolls, i) - phase.start
    before = plan.phases[i - 1] if i else None
    after = plan.phases[i + 1] if i + 1 < len(plan.phases) else None
    if before is not None and _swings(plan, before, side) and rolls[i - 1, 1]:
        return np.concatenate([-np.ones(down), _blend(n - down) - 1.0])
    if after is not None and _swings(plan, after, side) and rolls[i + 1, 0]:
        return np.concatenate([_blend(down), np.ones(n - down)])
    return None


def _swings(plan: WalkPlan, phase: Phase, side: Side) -> bool:
    return phase.target is not None and plan.footsteps[phase.target].side is side


def _apart(plan: WalkPlan, phase: Phase) -> tuple[float, float]:
    """How far the swing sole is behind the standing one at first, and ahead of it at last [m]."""
    if phase.target is None:
        return 0.0, 0.0
    target = plan.footsteps[phase.target]
    stand, start = (plan.footsteps[phase.feet[s]] for s in (target.side.other, target.side))
    ways = [
        rotate_planar(np.array([b.x - a.x, b.y - a.y]), -stand.yaw)[0]
        for a, b in ((start, stand), (stand, target))
    ]
    return float(ways[0]), float(ways[1])


def _turn(plan: WalkPlan, rolls: Array, i: int) -> int:
    """Sample of double support `i` at which one sole has come down and the other begins to rise."""
    phase = plan.phases[i]
    rises = i + 1 < len(plan.phases) and rolls[i + 1, 0] > 0.0
    share = LANDING_SHARE if rises else LANDING_ALONE
    return phase.start + round(share * (phase.end - phase.start))


def _blend(n: int) -> Array:
    return quintic(np.arange(n) / n)
