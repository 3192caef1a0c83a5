"""Kicking: a swing on one foot through the place of the ball, back to where the foot stood.

The foot rises, turns to the direction asked and is drawn back on the line of the strike. From rest
there it reaches the speed asked when its front edge meets the ball, and comes to rest beyond it:
two quintic pieces whose mean speed is half of that at contact.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from mgs.core.constants import GRAVITY
from mgs.core.contact import Footstep, Side
from mgs.core.curves import Knots, at_rest, evaluate
from mgs.core.errors import ConfigError, InfeasibleGaitError
from mgs.core.geometry import polygon_margins, rectangle_gaps, sole_corners
from mgs.core.scene import Ball, Scene
from mgs.gait import KickGait, KickParameters
from mgs.motion_planner.motion_plan import MotionPlan, SwingPath
from mgs.motion_planner.standing import standing_figures
from mgs.motion_planner.terrain import corners_of
from mgs.motion_planner.walk import MIN_PHASE_SAMPLES, step_phases
from mgs.robot import Robot, leg_length, midpoint_width

SPEED = 0.35  # default, of sqrt(g leg)
ADVANCE, BACK_SWING, FOLLOW_THROUGH = 0.12, 0.2, 0.14  # defaults, of the leg's length
MIDDLE = 0.9  # of a ball's radius: there the edge of a thin sole is close to its middle
MIN_RUN = 0.02  # [m] in which the foot gathers speed, at least
N_ALONG = 201  # places of the swing that are looked at


def plan_kick(robot: Robot, gait: KickGait) -> MotionPlan:
    """Footsteps, phases, swing and ball of a kick; see `plan_motion` for the errors."""
    kick = gait.kick
    swing = Side[kick.foot.upper()]
    width = kick.step_width or midpoint_width(robot)
    feet = [Footstep(side, 0.0, 0.5 * side.sign * width, 0.0) for side in Side]
    footsteps = (*feet, feet[swing])
    path, contact, ball = _strike(robot, kick, feet[swing])
    _refuse_ball_at_foot(robot, ball, feet)
    _refuse_crossing(robot, path, feet[swing], feet[swing.other])
    phases = step_phases(_boundaries(kick, gait.dt, float(path.planar.times[-1])), footsteps)
    phases = tuple(phase if phase.target is None else replace(phase, path=path) for phase in phases)
    lift_off = next(phase.start for phase in phases if phase.target is not None)
    rest = standing_figures(robot)
    return MotionPlan(
        dt=gait.dt,
        n_samples=phases[-1].end,
        footsteps=footsteps,
        phases=phases,
        step_height=float(path.height.points.max()),
        landing=0.0,
        com_height=kick.com_height or float(rest.com[2]),
        zmp_offset=(kick.zmp_offset[0], kick.zmp_offset[1]),
        hand_offsets=rest.hands - rest.com,
        torso=rest.torso,
        scene=Scene(balls=(replace(ball, time=lift_off * gait.dt + contact),)),
    )


def _strike(robot: Robot, kick: KickParameters, foot: Footstep) -> tuple[SwingPath, float, Ball]:
    """Path of the foot, time of contact after lift-off [s], and the ball without its time."""
    leg, sole = leg_length(robot), robot.sole_spec(foot.side)
    speed = kick.speed or SPEED * math.sqrt(GRAVITY * leg)
    height = kick.height or MIDDLE * kick.ball.radius
    ahead = np.array([math.cos(kick.direction), math.sin(kick.direction)])
    home = np.array([foot.x, foot.y])
    below = kick.ball.radius - height
    if abs(below) >= kick.ball.radius:
        raise ConfigError(
            "kick.height",
            f"{height:g} m is above the ball, which is {2 * kick.ball.radius:g} m high",
        )
    reach = 0.5 * sole.length + math.sqrt(kick.ball.radius**2 - below**2)  # to the ball's centre
    best = home + (ADVANCE * leg + reach) * ahead
    x = best[0] if kick.ball.x is None else kick.ball.x
    # on the line through the foot where only x is given
    y = foot.y + (x - foot.x) * math.tan(kick.direction) if kick.ball.y is None else kick.ball.y
    strike = np.array([x, y]) - reach * ahead
    advance = float((strike - home) @ ahead)
    run = advance + (kick.back_swing or BACK_SWING * leg)
    if run < MIN_RUN:
        raise InfeasibleGaitError(
            f"the ball at ({x:.3f}, {y:.3f}) m is too near: the foot would strike it after "
            f"{1e3 * run:.0f} mm, {1e3 * MIN_RUN:.0f} mm are needed; move it at least "
            f"{1e3 * (MIN_RUN - run):.0f} mm on or lengthen kick.back_swing"
        )
    back, beyond = run, kick.follow_through or FOLLOW_THROUGH * leg
    durations = [kick.lift, kick.draw, 2.0 * run / speed, 2.0 * beyond / speed, kick.recover]
    times = np.concatenate([[0.0], np.cumsum([*durations, kick.lift])])
    places = [home, home, strike - back * ahead, strike, strike + beyond * ahead, home, home]
    yaws = [0.0, 0.0, *[kick.direction] * 3, 0.0, 0.0]
    points = np.column_stack([places, yaws])
    speeds = np.zeros_like(points)
    speeds[3, :2] = speed * ahead
    up = [[0.0], [height], [height], [0.0]]
    path = SwingPath(Knots(times, points, speeds), at_rest(times[[0, 1, -2, -1]], up))
    ball = Ball(
        float(x), float(y), kick.ball.radius, kick.ball.mass, 0.0, kick.direction, float(speed)
    )
    return path, float(times[3]), ball


def _refuse_ball_at_foot(robot: Robot, ball: Ball, feet: list[Footstep]) -> None:
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
    gap = float(
        rectangle_gaps(
            sole_corners(poses, sole.length, sole.width), corners_of(robot, support)
        ).min()
    )
    if gap < 0.0:
        raise InfeasibleGaitError(
            f"the kicking foot would strike the other leg, by {-1e3 * gap:.1f} mm; use a ball "
            "farther outward, a direction away from the other foot or a larger kick.step_width"
        )


def _boundaries(kick: KickParameters, dt: float, swing: float) -> list[int]:
    """Samples at which phases begin, and the end."""
    durations = [kick.lead_in, kick.shift, swing, kick.shift, kick.lead_out]
    samples = np.round(np.concatenate([[0.0], np.cumsum(durations)]) / dt).astype(int)
    if np.diff(samples).min() < MIN_PHASE_SAMPLES:
        keys = ("lead_in", "shift", "lead_out")
        key = min(keys, key=lambda name: float(getattr(kick, name)))
        raise ConfigError(
            f"kick.{key}",
            f"{getattr(kick, key)} s is fewer than {MIN_PHASE_SAMPLES} samples of dt = {dt} s; "
            f"at least {MIN_PHASE_SAMPLES * dt:g} s, or a smaller dt",
        )
    return [int(k) for k in samples]
