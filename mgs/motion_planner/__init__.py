"""Stage 1: from a gait to footsteps and support phases."""

from mgs.motion_planner.motion_plan import MotionPlan, Phase
from mgs.motion_planner.plan import plan_motion

__all__ = ["MotionPlan", "Phase", "plan_motion"]
