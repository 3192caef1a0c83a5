"""Walking: footsteps on the ground and on boxes, and the support phases between them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from mgs.core.contact import Footstep, Side, Support
from mgs.core.errors import ConfigError, FootstepError
from mgs.core.geometry import rectangle_gap
from mgs.core.scene import Box, Scene
from mgs.gait import WalkGait, WalkParameters
from mgs.motion_planner.footsteps import first_support_of, plan_footsteps
from mgs.motion_planner.goal import StepLimits
from mgs.motion_planner.motion_plan import MotionPlan, Phase
from mgs.motion_planner.standing import leg_reach, standing_figures
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
MIN_PHASE_SAMPLES = 5  # below this a quintic is no longer sampled
# Of the largest step on the way to a goal, where the gait says nothing.
STEP_LENGTH, STEP_LATERAL, STEP_YAW = 0.18, 0.1, 0.2  # of the leg's length; [rad]


def plan_walk(robot: Robot, gait: WalkGait) -> MotionPlan:
    """Footsteps and support phases of a walk; see `plan_motion` for the errors."""
    walk = gait.walk
    width = walk.step_width or midpoint_width(robot)
    limits = _step_limits(robot, walk, width)
    level = plan_footsteps(walk, width, first_support_of(walk), limits)
    _refuse_what_legs_lack(robot, walk, level)
    _refuse_overlap(robot, level, walk)
    _refuse_zmp_beside_sole(robot, walk)
    boxes = tuple(Box(**box.model_dump()) for box in walk.boxes)
    footsteps = tuple(stand_on(robot, level, boxes))
    phases = step_phases(_boundaries(walk, gait.dt, len(footsteps) - 2), footsteps)
    if boxes:
        phases = _over_boxes(robot, phases, footsteps, boxes, gait)
    rest = standing_figures(robot)
    return MotionPlan(
        dt=gait.dt,
        n_samples=phases[-1].end,
        footsteps=footsteps,
        phases=phases,
        step_height=walk.step_height,
        landing=walk.landing,
        com_height=walk.com_height or float(rest.com[2]),
        zmp_offset=(walk.zmp_offset[0], walk.zmp_offset[1]),
        hand_offsets=rest.hands - rest.com,
        torso=rest.torso,
        zmp_travel=walk.zmp_travel,
        arm_swing=walk.arm_swing,
        scene=Scene(boxes=boxes),
        reach=leg_reach(robot) if boxes else None,
    )


def _step_limits(robot: Robot, walk: WalkParameters, width: float) -> StepLimits:
    """The largest steps on the way to a goal."""
    leg = leg_length(robot)
    lateral = abs(walk.lateral) or STEP_LATERAL * leg
    free = width - 0.5 * sum(robot.sole_spec(side).width for side in Side)
    return StepLimits(
        length=abs(walk.step_length) or STEP_LENGTH * leg,
        lateral=lateral,
        inward=max(min(lateral, 0.5 * free), 1e-3),
        yaw=abs(walk.step_yaw) or STEP_YAW,
    )


def _refuse_what_legs_lack(
    robot: Robot, walk: WalkParameters, footsteps: tuple[Footstep, ...]
) -> None:
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
    for number, footstep in enumerate(footsteps if turn is not None else ()):
        aside = turn == "roll" and footstep.y != footsteps[footstep.side].y
        if aside or abs(footstep.yaw) > ROUNDING:
            raise ConfigError(
                "walk",
                f"footstep {number} turns or goes aside, for which the legs of {robot.spec.name} "
                "lack a joint; walk straight ahead or back",
            )


def _refuse_overlap(robot: Robot, footsteps: tuple[Footstep, ...], walk: WalkParameters) -> None:
    """Look at each sole beside the one that stands while it lands, and at its way there."""
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
            advice = f"their centres are {distance:.3f} m apart: try a larger step_width"
            if walk.step_yaw:
                advice += " or a smaller step_yaw"
            raise FootstepError(standing, landing, gap, advice)
        if landing > 1:
            refuse_crossing(
                robot, footsteps[feet[side]], footsteps[landing], footsteps[standing], landing
            )
            feet[side] = landing


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
        room = sole.length - 2.0 * forward
        if walk.zmp_travel >= room:
            raise ConfigError(
                "walk.zmp_travel",
                f"{walk.zmp_travel:g} m leads out of the sole, which has room for {room:g} m",
            )


def _boundaries(walk: WalkParameters, dt: float, n_steps: int) -> list[int]:
    """Samples at which phases begin: lead-in, shift, step, ..., shift, lead-out, and the end."""
    steps = [walk.double_support, walk.single_support] * n_steps
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


def step_phases(bounds: list[int], footsteps: tuple[Footstep, ...]) -> tuple[Phase, ...]:
    """Phases between samples: rest, a shift and a swing for each footstep, shift and rest."""
    feet = (0, 1)
    phases = [Phase(bounds[0], bounds[1], Support.DOUBLE, feet)]
    for target in range(2, len(footsteps)):
        shift, lift, land = bounds[2 * target - 3 : 2 * target]
        swing = footsteps[target].side
        phases.append(Phase(shift, lift, Support.DOUBLE, feet))
        phases.append(Phase(lift, land, Support.single(swing.other), feet, target))
        feet = (target, feet[1]) if swing is Side.LEFT else (feet[0], target)
    phases.append(Phase(bounds[-3], bounds[-2], Support.DOUBLE, feet))
    phases.append(Phase(bounds[-2], bounds[-1] + 1, Support.DOUBLE, feet))
    return tuple(phases)


def _over_boxes(
    robot: Robot,
    phases: tuple[Phase, ...],
    footsteps: tuple[Footstep, ...],
    boxes: tuple[Box, ...],
    gait: WalkGait,
) -> tuple[Phase, ...]:
    """Phases whose swings keep clear of boxes."""
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
