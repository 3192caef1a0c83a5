"""Model of position servos: a geared DC motor with a proportional position loop at every joint.

    drive  = stiffness (q_command - q)
    motor  = drive - damping v, clipped to the line from stall torque to no-load speed
    torque = motor - friction(v)
    friction(v) = viscous_friction v + coulomb(v)

The magnitude of coulomb(v) grows in proportion to |v| up to `SLIP_SPEED` and is constant above.
The damping of a motor at constant voltage is caused by its back-EMF: stall torque / no-load speed.
Within the deadband the drive is 0; outside, it is stiffness (|q_command - q| - deadband) + punch.
Measured angles and commands are rounded to whole ticks of the encoder.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError
from mgs.core.short_repr import short_repr
from mgs.robot.friction import LoadFriction, load_friction
from mgs.robot.identified import NO_FRICTION
from mgs.robot.robot import Robot
from mgs.robot.servo_spec import ServoSpec

Bools = NDArray[np.bool_]

SLIP_SPEED = 0.1  # [rad/s] speed from which on the full Coulomb friction acts


@dataclass(frozen=True, eq=False)
class Servos:
    """Parameters (n,) of the servos of a robot, in the order of its joints."""

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
    brakes_beyond_stall: Bools  # whether a motor brakes with more than its stall torque
    load_friction: LoadFriction | None = None  # in place of Coulomb and viscous friction

    __repr__ = short_repr

    def friction(self, v: Array) -> Array:
        """Friction torque (..., n) [N m] of the gears at joint velocities v (..., n) [rad/s].

        Friction that depends on the load is left out.
        """
        sliding = np.minimum(np.maximum(v / SLIP_SPEED, -1.0), 1.0)
        return np.asarray(self.coulomb_friction * sliding + self.viscous_friction * v)

    def friction_under_load(self, v: Array, torque: Array) -> Array:
        """All friction (..., n) [N m] at joint velocities v [rad/s] and joint torques [N m]."""
        friction = self.friction(v)
        if self.load_friction is None:
            return friction
        sliding = np.minimum(np.maximum(v / SLIP_SPEED, -1.0), 1.0)
        return np.asarray(friction + sliding * self.load_friction.to_overcome(v, torque))


def is_modelled(robot: Robot) -> bool:
    """True if robot.yaml gives a stiffness for every servo in use."""
    return not _without_stiffness(robot)


def servos_of(robot: Robot) -> Servos:
    """Servo parameters of a robot.

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
    specs = [robot.spec.servos[robot.servo_of(name)] for name in robot.joint_names]

    motors = robot.motors  # a joint that follows another one has nothing of its own but its bearing

    def figures(name: str) -> Array:
        return np.array([getattr(spec, name) for spec in specs], dtype=np.float64)

    def of_motors(values: Array) -> Array:
        return np.where(motors, values, 0.0)

    damping, back_emf = figures("damping"), robot.torque_limit / robot.no_load_speed
    return Servos(
        stall_torque=robot.torque_limit,
        no_load_speed=robot.no_load_speed,
        stiffness=of_motors(figures("spring")),
        damping=of_motors(np.where(np.isnan(damping), back_emf, damping)),  # None is NaN here
        latency=figures("latency"),
        resolution=figures("resolution"),
        deadband=figures("deadband"),
        punch=of_motors(figures("punch")),
        coulomb_friction=of_motors(figures("friction")),
        viscous_friction=of_motors(figures("viscous_friction")),
        brakes_beyond_stall=np.array([spec.model is not None for spec in specs]),
        load_friction=_load_friction(specs, motors),
    )


def _load_friction(specs: list[ServoSpec], motors: Bools) -> LoadFriction | None:
    parameters = [
        spec.friction_parameters if has_motor else None
        for spec, has_motor in zip(specs, motors, strict=True)
    ]
    if not any(parameters):
        return None
    return load_friction([NO_FRICTION if found is None else found for found in parameters])


def servo_sources(robot: Robot) -> dict[str, str]:
    """Where the figures of the servos in use come from, by the names of the servo models."""
    used = sorted({robot.servo_of(name) for name in robot.joint_names})
    return {name: robot.spec.servos[name].source for name in used}


def pd_servos(robot: Robot, sag: Array | float, damping_time: float) -> Servos:
    """Plain PD servos, of which only stall torque and no-load speed are known.

    torque = stiffness ((q_command - q) - damping_time v), within the line from stall torque to
    no-load speed; stiffness = stall torque / sag.

    Args:
        robot: whose stall torques and no-load speeds they have.
        sag: error of the angle at stall torque, one for all joints or (n,) [rad].
        damping_time: damping relative to the stiffness [s].
    """
    none, stiffness = np.zeros(robot.n), np.where(robot.motors, robot.torque_limit / sag, 0.0)
    return Servos(
        stall_torque=robot.torque_limit,
        no_load_speed=robot.no_load_speed,
        stiffness=stiffness,
        damping=damping_time * stiffness,
        latency=none,
        resolution=none,
        deadband=none,
        punch=none,
        coulomb_friction=none,
        viscous_friction=none,
        brakes_beyond_stall=np.zeros(robot.n, dtype=np.bool_),
    )


def _without_stiffness(robot: Robot) -> list[str]:
    used = {robot.servo_of(name) for name in robot.joint_names}
    return sorted(name for name in used if robot.spec.servos[name].spring is None)
