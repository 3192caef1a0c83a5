"""Stage 1: from a gait to footsteps and support phases."""

from mgs.motion_planner.motion_plan import MotionPlan, Phase
from mgs.motion_planner.plan import plan_motion
from mgs.motion_planner.scaling import for_robot

__all__ = ["MotionPlan", "Phase", "for_robot", "plan_motion"]
