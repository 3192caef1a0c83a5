"""Inverse dynamics against balances that no inverse dynamics is needed for."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.contact import Side, Support
from mgs.gait import load_gait
from mgs.ik_solver.tree.support_tree import build_support_tree
from mgs.motion.dynamics import analyse, differentiate, place_on_soles
from mgs.pipeline import Stages
from mgs.pipeline.stages import run_stages
from mgs.robot import Robot

GRAVITY = 9.81
DT = 1e-3  # [s]


def swaying(robot: Robot, n: int = 200) -> np.ndarray:
    """Joint angles (n, joints) that all swing at once, each at a pace of its own."""
    rng = np.random.default_rng(11)
    t = DT * np.arange(n)[:, None]
    pace, phase = rng.uniform(2.0, 6.0, robot.n), rng.uniform(0.0, 6.0, robot.n)
    return robot.posture + 0.1 * np.sin(pace * t + phase)


def standing_on(robot: Robot, side: Side, joints: np.ndarray) -> np.ndarray:
    """Configurations (N, 7 + n) with one sole at the origin."""
    soles = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], (len(joints), 2, 1))
    return place_on_soles(robot, joints, np.full(len(joints), side, np.int8), soles)


def momentum_rate(robot: Robot, body, k: int) -> np.ndarray:
    """Rate (6,) of linear momentum and of angular momentum about the CoM."""
    data = robot.model.createData()
    return pin.computeCentroidalMomentumTimeVariation(
        robot.model, data, body.q[k], body.v[k], body.a[k]
    ).vector


# --- kinematics -------------------------------------------------------------------------------


@pytest.mark.parametrize("side", list(Side))
def test_the_root_sole_stands_on_its_reference(any_robot: Robot, side: Side):
    joints = swaying(any_robot, 20)
    rng = np.random.default_rng(1)
    pin.seed(1)
    soles = np.array([[pin.SE3ToXYZQUAT(pin.SE3.Random()) for _ in Side] for _ in joints])
    roots = rng.integers(0, 2, len(joints)).astype(np.int8)
    roots[0] = side
    q = place_on_soles(any_robot, joints, roots, soles)
    data = any_robot.model.createData()
    for k, row in enumerate(q):
        pin.framesForwardKinematics(any_robot.model, data, row)
        placed = data.oMf[any_robot.sole_frames[roots[k]]]
        expected = pin.XYZQUATToSE3(soles[k, roots[k]])
        assert_allclose(placed.homogeneous, expected.homogeneous, atol=1e-12)
    assert_allclose(q[:, 7:], joints, rtol=0)


def test_base_quaternions_do_not_jump_while_the_robot_turns_five_times(melson: Robot):
    """A rotation has two quaternions; a reader that interpolates needs neighbours to agree."""
    yaw = np.linspace(0.0, 10.0 * np.pi, 400)
    soles = np.zeros((400, 2, 7))
    soles[..., 5], soles[..., 6] = np.sin(0.5 * yaw)[:, None], np.cos(0.5 * yaw)[:, None]
    soles[::3] *= -1.0  # the same turns, in the other quaternion
    joints = np.tile(melson.posture, (400, 1))
    q = place_on_soles(melson, joints, np.zeros(400, np.int8), soles)
    assert np.all(np.sum(q[1:, 3:7] * q[:-1, 3:7], axis=1) > 0.99)


def test_differences_are_exact_on_a_parabola_and_start_and_end_at_rest(melson: Robot):
    t = DT * np.arange(50)
    q = np.tile(melson.standing_q, (50, 1))
    q[:, 10] += 0.3 * t + 0.7 * t**2
    q[:, 0] += 0.2 * t**2  # the base frame is parallel to the world
    v, a = differentiate(melson, q, DT)
    assert_allclose(v[1:-1, 9], (0.3 + 1.4 * t)[1:-1], atol=1e-12)
    assert_allclose(a[1:-1, 9], 1.4, atol=1e-9)
    assert_allclose(v[1:-1, 0], (0.4 * t)[1:-1], atol=1e-12)
    assert_allclose(a[1:-1, 0], 0.4, atol=1e-9)
    assert not v[[0, -1]].any()
    # at rest before and after: the accelerations at the ends show the jumps from rest and to rest
    forth, back = (q[1, 10] - q[0, 10]) / DT, (q[-2, 10] - q[-1, 10]) / DT
    assert_allclose(a[[0, -1], 9], [forth / DT, back / DT], rtol=1e-9)


# --- forces -----------------------------------------------------------------------------------


@pytest.mark.parametrize("side", list(Side))
def test_torques_of_a_still_robot_on_one_sole_are_its_gravity_torques(any_robot: Robot, side: Side):
    joints = np.tile(swaying(any_robot, 1), (3, 1))
    q = standing_on(any_robot, side, joints)
    body = analyse(any_robot, q, DT, np.full(3, 1.0 - side))
    tree = build_support_tree(any_robot, side)
    tau = pin.computeGeneralizedGravity(tree.model, tree.model.createData(), joints[1, tree.order])
    assert_allclose(body.torque[1, tree.order], tau, atol=1e-10)


@pytest.mark.parametrize("side", list(Side))
def test_power_of_the_torques_is_the_rate_of_the_energy(any_robot: Robot, side: Side):
    """On one sole that stands still the ground does no work."""
    q = standing_on(any_robot, side, swaying(any_robot))
    body = analyse(any_robot, q, DT, np.full(len(q), 1.0 - side))
    model, data = any_robot.model, any_robot.model.createData()
    energy = np.array(
        [
            pin.computeKineticEnergy(model, data, row, v)
            + pin.computePotentialEnergy(model, data, row)
            for row, v in zip(body.q, body.v, strict=True)
        ]
    )
    on_links = body.torque - any_robot.armature * body.a[:, 6:]  # the rotors keep the rest
    power = np.sum(on_links * body.v[:, 6:], axis=1)
    rate = (energy[3:-1] - energy[1:-3]) / (2.0 * DT)
    # all differences err by (pace DT)^2 / 6, under 1e-5 of the power
    assert_allclose(power[2:-2], rate, atol=3e-5 * np.abs(power).max())


def test_at_rest_the_zmp_lies_under_the_com(any_robot: Robot):
    q = standing_on(any_robot, Side.LEFT, np.tile(swaying(any_robot, 1), (3, 1)))
    body = analyse(any_robot, q, DT, np.ones(3))
    assert_allclose(body.zmp, body.com[:, :2], atol=1e-12)


def test_the_zmp_is_where_the_ground_must_push_to_change_the_momentum(any_robot: Robot):
    """The ground pushes with f = dl/dt - m g at p, without moment about horizontal axes.

    dk/dt + (c - p) x f = 0 in x and y, with k the angular momentum about the CoM c.
    """
    body = analyse(
        any_robot, standing_on(any_robot, Side.LEFT, swaying(any_robot)), DT, np.ones(200)
    )
    for k in range(1, 199, 9):
        rate = momentum_rate(any_robot, body, k)
        force = rate[:3] + any_robot.mass * np.array([0.0, 0.0, GRAVITY])
        c = body.com[k]
        p = [
            c[0] - (rate[4] + c[2] * force[0]) / force[2],
            c[1] + (rate[3] - c[2] * force[1]) / force[2],
        ]
        assert_allclose(body.zmp[k], p, atol=1e-10)


def contact_wrenches(
    robot: Robot, body, k: int, sides: tuple[Side, ...]
) -> tuple[np.ndarray, float]:
    """Wrenches (sides, 6) at the sole centres, world axes, that explain motion and torques.

    They solve M a + h = S^T tau + sum J^T w in the least squares sense; the residual must vanish.
    """
    data = robot.model.createData()
    unexplained = pin.rnea(robot.model, data, body.q[k], body.v[k], body.a[k]).copy()
    unexplained[6:] -= body.torque[k] - robot.armature * body.a[k, 6:]  # rotors push on no link
    pin.computeJointJacobians(robot.model, data, body.q[k])
    aligned = pin.LOCAL_WORLD_ALIGNED
    J = np.concatenate(
        [pin.getFrameJacobian(robot.model, data, robot.sole_frames[s], aligned) for s in sides]
    )
    w, *_ = np.linalg.lstsq(J.T, unexplained, rcond=None)
    residual = float(np.abs(unexplained - J.T @ w).max())
    return w.reshape(-1, 6), residual


def test_wrenches_on_the_soles_in_contact_explain_all_equations_of_motion(walk_5cm: Stages):
    motion, tasks = walk_5cm.motion, walk_5cm.tasks
    body = analyse(motion.robot, motion.q, motion.dt, tasks.load_left)
    assert_allclose(body.torque, motion.torque, rtol=0)
    for k in range(0, motion.n_samples, 23):
        sides = Support(int(motion.support[k])).sides
        wrenches, residual = contact_wrenches(motion.robot, body, k, sides)
        assert residual < 1e-9
        force = wrenches[:, :3]
        rate = momentum_rate(motion.robot, body, k)
        weight = motion.robot.mass * np.array([0.0, 0.0, GRAVITY])
        assert_allclose(force.sum(axis=0), rate[:3] + weight, atol=1e-9)


def test_a_rotor_asks_for_its_inertia_times_the_acceleration_of_its_joint(melson: Robot):
    """A rotor that turns n times as fast as its joint weighs n^2 J there: tau = n^2 J qdd."""
    q = standing_on(melson, Side.LEFT, swaying(melson))
    bare = dataclasses.replace(melson, armature=np.zeros(melson.n))
    with_rotors, without = (analyse(robot, q, DT, np.ones(200)) for robot in (melson, bare))
    acceleration = np.diff(q[:, 7:], n=2, axis=0) / DT**2
    extra = (with_rotors.torque - without.torque)[1:-1]
    assert np.abs(extra).max() > 1e-3  # [N m]
    assert_allclose(extra, melson.armature * acceleration, atol=1e-9)


def test_both_soles_share_force_and_turning_moment_as_told(walk_5cm: Stages):
    """Each centre of pressure is off its sole's centre by the same, so that both act at the ZMP."""
    motion, tasks = walk_5cm.motion, walk_5cm.tasks
    body = analyse(motion.robot, motion.q, motion.dt, tasks.load_left)
    for k in (100, 200, 250, 600, 640, 950, 1100):
        share = np.array([tasks.load_left[k], 1.0 - tasks.load_left[k]])
        wrenches, _ = contact_wrenches(motion.robot, body, k, (Side.LEFT, Side.RIGHT))
        total = wrenches[:, :3].sum(axis=0)
        assert_allclose(wrenches[:, :3], share[:, None] * total, atol=1e-8)
        assert_allclose(wrenches[:, 5], share * wrenches[:, 5].sum(), atol=1e-8)
        pressure = np.column_stack([-wrenches[:, 4], wrenches[:, 3]]) / wrenches[:, 2:3]
        # [m]; soles that reach the ground within 2e-6 m tilt the lever of the sideways force
        assert_allclose(pressure[0], pressure[1], atol=1e-7)
        points = motion.soles[k, :, :2] + pressure
        assert_allclose(share @ points, motion.zmp[k], atol=1e-7)


def test_the_com_and_frames_are_those_of_the_configuration(walk_5cm: Stages):
    motion = walk_5cm.motion
    data = motion.robot.model.createData()
    for k in (0, 400, 700, 1200):
        com = pin.centerOfMass(motion.robot.model, data, motion.q[k])
        pin.framesForwardKinematics(motion.robot.model, data, motion.q[k])
        assert_allclose(motion.com[k], com, atol=1e-12)
        for side in Side:
            for frames, poses in (
                (motion.robot.sole_frames, motion.soles),
                (motion.robot.hand_frames, motion.hands),
            ):
                expected = data.oMf[frames[side]].homogeneous
                found = pin.XYZQUATToSE3(poses[k, side]).homogeneous
                assert_allclose(found, expected, atol=1e-12)


def test_a_payload_counts_as_a_body_added_to_the_hand(any_robot: Robot):
    """The oracle is the inverse dynamics of a robot whose hand is that much heavier."""
    mass, side = 0.2, Side.RIGHT
    q = standing_on(any_robot, Side.LEFT, swaying(any_robot))
    payload = np.tile([0.0, mass], (len(q), 1))
    body = analyse(any_robot, q, DT, np.ones(len(q)), payload)
    heavy = any_robot.model.copy()
    hand = heavy.frames[any_robot.hand_frames[side]]
    point = pin.Inertia(mass, np.zeros(3), np.zeros((3, 3)))
    heavy.appendBodyToJoint(hand.parentJoint, point, hand.placement)
    other = analyse(dataclasses.replace(any_robot, model=heavy), q, DT, np.ones(len(q)))
    # the hand's acceleration: of its positions here, of the joints there; ends jump
    inner = slice(2, -2)
    assert_allclose(body.zmp[inner], other.zmp[inner], atol=2e-4)
    scale = np.abs(other.torque).max()
    assert_allclose(body.torque[inner], other.torque[inner], atol=2e-3 * scale)
    without = analyse(any_robot, q, DT, np.ones(len(q)))
    assert_allclose(body.com, without.com, atol=0.0)
    assert np.abs(body.torque - without.torque).max() > 0.02 * scale


def test_planned_centres_of_pressure_bear_what_the_zmp_between_them_says(melson: Robot):
    """Oracle: RNEA with the wrenches of two forces at given points, shared by the lever arms."""
    walk = run_stages(melson, load_gait("melson/walk_rolling"))
    tasks, motion = walk.tasks, walk.motion
    double = tasks.support == Support.DOUBLE
    k = int(np.flatnonzero(double & (tasks.load_left > 0.3) & (tasks.load_left < 0.7))[40])
    span = slice(k - 1, k + 2)
    body = analyse(
        melson, motion.q[span], motion.dt, tasks.load_left[span], None, tasks.pressure[span]
    )
    left, right = tasks.pressure[k]
    way = (left - right)[:2]
    share = float((body.zmp[1] - right[:2]) @ way / (way @ way))
    beside = body.zmp[1] - (right[:2] + share * way)  # across the line between both points
    model, data = melson.model, melson.model.createData()
    forces = [pin.Force.Zero() for _ in range(model.njoints)]
    q = motion.q[k]
    pin.framesForwardKinematics(model, data, q)
    free = body.wrench[1, 5]
    wrenches = []
    for part, point in ((share, left), (1.0 - share, right)):
        force = part * body.wrench[1, :3]
        moment = np.cross(point + np.array([*beside, 0.0]), force)
        free -= moment[2]
        wrenches.append((part, force, moment))
    for side, (part, force, moment) in zip(Side, wrenches, strict=True):
        joint = model.frames[melson.sole_frames[side]].parentJoint
        world = pin.Force(force, moment + np.array([0.0, 0.0, part * free]))
        forces[joint] = data.oMi[joint].actInv(world)
    a = body.a[1].copy()
    torque = pin.rnea(model, data, q, body.v[1], a, forces)[6:] + melson.armature * a[6:]
    assert_allclose(body.torque[1], torque, atol=1e-9)
    assert 0.0 < share < 1.0
