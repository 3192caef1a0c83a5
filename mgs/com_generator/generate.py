"""The choice of the CoM generator."""

from __future__ import annotations

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.com_generator.given import follow_com
from mgs.com_generator.preview import follow_zmp
from mgs.gait import ComParameters
from mgs.trajectory_planner import TaskTrajectory


def generate_com(tasks: TaskTrajectory, parameters: ComParameters | None) -> ComTrajectory:
    """Stage 3: the CoM motion that is asked for, or whose ZMP follows the reference.

    `parameters` are those of the preview control; None will do where the CoM itself is asked for.

    Raises:
        ConfigError: dt, CoM height or weights admit no stabilising gain.
        InfeasibleGaitError: the CoM is not at rest when the motion ends.
    """
    if tasks.com is not None:
        return follow_com(tasks.com, tasks.dt)
    assert parameters is not None
    return follow_zmp(tasks.zmp_ref, tasks.com_height, tasks.dt, parameters)
