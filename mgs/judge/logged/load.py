"""Torques that joints carry in a motion: standing on the ground, or hung up with the feet free.

A robot that stands on both feet is a closed chain. Zeros that are off make its legs push against
each other, and what they carry then differs from the plan. Hung up, each joint carries what hangs
on it, which the plan knows well.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.motion import Motion
from mgs.robot.servos import is_modelled, servos_of


def loads(motion: Motion, hung: bool) -> tuple[Array, Array]:
    """Torques on the joints, and with friction and damping of described servos; (N, n) [N m].

    Args:
        motion: the plan.
        hung: the base is held as it is at the first sample, and the feet are free.
    """
    torque = _hung(motion) if hung else motion.torque
    if not is_modelled(motion.robot):
        return torque, torque
    servos, v = servos_of(motion.robot), motion.v[:, FLOATING_BASE_NV:]
    return torque, torque + servos.friction_under_load(v, torque) + servos.damping * v


def carried(motion: Motion, hung: bool) -> Motion:
    """The motion with the torques of a robot that is hung up, if it is."""
    return dataclasses.replace(motion, torque=_hung(motion)) if hung else motion


def _hung(motion: Motion) -> Array:
    """Torques (N, n) [N m] of inverse dynamics with a base that does not move."""
    model, data = motion.robot.model, motion.robot.model.createData()
    acceleration = np.gradient(motion.v[:, FLOATING_BASE_NV:], motion.dt, axis=0)
    torque = np.empty_like(acceleration)
    q, v, a = motion.q[0].copy(), np.zeros(model.nv), np.zeros(model.nv)
    for k, row in enumerate(motion.q):
        q[FLOATING_BASE_NQ:] = row[FLOATING_BASE_NQ:]
        v[FLOATING_BASE_NV:] = motion.v[k, FLOATING_BASE_NV:]
        a[FLOATING_BASE_NV:] = acceleration[k]
        torque[k] = pin.rnea(model, data, q, v, a)[FLOATING_BASE_NV:]
    return torque
