"""The plan of a walk: footsteps on the ground and on boxes, and the support phases between them."""

from __future__ import annotations

import math
from dataclasses import replace

from mgs.core.contact import Footstep, Side
from mgs.core.errors import ConfigError, FootstepError
from mgs.core.geometry import rectangle_gap
from mgs.core.limits import MAX_CROWD
from mgs.core.scene import PLACE, Box, Scene, is_crowded
from mgs.gait import WalkGait, WalkParameters
from mgs.motion_planner.footsteps import first_support_of, plan_footsteps
from mgs.motion_planner.goal import StepLimits
from mgs.motion_planner.motion_plan import FootRoll, LegReach, Phase, WalkPlan
from mgs.motion_planner.phases import Duration, phase_bounds, step_phases
from mgs.motion_planner.standing import STRETCH, leg_reach, standing_figures
from mgs.motion_planner.terrain import (
    SwingParameters,
    corners_of,
    refuse_crossing,
    stand_on,
    swing_over,
)
from mgs.robot import Robot, leg_length, midpoint_width
from mgs.robot.legs import missing_turn

ROUNDING = 1e-9  # [rad]
# Largest step on the way to a goal where the gait gives none.
STEP_LENGTH, STEP_LATERAL = 0.18, 0.1  # in leg lengths
STEP_YAW = 0.2  # [rad]


def plan_walk(robot: Robot, gait: WalkGait) -> WalkPlan:
    """Footsteps and support phases of a walk; see `plan_motion` for the errors."""
    walk = gait.walk
    width = walk.step_width or midpoint_width(robot)
    limits = _step_limits(robot, walk, width)
    level = plan_footsteps(walk, width, first_support_of(walk), limits)
    bounds = phase_bounds(_durations(walk, len(level) - 2), gait.dt)  # before what takes longer
    _refuse_what_legs_lack(robot, walk, level)
    _refuse_overlap(robot, level)
    _refuse_zmp_beside_sole(robot, walk)
    boxes = tuple(Box(**box.model_dump()) for box in walk.boxes)
    if is_crowded(boxes):
        raise ConfigError(
            "walk.boxes",
            f"more than {MAX_CROWD} boxes touch one square of {PLACE:g} m x {PLACE:g} m, which "
            "takes engines too long; use fewer or larger boxes",
        )
    footsteps = tuple(stand_on(robot, level, boxes))
    phases = step_phases(bounds, footsteps)
    if boxes:
        phases = _over_boxes(robot, phases, footsteps, boxes, gait)
    rest = standing_figures(robot)
    return WalkPlan(
        dt=gait.dt,
        n_samples=phases[-1].end,
        footsteps=footsteps,
        scene=Scene(boxes=boxes),
        phases=phases,
        step_height=walk.step_height,
        swing_profile=walk.swing_profile,
        landing=walk.landing,
        roll=_foot_roll(robot, walk),
        com_height=walk.com_height or float(rest.com[2]),
        zmp_offset=(walk.zmp_offset[0], walk.zmp_offset[1]),
        zmp_travel=walk.zmp_travel,
        hand_offsets=rest.hands - rest.com,
        arm_swing=walk.arm_swing,
        hands_held=walk.hands == "held",
        torso=rest.torso,
        reach=_reach(robot, walk),
    )


def _foot_roll(robot: Robot, walk: WalkParameters) -> FootRoll | None:
    """How soles roll over heels and toes; None: they stay level."""
    asked = walk.foot_roll
    if asked is None or asked.toe_off == asked.heel_strike == 0.0:
        return None
    if walk.boxes:
        raise ConfigError(
            "walk.foot_roll", "soles roll on level ground only; leave out walk.foot_roll or boxes"
        )
    left, right = (robot.sole_spec(side).length for side in Side)
    return FootRoll(asked.toe_off, asked.heel_strike, (left, right))


def _reach(robot: Robot, walk: WalkParameters) -> LegReach | None:
    """Bound of the CoM's height; None: the height is as asked."""
    if walk.leg_stretch is None and not walk.boxes:
        return None
    return leg_reach(robot, walk.leg_stretch or STRETCH)


def _step_limits(robot: Robot, walk: WalkParameters, width: float) -> StepLimits:
    """Largest steps on the way to a goal."""
    leg = leg_length(robot)
    lateral = abs(walk.lateral) or STEP_LATERAL * leg
    free = width - 0.5 * sum(robot.sole_spec(side).width for side in Side)
    return StepLimits(
        length=abs(walk.step_length) or STEP_LENGTH * leg,
        lateral=lateral,
        inward=max(min(lateral, 0.5 * free), 1e-3),
        yaw=abs(walk.step_yaw) or STEP_YAW,
    )


def _durations(walk: WalkParameters, n_steps: int) -> list[Duration]:
    """Durations of all phases: lead-in, weight shift, step, ..., weight shift, lead-out."""
    shift = ("walk.double_support", walk.double_support)
    steps = [shift, ("walk.single_support", walk.single_support)] * n_steps
    return [("walk.lead_in", walk.lead_in), *steps, shift, ("walk.lead_out", walk.lead_out)]


def _refuse_what_legs_lack(
    robot: Robot, walk: WalkParameters, footsteps: tuple[Footstep, ...]
) -> None:
    """Raise ConfigError where a step needs a turn of the sole that the legs lack."""
    turn = missing_turn(robot)
    keys = {"yaw": ("step_yaw",), "roll": ("lateral", "step_width", "step_yaw")}
    for key in keys[turn] if turn is not None else ():
        if getattr(walk, key):
            joint = "hip yaw" if turn == "yaw" else "ankle roll"
            raise ConfigError(
                f"walk.{key}",
                f"{getattr(walk, key):g} asks for a joint for {joint}, which the legs of "
                f"{robot.spec.name} lack; leave it out",
            )
    for number, footstep in enumerate(footsteps if turn is not None else ()):
        aside = turn == "roll" and footstep.y != footsteps[footstep.side].y
        if aside or abs(footstep.yaw) > ROUNDING:
            raise ConfigError(
                "walk",
                f"footstep {number} turns or goes sideways, but the legs of {robot.spec.name} lack "
                "a joint for that; walk straight ahead or back",
            )


def _refuse_overlap(robot: Robot, footsteps: tuple[Footstep, ...]) -> None:
    """Raise FootstepError where a sole lands on the other one, or strikes it on its way there."""
    corners = [corners_of(robot, footstep) for footstep in footsteps]
    feet = [0, 1]
    for landing in range(1, len(footsteps)):
        side = footsteps[landing].side
        standing = 0 if landing == 1 else feet[side.other]
        gap = rectangle_gap(corners[standing], corners[landing])
        if gap < 0.0:
            distance = math.hypot(
                footsteps[standing].x - footsteps[landing].x,
                footsteps[standing].y - footsteps[landing].y,
            )
            raise FootstepError(standing, landing, gap, distance)
        if landing > 1:
            refuse_crossing(
                robot, footsteps[feet[side]], footsteps[landing], footsteps[standing], landing
            )
            feet[side] = landing


def _refuse_zmp_beside_sole(robot: Robot, walk: WalkParameters) -> None:
    """Raise ConfigError where the planned ZMP would leave the support sole."""
    for side in Side:
        sole = robot.sole_spec(side)
        forward, inward = (abs(offset) for offset in walk.zmp_offset)
        if forward >= 0.5 * sole.length or inward >= 0.5 * sole.width:
            raise ConfigError(
                "walk.zmp_offset",
                f"{walk.zmp_offset} m lies outside the sole, which ends {0.5 * sole.length:g} m "
                f"ahead and {0.5 * sole.width:g} m beside its centre; move it nearer to the centre",
            )
        room = sole.length - 2.0 * forward
        if walk.zmp_travel >= room:
            raise ConfigError(
                "walk.zmp_travel",
                f"{walk.zmp_travel:g} m leads out of the sole, which has room for {room:g} m; "
                "use a smaller one",
            )


def _over_boxes(
    robot: Robot,
    phases: tuple[Phase, ...],
    footsteps: tuple[Footstep, ...],
    boxes: tuple[Box, ...],
    gait: WalkGait,
) -> tuple[Phase, ...]:
    """The phases with swing paths that keep clear of boxes."""
    walk, cleared = gait.walk, []
    for phase in phases:
        if phase.target is not None:
            target = footsteps[phase.target]
            duration = (phase.end - phase.start) * gait.dt
            plan = SwingParameters(boxes, walk.step_height, walk.clearance, duration)
            path = swing_over(robot, footsteps[phase.feet[target.side]], target, plan)
            phase = replace(phase, path=path)
        cleared.append(phase)
    return tuple(cleared)
