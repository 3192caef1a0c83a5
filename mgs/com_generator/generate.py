"""Stage 3: the CoM motion whose ZMP follows the reference, by the generator that the gait names."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.errors import MgsError
from mgs.core.plugins import COM_GENERATORS
from mgs.gait import ComParameters
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

FOLLOWS_REFERENCE = "preview"  # the one generator whose planned ZMP is the reference itself


class ComGenerator(Protocol):
    """Frozen tuning and one method that takes the whole task trajectory.

    A class attribute `Parameters`, a pydantic model, declares the keys of the block
    `com.parameters` where the generator comes from another package.
    """

    @classmethod
    def from_parameters(cls, parameters: ComParameters) -> ComGenerator:
        """Generator with the tuning of a gait file."""
        ...

    def generate(self, robot: Robot, tasks: TaskTrajectory) -> ComTrajectory:
        """CoM motion from rest to rest at tasks.com_height whose ZMP stays near tasks.zmp_ref.

        Raises:
            ConfigError: the tuning admits no solution for this sampling period or CoM height.
            InfeasibleGaitError: the robot cannot do it.
        """
        ...


def generate_com(robot: Robot, tasks: TaskTrajectory, parameters: ComParameters) -> ComTrajectory:
    """CoM motion for a ZMP reference, by the generator `parameters.generator`.

    Raises:
        ConfigError: sampling period, CoM height or weights admit no stabilising gain, or nothing
            of the generator's name is installed.
        InfeasibleGaitError: the CoM is not at rest when the motion ends, or the ZMP cannot keep
            its margin.
        MgsError: a generator of another package returns arrays of a wrong shape.
    """
    generator = COM_GENERATORS.load(parameters.generator).from_parameters(parameters)
    com: ComTrajectory = generator.generate(robot, tasks)
    shapes = {"position": 3, "velocity": 3, "acceleration": 3, "zmp": 2}
    for name, columns in shapes.items():
        _refuse_malformed(parameters.generator, name, getattr(com, name), tasks.n_samples, columns)
    return com


def _refuse_malformed(generator: str, name: str, array: Array, n: int, columns: int) -> None:
    if array.shape != (n, columns) or not np.isfinite(array).all():
        raise MgsError(
            f"com.generator {generator}: {name} has shape {array.shape} or is not finite; it has "
            f"to be {(n, columns)} finite numbers"
        )


def planned_zmp(tasks: TaskTrajectory, com: ComTrajectory, parameters: ComParameters) -> Array:
    """Where the ZMP (N, 2) of the whole robot is planned [m].

    Preview control follows the reference of stage 2. Any other generator may depart from it on
    purpose, as the QP does; there the plan is the ZMP of its own cart-table model.
    """
    return tasks.zmp_ref if parameters.generator == FOLLOWS_REFERENCE else com.zmp
