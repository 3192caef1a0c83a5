"""What servos are told so that one physical robot, or yielding servos, do what was planned.

At the planned samples the angles wanted are

    wanted = q + lead        lead = torque / stiffness + backlash / 2 side(torque)

in the joint ranges, where the lead is that of the robot's own corrections (`mgs.robot.unit`), or of
the servo models (`mgs.motion.servo_commands`). The lead is resampled with the motion. A physical
robot is then told (wanted - zero_offset) / (sign scale).
"""

from __future__ import annotations

import dataclasses

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.spline import evaluate, spline_at_rest
from mgs.motion.motion import Motion
from mgs.motion.sampled import SampledMotion
from mgs.motion.servo_commands import servo_commands
from mgs.robot import Servos
from mgs.robot.unit import Unit


def commanded(
    sampled: SampledMotion, unit: Unit | None = None, servos: Servos | None = None
) -> SampledMotion:
    """Frames whose joint angles are commands; the base and its velocity are those of the plan.

    Args:
        sampled: frames of a motion.
        unit: corrections of one physical robot; None: none.
        servos: servos whose yielding is compensated (feed-forward); None: that of the unit is. If
            both are given, the servos should have the stiffness of the unit (`yielding_servos`).
    """
    lead = lead_of(sampled.motion, unit, servos)
    if lead is None and unit is None:
        return sampled
    joints, rates = sampled.joints, sampled.joint_velocity
    second = sampled.joint_acceleration
    if lead is not None:
        added = _along(sampled, lead)
        joints, rates, second = joints + added[0], rates + added[1], second + added[2]
    if unit is not None:
        turn = unit.sign * unit.scale
        joints, rates, second = unit.command_for(joints), rates / turn, second / turn
    return dataclasses.replace(
        sampled,
        q=np.hstack([sampled.q[:, :FLOATING_BASE_NQ], joints]),
        v=np.hstack([sampled.v[:, :FLOATING_BASE_NV], rates]),
        joint_acceleration=second,
        plan=sampled,
    )


def lead_of(motion: Motion, unit: Unit | None, servos: Servos | None) -> Array | None:
    """How far (N, n) [rad] commands are ahead of the plan, before signs and zeros; None: not."""
    planned = motion.q[:, FLOATING_BASE_NQ:]
    if servos is not None:
        lead = servo_commands(motion, servos=servos).position - planned
        if unit is not None:
            lead = lead + unit.play(motion.torque)
    elif unit is not None:
        lead = unit.yielding(motion.torque)
    else:
        return None
    robot = motion.robot
    return np.asarray(np.clip(planned + lead, robot.lower, robot.upper) - planned)


def _along(sampled: SampledMotion, lead: Array) -> tuple[Array, Array, Array]:
    """Lead, its rate and its second derivative (T, n) at the frames, of a lead (N, n)."""
    motion, cycle = sampled.motion, sampled.cycle
    if cycle is None:
        return evaluate(spline_at_rest(lead, motion.dt), sampled.times)
    once = lead[cycle.start : cycle.start + cycle.n_samples]
    around = spline_at_rest(np.tile(once, (3, 1)), motion.dt)
    period = cycle.n_samples * motion.dt
    return evaluate(around, period + sampled.times % period)
