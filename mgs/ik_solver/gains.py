"""Gains of the joint-limit and gravity-torque objectives: scale, change over time, upper bounds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Support
from mgs.core.errors import ConfigError
from mgs.core.spans import spans
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.robot import Robot

REFERENCE_MOMENT = 0.70  # [kg m] mass times CoM height of the robot whose gains were chosen first
DIFFERENCE_STEP = 1e-5  # [rad] of the central differences of the gradient


def gravity_scale(robot: Robot, com_height: float) -> float:
    """Factor s^2 of W = s^2 I [1/(N m)^2], with which a gain means the same on every robot."""
    return float((REFERENCE_MOMENT / (robot.mass * com_height)) ** 2)


def gravity_gain_profile(support: NDArray[np.int8], dt: float, ramp: float) -> Array:
    """Factor (N,) on gamma_grav: 1 in single support, falling to 0 over `ramp` [s] at its ends."""
    factor = np.zeros(len(support))
    for start, end in spans(support):
        if support[start] != Support.DOUBLE:
            k = np.arange(start, end)
            width = min(ramp, 0.5 * (end - start) * dt)
            factor[start:end] = np.clip(np.minimum(k - start, end - k) * dt / width, 0.0, 1.0)
    return factor


def rest_profile(n_samples: int, dt: float, ramp: float) -> Array:
    """Factor (N,) on all null-space motion: 0 at both ends of the motion, 1 beyond `ramp` [s]."""
    k = np.arange(n_samples)
    return np.clip(np.minimum(k, n_samples - 1 - k) * dt / ramp, 0.0, 1.0)


def refuse_stiff_joint_gain(robot: Robot, gamma_joint: float, dt: float) -> None:
    """Raise ConfigError where an explicit step of dt [s] down grad H_joint would overshoot."""
    product = dt * gamma_joint * float((1.0 / (robot.upper - robot.lower) ** 2).max())
    _refuse_stiff("gamma_joint", gamma_joint, product, dt, robot)


def refuse_stiff_gravity_gain(
    robot: Robot, tree: TreeTasks, q: Array, gamma_grav: float, scale: float, dt: float
) -> None:
    """Raise ConfigError where an explicit step of dt [s] down grad H_grav would overshoot.

    The curvature is that in the null space of the tasks at joint angles q (n,) in the tree's order,
    by central differences of the gradient; `scale` is the factor of `gravity_scale`.
    """
    gradients = []
    for i in range(len(q)):
        for sign in (1.0, -1.0):
            moved = q.copy()
            moved[i] += sign * DIFFERENCE_STEP
            tau, dtau = tree.at_motors(*tree.gravity(moved))
            gradients.append(tau @ dtau)
    hessian = (np.array(gradients[::2]) - np.array(gradients[1::2])) / (2.0 * DIFFERENCE_STEP)
    tree.update(q)
    projector = np.eye(len(q)) - np.linalg.pinv(tree.J) @ tree.J
    curvature = np.linalg.eigvalsh(projector @ (0.5 * (hessian + hessian.T)) @ projector)[-1]
    _refuse_stiff("gamma_grav", gamma_grav, dt * gamma_grav * scale * curvature, dt, robot)


def _refuse_stiff(key: str, gain: float, product: float, dt: float, robot: Robot) -> None:
    """Raise ConfigError where the product of step, gain and curvature reaches 1."""
    if product >= 1.0:
        raise ConfigError(
            f"ik.{key}",
            f"{gain:g} is too stiff for dt = {dt:g} s on {robot.spec.name}; "
            f"use a value below {gain / product:.3g}, or a smaller dt",
        )
