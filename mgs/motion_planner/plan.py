"""The choice of the planner by the kind of motion."""

from __future__ import annotations

from mgs.gait import Gait, KeyframesGait, KickGait, PickUpGait, SequenceGait, WalkGait
from mgs.motion_planner.balance import plan_balance
from mgs.motion_planner.keyframes import plan_keyframes
from mgs.motion_planner.kick import plan_kick
from mgs.motion_planner.motion_plan import MotionPlan
from mgs.motion_planner.pick_up import plan_pick_up
from mgs.motion_planner.walk import plan_walk
from mgs.robot import Robot


def plan_motion(robot: Robot, gait: Gait) -> MotionPlan:
    """Stage 1: footsteps and support phases of a gait.

    Raises:
        FootstepError: two soles would overlap.
        InfeasibleGaitError: a footstep on an edge, a leg in the way, a ball too near, a point
            out of a hand's reach.
        ConfigError: a duration does not fit the sampling period or the preview window, or a hand or
            joint is none that this robot can move so.
    """
    if isinstance(gait, SequenceGait):
        raise TypeError("a sequence has a plan for each of its parts")
    if isinstance(gait, WalkGait):
        return plan_walk(robot, gait)
    if isinstance(gait, KeyframesGait):
        return plan_keyframes(robot, gait)
    if isinstance(gait, PickUpGait):
        return plan_pick_up(robot, gait)
    if isinstance(gait, KickGait):
        return plan_kick(robot, gait)
    return plan_balance(robot, gait)
