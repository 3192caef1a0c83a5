"""The floor of PyBullet, and what is on it besides the robot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mgs.core.geometry import quat_xyzw_from_yaw
from mgs.core.scene import BALL_FRICTION, Ball, Box
from mgs.robot import Robot

BASE = -1  # PyBullet's index of the base link
GEAR_FORCE = 1e5  # [N m] that holds coupled joints together: more than any of them needs
GEAR_CORRECTION = 0.8  # part of the error of coupled joints that is removed in a step


def add_ground(p: Any, client: int, boxes: Sequence[Box]) -> list[int]:
    """Add a plane and boxes to a client of the module pybullet; gives their bodies."""
    plane = p.createCollisionShape(p.GEOM_PLANE, physicsClientId=client)
    grounds = [p.createMultiBody(0.0, plane, physicsClientId=client)]
    for box in boxes:
        size = [0.5 * box.length, 0.5 * box.width, 0.5 * box.height]
        shape = p.createCollisionShape(p.GEOM_BOX, halfExtents=size, physicsClientId=client)
        grounds.append(
            p.createMultiBody(
                0.0,
                shape,
                basePosition=[box.x, box.y, 0.5 * box.height],
                baseOrientation=quat_xyzw_from_yaw(box.yaw).tolist(),
                physicsClientId=client,
            )
        )
    for ground in grounds:  # the friction of a pair is the product: all is in the robot's links
        p.changeDynamics(ground, BASE, lateralFriction=1.0, restitution=0.0, physicsClientId=client)
    return grounds


def add_balls(p: Any, client: int, balls: Sequence[Ball], friction: float) -> list[int]:
    """Add balls to a client of the module pybullet; gives their bodies.

    `friction` is the coefficient of the robot's links.
    """
    bodies = []
    for ball in balls:
        shape = p.createCollisionShape(p.GEOM_SPHERE, radius=ball.radius, physicsClientId=client)
        at = [ball.x, ball.y, ball.radius]
        body = p.createMultiBody(ball.mass, shape, basePosition=at, physicsClientId=client)
        p.changeDynamics(
            body,
            BASE,
            lateralFriction=BALL_FRICTION / friction,  # a pair's is the product
            spinningFriction=0.0,
            rollingFriction=0.0,
            restitution=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
            physicsClientId=client,
        )
        bodies.append(body)
    return bodies


def couple_joints(p: Any, client: int, body: int, joints: Sequence[int], robot: Robot) -> None:
    """Let followers turn with their leaders: q_follower - multiplier q_leader = offset.

    `joints` are PyBullet's indices of the robot's joints, in their order.
    """
    coupling = robot.coupling
    if coupling is None:
        return
    rows = zip(
        coupling.followers, coupling.leaders, coupling.multipliers, coupling.offsets, strict=True
    )
    for follower, leader, multiplier, offset in rows:
        gear = p.createConstraint(
            body,
            joints[follower],
            body,
            joints[leader],
            p.JOINT_GEAR,
            jointAxis=[0, 0, 1],
            parentFramePosition=[0, 0, 0],
            childFramePosition=[0, 0, 0],
            physicsClientId=client,
        )
        p.changeConstraint(
            gear,
            gearRatio=-float(multiplier),
            relativePositionTarget=float(offset),
            erp=GEAR_CORRECTION,
            maxForce=GEAR_FORCE,
            physicsClientId=client,
        )
