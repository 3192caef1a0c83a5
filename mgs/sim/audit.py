"""Proof that an engine has loaded the robot that Pinocchio knows.

URDF importers drop, merge, weld or invent bodies in silence; a replay of another robot proves
nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.errors import SimulationError
from mgs.robot import Robot

MASS_TOLERANCE = 1e-3  # [kg]
LENGTH_TOLERANCE = 1e-3  # [m]
ANGLE_TOLERANCE = 1e-3  # [rad]
LIMIT_TOLERANCE = 1e-4  # [rad] and [N m]
INERTIA_TOLERANCE = 0.01  # of the largest entry
N_POSES = 3


@dataclass(frozen=True, eq=False)
class EngineModel:
    """A robot as an engine understands it."""

    joints: dict[str, tuple[float, float, float]]  # lower, upper [rad], torque limit [N m] by name
    mass: float  # [kg]
    com: Array  # (3,) at the current state, world frame [m]
    inertia: Array  # (n, n) in the space of `Robot.joint_names`, rotors left out [kg m^2]
    links: Array  # (1 + n, 7) poses of the base and of the links that `Robot.joint_names` move


class Inspected(Protocol):
    """The part of an engine that the audit needs."""

    def place(self, q: Array) -> None:
        """Put the robot at q, at rest."""

    def inspect(self) -> EngineModel:
        """The robot as the engine understands it, at the current q."""


def audit(engine: Inspected, robot: Robot, name: str) -> None:
    """Compare an engine's model with Pinocchio's at a few random poses.

    Raises:
        SimulationError: joints, limits, mass, inertia, CoM or link frames differ; lists them all.
    """
    rng = np.random.default_rng(0)
    problems = _compare_figures(engine.inspect(), robot)
    for _ in range(0 if problems else N_POSES):
        q = random_q(robot, rng)
        engine.place(q)
        problems += _compare_pose(engine.inspect(), robot, q)
    if problems:
        raise SimulationError(
            f"{name} has loaded another robot than {robot.spec.name}: {'; '.join(problems)}"
        )


def random_q(robot: Robot, rng: np.random.Generator) -> Array:
    """Random configuration (7 + n,): base within 1 m of the origin, joints inside their limits."""
    base = pin.SE3(pin.Quaternion(*_unit(rng.normal(size=4))).matrix(), rng.uniform(-1, 1, 3))
    return np.concatenate([pin.SE3ToXYZQUAT(base), rng.uniform(robot.lower, robot.upper)])


def _unit(vector: Array) -> Array:
    return vector / np.linalg.norm(vector)


def _compare_figures(model: EngineModel, robot: Robot) -> list[str]:
    if set(model.joints) != set(robot.joint_names):
        odd = sorted(set(model.joints) ^ set(robot.joint_names))
        return [f"joints that only one of the two has: {', '.join(odd)}"]
    problems = []
    if abs(model.mass - robot.mass) > MASS_TOLERANCE:
        problems.append(f"mass {model.mass:.4f} kg instead of {robot.mass:.4f} kg")
    expected = np.stack([robot.lower, robot.upper, robot.torque_limit], axis=1)
    for name, limits in zip(robot.joint_names, expected, strict=True):
        if not np.allclose(model.joints[name], limits, rtol=0.0, atol=LIMIT_TOLERANCE):
            problems.append(f"lower, upper and torque limit of {name} are {model.joints[name]}")
    return problems


def _compare_pose(model: EngineModel, robot: Robot, q: Array) -> list[str]:
    data = robot.model.createData()
    com = pin.centerOfMass(robot.model, data, q)
    problems = []
    inertia = pin.crba(robot.model, data, q)[FLOATING_BASE_NV:, FLOATING_BASE_NV:]
    excess = np.abs(np.triu(model.inertia - inertia)).max() / np.abs(inertia).max()
    if excess > INERTIA_TOLERANCE:
        problems.append(f"inertia at the joints is {100 * excess:.1f} % off")
    if (offset := np.linalg.norm(model.com - com)) > LENGTH_TOLERANCE:
        problems.append(f"CoM is {1e3 * offset:.2f} mm off")
    for joint, pose in enumerate(model.links, start=1):
        error = data.oMi[joint].actInv(pin.XYZQUATToSE3(pose))
        shift = np.linalg.norm(error.translation)
        turn = np.linalg.norm(pin.log3(error.rotation))
        if shift > LENGTH_TOLERANCE or turn > ANGLE_TOLERANCE:
            moved_by = robot.model.names[joint]
            problems.append(f"link of {moved_by} is {1e3 * shift:.2f} mm and {turn:.4f} rad off")
    return problems
