"""The choice of the IK solver."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from mgs.com_generator import ComTrajectory
from mgs.core.errors import ConfigError, InfeasibleGaitError
from mgs.core.progress import Progress
from mgs.gait import IkParameters
from mgs.ik_solver.clik import ClosedLoopIk
from mgs.ik_solver.hard_soft import FarajiIk
from mgs.ik_solver.joint_trajectory import JointTrajectory
from mgs.ik_solver.prioritized import PrioritizedIk
from mgs.ik_solver.whole_motion import TrajectoryIk
from mgs.robot import Robot
from mgs.robot.legs import missing_turn
from mgs.trajectory_planner import TaskTrajectory


class IkSolver(Protocol):
    """Frozen tuning and one method that takes the whole task trajectory."""

    @classmethod
    def from_parameters(cls, parameters: IkParameters) -> IkSolver:
        """Solver with the tuning of a gait file."""
        ...

    def solve(
        self,
        robot: Robot,
        tasks: TaskTrajectory,
        com: ComTrajectory,
        progress: Progress | None = None,
    ) -> JointTrajectory:
        """Joint angles that meet the tasks at every sample.

        `progress` is called with samples done and samples in all.

        Raises:
            IkError: a task is missed.
            JointLimitError: a joint leaves its range.
        """
        ...


SOLVERS: dict[str, type[IkSolver]] = {
    "clik": ClosedLoopIk,
    **{f"ik{method}": FarajiIk for method in range(1, 6)},
    "prioritized": PrioritizedIk,
    "prioritized-acceleration": PrioritizedIk,
    "trajectory": TrajectoryIk,
}


def solve_ik(
    robot: Robot,
    tasks: TaskTrajectory,
    com: ComTrajectory,
    parameters: IkParameters,
    progress: Progress | None = None,
) -> JointTrajectory:
    """Stage 4: joint angles that meet the tasks; see `IkSolver.solve` for the errors.

    Raises:
        ConfigError: as well as the solver's own, where legs lack a turn of the sole that only clik
            does without.
    """
    turn = missing_turn(robot)
    if turn is not None and parameters.solver != "clik":
        raise ConfigError(
            "ik.solver",
            f"{parameters.solver} needs legs that turn their soles in {turn}, which those of "
            f"{robot.spec.name} cannot; use clik",
        )
    solver = SOLVERS[parameters.solver].from_parameters(parameters)
    try:
        return solver.solve(robot, tasks, com, progress)
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        raise InfeasibleGaitError(
            f"ik.solver {parameters.solver}: {error}; the motion has probably run away from its "
            "tasks: ask for less, or take ik4, which keeps within limits"
        ) from error
