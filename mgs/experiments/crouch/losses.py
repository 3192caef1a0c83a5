"""Electric power of servos whose motors and gears have been identified.

A direct-current motor with torque constant k and resistance R, both at the joint, that has to give
the torque m draws

    P = m v + (R / k^2) m^2 ,   m = tau + friction(v, tau)

with tau the torque at the joint and the friction law of `mgs.robot.friction`. Power that flows back
is not recovered.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.motion import Motion
from mgs.robot import Robot, servos_of
from mgs.robot.identified import MOTORS


def copper_factor(robot: Robot) -> Array | None:
    """R / k^2 (n,) of the servos [W/(N m)^2]; None: robot.yaml names no model for one of them."""
    specs = [robot.spec.servos[robot.servo_of(name)] for name in robot.joint_names]
    factors = []
    for spec in specs:
        if spec.model is None:
            return None
        motor = MOTORS[spec.model]
        factors.append(motor.resistance / motor.torque_constant**2)
    return np.array(factors)


def electric_power(motion: Motion) -> Array | None:
    """Electric power (N,) of all servos [W]; None: they are not identified."""
    robot = motion.robot
    factor = copper_factor(robot)
    if factor is None:
        return None
    v, torque = motion.v[:, FLOATING_BASE_NV:], motion.torque
    servos = servos_of(robot)
    motor = torque + np.array(
        [servos.friction_under_load(*row) for row in zip(v, torque, strict=True)]
    )
    power = motor * v + factor * motor**2
    return np.asarray(np.maximum(power, 0.0).sum(axis=1))
