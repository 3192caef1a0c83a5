"""Stage 2: from footsteps and channels to the trajectories of ZMP, soles, hands, torso and CoM."""

from mgs.trajectory_planner.plan import plan_trajectories
from mgs.trajectory_planner.task_trajectory import TaskTrajectory

__all__ = ["TaskTrajectory", "plan_trajectories"]
