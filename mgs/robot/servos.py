"""What a position servo makes of a command, and the command that makes it do what was planned.

A motor behind a gear, driven in proportion to the error of its position loop, at every joint:

    drive  = stiffness (q_command - q)
    motor  = drive - damping v, at most what the line from stall torque to no-load speed leaves
    torque = motor - friction(v)
    friction(v) = viscous_friction v + coulomb(v)

coulomb(v) is the Coulomb friction, reached in proportion to v at `SLIP_SPEED`. The damping of a
motor at constant voltage is its back-EMF, stall torque / no-load speed. Up to the deadband there is
no drive; beyond it the drive is stiffness (|q_command - q| - deadband) + punch. What a servo
measures and what it is told are whole ticks of its encoder.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError
from mgs.robot.robot import Robot

SLIP_SPEED = 0.1  # [rad/s] at which all of the Coulomb friction acts


@dataclass(frozen=True, eq=False)
class Servos:
    """Figures (n,) of the servos of a robot, in the order of its joints."""

    stall_torque: Array  # [N m]
    no_load_speed: Array  # [rad/s]
    stiffness: Array  # [N m/rad]
    damping: Array  # [N m s/rad]
    latency: Array  # [s]
    resolution: Array  # [rad]
    deadband: Array  # [rad]
    punch: Array  # [N m]
    coulomb_friction: Array  # [N m]
    viscous_friction: Array  # [N m s/rad]

    def friction(self, v: Array) -> Array:
        """Torque (..., n) [N m] by which gears brake joints at v (..., n) [rad/s]."""
        sliding = np.minimum(np.maximum(v / SLIP_SPEED, -1.0), 1.0)
        return np.asarray(self.coulomb_friction * sliding + self.viscous_friction * v)


def is_modelled(robot: Robot) -> bool:
    """Whether robot.yaml says of every servo in use how stiff it is."""
    return not _without_stiffness(robot)


def servos_of(robot: Robot) -> Servos:
    """Servos of a robot.

    Raises:
        ConfigError: a servo in use has no stiffness.
    """
    if missing := _without_stiffness(robot):
        raise ConfigError(
            robot.source,
            [
                f"servos.{name}: without a stiffness this servo cannot be modelled; give stiffness "
                "[N m/rad] or compliance_slope, or simulate ideal servos"
                for name in missing
            ],
        )
    specs = [robot.spec.servos[robot.spec.joints[name]] for name in robot.joint_names]

    def figures(name: str) -> Array:
        return np.array([getattr(spec, name) for spec in specs], dtype=np.float64)

    damping, back_emf = figures("damping"), robot.torque_limit / robot.no_load_speed
    return Servos(
        stall_torque=robot.torque_limit,
        no_load_speed=robot.no_load_speed,
        stiffness=figures("spring"),
        damping=np.where(np.isnan(damping), back_emf, damping),  # None is NaN here
        latency=figures("latency"),
        resolution=figures("resolution"),
        deadband=figures("deadband"),
        punch=figures("punch"),
        coulomb_friction=figures("friction"),
        viscous_friction=figures("viscous_friction"),
    )


def _without_stiffness(robot: Robot) -> list[str]:
    used = {robot.spec.joints[name] for name in robot.joint_names}
    return sorted(name for name in used if robot.spec.servos[name].spring is None)
