"""Stage 2: from footsteps to the trajectories of ZMP, soles and hands."""

from mgs.trajectory_planner.trajectories import TaskTrajectory, plan_trajectories

__all__ = ["TaskTrajectory", "plan_trajectories"]
