"""Walking: a chain of body-centre poses, with each sole half a step width beside its own.

The centre advances by (step_length, lateral, step_yaw) a step along the chord of the arc, so that
equal steps lie on one circle. The trailing foot of a sideways walk only closes up. The last step
lands beside the other foot.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mgs.contact import Footstep, Side, Support
from mgs.errors import ConfigError, FootstepError
from mgs.gait import WalkGait, WalkParameters
from mgs.geometry import compose_planar, rectangle_gap, sole_corners
from mgs.legs import missing_turn
from mgs.motion_planner.motion_plan import MotionPlan, Phase
from mgs.motion_planner.standing import standing_figures
from mgs.robot import Robot, midpoint_width

Array = NDArray[np.float64]
MIN_PHASE_SAMPLES = 5  # below this a quintic is no longer sampled


def plan_walk(robot: Robot, gait: WalkGait) -> MotionPlan:
    """Footsteps and support phases of a walk; see `plan_motion` for the errors."""
    walk = gait.walk
    first_support = _first_support(walk)
    _refuse_what_legs_lack(robot, walk)
    footsteps = plan_footsteps(walk, walk.step_width or midpoint_width(robot), first_support)
    _refuse_overlap(robot, footsteps, walk)
    _refuse_zmp_beside_sole(robot, walk)
    rest = standing_figures(robot)
    return MotionPlan(
        dt=gait.dt,
        n_samples=_boundaries(walk, gait.dt)[-1] + 1,
        footsteps=footsteps,
        phases=_plan_phases(walk, gait.dt, first_support),
        step_height=walk.step_height,
        landing=walk.landing,
        com_height=walk.com_height or float(rest.com[2]),
        zmp_offset=(walk.zmp_offset[0], walk.zmp_offset[1]),
        hand_offsets=rest.hands - rest.com,
        torso=rest.torso,
    )


def _refuse_what_legs_lack(robot: Robot, walk: WalkParameters) -> None:
    """Raise ConfigError for steps that need a turn of the sole which the legs do not have."""
    turn = missing_turn(robot)
    keys = {"yaw": ("step_yaw",), "roll": ("lateral", "step_width", "step_yaw")}
    for key in keys[turn] if turn is not None else ():
        if getattr(walk, key):
            joint = "hip yaw" if turn == "yaw" else "ankle roll"
            raise ConfigError(
                f"walk.{key}",
                f"{getattr(walk, key):g} asks for a {joint}, which the legs of {robot.spec.name} "
                "lack; leave it out",
            )


def plan_footsteps(walk: WalkParameters, width: float, first_support: Side) -> tuple[Footstep, ...]:
    """The two initial footsteps (left, right) about the origin, then one per step."""
    centre = np.zeros(3)
    footsteps = [_beside(centre, side, width) for side in Side]
    swing = first_support.other
    for step in range(walk.n_steps):
        if step < walk.n_steps - 1:
            leads = swing.sign * walk.lateral > 0.0
            chord = compose_planar(centre, [0.0, 0.0, 0.5 * walk.step_yaw])
            ahead = [walk.step_length, walk.lateral if leads else 0.0, 0.5 * walk.step_yaw]
            centre = compose_planar(chord, ahead)
        footsteps.append(_beside(centre, swing, width))
        swing = swing.other
    return tuple(footsteps)


def _beside(centre: Array, side: Side, width: float) -> Footstep:
    x, y, yaw = compose_planar(centre, [0.0, 0.5 * side.sign * width, 0.0])
    return Footstep(side, float(x), float(y), float(yaw))


def _first_support(walk: WalkParameters) -> Side:
    """The side asked for, else the one that lets the leading foot begin."""
    if walk.first_support is not None:
        return Side[walk.first_support.upper()]
    return Side.RIGHT if (walk.lateral or walk.step_yaw) > 0.0 else Side.LEFT


def _refuse_overlap(robot: Robot, footsteps: tuple[Footstep, ...], walk: WalkParameters) -> None:
    specs = {side: robot.sole_spec(side) for side in Side}
    corners = [
        sole_corners([f.x, f.y, f.yaw], specs[f.side].length, specs[f.side].width)
        for f in footsteps
    ]
    for second in range(1, len(footsteps)):  # each sole lands beside the one placed before it
        first = second - 1
        if second == 2 and footsteps[1].side is footsteps[2].side:
            first = 0  # the first swing foot is the right one: its neighbour is the initial left
        gap = rectangle_gap(corners[first], corners[second])
        if gap < 0.0:
            distance = math.hypot(
                footsteps[first].x - footsteps[second].x, footsteps[first].y - footsteps[second].y
            )
            advice = f"their centres are {distance:.3f} m apart: try a larger step_width"
            if walk.step_yaw:
                advice += " or a smaller step_yaw"
            raise FootstepError(first, second, gap, advice)


def _refuse_zmp_beside_sole(robot: Robot, walk: WalkParameters) -> None:
    for side in Side:
        sole = robot.sole_spec(side)
        forward, inward = (abs(offset) for offset in walk.zmp_offset)
        if forward >= 0.5 * sole.length or inward >= 0.5 * sole.width:
            raise ConfigError(
                "walk.zmp_offset",
                f"{walk.zmp_offset} m lies outside the sole, which ends {0.5 * sole.length:g} m "
                f"ahead and {0.5 * sole.width:g} m beside its centre; move it nearer to the centre",
            )


def _boundaries(walk: WalkParameters, dt: float) -> list[int]:
    """Samples at which phases begin: lead-in, shift, step, ..., shift, lead-out, and the end."""
    steps = [walk.double_support, walk.single_support] * walk.n_steps
    durations = [walk.lead_in, *steps, walk.double_support, walk.lead_out]
    samples = np.round(np.concatenate([[0.0], np.cumsum(durations)]) / dt).astype(int)
    if np.diff(samples).min() < MIN_PHASE_SAMPLES:
        keys = ("lead_in", "double_support", "single_support", "lead_out")
        key = min(keys, key=lambda name: float(getattr(walk, name)))
        raise ConfigError(
            f"walk.{key}",
            f"{getattr(walk, key)} s is fewer than {MIN_PHASE_SAMPLES} samples of dt = {dt} s; "
            f"at least {MIN_PHASE_SAMPLES * dt:g} s, or a smaller dt",
        )
    return [int(k) for k in samples]


def _plan_phases(walk: WalkParameters, dt: float, first_support: Side) -> tuple[Phase, ...]:
    bounds = _boundaries(walk, dt)
    feet, support = (0, 1), first_support
    phases = [Phase(bounds[0], bounds[1], Support.DOUBLE, feet)]
    for step in range(walk.n_steps):
        shift, lift, land = bounds[2 * step + 1 : 2 * step + 4]
        target = 2 + step
        phases.append(Phase(shift, lift, Support.DOUBLE, feet))
        phases.append(Phase(lift, land, Support.single(support), feet, target))
        feet = (feet[0], target) if support is Side.LEFT else (target, feet[1])
        support = support.other
    phases.append(Phase(bounds[-3], bounds[-2], Support.DOUBLE, feet))
    phases.append(Phase(bounds[-2], bounds[-1] + 1, Support.DOUBLE, feet))
    return tuple(phases)
