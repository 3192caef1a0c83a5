"""The plan of a kick: one foot swings through the ball and back to where it stood.

The foot rises, turns to the direction asked for and is drawn back on the line of the strike. From
rest there it reaches the speed asked for when its front edge meets the ball, and comes to rest
beyond it: two quintic pieces whose mean speed is half of the speed at contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY
from mgs.core.contact import Footstep, Side
from mgs.core.curves import Knots, at_rest, evaluate
from mgs.core.errors import ConfigError, InfeasibleGaitError
from mgs.core.geometry import polygon_margins, rectangle_gaps, sole_corners
from mgs.core.scene import Ball, Scene
from mgs.gait import KickGait, KickParameters
from mgs.motion_planner.motion_plan import SwingPath, WalkPlan
from mgs.motion_planner.phases import Duration, phase_bounds, step_phases
from mgs.motion_planner.standing import feet_abreast, standing_figures
from mgs.motion_planner.terrain import corners_of
from mgs.robot import Robot, leg_length

# Defaults for a leg of length L.
SPEED = 0.35  # in sqrt(g L)
ADVANCE, BACK_SWING, FOLLOW_THROUGH = 0.12, 0.2, 0.14  # in L
MIDDLE = 0.9  # height of the strike in radii of the ball: there a sole meets nearly its middle
MIN_RUN = 0.02  # shortest way on which the foot gathers speed [m]
N_ALONG = 201  # number of instants of the swing at which the other leg is kept clear of


def plan_kick(robot: Robot, gait: KickGait) -> WalkPlan:
    """Footsteps, phases, swing and ball of a kick; see `plan_motion` for the errors."""
    kick = gait.kick
    swing = Side[kick.foot.upper()]
    feet = feet_abreast(robot, kick.step_width)
    strike = _strike(robot, kick, feet[swing])
    ball, path = strike.ball, _path(robot, kick, feet[swing], strike)
    _refuse_ball_at_foot(robot, ball, feet)
    _refuse_crossing(robot, path, feet[swing], feet[swing.other])
    footsteps = (*feet, feet[swing])
    bounds = phase_bounds(_durations(kick, float(path.planar.times[-1])), gait.dt)
    phases = tuple(
        phase if phase.target is None else replace(phase, path=path)
        for phase in step_phases(bounds, footsteps)
    )
    contact = gait.dt * bounds[2] + float(path.planar.times[3])  # bounds[2] is lift-off
    rest = standing_figures(robot)
    return WalkPlan(
        dt=gait.dt,
        n_samples=phases[-1].end,
        footsteps=footsteps,
        scene=Scene(balls=(replace(ball, time=contact),)),
        phases=phases,
        step_height=strike.height,
        com_height=kick.com_height or float(rest.com[2]),
        zmp_offset=(kick.zmp_offset[0], kick.zmp_offset[1]),
        hand_offsets=rest.hands - rest.com,
        torso=rest.torso,
    )


@dataclass(frozen=True, eq=False)
class _Strike:
    """Contact of the foot with the ball."""

    ball: Ball  # its time of contact is not known yet
    place: Array  # (2,) centre of the sole at contact [m]
    ahead: Array  # (2,) unit vector of the direction
    run: float  # way on which the foot gathers speed [m]
    height: float  # of the sole [m]


def _strike(robot: Robot, kick: KickParameters, foot: Footstep) -> _Strike:
    """Where and how the foot strikes the ball.

    Raises:
        ConfigError: the foot would pass above the ball.
        InfeasibleGaitError: the foot has no room to gather speed.
    """
    leg, radius = leg_length(robot), kick.ball.radius
    height = kick.height or MIDDLE * radius
    if abs(radius - height) >= radius:
        raise ConfigError(
            "kick.height",
            f"{height:g} m is above the ball, which is {2 * radius:g} m high; use a smaller one",
        )
    ahead = np.array([math.cos(kick.direction), math.sin(kick.direction)])
    home = np.array([foot.x, foot.y])
    # distance of the sole's centre from that of the ball, both seen from above
    reach = 0.5 * robot.sole_spec(foot.side).length + math.sqrt(radius**2 - (radius - height) ** 2)
    best = home + (ADVANCE * leg + reach) * ahead
    x = best[0] if kick.ball.x is None else kick.ball.x
    # on the line through the foot where only x is given
    y = foot.y + (x - foot.x) * math.tan(kick.direction) if kick.ball.y is None else kick.ball.y
    place = np.array([x, y]) - reach * ahead
    run = float((place - home) @ ahead) + (kick.back_swing or BACK_SWING * leg)
    if run < MIN_RUN:
        raise InfeasibleGaitError(
            f"the ball at ({x:.3f}, {y:.3f}) m is too near: the foot would strike it after "
            f"{1e3 * run:.0f} mm, {1e3 * MIN_RUN:.0f} mm are needed; move it at least "
            f"{1e3 * (MIN_RUN - run):.0f} mm farther ahead or use a longer kick.back_swing"
        )
    speed = kick.speed or SPEED * math.sqrt(GRAVITY * leg)
    ball = Ball(float(x), float(y), radius, kick.ball.mass, 0.0, kick.direction, float(speed))
    return _Strike(ball, place, ahead, run, height)


def _path(robot: Robot, kick: KickParameters, foot: Footstep, strike: _Strike) -> SwingPath:
    """Path of the foot from lift-off through the ball, its fourth knot, back to its place."""
    home, place, ahead = np.array([foot.x, foot.y]), strike.place, strike.ahead
    speed = strike.ball.speed
    run, beyond = strike.run, kick.follow_through or FOLLOW_THROUGH * leg_length(robot)
    durations = [kick.lift, kick.draw, 2.0 * run / speed, 2.0 * beyond / speed, kick.recover]
    times = np.concatenate([[0.0], np.cumsum([*durations, kick.lift])])
    places = [home, home, place - run * ahead, place, place + beyond * ahead, home, home]
    yaws = [0.0, 0.0, *[kick.direction] * 3, 0.0, 0.0]
    points = np.column_stack([places, yaws])
    speeds = np.zeros_like(points)
    speeds[3, :2] = speed * ahead
    up = [[0.0], [strike.height], [strike.height], [0.0]]
    return SwingPath(Knots(times, points, speeds), at_rest(times[[0, 1, -2, -1]], up))


def _refuse_ball_at_foot(robot: Robot, ball: Ball, feet: tuple[Footstep, ...]) -> None:
    """Raise InfeasibleGaitError where the ball touches a sole that stands."""
    centre = np.array([[ball.x, ball.y]])
    for foot in feet:
        gap = -float(polygon_margins(centre, corners_of(robot, foot))[0]) - ball.radius
        if gap <= 0.0:
            raise InfeasibleGaitError(
                f"the ball at ({ball.x:.3f}, {ball.y:.3f}) m touches the {foot.side.label} sole; "
                f"move it at least {-1e3 * gap:.0f} mm away"
            )


def _refuse_crossing(robot: Robot, path: SwingPath, swing: Footstep, support: Footstep) -> None:
    """Raise InfeasibleGaitError where the kicking foot would strike the other leg."""
    sole = robot.sole_spec(swing.side)
    poses = evaluate(path.planar, np.linspace(0.0, path.planar.times[-1], N_ALONG))
    corners = sole_corners(poses, sole.length, sole.width)
    gap = float(rectangle_gaps(corners, corners_of(robot, support)).min())
    if gap < 0.0:
        raise InfeasibleGaitError(
            f"the kicking foot would strike the other leg, by {-1e3 * gap:.1f} mm; use a ball "
            "farther outward, a kick.direction away from the other foot or a larger kick.step_width"
        )


def _durations(kick: KickParameters, swing: float) -> list[Duration]:
    """Durations of all phases; that of the swing [s] is given."""
    shift = ("kick.shift", kick.shift)
    lead_in, lead_out = ("kick.lead_in", kick.lead_in), ("kick.lead_out", kick.lead_out)
    return [lead_in, shift, ("kick.lift, kick.draw and kick.recover", swing), shift, lead_out]
