"""An IK solver and a CoM generator from another package; docs/plug-ins.md explains them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from pydantic import BaseModel, Field
from scipy.linalg import solve_banded

from mgs.com_generator import ComTrajectory
from mgs.gait import ComParameters, IkParameters
from mgs.ik_solver import JointTrajectory
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory


class Tuning(BaseModel):
    updates: int = Field(4, ge=1, le=50, description="Newton updates per sample.")


@dataclass(frozen=True)
class NewtonIk:
    updates: int
    Parameters = Tuning

    @classmethod
    def from_parameters(cls, parameters: IkParameters) -> NewtonIk:
        return cls(**parameters.parameters)

    def solve(
        self, robot: Robot, tasks: TaskTrajectory, com: ComTrajectory, progress=None
    ) -> JointTrajectory:
        model, data, q = robot.model, robot.model.createData(), robot.standing_q.copy()
        angles = np.empty((tasks.n_samples, robot.n))
        for k in range(tasks.n_samples):
            for _ in range(self.updates):
                J = [pin.jacobianCenterOfMass(model, data, q)]
                error = [com.position[k] - data.com[0]]
                pin.updateFramePlacements(model, data)
                for frame, hand in zip(robot.hand_frames, tasks.hands[k], strict=True):
                    J.append(pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3])
                    error.append(com.position[k] + hand - data.oMf[frame].translation)
                for frame, sole in zip(robot.sole_frames, tasks.soles[k], strict=True):
                    J.append(pin.getFrameJacobian(model, data, frame, pin.LOCAL))
                    error.append(pin.log(data.oMf[frame].actInv(pin.XYZQUATToSE3(sole))).vector)
                step = np.linalg.lstsq(np.concatenate(J), np.concatenate(error), rcond=None)[0]
                q = pin.integrate(model, q, step)
            angles[k] = q[7:]
        return JointTrajectory(angles)


@dataclass(frozen=True)
class CartTable:
    """c - com_height / g d2c/dt2 = zmp_ref as a boundary value problem, at rest at both ends."""

    @classmethod
    def from_parameters(cls, parameters: ComParameters) -> CartTable:
        return cls()

    def generate(self, robot: Robot, tasks: TaskTrajectory) -> ComTrajectory:
        lever = tasks.com_height / (9.81 * tasks.dt**2)
        bands = np.stack([-lever, 1.0 + 2.0 * lever, -lever])
        bands[:, [0, -1]] = [[0.0, 0.0], [1.0, 1.0], [0.0, 0.0]]
        bands[0, 1:], bands[2, :-1] = bands[0, :-1].copy(), bands[2, 1:].copy()
        xy = solve_banded((1, 1), bands, tasks.zmp_ref)
        position = np.column_stack([xy, tasks.com_height])
        velocity = np.gradient(position, tasks.dt, axis=0)
        acceleration = np.zeros_like(position)
        acceleration[1:-1] = np.diff(position, 2, axis=0) / tasks.dt**2
        zmp = xy - tasks.com_height[:, None] / 9.81 * acceleration[:, :2]
        return ComTrajectory(position, velocity, acceleration, zmp)
