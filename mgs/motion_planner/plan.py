"""The choice of the planner by the kind of gait."""

from __future__ import annotations

from mgs.gait import (
    Gait,
    KeyframesGait,
    KickGait,
    PickUpGait,
    RecordedGait,
    SequenceGait,
    WalkGait,
)
from mgs.motion_planner.motion_plan import MotionPlan
from mgs.robot import Robot


def plan_motion(robot: Robot, gait: Gait) -> MotionPlan:
    """Stage 1: the plan of a gait, of the type that belongs to its kind.

    Raises:
        FootstepError: two soles would overlap.
        InfeasibleGaitError: a footstep lies on an edge, a leg is in the way, a ball is too near, or
            a hand cannot reach a point.
        ConfigError: a duration does not fit the sampling period, or the robot has no such joint or
            cannot move the hand or turn the sole that the gait names.
        TypeError: the gait is a sequence, which has a plan for each of its parts, or that of a
            recorded motion, which nobody planned.
    """
    if isinstance(gait, SequenceGait):
        raise TypeError("a sequence has a plan for each of its parts, not one of its own")
    if isinstance(gait, RecordedGait):
        raise TypeError("a recorded motion has no plan")
    # Each branch imports its own planner, so that a walk loads no code of the other kinds.
    if isinstance(gait, WalkGait):
        from mgs.motion_planner.walk import plan_walk

        return plan_walk(robot, gait)
    if isinstance(gait, KickGait):
        from mgs.motion_planner.kick import plan_kick

        return plan_kick(robot, gait)
    if isinstance(gait, PickUpGait):
        from mgs.motion_planner.pick_up import plan_pick_up

        return plan_pick_up(robot, gait)
    if isinstance(gait, KeyframesGait):
        from mgs.motion_planner.keyframes import plan_keyframes, plan_postures

        return plan_keyframes(robot, gait) if gait.is_balanced else plan_postures(robot, gait)
    from mgs.motion_planner.balance import plan_balance

    return plan_balance(robot, gait)
