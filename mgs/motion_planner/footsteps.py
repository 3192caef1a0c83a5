"""Footsteps of a walk: a chain of centre poses, and beside each of them one sole.

The centre between the feet advances by (step_length, lateral, step_yaw) in each step, along the
chord of an arc, so that equal steps lie on one circle; the sole lands half a step width beside it.
In a sideways walk only the leading foot steps out, and the trailing foot closes up. The last step
lands beside the other foot.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Footstep, Side
from mgs.core.errors import ConfigError
from mgs.core.geometry import compose_planar
from mgs.gait import StepParameters, WalkParameters
from mgs.motion_planner.goal import StepLimits, way_to_goal


def plan_footsteps(
    walk: WalkParameters, width: float, first_support: Side, limits: StepLimits | None = None
) -> tuple[Footstep, ...]:
    """The two initial footsteps (left, right) about the origin, then one per step.

    Args:
        walk: the block `walk` of the gait.
        width: distance of the sole centres [m].
        first_support: side of the foot that stands first.
        limits: largest steps; needed only for a walk to a goal.

    Raises:
        ConfigError: the goal is too far away, or `walk.footsteps` contradicts another key.
    """
    initial = [_beside(np.zeros(3), side, width) for side in Side]
    if walk.footsteps is not None:
        _refuse_contradictions(walk, first_support)
        return (
            *initial,
            *(Footstep(Side[f.side.upper()], f.x, f.y, f.yaw) for f in walk.footsteps),
        )
    swing = first_support.other
    if walk.goal is not None:
        assert limits is not None
        centres = way_to_goal(walk.goal, swing, limits)
    else:
        steps = walk.steps or [StepParameters()] * (walk.most_steps - 1)
        centres = _chain([_increment(step, walk) for step in steps], swing)
    if walk.last_support is not None:
        last_swing = swing if len(centres) % 2 == 0 else swing.other
        if Side[walk.last_support.upper()] is last_swing:
            centres = [*centres, *(centres[-1:] or [np.zeros(3)])]
    centres = [*centres, *(centres[-1:] or [np.zeros(3)])]  # the closing step
    placed = []
    for centre in centres:
        placed.append(_beside(centre, swing, width))
        swing = swing.other
    return (*initial, *placed)


def first_support_of(walk: WalkParameters) -> Side:
    """Side of the foot that stands first: as asked, else such that the leading foot steps first."""
    if walk.footsteps is not None and walk.first_support is None:
        return Side[walk.footsteps[0].side.upper()].other
    if walk.first_support is not None:
        return Side[walk.first_support.upper()]
    sideways, turn = walk.lateral, walk.step_yaw
    if walk.steps is not None:
        _, sideways, turn = _increment(walk.steps[0], walk)
    elif walk.goal is not None:
        sideways, turn = walk.goal.y, walk.goal.yaw
    return Side.RIGHT if (sideways or turn) > 0.0 else Side.LEFT


def _increment(step: StepParameters, walk: WalkParameters) -> tuple[float, float, float]:
    """Forward [m], lateral [m] and yaw [rad] of one step."""
    forward = walk.step_length if step.step_length is None else step.step_length
    lateral = walk.lateral if step.lateral is None else step.lateral
    return forward, lateral, walk.step_yaw if step.step_yaw is None else step.step_yaw


def _chain(increments: list[tuple[float, float, float]], swing: Side) -> list[Array]:
    """Centre pose x, y [m], yaw [rad] (3,) after each step."""
    centre, centres = np.zeros(3), []
    for forward, lateral, yaw in increments:
        leads = swing.sign * lateral > 0.0
        chord = compose_planar(centre, [0.0, 0.0, 0.5 * yaw])
        centre = compose_planar(chord, [forward, lateral if leads else 0.0, 0.5 * yaw])
        centres.append(centre)
        swing = swing.other
    return centres


def _beside(centre: Array, side: Side, width: float) -> Footstep:
    """The footstep on one side of a centre pose (3,), half a step width [m] away from it."""
    x, y, yaw = compose_planar(centre, [0.0, 0.5 * side.sign * width, 0.0])
    return Footstep(side, float(x), float(y), float(yaw))


def _refuse_contradictions(walk: WalkParameters, first_support: Side) -> None:
    """Raise ConfigError where `walk.footsteps` implies other support feet than the gait names."""
    assert walk.footsteps is not None
    first, last = (Side[walk.footsteps[i].side.upper()].other for i in (0, -1))
    if first is not first_support:
        raise ConfigError(
            "walk.first_support",
            f"{first_support.label}, but the first of walk.footsteps is a step of this foot; "
            "leave walk.first_support out",
        )
    if walk.last_support is not None and Side[walk.last_support.upper()] is not last:
        raise ConfigError(
            "walk.last_support",
            f"{walk.last_support}, but the last of walk.footsteps is a step of this foot; "
            "leave walk.last_support out",
        )
