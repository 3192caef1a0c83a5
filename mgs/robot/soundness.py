"""Whether a robot folder is sound: what can be proven of its model before any gait is made."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.geometry import convex_hull, polygon_margins, sole_corners
from mgs.robot.legs import missing_turn
from mgs.robot.limbs import leg_joints, leg_length
from mgs.robot.robot import Robot

MASS_SYMMETRY = 0.01  # relative difference of the two legs' and arms' masses
LEVEL_TOLERANCE = 1e-4  # [m] between the corners of both soles in the posture
LEAST_MARGIN = 0.005  # [m] of the CoM inside the support polygon


@dataclass(frozen=True)
class Finding:
    """One property of a robot and, where it does not hold, what to do."""

    name: str
    ok: bool
    figure: str
    remedy: str


def check_robot(robot: Robot) -> list[Finding]:
    """Inertias, symmetry, limits, soles, balance and collisions in the half-sitting posture."""
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
        f"mass {robot.mass:.3f} kg" + (f"; not physical: {', '.join(bad)}" if bad else ""),
        "give these bodies a positive mass and inertias of which any two exceed the third",
    )


def _legs(robot: Robot) -> Finding:
    """Whether legs can keep their soles level; tells what walks have to do without."""
    n, length = len(leg_joints(robot, Side.LEFT)), leg_length(robot)
    remedy = "six joints place a sole anywhere; of five, hip yaw or ankle roll may be missing"
    try:
        turn = missing_turn(robot)
    except ConfigError as error:
        return Finding("legs", False, error.problems[0], remedy)
    lack = {
        None: "",
        "yaw": "; no hip yaw: no turns, the pelvis is kept upright instead, clik only",
        "roll": "; no ankle roll: the pelvis is kept level, so that waist and arms have to bring "
        "the CoM over a sole, clik only",
    }
    return Finding("legs", True, f"{n} joints, {length:.3f} m stretched{lack[turn]}", remedy)


def _symmetry(robot: Robot) -> Finding:
    """Masses of paired groups must agree, and the CoM must stand in the middle."""
    data = robot.model.createData()
    com = pin.centerOfMass(robot.model, data, robot.standing_q, False)
    sideways = abs(float(com[1]))
    worst, pair = 0.0, "no groups named left and right to compare"
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
        f"masses differ by {100 * worst:.2f} % ({pair}), CoM {1e3 * sideways:.1f} mm off middle",
        "compare the inertial elements of left and right; a walk needs room for the difference",
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
        f"{robot.joint_names[j]} is {np.degrees(room[j]):.1f} deg inside its range",
        "change the posture or the limit in the URDF",
    )


def _soles_level(corners: Array) -> Finding:
    spread = float(np.ptp(corners[..., 2]))
    return Finding(
        "soles_level",
        spread <= LEVEL_TOLERANCE,
        f"corners of both soles within {1e3 * spread:.3f} mm of one plane",
        "choose hip, knee and ankle pitch of the posture so that they add up to zero on both sides",
    )


def _balance(com: Array, corners: Array) -> Finding:
    polygon = convex_hull(corners[..., :2].reshape(-1, 2))
    margin = float(polygon_margins(com[None, :2], polygon)[0])
    return Finding(
        "balance",
        margin >= LEAST_MARGIN,
        f"CoM at height {com[2]:.4f} m, {1e3 * margin:.1f} mm inside the support polygon",
        "lean the posture (hip against ankle pitch) until the CoM stands above the soles",
    )


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
        f"{len(geometry.collisionPairs)} pairs watched"
        + (f"; touching: {listed}" if names else ""),
        "shrink the collision shapes, or list pairs that always touch under ignore_collisions",
    )
