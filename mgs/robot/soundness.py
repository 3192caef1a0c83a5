"""Checks of a robot description before any gait is made: inertias, posture, soles, collisions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV, GRAVITY
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.geometry import convex_hull, polygon_margins, sole_corners
from mgs.robot.legs import missing_turn
from mgs.robot.limbs import leg_joints, leg_length
from mgs.robot.robot import Robot

MASS_SYMMETRY = 0.01  # largest relative difference between the masses of left and right limbs
LEVEL_TOLERANCE = 1e-4  # [m] largest height difference of the sole corners in the posture
LEAST_MARGIN = 0.005  # [m] least distance of the CoM from the edge of the support polygon


@dataclass(frozen=True)
class Finding:
    """Result of one check: name, whether it passes, its figures, and a remedy if it fails."""

    name: str
    ok: bool
    figure: str
    remedy: str


def check_robot(robot: Robot) -> list[Finding]:
    """Check inertias, legs, symmetry, limits, soles, balance, strength and collisions."""
    data = robot.model.createData()
    q = robot.standing_q
    pin.framesForwardKinematics(robot.model, data, q)
    com = pin.centerOfMass(robot.model, data, q, False).copy()
    corners = np.array([_sole_corners(robot, data, side) for side in Side])
    return [
        _inertias(robot),
        _legs(robot),
        _symmetry(robot),
        _limits(robot),
        _soles_level(corners),
        _balance(com, corners),
        _strength(robot, data),
        _collisions(robot, q),
    ]


def _sole_corners(robot: Robot, data: pin.Data, side: Side) -> Array:
    spec = robot.sole_spec(side)
    T_world_sole = data.oMf[robot.sole_frames[side]]
    planar = sole_corners(np.zeros(3), spec.length, spec.width)
    return np.array([T_world_sole.act(np.array([x, y, 0.0])) for x, y in planar])


def _inertias(robot: Robot) -> Finding:
    bad = []
    for name, inertia in zip(robot.model.names[1:], robot.model.inertias[1:], strict=True):
        principal = np.sort(np.linalg.eigvalsh(inertia.inertia))
        physical = inertia.mass > 0.0 and principal[0] > 0.0
        if not physical or principal[0] + principal[1] < principal[2] * (1.0 - 1e-9):
            bad.append(name)
    return Finding(
        "inertias",
        not bad,
        f"mass {robot.mass:.3f} kg"
        + (f"; physically impossible inertia: {', '.join(bad)}" if bad else ""),
        "give these bodies a positive mass and principal inertias of which any two sum to more "
        "than the third",
    )


def _legs(robot: Robot) -> Finding:
    """Check that the legs can keep their soles level; report a missing degree of freedom."""
    n, length = len(leg_joints(robot, Side.LEFT)), leg_length(robot)
    remedy = "use legs with six joints, or with five joints without hip yaw or without ankle roll"
    try:
        turn = missing_turn(robot)
    except ConfigError as error:
        return Finding("legs", False, error.problems[0], remedy)
    lack = {
        None: "",
        "yaw": "; no hip yaw: the robot cannot turn, the pelvis is kept upright, only the solver "
        "clik can be used",
        "roll": "; no ankle roll: the pelvis is kept level, waist and arms have to move the CoM "
        "over a sole, only the solver clik can be used",
    }
    return Finding("legs", True, f"{n} joints, leg length {length:.3f} m{lack[turn]}", remedy)


def _symmetry(robot: Robot) -> Finding:
    """Check that left and right groups have equal masses and that the CoM is in the middle."""
    data = robot.model.createData()
    com = pin.centerOfMass(robot.model, data, robot.standing_q, False)
    sideways = abs(float(com[1]))
    worst, pair = 0.0, "there are no groups named left and right"
    for group, members in robot.spec.groups.items():
        other = robot.spec.groups.get(group.replace("left", "right"), members)
        if "left" in group and other is not members:
            masses = [sum(_link_mass(robot, name) for name in names) for names in (members, other)]
            difference = abs(masses[0] - masses[1]) / max(*masses, 1e-9)
            if difference >= worst:
                worst, pair = difference, group
    return Finding(
        "symmetry",
        worst <= MASS_SYMMETRY and sideways <= 0.02,
        f"masses differ by {100 * worst:.2f} % ({pair}), CoM is {1e3 * sideways:.1f} mm beside the "
        "middle",
        "compare the inertial elements of left and right links in the URDF",
    )


def _link_mass(robot: Robot, joint: str) -> float:
    return float(robot.model.inertias[robot.model.getJointId(joint)].mass)


def _limits(robot: Robot) -> Finding:
    posture = robot.standing_q[FLOATING_BASE_NQ:]
    room = np.minimum(posture - robot.lower, robot.upper - posture)
    j = int(np.argmin(room))
    return Finding(
        "limits",
        bool(room[j] >= 0.0),
        f"{robot.joint_names[j]} has the least distance from its limits: "
        f"{np.degrees(room[j]):.1f} deg",
        "change the posture in robot.yaml or the joint limit in the URDF",
    )


def _soles_level(corners: Array) -> Finding:
    spread = float(np.ptp(corners[..., 2]))
    return Finding(
        "soles_level",
        spread <= LEVEL_TOLERANCE,
        f"the heights of the sole corners differ by {1e3 * spread:.3f} mm",
        "choose hip, knee and ankle pitch of the posture so that they add up to zero on both sides",
    )


def _balance(com: Array, corners: Array) -> Finding:
    polygon = convex_hull(corners[..., :2].reshape(-1, 2))
    margin = float(polygon_margins(com[None, :2], polygon)[0])
    return Finding(
        "balance",
        margin >= LEAST_MARGIN,
        f"CoM at height {com[2]:.4f} m, {1e3 * margin:.1f} mm inside the support polygon",
        "change hip and ankle pitch of the posture until the CoM is above the soles",
    )


def _strength(robot: Robot, data: pin.Data) -> Finding:
    """Check that the servos can hold the posture on one leg, with the weight on its sole.

    tau = g(q) - J^T w, with the wrench w of the whole weight in the middle of one sole. `data`
    holds the frames of the posture.
    """
    worst, weak = (0.0, ""), []
    for side in Side:
        needed = np.abs(one_legged_torques(robot, data, side))
        for joint in leg_joints(robot, side):
            j = robot.model.idx_vs[joint] - FLOATING_BASE_NV
            name, limit = robot.joint_names[j], float(robot.torque_limit[j])
            worst = max(worst, (needed[j] / limit, name))
            if needed[j] > limit:
                weak.append(f"{name} needs {needed[j]:.3g} of {limit:.3g} N m")
    return Finding(
        "strength",
        not weak,
        f"standing on one leg takes {100 * worst[0]:.0f} % of the stall torque of {worst[1]}"
        + (f"; too weak: {', '.join(weak)}" if weak else ""),
        "check stall_torque under servos in robot.yaml: a URDF may give the torque of the motor "
        "before its gear; otherwise bend the knees of the posture less",
    )


def one_legged_torques(robot: Robot, data: pin.Data, side: Side) -> Array:
    """Torques (n,) [N m] of the motors in the posture, the whole weight in the middle of one sole.

    Followers have none.
    """
    model, q = robot.model, robot.standing_q
    frame = robot.sole_frames[side]
    J = pin.computeFrameJacobian(model, model.createData(), q, frame, pin.LOCAL_WORLD_ALIGNED)
    middle = np.array([0.0, 0.0, robot.mass * GRAVITY])
    gravity = pin.computeGeneralizedGravity(model, data, q)
    torque = np.asarray((gravity - J[:3].T @ middle)[FLOATING_BASE_NV:])
    return torque if robot.coupling is None else robot.coupling.at_motors(torque)


def _collisions(robot: Robot, q: Array) -> Finding:
    geometry = robot.geometry
    geometry_data = geometry.createData()
    pin.computeCollisions(robot.model, robot.model.createData(), geometry, geometry_data, q, False)
    names = {
        tuple(
            robot.model.frames[geometry.geometryObjects[i].parentFrame].name
            for i in (pair.first, pair.second)
        )
        for pair, result in zip(
            geometry.collisionPairs, geometry_data.collisionResults, strict=True
        )
        if result.isCollision()
    }
    listed = ", ".join(" and ".join(pair) for pair in sorted(names))
    return Finding(
        "collisions",
        not names,
        f"{len(geometry.collisionPairs)} pairs of links checked"
        + (f"; in contact: {listed}" if names else ""),
        "reduce the collision shapes, or list pairs that always touch under ignore_collisions",
    )
