"""The choice of the trajectory planner by the type of plan."""

from __future__ import annotations

from mgs.motion_planner import BalancePlan, KeyframePlan, WalkPlan
from mgs.trajectory_planner.task_trajectory import TaskTrajectory


def plan_trajectories(plan: WalkPlan | BalancePlan | KeyframePlan) -> TaskTrajectory:
    """Stage 2: references of ZMP, soles, hands, torso and CoM height for a motion in balance.

    A `PosturePlan` has no such references; `plan_posture_trajectory` plans its joint angles.

    Raises:
        ComOutsideFeetError: the CoM is asked to go sideways beyond both feet.
    """
    # Only the planner of this kind of plan is imported, see `mgs.motion_planner.plan`.
    if isinstance(plan, WalkPlan):
        from mgs.trajectory_planner.walk import plan_walk_trajectories

        return plan_walk_trajectories(plan)
    if isinstance(plan, BalancePlan):
        from mgs.trajectory_planner.balance import plan_balance_trajectories

        return plan_balance_trajectories(plan)
    from mgs.trajectory_planner.keys import plan_key_trajectories

    return plan_key_trajectories(plan)
