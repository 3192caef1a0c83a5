"""The choice of the CoM generator."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.com_generator.from_positions import follow_com
from mgs.com_generator.preview import follow_zmp
from mgs.gait import ComParameters
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory


def generate_com(
    tasks: TaskTrajectory, parameters: ComParameters | None, robot: Robot | None = None
) -> ComTrajectory:
    """Stage 3: the CoM motion that is asked for, or that the ZMP asks for.

    `parameters` may be None where the CoM itself is asked for; only the QP has to know the robot,
    whose soles bound the ZMP.

    Raises:
        ConfigError: dt, CoM height or weights admit no stabilising gain.
        InfeasibleGaitError: the CoM is not at rest when the motion ends, or the ZMP cannot keep
            its margin.
    """
    if tasks.com is not None:
        return follow_com(tasks.com, tasks.dt)
    assert parameters is not None
    if parameters.generator == "qp":
        from mgs.com_generator.qp import bound_zmp  # sparse algebra that preview control spares us

        assert robot is not None
        return bound_zmp(robot, tasks, parameters)
    return follow_zmp(tasks.zmp_ref, tasks.com_height, tasks.dt, parameters)


def planned_zmp(
    tasks: TaskTrajectory, com: ComTrajectory, parameters: ComParameters
) -> NDArray[np.float64]:
    """Where the ZMP (N, 2) of the whole robot shall be.

    That is the reference of stage 2; the QP departs from it on purpose, and there it is the ZMP of
    its cart-table, which keeps the margin.
    """
    return com.zmp if parameters.generator == "qp" else tasks.zmp_ref
