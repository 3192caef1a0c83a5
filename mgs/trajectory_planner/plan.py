"""The choice of the trajectory planner by the kind of plan."""

from __future__ import annotations

from mgs.motion_planner import MotionPlan
from mgs.trajectory_planner.balance import plan_balance_trajectories
from mgs.trajectory_planner.keys import plan_key_trajectories
from mgs.trajectory_planner.task_trajectory import TaskTrajectory
from mgs.trajectory_planner.walk import plan_walk_trajectories


def plan_trajectories(plan: MotionPlan) -> TaskTrajectory:
    """Stage 2: trajectories of ZMP, soles, hands and torso for a plan.

    Raises:
        InfeasibleGaitError: the CoM is asked to go where it cannot be carried.
    """
    if plan.body is not None:
        return plan_balance_trajectories(plan, plan.body)
    if plan.keys is not None:
        return plan_key_trajectories(plan, plan.keys)
    return plan_walk_trajectories(plan)
