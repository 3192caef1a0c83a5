"""Stage 2: from a plan to trajectories of ZMP, soles, hands, torso and CoM height."""

from mgs.trajectory_planner.keys import plan_posture_trajectory
from mgs.trajectory_planner.plan import plan_trajectories
from mgs.trajectory_planner.task_trajectory import (
    PostureTrajectory,
    PreferredPosture,
    TaskTrajectory,
)

__all__ = [
    "PostureTrajectory",
    "PreferredPosture",
    "TaskTrajectory",
    "plan_posture_trajectory",
    "plan_trajectories",
]
