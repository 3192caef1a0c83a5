"""Roles: names of joints that mean the same on every humanoid, such as left_knee.

Gaits for any robot (`sizes: robot`) name joints by their roles. Roles follow from the geometry of
the robot in its half-sitting posture; `roles` in robot.yaml replaces what is found there.

An angle of a role is measured from the half-sitting posture. Its sign is that of a rotation of the
outer link about an axis of the body: x forward for roll, y to the left for pitch, z up for yaw. So
a positive knee angle bends the knee, and a negative elbow angle bends the elbow.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.robot.limbs import arm_joints, joint_chain, leg_joints
from mgs.robot.robot import Robot
from mgs.robot.role_names import ROLES, TURNS
from mgs.robot.urdf_text import joint_axis

ALONG = 0.7  # an axis belongs to the axis of the body that makes up this part of it at least
SHOULDER_ALONG = 0.5  # the same in shoulders, since the arms of the posture do not hang straight


class Role(NamedTuple):
    """Joint of a role."""

    joint: int  # place in the joint arrays of the robot
    sign: float  # of the joint angle for a positive angle of the role


def find_roles(robot: Robot) -> dict[str, Role]:
    """Roles of the joints of a robot by name; joints in no clear place have none."""
    body = _Body(robot)
    found: dict[str, Role] = {}
    for side in Side:
        legs, arms = _leg(body, leg_joints(robot, side)), _arm(body, robot, side)
        found |= {f"{side.label}_{role}": body.role(*at) for role, at in (legs | arms).items()}
    waist = joint_chain(robot, robot.torso_frame)
    found |= {f"waist_{turn}": body.role(*at) for turn, at in _by_turn(body, waist).items()}
    head = [robot.joint_names.index(name) + 2 for name in robot.spec.groups.get("head", [])]
    found |= {f"head_{turn}": body.role(*at) for turn, at in _by_turn(body, head).items()}
    for name, joint in robot.spec.roles.items():
        place = robot.joint_names.index(joint)
        found = {role: at for role, at in found.items() if at.joint != place or role == name}
        found[name] = Role(place, body.sign(place + 2, _axis_of(name)))
    return {name: found[name] for name in ROLES if name in found}


class _Body:
    """Axes (3,) and origins (3,) of the joints in the half-sitting posture, in the world frame."""

    def __init__(self, robot: Robot) -> None:
        model, data = robot.model, robot.model.createData()
        pin.framesForwardKinematics(model, data, robot.standing_q)
        self.idx_vs = model.idx_vs
        self.axes = {
            j: data.oMi[j].rotation @ joint_axis(model, j) for j in range(2, model.njoints)
        }
        self.origins = [placement.translation.copy() for placement in data.oMi]
        self.hands = [data.oMf[frame].translation.copy() for frame in robot.hand_frames]

    def role(self, joint: int, sign: float) -> Role:
        return Role(self.idx_vs[joint] - FLOATING_BASE_NV, sign)

    def sign(self, joint: int, axis: int) -> float:
        """Sign of the rotation about an axis of the body for a positive angle of a joint."""
        return 1.0 if self.axes[joint][axis] >= 0.0 else -1.0

    def shortens(self, joint: int, root: Array, tip: Array) -> float:
        """Sign of the angle of a joint that brings `tip` (3,) nearer to `root` (3,) [m]."""
        lever = np.cross(self.axes[joint], tip - self.origins[joint])
        return 1.0 if float(lever @ (tip - root)) < 0.0 else -1.0


Place = tuple[int, float]  # joint of Pinocchio's model and its sign


def _axis_of(role: str) -> int:
    """Axis of the body of a role: 0 for x, 1 for y, 2 for z."""
    return next((i for i, turn in enumerate(TURNS) if role.endswith(turn)), 1)


def _by_turn(body: _Body, joints: list[int]) -> dict[str, Place]:
    """Joints of a chain by the axis of the body that they turn about; the first of each."""
    found: dict[str, Place] = {}
    for joint in joints:
        axis = int(np.argmax(np.abs(body.axes[joint])))
        if abs(body.axes[joint][axis]) >= ALONG:
            found.setdefault(TURNS[axis], (joint, body.sign(joint, axis)))
    return found


def _leg(body: _Body, joints: list[int]) -> dict[str, Place]:
    """Roles of a leg; the knee is the second of its three pitch joints."""
    pitch = [joint for joint in joints if abs(body.axes[joint][1]) >= ALONG]
    if len(pitch) < 3:
        return {}
    knee = pitch[1]
    at = joints.index(knee)
    bends = body.shortens(knee, body.origins[joints[0]], body.origins[joints[-1]])
    hip, ankle = _by_turn(body, joints[:at]), _by_turn(body, joints[at + 1 :])
    return {
        **{f"hip_{turn}": place for turn, place in hip.items()},
        "knee": (knee, bends),
        **{f"ankle_{turn}": place for turn, place in ankle.items()},
    }


def _arm(body: _Body, robot: Robot, side: Side) -> dict[str, Place]:
    """Roles of an arm; the elbow is the hinge that is far from shoulder and hand alike."""
    if robot.hand_frames[side] == robot.torso_frame:
        return {}
    joints, hand = arm_joints(robot, side), body.hands[side]
    if len(joints) < 3:
        return {}
    shoulder = body.origins[joints[0]]
    hinges = [joint for joint in joints[1:] if _is_hinge(body, joint, hand)]
    if not hinges:
        return {}
    elbow = max(hinges, key=lambda j: _nearer(body.origins[j], shoulder, hand))
    at = joints.index(elbow)
    found: dict[str, Place] = {"elbow": (elbow, -body.shortens(elbow, shoulder, hand))}
    upper = body.origins[elbow] - shoulder
    for turn, place in _shoulder(body, joints[:at], upper).items():
        found[f"shoulder_{turn}"] = place
    for turn, place in _by_turn(body, joints[at + 1 :]).items():
        found[f"wrist_{turn}"] = place
    return found


def _is_hinge(body: _Body, joint: int, hand: Array) -> bool:
    """Whether a joint turns the forearm about an axis across it."""
    forearm = hand - body.origins[joint]
    across = np.linalg.norm(np.cross(body.axes[joint], forearm))
    return bool(across >= ALONG * np.linalg.norm(forearm) > 0.0)


def _nearer(point: Array, shoulder: Array, hand: Array) -> float:
    return min(float(np.linalg.norm(point - shoulder)), float(np.linalg.norm(point - hand)))


def _shoulder(body: _Body, joints: list[int], upper: Array) -> dict[str, Place]:
    """The assignment of up to three joints to roll, pitch and yaw that fits their axes best.

    Yaw turns about the upper arm (3,), which hangs down; pitch and roll turn about y and x.
    """
    along = upper / max(float(np.linalg.norm(upper)), 1e-9)
    directions = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], -along])
    joints = joints[:3]
    fits = np.array([directions @ body.axes[joint] for joint in joints]).reshape(len(joints), 3)
    best = max(
        itertools.permutations(range(3), len(joints)),
        key=lambda turns: sum(abs(fits[i, turn]) for i, turn in enumerate(turns)),
    )
    return {
        TURNS[turn]: (joint, 1.0 if fits[i, turn] >= 0.0 else -1.0)
        for i, (joint, turn) in enumerate(zip(joints, best, strict=True))
        if abs(fits[i, turn]) >= SHOULDER_ALONG
    }
