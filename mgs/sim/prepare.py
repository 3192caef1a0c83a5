"""What all replays of one motion in one engine with one kind of servos have in common."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.errors import SimulationError
from mgs.motion import Motion
from mgs.motion.servo_commands import Commands, servo_commands
from mgs.robot import servos_of
from mgs.sim.engine import require
from mgs.sim.one_robot import OneRobot
from mgs.sim.poses import poses_along
from mgs.sim.servo import servo_figures
from mgs.sim.settings import DEFAULTS, LOAD_FRICTION_STEP, SERVOS, EngineName, ServoName, Settings
from mgs.sim.targets import targets_along


@dataclass(frozen=True, eq=False)
class Prepared:
    """A motion ready for replays under any conditions; M samples with the tail, K steps."""

    motion: Motion
    engine: EngineName
    settings: Settings  # dt divides the sampling period
    servo: ServoName
    feed_forward: bool
    assumed_stiffness: float
    one_robot: OneRobot | None  # physical robot whose errors the simulated one has; None: none
    clipped: Array  # (n,) by how much a joint limit cuts a command at most [rad]
    plan: NDArray[np.intp]  # (M,) sample of the motion; the last one stays during the tail
    up: Array  # (M, 3) the world's vertical seen from the torso in the plan
    position: Array  # (K, n) targets of the servos at the end of every physics step [rad]
    velocity: Array  # (K, n) [rad/s]


def prepare(
    motion: Motion,
    engine: EngineName,
    settings: Settings | None = None,
    servo: ServoName = "ideal",
    feed_forward: bool | None = None,
    assumed_stiffness: float = 1.0,
    one_robot: OneRobot | None = None,
) -> Prepared:
    """Prepare a motion for replays; the arguments are those of `mgs.sim.replay.replay`.

    Raises:
        SimulationError: the engine is missing or the kind of servos unknown.
        ConfigError: robot.yaml gives a servo no stiffness.
    """
    require(engine)
    if servo not in SERVOS:
        raise SimulationError(f"no servo {servo!r}; there are: {', '.join(SERVOS)}")
    settings = settings or DEFAULTS[engine]
    if servo == "model" and servos_of(motion.robot).load_friction is not None:
        settings = dataclasses.replace(settings, dt=min(settings.dt, LOAD_FRICTION_STEP[engine]))
    settings = _divide(settings, motion.dt)
    feed_forward = servo == "model" if feed_forward is None else feed_forward
    commands, assumed, clipped = None, None, np.zeros(motion.robot.n)
    if feed_forward:
        assumed = servo_figures(motion.robot, servo, settings, assumed_stiffness)
        commands = servo_commands(motion, servos=assumed)
        clipped = commands.clipped
    if one_robot is not None:
        commands = Commands(one_robot.arriving(motion, assumed, servo != "ideal"), clipped)
    n_samples = motion.n_samples + round(settings.tail / motion.dt)
    plan = np.minimum(np.arange(n_samples), motion.n_samples - 1)
    position, velocity = targets_along(motion, settings, commands)
    return Prepared(
        motion=motion,
        engine=engine,
        settings=settings,
        servo=servo,
        feed_forward=feed_forward,
        assumed_stiffness=assumed_stiffness,
        one_robot=one_robot,
        clipped=clipped,
        plan=plan,
        up=poses_along(motion.robot, motion.q)[1][plan],
        position=position,
        velocity=velocity,
    )


def _divide(settings: Settings, period: float) -> Settings:
    """Settings with the longest step that is no longer and divides the sampling period [s]."""
    n_steps = max(1, int(np.ceil(period / settings.dt - 1e-9)))
    return dataclasses.replace(settings, dt=period / n_steps)
