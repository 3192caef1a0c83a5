"""Electric power and current of the joints, from a model of their motors.

A direct-current motor with supply voltage V, stall torque T and no-load speed w has the torque
constant k = V / w and the resistance R = V k / T, both at the joint. It draws the current
i = tau / k and the power

    P = tau qdot + R i^2 = tau qdot + (w / T) tau^2 ,

so that the voltage drops out of the losses. Power that flows back is not recovered: a negative P of
a joint counts as zero in the consumption of the robot. Friction and electronics are left out.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.experiments.faraji.measures import speeds_of_joints
from mgs.experiments.faraji.runs import Run
from mgs.robot import Robot

SUPPLY = 24.0  # [V] assumed; a factor of the current only


def power_of_joints(robot: Robot, run: Run) -> Array:
    """Electric power (m, n) of the joints in the window [W]; negative: flows back."""
    torque = run.stages.motion.torque[run.window]
    loss = robot.no_load_speed / robot.torque_limit
    return np.asarray(torque * speeds_of_joints(run) + loss * torque**2)


def current_of_joints(robot: Robot, run: Run) -> Array:
    """Magnitude of the motor currents (m, n) in the window [A], with the sign of the power.

    A current is negative where the motor brakes and its power flows back.
    """
    torque = run.stages.motion.torque[run.window]
    driving = np.where(torque * speeds_of_joints(run) < 0.0, -1.0, 1.0)
    return np.asarray(driving * np.abs(torque) * robot.no_load_speed / SUPPLY)


def consumption(robot: Robot, run: Run) -> tuple[float, float, float]:
    """Mean electric power [W], mean sum |tau qdot| [W] and mean sum tau^2 [(N m)^2]."""
    torque = run.stages.motion.torque[run.window]
    electric = np.maximum(power_of_joints(robot, run), 0.0)
    work = np.abs(torque * speeds_of_joints(run))
    return (
        float(electric.sum(axis=1).mean()),
        float(work.sum(axis=1).mean()),
        float((torque**2).sum(axis=1).mean()),
    )


def fitted_line(x: Array, y: Array) -> tuple[float, float, float]:
    """Slope, intercept and coefficient of determination of the least-squares line of y over x."""
    slope, intercept = np.polyfit(x, y, 1)
    rest = y - (slope * x + intercept)
    return (
        float(slope),
        float(intercept),
        float(1.0 - np.sum(rest**2) / np.sum((y - y.mean()) ** 2)),
    )
