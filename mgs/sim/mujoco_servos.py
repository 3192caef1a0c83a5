"""MuJoCo's own servos: actuators of a model, and the torques that they give.

An actuator whose force is cut at the stall torque knows no speed limit. A PD servo therefore has
two at its joint: the PD law with the slope of the speed-torque line taken out of its damping, cut
at the stall torque, and the slope on its own; their sum is cut at the stall torque again. Together
that is the PD law between

    most  = min(stall, stall - slope v)
    least = max(-stall, -stall - slope v)      slope = stall / no_load_speed

while MuJoCo's implicit integrator sees the damping of both, so that it is stable at large steps.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.robot import Robot
from mgs.sim.model import joint_names
from mgs.sim.servo import AT_LIMIT, Driven
from mgs.sim.settings import ServoName, Settings

HARDEST = 0.9999  # largest impedance of a constraint in MuJoCo
ROTOR_ACCELERATION = 1500.0  # [rad/s^2] at stall, of servos whose armature is not known


def add_servos(spec: Any, robot: Robot, settings: Settings, servo: ServoName, gain: Array) -> None:
    """Add the actuators of n joints to an MjSpec, in their order, and the rotors.

    Args:
        spec: the model so far.
        robot: whose stall torques, no-load speeds and rotors they have.
        settings: gains of ideal and PD servos.
        servo: "ideal", "pd", or anything else for servos that are evaluated outside.
        gain: factors (n,) on the stiffness.
    """
    stall = robot.torque_limit
    kp = _stiffness(robot, settings, servo) * gain
    # MuJoCo's contacts give way in proportion to 1 / inertia: feet without rotor inertia creep
    armature = np.where(robot.armature > 0.0, robot.armature, stall / ROTOR_ACCELERATION)
    armature = np.where(robot.motors, armature, 0.0)
    for i, name in enumerate(joint_names(robot)):
        spec.joint(name).armature = float(armature[i])
        actuator = _add_actuator(spec, name, name)
        actuator.forcelimited, actuator.forcerange = True, [-stall[i], stall[i]]
        actuator.gainprm[0] = kp[i]
        actuator.biasprm[:3] = [0.0, -kp[i], -kp[i] * settings.damping]
    for i, name in enumerate(joint_names(robot) if servo == "pd" else ()):
        joint = spec.joint(name)
        joint.actfrclimited, joint.actfrcrange = True, [-stall[i], stall[i]]
        _add_actuator(spec, name, f"{name} back-EMF")


def couple_joints(spec: Any, robot: Robot, dt: float) -> None:
    """Let followers turn with their leaders, as hard as a step of dt [s] allows."""
    import mujoco

    coupling = robot.coupling
    if coupling is None:
        return
    names = joint_names(robot)
    rows = zip(
        coupling.followers, coupling.leaders, coupling.multipliers, coupling.offsets, strict=True
    )
    for follower, leader, multiplier, offset in rows:
        equality = spec.add_equality(
            type=mujoco.mjtEq.mjEQ_JOINT,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            name1=names[follower],
            name2=names[leader],
            solref=[2.0 * dt, 1.0],
        )
        equality.data[:5] = [offset, multiplier, 0.0, 0.0, 0.0]
        equality.solimp[:2] = HARDEST


def set_damping(model: Any, robot: Robot, settings: Settings, gain: Array) -> None:
    """Give the PD servos of a compiled model their damping.

    Compilation would take a positive coefficient of the speed for a damping ratio.
    """
    n, slope = robot.n, robot.motors * robot.torque_limit / robot.no_load_speed
    kp = _stiffness(robot, settings, "pd") * gain
    model.actuator_biasprm[:n, 2] = slope - kp * settings.damping_time
    model.actuator_biasprm[n:, 2] = -slope


def pd_torques(forces: Array, stall: Array) -> Driven:
    """Torques of PD servos from the forces (k, 2 n) of their actuators and stall torques (n,)."""
    n, most = len(stall), (1.0 - AT_LIMIT) * stall
    by_law = forces[:, :n]
    torque = np.minimum(np.maximum(by_law + forces[:, n:], -stall), stall)
    return Driven(torque, np.maximum(np.abs(by_law), np.abs(torque)) >= most)


def harden_friction(model: Any, dt: float) -> None:
    """Let dry friction of joints hold without creeping, as far as a step of dt [s] allows."""
    model.dof_solref[:] = [2.0 * dt, 1.0]
    model.dof_solimp[:, :2] = HARDEST


def friction_torques(model: Any, data: Any) -> Array:
    """Torques (nv,) of the joints' dry friction in the last step [N m]."""
    torques, rows = np.zeros(model.nv), slice(data.ne, data.ne + data.nf)
    torques[data.efc_id[rows]] = data.efc_force[rows]
    return torques


def _stiffness(robot: Robot, settings: Settings, servo: ServoName) -> Array:
    """Stiffness (n,) [N m/rad]; 0 where torques are pushed from outside."""
    stall = np.where(robot.motors, robot.torque_limit, 0.0)  # followers have no motor
    if servo == "ideal":
        return stall * settings.stiffness
    return stall / settings.sag if servo == "pd" else np.zeros(robot.n)


def _add_actuator(spec: Any, joint: str, name: str) -> Any:
    """An actuator at a joint whose force is affine in its angle and speed."""
    import mujoco

    actuator = spec.add_actuator(name=name, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    return actuator
