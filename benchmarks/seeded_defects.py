"""Defects for `audit.py`: each function spoils a clean motion in one way, by a random amount.

A function returns the spoiled motion, and where a defect has a time, that time [s]; None where this
motion cannot have the defect, such as a link velocity of a motion that stands still.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.geometry import rotations_from_quat_xyzw
from mgs.judge.audit import GivenMotion, StatedLinks
from mgs.judge.audit.tree import joint_poses

Seeded = tuple[GivenMotion, float | None] | None
Seed = Callable[[GivenMotion, np.random.Generator], Seeded]
DEEPEST = 0.03  # [m]


def span(given: GivenMotion, rng: np.random.Generator, least: float, most: float) -> Array:
    """Smooth rise and fall (T,) between 0 and 1 that lasts `least` to `most` seconds at its top."""
    top, ramp = rng.uniform(least, most), 0.15
    end = given.dt * (given.n_samples - 1)
    top = min(top, end - 2 * ramp)
    start = rng.uniform(0.0, max(end - top - 2 * ramp, 0.0))
    t = given.dt * np.arange(given.n_samples) - start
    s = np.clip(np.minimum(t / ramp, (top + 2 * ramp - t) / ramp), 0.0, 1.0)
    return np.asarray(s * s * (3.0 - 2.0 * s))


def moved(given: GivenMotion, way: Array) -> GivenMotion:
    """The motion with its base moved by `way` (T, 3) [m]; stated velocities follow."""
    q = given.q.copy()
    q[:, :3] += way
    assert given.base_linear is not None
    linear = given.base_linear + np.gradient(way, given.dt, axis=0)
    return dataclasses.replace(given, q=q, base_linear=linear)


def bent(given: GivenMotion, joint: int, way: Array) -> GivenMotion:
    """The motion with one joint moved by `way` (T,) [rad]; stated velocities follow."""
    q = given.q.copy()
    q[:, 7 + joint] += way
    assert given.joint_velocity is not None
    v = given.joint_velocity.copy()
    v[:, joint] += np.gradient(way, given.dt)
    return dataclasses.replace(given, q=q, joint_velocity=v)


def penetration(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """The whole robot 5 to 30 mm too low, for a while or all the time."""
    depth = rng.uniform(0.005, DEEPEST)
    shape = span(given, rng, 0.2, 1.0) if rng.random() < 0.5 else np.ones(given.n_samples)
    return moved(given, np.outer(-depth * shape, [0.0, 0.0, 1.0])), _time(given, shape)


def floating(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """The whole robot 8 to 30 mm too high, for a while or all the time."""
    height = rng.uniform(0.008, DEEPEST)
    shape = span(given, rng, 0.2, 1.0) if rng.random() < 0.5 else np.ones(given.n_samples)
    return moved(given, np.outer(height * shape, [0.0, 0.0, 1.0])), _time(given, shape)


def slip(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """The whole robot slides at 25 to 100 mm/s, to and fro or all the way."""
    speed, turn = rng.uniform(0.025, 0.1), rng.uniform(-np.pi, np.pi)
    t = given.dt * np.arange(given.n_samples)
    way = speed * t
    if rng.random() < 0.5:
        period = rng.uniform(0.8, 2.0)
        way = speed * np.abs((t + 0.5 * period) % period - 0.5 * period)
    return moved(given, np.outer(way, [np.cos(turn), np.sin(turn), 0.0])), None


def joint_position(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """One joint 0.02 to 0.3 rad beyond its range."""
    robot, j = given.robot, int(rng.integers(given.robot.n))
    excess = rng.uniform(0.02, 0.3)
    shape, angles = span(given, rng, 0.2, 1.0), given.joints[:, j]
    limit, sign = (robot.upper[j], 1.0) if rng.random() < 0.5 else (robot.lower[j], -1.0)
    k = int(np.argmax(shape > 0.999))
    return bent(given, j, (limit + sign * excess - angles[k]) * shape), k * given.dt


def joint_speed(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """The file is played so fast that one joint is 10 to 100 % too fast."""
    top = np.abs(np.diff(given.joints, axis=0)).max(axis=0) / given.dt / given.robot.speed_limit
    return _faster(given, rng.uniform(1.1, 2.0) / float(top.max())), None


def _faster(given: GivenMotion, factor: float) -> GivenMotion:
    assert given.joint_velocity is not None
    assert given.base_linear is not None
    assert given.base_angular is not None
    return dataclasses.replace(
        given,
        dt=given.dt / factor,
        joint_velocity=factor * given.joint_velocity,
        base_linear=factor * given.base_linear,
        base_angular=factor * given.base_angular,
    )


def joint_torque(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """The servo of one joint has 40 to 70 % of the torque that it needs to stand as it does.

    The need is that at rest, over 0.2 s throughout; each sole bears what the place of the centre of
    mass between both gives it. Jacobians are Pinocchio's.
    """
    robot, half = given.robot, round(0.1 / given.dt)
    k = int(rng.integers(given.n_samples // 4, given.n_samples * 3 // 4))
    around = {max(0, k - half), k, min(given.n_samples - 1, k + half)}
    need = np.min([_static_torques(given, i) for i in around], axis=0)
    share = need / robot.torque_limit
    j = int(np.argmax(share))
    if share[j] < 0.05:
        return None
    limits = robot.torque_limit.copy()
    limits[j] = rng.uniform(0.4, 0.7) * need[j]
    weak = dataclasses.replace(robot, torque_limit=limits)
    return dataclasses.replace(given, robot=weak), k * given.dt


def _static_torques(given: GivenMotion, k: int) -> Array:
    """Sizes (n,) of the torques at rest at sample k [N m]."""
    robot, model, q = given.robot, given.robot.model, given.q[k]
    data = model.createData()
    tau = pin.computeGeneralizedGravity(model, data, q).copy()
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    left, right = (data.oMf[frame].translation for frame in robot.sole_frames)
    com, way = pin.centerOfMass(model, data, q), left - right
    part = float(np.clip((com - right)[:2] @ way[:2] / (way[:2] @ way[:2]), 0.0, 1.0))
    if abs(way[2]) > 2e-3:
        part = float(left[2] < right[2])
    shift = com - (part * left + (1.0 - part) * right)
    for frame, share in zip(robot.sole_frames, (part, 1.0 - part), strict=True):
        J = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
        force = np.array([0.0, 0.0, 9.81 * robot.mass * share])
        tau -= J.T @ np.concatenate([force, np.cross([*shift[:2], 0.0], force)])
    return np.abs(tau[6:])


def self_collision(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """Arms bent inside their ranges until two links overlap by 5 mm; all pairs are tested."""
    robot, geometry = given.robot, given.robot.geometry
    data, found = robot.model.createData(), geometry.createData()
    shape = span(given, rng, 0.3, 1.0)
    k = int(np.argmax(shape > 0.999))
    arms = [j for j in range(robot.n) if _is_free(given, j)]
    for _ in range(300):
        chosen = rng.choice(arms, size=min(3, len(arms)), replace=False)
        target = given.joints[k].copy()
        target[chosen] = rng.uniform(robot.lower[chosen], robot.upper[chosen])
        q = given.q[k].copy()
        q[7:] = target
        if not pin.computeCollisions(robot.model, data, geometry, found, q, False):
            continue
        hits = [i for i, result in enumerate(found.collisionResults) if result.isCollision()]
        depth = -min(pin.computeDistance(geometry, found, i).min_distance for i in hits)
        if depth > 0.005:
            spoiled = given
            for j in chosen:
                spoiled = bent(spoiled, int(j), (target[j] - given.joints[k, j]) * shape)
            return spoiled, k * given.dt
    return None


def _is_free(given: GivenMotion, joint: int) -> bool:
    """Whether a joint carries no sole, so that bending it moves no foot."""
    model = given.robot.model
    feet = {model.frames[frame].parentJoint for frame in given.robot.sole_frames}
    legs = {i for foot in feet for i in model.supports[foot]}
    return joint + 2 not in legs


def zmp(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """The trunk's mass is elsewhere than planned, so that the weight is beside the soles.

    Beside both: 10 to 40 mm ahead of the toes that are farthest ahead, or behind the heels, at an
    instant at which the robot stands on level soles.
    """
    robot, model = given.robot, given.robot.model.copy()
    k = int(rng.integers(given.n_samples // 4, given.n_samples * 3 // 4))
    data = model.createData()
    pin.framesForwardKinematics(model, data, given.q[k])
    com = pin.centerOfMass(model, data, given.q[k])
    heading = data.oMf[robot.sole_frames[0]].rotation[:, 0]
    reach = []
    for frame, spec in zip(
        robot.sole_frames, (robot.spec.soles.left, robot.spec.soles.right), strict=True
    ):
        for x in (-0.5, 0.5):
            for y in (-0.5, 0.5):
                corner = data.oMf[frame].act(np.array([x * spec.length, y * spec.width, 0.0]))
                reach.append(float((corner - com) @ heading))
    ahead = rng.random() < 0.5
    by = (max(reach) if ahead else min(reach)) + (1 if ahead else -1) * rng.uniform(0.01, 0.04)
    trunk = max(range(1, model.njoints), key=lambda joint: model.inertias[joint].mass)
    shift = heading * by * robot.mass / model.inertias[trunk].mass
    lever = model.inertias[trunk].lever + data.oMi[trunk].rotation.T @ shift
    old = model.inertias[trunk]
    model.inertias[trunk] = pin.Inertia(old.mass, lever, old.inertia)
    changed = dataclasses.replace(given, robot=dataclasses.replace(robot, model=model))
    return changed, k * given.dt


def jitter(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """White noise of 8 to 20 mrad on one joint or several, all the time."""
    q, robot = given.q.copy(), given.robot
    joints = rng.choice(robot.n, size=int(rng.integers(1, robot.n + 1)), replace=False)
    q[:, 7 + joints] += rng.normal(0.0, rng.uniform(8e-3, 20e-3), (given.n_samples, len(joints)))
    return dataclasses.replace(given, q=q, joint_velocity=None), None


def jump(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """One joint moves by 0.15 to 0.5 rad, or the base by 30 to 100 mm, from one sample on."""
    q = given.q.copy()
    k = int(rng.integers(given.n_samples // 4, given.n_samples * 3 // 4))
    sign = 1.0 if rng.random() < 0.5 else -1.0
    if rng.random() < 0.5:
        q[k:, int(rng.integers(3))] += sign * rng.uniform(0.03, 0.1)
    else:
        q[k:, 7 + int(rng.integers(given.robot.n))] += sign * rng.uniform(0.15, 0.5)
    spoiled = dataclasses.replace(given, q=q, joint_velocity=None, base_linear=None)
    return spoiled, k * given.dt


def velocity_end(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """The first velocity is position / dt, as where a file is differentiated from zero."""
    assert given.joint_velocity is not None
    assert given.base_linear is not None
    v, base = given.joint_velocity.copy(), given.base_linear.copy()
    if rng.random() < 0.5:
        v[0] = given.joints[0] / given.dt
    else:
        base[0] = given.q[0, :3] / given.dt
    return dataclasses.replace(given, joint_velocity=v, base_linear=base), 0.0


def clock(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """The period in the file is 2 to 20 % too long or too short, or its time stamps are."""
    factor = 1.0 + rng.uniform(0.02, 0.2) * (1.0 if rng.random() < 0.5 else -1.0)
    if rng.random() < 0.3:
        times = np.asarray(factor * given.dt * np.arange(given.n_samples), dtype=np.float64)
        return dataclasses.replace(given, times=times), None
    assert given.joint_velocity is not None
    if np.sqrt(np.mean(np.sum(given.joint_velocity**2, axis=1))) < 0.1:
        return None  # a robot that stands still shows no clock
    return dataclasses.replace(given, dt=factor * given.dt), None


def velocity(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """Angular velocities times their own size, a published error; or joints in another order."""
    assert given.base_angular is not None
    assert given.joint_velocity is not None
    speed = np.linalg.norm(given.base_angular, axis=1)
    if rng.random() < 0.5 and np.sqrt(np.mean(speed**2)) > 0.1:
        wrong = given.base_angular * speed[:, None]
        return dataclasses.replace(given, base_angular=wrong), None
    v = given.joint_velocity
    if np.sqrt(np.mean(np.sum(v**2, axis=1))) < 0.1:
        return None
    order = rng.permutation(given.robot.n)
    if np.linalg.norm(v - v[:, order]) < 0.5 * np.linalg.norm(v):
        return None
    return dataclasses.replace(given, joint_velocity=v[:, order]), None


def angular_frame(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """Angular velocities of the base in its own frame, said to be in the world; or the reverse."""
    assert given.base_angular is not None
    R = rotations_from_quat_xyzw(given.q[:, 3:7])
    inside = np.einsum("tji,tj->ti", R, given.base_angular)
    size = float(np.sqrt(np.mean(np.sum(given.base_angular**2, axis=1))))
    gap = float(np.sqrt(np.mean(np.sum((inside - given.base_angular) ** 2, axis=1))))
    if size < 0.1 or gap < 0.3 * size:
        return None  # a robot that does not turn, or turns about the vertical alone, shows no frame
    if rng.random() < 0.5:  # the velocities stay, and the file says that they are in the other one
        return dataclasses.replace(given, angular_frame="body"), None
    return dataclasses.replace(given, base_angular=inside), None


def link_point(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """Link velocities of the centres of mass, stated to be those of the origins; or the reverse."""
    model = given.robot.model
    bodies = [
        frame
        for frame in model.frames
        if frame.type == pin.FrameType.BODY and frame.placement.isIdentity()
    ]
    poses = joint_poses(given.robot, given.q)
    points: dict[str, list[Array]] = {"origin": [], "com": []}
    for frame in bodies:
        R, p = poses.R[frame.parentJoint], poses.p[frame.parentJoint]
        points["origin"].append(p + R @ frame.placement.translation)
        points["com"].append(p + R @ model.inertias[frame.parentJoint].lever)
    speeds = {
        name: np.gradient(np.stack(where, axis=1), given.dt, axis=0)
        for name, where in points.items()
    }
    size = np.sqrt(np.mean(np.sum(speeds["origin"] ** 2, axis=(1, 2))))
    if size < 0.05:
        return None
    said, meant = ("origin", "com") if rng.random() < 0.5 else ("com", "origin")
    names = tuple(frame.name for frame in bodies)
    links = StatedLinks(names, speeds[meant], None, "origin" if said == "origin" else "com")
    return dataclasses.replace(given, links=links), None


def quaternion_order(given: GivenMotion, rng: np.random.Generator) -> Seeded:
    """Quaternions xyzw read as wxyz, or the reverse."""
    roll = 1 if rng.random() < 0.5 else -1
    q = given.q.copy()
    q[:, 3:7] = np.roll(q[:, 3:7], roll, axis=1)
    spoiled = dataclasses.replace(given, q=q, base_angular=None)
    return spoiled, None


def _time(given: GivenMotion, shape: Array) -> float:
    """Middle of the time at which a shape (T,) is at its top [s]."""
    return float(np.flatnonzero(shape > 0.99).mean() * given.dt)


DEFECTS: dict[str, Seed] = {
    "penetration": penetration,
    "float": floating,
    "slip": slip,
    "joint_position": joint_position,
    "joint_speed": joint_speed,
    "joint_torque": joint_torque,
    "self_collision": self_collision,
    "zmp": zmp,
    "velocity": velocity,
    "velocity_end": velocity_end,
    "angular_frame": angular_frame,
    "link_point": link_point,
    "clock": clock,
    "quaternion_order": quaternion_order,
    "jitter": jitter,
    "jump": jump,
}
