"""Differential IK by pink on a motion of mgs, with one step per sample.

The tasks are those of the examples of pink: both soles, CoM, torso orientation and a posture task
with a small weight. Limits of joint positions and speeds are inequalities.
"""

from __future__ import annotations

import importlib.metadata
import time
from dataclasses import dataclass

import numpy as np
import pink
import pinocchio as pin
from pink.limits import ConfigurationLimit, VelocityLimit
from pink.tasks import ComTask, FrameTask, PostureTask, Task

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.core.geometry import rotations_from_quat_xyzw
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

QP_SOLVER = "daqp"
SOLE_COST, COM_COST, TORSO_COST, POSTURE_COST = 10.0, 1.0, 1.0, 1e-3


@dataclass(frozen=True, eq=False)
class PinkRun:
    """Times (N,) of the steps [s], and the largest errors of soles and CoM after a step [m]."""

    seconds: Array
    sole_error: float
    com_error: float


class PinkSide:
    """Run of pink on one motion.

    Args:
        robot: robot model.
        tasks: sole and torso references.
        com: CoM reference.
        q0: initial configuration (7 + n,).
        speed_max: largest joint speeds (n,) [rad/s].
    """

    def __init__(
        self,
        robot: Robot,
        tasks: TaskTrajectory,
        com: ComTrajectory,
        q0: Array,
        speed_max: Array,
    ) -> None:
        self.version = importlib.metadata.version("pin-pink")
        self.model = pin.Model(robot.model)  # a copy, because pink modifies the model
        self.q0, self.dt = q0, tasks.dt
        names = [self.model.frames[i].name for i in (*robot.sole_frames, robot.torso_frame)]
        self.soles = [FrameTask(name, SOLE_COST, SOLE_COST) for name in names[:2]]
        self.torso = FrameTask(names[2], 0.0, TORSO_COST)
        self.com, self.posture = ComTask(COM_COST), PostureTask(POSTURE_COST)
        self.posture.set_target(robot.standing_q)
        speed = np.concatenate([np.full(FLOATING_BASE_NV, np.inf), speed_max])
        self.limits = [ConfigurationLimit(self.model), VelocityLimit(self.model, speed)]
        self.sole_targets = [_poses(tasks.soles[:, side]) for side in Side]
        torso = np.concatenate([np.zeros((tasks.n_samples, 3)), tasks.torso], axis=1)
        self.torso_targets, self.com_targets = _poses(torso), com.position

    def run(self) -> PinkRun:
        """Run over the motion once; the times exclude the measurement of errors."""
        data = self.model.createData()
        configuration = pink.Configuration(self.model, data, self.q0)
        tasks: list[Task] = [*self.soles, self.torso, self.com, self.posture]
        seconds = np.empty(len(self.com_targets))
        sole_error = com_error = 0.0
        for k in range(len(seconds)):
            start = time.perf_counter()
            for task, targets in zip(self.soles, self.sole_targets, strict=True):
                task.set_target(targets[k])
            self.torso.set_target(self.torso_targets[k])
            self.com.set_target(self.com_targets[k])
            v = pink.solve_ik(configuration, tasks, self.dt, solver=QP_SOLVER, limits=self.limits)
            configuration.integrate_inplace(v, self.dt)
            seconds[k] = time.perf_counter() - start
            for task in self.soles:
                error = np.linalg.norm(task.compute_error(configuration)[:3])
                sole_error = max(sole_error, float(error))
            error = np.linalg.norm(self.com.compute_error(configuration))
            com_error = max(com_error, float(error))
        return PinkRun(seconds, sole_error, com_error)


def _poses(poses: Array) -> list[pin.SE3]:
    """Poses from positions and quaternions xyzw (N, 7)."""
    rotations = rotations_from_quat_xyzw(poses[:, 3:])
    return [pin.SE3(R, p) for R, p in zip(rotations, poses[:, :3], strict=True)]
