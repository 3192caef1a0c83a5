"""The choice of the IK solver."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from mgs.com_generator import ComTrajectory
from mgs.core.errors import ConfigError, InfeasibleGaitError, MgsError
from mgs.core.plugins import IK_SOLVERS
from mgs.core.progress import Progress
from mgs.gait import IkParameters
from mgs.ik_solver.joint_trajectory import JointTrajectory
from mgs.robot import Robot
from mgs.robot.legs import missing_turn
from mgs.trajectory_planner import TaskTrajectory

KNOW_COUPLED = ("clik", "ik1", "ik2", "ik3", "ik4", "ik5")  # solvers that know coupled joints


class IkSolver(Protocol):
    """Frozen tuning and one method that takes the whole task trajectory.

    A class attribute `Parameters`, a pydantic model, declares the keys of the block
    `ik.parameters` where the solver comes from another package.
    """

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


def solve_ik(
    robot: Robot,
    tasks: TaskTrajectory,
    com: ComTrajectory,
    parameters: IkParameters,
    progress: Progress | None = None,
) -> JointTrajectory:
    """Stage 4: joint angles that meet the tasks; see `IkSolver.solve` for the errors.

    Raises:
        ConfigError: nothing of the solver's name is installed, legs lack a turn of the sole that
            only clik does without, or joints are coupled, which few solvers know.
        MgsError: a solver of another package returns joint angles of a wrong shape.
    """
    if robot.followers and parameters.solver not in KNOW_COUPLED:
        raise ConfigError(
            "ik.solver",
            f"{parameters.solver} moves every joint by itself, but joints of {robot.spec.name} are "
            f"coupled ({', '.join(robot.followers)}); use clik or ik1 to ik5",
        )
    turn = missing_turn(robot)
    if turn is not None and parameters.solver != "clik":
        raise ConfigError(
            "ik.solver",
            f"{parameters.solver} needs legs that turn their soles in {turn}, which those of "
            f"{robot.spec.name} cannot; use clik",
        )
    solver = IK_SOLVERS.load(parameters.solver).from_parameters(parameters)
    try:
        joints: JointTrajectory = solver.solve(robot, tasks, com, progress)
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        raise InfeasibleGaitError(
            f"ik.solver {parameters.solver}: {error}; the motion has probably run away from its "
            "tasks: ask for less, or take ik4, which keeps within limits"
        ) from error
    expected = (tasks.n_samples, robot.n)
    if joints.angles.shape != expected or not np.isfinite(joints.angles).all():
        raise MgsError(
            f"ik.solver {parameters.solver}: joint angles have shape {joints.angles.shape} or are "
            f"not finite; they have to be {expected} finite numbers"
        )
    return joints
