"""Servos with finite stiffness, speed and attention, stepped together with either engine.

The law is that of mgs.robot.servos, evaluated at the beginning of every physics step. Beside the
torque it gives the speed at which that torque would be zero: a motor pushes towards this speed and
not past it. An engine that lets the torque stop there has the damping right however light the link.
"""

from __future__ import annotations

import dataclasses
from typing import NamedTuple, Protocol

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.robot import Robot, Servos, pd_servos, servos_of
from mgs.sim.settings import ServoName, Settings

Bools = NDArray[np.bool_]

NO_TICK = 1e-12  # [rad] resolution of a servo that has none
LEAST_DAMPING = 1e-9  # [N m s/rad]; where it is 0 the speed-torque line ends a motion
STILL = 1e-3  # [rad/s] below which dry friction holds a joint
AT_LIMIT = 1e-3  # of the stall torque: so near the speed-torque line a servo is at its limit


class Driven(NamedTuple):
    """What servos did in k physics steps."""

    torque: Array  # (k, n) [N m]
    limited: Bools | None  # (k, n) whether a servo is at its limit; None: where at stall torque


class JointState(NamedTuple):
    """Joints at the end of a physics step, and what was done to them in it."""

    position: Array  # (n,) [rad]
    velocity: Array  # (n,) [rad/s]
    torque: Array  # (n,) [N m]


class DryFriction(NamedTuple):
    """Friction that takes up any torque up to a bound, at joints that move or stand still."""

    bound: Array  # (n,) [N m], 0 where there is none
    velocity: Array  # (n,) of the joints [rad/s]
    external: Array  # (n,) torques besides those of the servos, in the step before [N m]
    brake: Array  # (n,) torque that the motor loses with speed [N m s/rad]


class Pushed(Protocol):
    """The part of an engine that modelled servos need."""

    @property
    def rotors(self) -> Array:
        """Inertia (n,) that the engine adds at the joints for the rotors [kg m^2]."""

    def joints(self) -> JointState:
        """Current state of the joints."""

    def push(
        self, torque: Array, free_speed: Array, friction: DryFriction | None = None
    ) -> JointState:
        """Make one step with torques (n,) [N m] that would be zero at free_speed (n,) [rad/s]."""


def servo_figures(
    robot: Robot, servo: ServoName, settings: Settings, gain: Array | float = 1.0
) -> Servos:
    """Figures of the servos of a robot that are not ideal.

    Args:
        robot: whose stall torques and no-load speeds they have.
        servo: "pd", or anything else for those that robot.yaml describes.
        settings: sag and damping time of PD servos.
        gain: factor on the stiffness, one for all joints or (n,).

    Raises:
        ConfigError: robot.yaml is asked and a servo in use has no stiffness.
    """
    if servo == "pd":
        return pd_servos(robot, settings.sag / gain, settings.damping_time)
    servos = servos_of(robot)
    return dataclasses.replace(servos, stiffness=gain * servos.stiffness)


def with_friction(
    torque: Array, free_speed: Array, friction: DryFriction
) -> tuple[Array, Array, Array]:
    """Motors that push and rub, for an engine whose motors aim at a speed with a limited torque.

    A joint that moves, or is about to, is braked by all of the friction, and not past standing
    still. One that stands still is held there with the bound of the friction as the limit, and the
    torque has to act against it.

    Returns:
        torque: limit (n,) of each motor [N m].
        free_speed: the speed (n,) that it aims at [rad/s].
        against: the torque (n,) that acts besides the motor [N m].
    """
    bound, v, external, brake = friction
    moves, load = np.abs(v) > STILL, torque + external
    sense = np.sign(np.where(moves, v, load))
    net = torque - sense * bound
    aim = v + net / brake
    aim = np.where(aim * sense < 0.0, 0.0, aim)
    rubs = bound > 0.0
    holds = rubs & ~moves & (np.abs(load) <= bound)
    limit = np.where(holds, bound, np.where(rubs, net, torque))
    speed = np.where(holds, 0.0, np.where(rubs, aim, free_speed))
    return limit, speed, np.where(holds, torque, 0.0)


def inertia_at_joints(robot: Robot) -> Array:
    """Inertia (n,) [kg m^2] of what each joint moves in the standing posture, without rotors."""
    model = robot.model
    return np.array(np.diag(pin.crba(model, model.createData(), robot.standing_q)))[
        FLOATING_BASE_NV:
    ]


class ServoModel:
    """The servos of one robot in one replay.

    Dry friction that depends on the load is left to the engine; the model gives its bound. The
    external torque that the bound depends on is what the last step shows to have acted on a joint
    besides its servo: inertia a - torque, with the inertia that the joint has if all others are
    held.
    """

    def __init__(self, servos: Servos, dt: float, inertia: Array | float = 0.0) -> None:
        """Prepare for physics steps.

        Args:
            servos: figures of the servos.
            dt: physics step [s]; latencies become whole steps.
            inertia: of what each joint (n,) moves, without rotors [kg m^2]; only for servos whose
                friction depends on the load.
        """
        self._servos, self._dt, self._inertia = servos, dt, inertia
        s = servos
        self._external = np.zeros_like(s.stall_torque)  # torques (n,) besides those of servos [N m]
        self.delay = np.rint(s.latency / dt).astype(np.intp)  # (n,) [steps]
        self._memory = int(self.delay.max(initial=0))
        self._told: Array | None = None  # (memory, n) commands that are still under way
        self._tick = np.maximum(s.resolution, NO_TICK)
        self._line = s.stall_torque / s.no_load_speed
        self._margin = AT_LIMIT * s.stall_torque
        self._brake = np.maximum(s.damping + s.viscous_friction, LEAST_DAMPING)
        by_line = (s.stall_torque - s.coulomb_friction) / (self._line + s.viscous_friction)
        self._fastest = np.maximum(by_line, 0.0)
        self._most = np.where(s.brakes_beyond_stall, np.inf, s.stall_torque)

    def drive(self, engine: Pushed, commands: Array) -> Driven:
        """Make k steps under commands (k, n) [rad]."""
        torques, limited = np.empty_like(commands), np.empty(commands.shape, dtype=np.bool_)
        state = engine.joints()
        for k, command in enumerate(self._in_ticks(self._delayed(commands))):
            torque, free_speed, limited[k] = self._torque(command, state.position, state.velocity)
            if self._servos.load_friction is None:
                state = engine.push(torque, free_speed)
            else:
                state = self._push_under_load(engine, torque, free_speed, state.velocity)
            torques[k] = state.torque
        return Driven(torques, limited)

    def _push_under_load(
        self, engine: Pushed, torque: Array, free_speed: Array, v: Array
    ) -> JointState:
        """Make one step with friction that depends on the load, and look at what the load was."""
        friction = self._servos.load_friction
        assert friction is not None
        bound = friction.bound(v, torque, self._external)
        state = engine.push(torque, free_speed, DryFriction(bound, v, self._external, self._brake))
        inertia = self._inertia + engine.rotors
        self._external = inertia * (state.velocity - v) / self._dt - state.torque
        return state

    def _delayed(self, commands: Array) -> Array:
        """What reaches the servos (k, n); before anything was told, they were told the first."""
        if self._told is None:
            self._told = np.repeat(commands[:1], self._memory, axis=0)
        told = np.concatenate([self._told, commands])
        self._told = told[len(told) - self._memory :]
        now = np.arange(self._memory, len(told))
        return np.asarray(told[now[:, None] - self.delay, np.arange(commands.shape[1])])

    def torque(self, command: Array, q: Array, v: Array) -> tuple[Array, Array, Bools]:
        """Torques, the speeds at which they vanish, and which are limits; all (n,).

        Args:
            command: (n,) [rad].
            q: joint angles (n,) [rad].
            v: joint speeds (n,) [rad/s].
        """
        return self._torque(self._in_ticks(command), q, v)

    def _in_ticks(self, angle: Array) -> Array:
        return np.asarray(np.rint(angle / self._tick) * self._tick)

    def _torque(self, command: Array, q: Array, v: Array) -> tuple[Array, Array, Bools]:
        """Torque as by `torque`, for a command that is rounded to whole ticks.

        Once a physics step: plain ufuncs, whose call is all that they cost.
        """
        s = self._servos
        error = command - self._in_ticks(q)
        beyond = np.abs(error) - s.deadband
        # a whole number of ticks equals the deadband only up to rounding
        drive = np.where(beyond > 1e-9, s.stiffness * beyond + s.punch, 0.0)
        # on its own, damping leaves nothing of a drive at this speed; the line may do so before
        free_speed = np.minimum((drive - s.coulomb_friction) / self._brake, self._fastest)
        free_speed = np.copysign(np.maximum(free_speed, 0.0), error)
        wanted = np.copysign(drive, error) - s.damping * v
        braked = self._line * v
        most = np.minimum(self._most, s.stall_torque - braked)
        least = np.maximum(-self._most, -s.stall_torque - braked)
        limited = (wanted >= most - self._margin) | (wanted <= least + self._margin)
        torque = np.minimum(np.maximum(wanted, least), most) - s.friction(v)
        free_speed = np.where(torque > 0.0, np.maximum(free_speed, v), np.minimum(free_speed, v))
        return torque, free_speed, limited
