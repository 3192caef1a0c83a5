"""The robot as a kinematic tree that is rooted at one sole.

A robot that stands on a sole is a fixed-base manipulator whose root is that sole: section 4.2 of
"Inverse kinematics of a humanoid robot modelled as a tree-shaped manipulator". Pinocchio roots a
model where its URDF does. Here the chain from the sole to the old root is reversed, so that
Pinocchio's own algorithms (gravity torques and their derivatives, CoM Jacobian) apply to the
standing robot.

A joint with placement M (parent to joint frame at q = 0) and motion S(q), seen from its child:

    T_child_parent(q) = S(q)^-1 M^-1 = S'(q) M^-1        S' turns about the negative axis

The reversed joint is at the child's origin and carries a body whose old frame is at M^-1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.robot import Robot

# from a body of the old model to its joint in the new one and its pose in the frame of that joint
Placed = dict[int, tuple[int, pin.SE3]]


@dataclass(frozen=True, eq=False)
class SupportTree:
    """Fixed-base model of a robot that stands on one sole.

    `model` has one joint for each of the robot's, in another order: q_tree = q_robot[order].
    A fixed-base model ignores the mass of its root link. That mass is lumped at the origin of the
    first joint, a point that no joint moves. The model then has the robot's mass, CoM Jacobian and
    gravity torques, and its CoM is `com_offset` away from the robot's.
    """

    side: Side
    model: pin.Model
    order: NDArray[np.intp]  # (n,)
    com_offset: Array  # (3,) CoM of the robot minus CoM of the model, in the sole frame [m]
    first_placements: tuple[tuple[int, pin.SE3], ...]  # joints on the sole's link, in its frame
    swing_sole: int  # ids of frames in `model`, here and below
    hands: tuple[int, int]
    base: int
    torso: int

    def place(self, T_world_sole: pin.SE3) -> None:
        """Place the root sole in the world, the frame of all results from then on."""
        for joint, placement in self.first_placements:
            self.model.jointPlacements[joint] = T_world_sole * placement


def build_support_tree(robot: Robot, side: Side) -> SupportTree:
    """Re-root a robot at its left or right sole."""
    source = robot.model
    sole = source.frames[robot.sole_frames[side]]
    root = int(sole.parentJoint)
    model, placed = pin.Model(), {root: (0, sole.placement.inverse())}
    model.gravity.linear = source.gravity.linear
    order = _grow(source, model, placed, root)
    com_offset = _lump(model, sole.placement.inverse().act(source.inertias[root]))
    base = _copy_frame(source, model, placed, source.getBodyId(robot.spec.base_link))
    swing = _copy_frame(source, model, placed, robot.sole_frames[side.other])
    left_hand, right_hand = (_copy_frame(source, model, placed, f) for f in robot.hand_frames)
    return SupportTree(
        side=side,
        model=model,
        order=np.array(order),
        com_offset=com_offset,
        first_placements=tuple(
            (joint, model.jointPlacements[joint].copy())
            for joint in range(1, model.njoints)
            if model.parents[joint] == 0
        ),
        swing_sole=swing,
        hands=(left_hand, right_hand),
        base=base,
        torso=_copy_frame(source, model, placed, robot.torso_frame),
    )


def _grow(source: pin.Model, model: pin.Model, placed: Placed, root: int) -> list[int]:
    """Add every joint of `source` to `model`, outward from body `root`.

    Fills `placed` and returns the index in the robot's joint arrays of each joint, in the order in
    which they are added.
    """
    order: list[int] = []
    neighbours = _neighbours(source)
    stack = [(root, neighbour) for neighbour in reversed(neighbours[root])]
    while stack:
        here, there = stack.pop()
        parent, T_parent_here = placed[here]
        turned = source.parents[here] == there  # on the way to the old root
        joint = here if turned else there
        axis, placement = _axis(source, joint), source.jointPlacements[joint]
        new = model.addJoint(
            parent,
            pin.JointModelRevoluteUnaligned(*(-axis if turned else axis)),
            T_parent_here if turned else T_parent_here * placement,
            source.names[joint],
        )
        T_joint_body = placement.inverse() if turned else pin.SE3.Identity()
        placed[there] = (new, T_joint_body)
        model.appendBodyToJoint(new, source.inertias[there], T_joint_body)
        order.append(int(source.idx_vs[joint]) - FLOATING_BASE_NV)
        stack += [
            (there, following) for following in reversed(neighbours[there]) if following != here
        ]
    return order


def _lump(model: pin.Model, link: pin.Inertia) -> Array:
    """Lump the mass of the root link at the origin of joint 1; the CoM offset (3,) [m] left."""
    model.appendBodyToJoint(
        1, pin.Inertia(link.mass, np.zeros(3), np.zeros((3, 3))), pin.SE3.Identity()
    )
    share = link.mass / pin.computeTotalMass(model)
    return np.asarray(share * (link.lever - model.jointPlacements[1].translation))


def _copy_frame(source: pin.Model, model: pin.Model, placed: Placed, frame_id: int) -> int:
    """Copy a frame of `source` to `model`; its id there."""
    frame = source.frames[frame_id]
    joint, T_joint_body = placed[int(frame.parentJoint)]
    copy = pin.Frame(frame.name, joint, T_joint_body * frame.placement, pin.OP_FRAME)
    return int(model.addFrame(copy))


def _neighbours(model: pin.Model) -> list[list[int]]:
    """Neighbours of each joint in the tree; the floating base, joint 1, is an ordinary body."""
    out: list[list[int]] = [[] for _ in range(model.njoints)]
    for joint in range(2, model.njoints):
        out[model.parents[joint]].append(joint)
        out[joint].append(model.parents[joint])
    return out


def _axis(model: pin.Model, joint: int) -> Array:
    """Axis (3,) of a revolute joint in its own frame."""
    data = model.joints[joint].createData()
    model.joints[joint].calc(data, np.zeros(1), np.zeros(1))
    return np.asarray(data.S).reshape(6)[3:]
