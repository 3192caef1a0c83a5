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

Such a servo gives way under load and lags when it moves: at 17 N m/rad by 3 deg a newton metre. The
feed-forward command is the law above solved for q_command where torque, q and v are the plan's:

    q_command = q + (torque + friction(v) + damping v) / stiffness
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.short_repr import short_repr
from mgs.motion.motion import Motion
from mgs.robot.servos import Servos, servos_of


@dataclass(frozen=True, eq=False)
class Commands:
    """What servos are told to follow a motion."""

    position: Array  # (N, n) [rad]
    clipped: Array  # (n,) by how much a joint limit cuts it at most [rad]; 0: not at all

    __repr__ = short_repr


def servo_commands(
    motion: Motion, samples: slice = slice(None), servos: Servos | None = None
) -> Commands:
    """Feed-forward commands at some or all samples of a motion, inside the joint limits.

    Args:
        motion: the plan.
        samples: the samples wanted.
        servos: servos that the commands are for; None: those that robot.yaml describes.

    Raises:
        ConfigError: robot.yaml is asked and a servo in use has no stiffness.
    """
    robot = motion.robot
    servos = servos_of(robot) if servos is None else servos
    v = motion.v[samples, FLOATING_BASE_NV:]
    torque = motion.torque[samples]
    friction = servos.friction_under_load(v, torque)
    stiffness = np.where(robot.motors, servos.stiffness, 1.0)  # a follower gets its planned angle
    lead = (torque + friction + servos.damping * v) / stiffness
    wanted = motion.q[samples, FLOATING_BASE_NQ:] + lead
    position = np.clip(wanted, robot.lower, robot.upper)
    return Commands(position, np.abs(wanted - position).max(axis=0))
