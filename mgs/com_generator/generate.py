"""The choice of the CoM generator."""

from __future__ import annotations

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.com_generator.preview import follow_zmp
from mgs.gait import ComParameters
from mgs.trajectory_planner import TaskTrajectory


def generate_com(tasks: TaskTrajectory, parameters: ComParameters) -> ComTrajectory:
    """Stage 3: the CoM motion whose ZMP follows the reference.

    Raises:
        ConfigError: dt, CoM height or weights admit no stabilising gain.
        InfeasibleGaitError: the CoM is not at rest when the motion ends.
    """
    return follow_zmp(tasks.zmp_ref, tasks.com_height, tasks.dt, parameters)
