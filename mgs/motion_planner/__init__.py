"""Stage 1: from a gait to footsteps, support phases and keys of the body."""

from mgs.motion_planner.motion_plan import (
    BalancePlan,
    FootRoll,
    KeyframePlan,
    MotionPlan,
    Phase,
    PosturePlan,
    WalkPlan,
)
from mgs.motion_planner.plan import plan_motion
from mgs.motion_planner.scaling import for_robot

__all__ = [
    "BalancePlan",
    "FootRoll",
    "KeyframePlan",
    "MotionPlan",
    "Phase",
    "PosturePlan",
    "WalkPlan",
    "for_robot",
    "plan_motion",
]
