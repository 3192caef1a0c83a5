"""The robot re-rooted at a sole, against the same robot with a floating base.

The oracle never turns a joint round: it moves Pinocchio's floating-base model so that the sole
stands where it should. With the sole held still the base follows the joints,

    v = Z v_joints,   Z = [ -J_b^-1 J_r ; I ]        [J_b J_r] the Jacobian of the sole
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.contact import Side
from mgs.ik_solver.tree.support_tree import build_support_tree
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.robot import Robot

STEP = 1e-6  # [rad] of a central difference: its error is STEP^2 times a third derivative
T_WORLD_SOLE = pin.SE3(pin.utils.rotate("z", 0.7), np.array([0.3, -0.2, 0.05]))

pytestmark = pytest.mark.parametrize("side", list(Side), ids=lambda side: side.label)


def random_angles(robot: Robot, n: int = 5) -> np.ndarray:
    return np.random.default_rng(7).uniform(robot.lower, robot.upper, size=(n, robot.n))


def standing(robot: Robot, side: Side, joints: np.ndarray) -> tuple[np.ndarray, pin.Data]:
    """Configuration and kinematics of the floating robot whose sole is at T_WORLD_SOLE."""
    q = np.concatenate([pin.neutral(robot.model)[:7], joints])
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    q[:7] = pin.SE3ToXYZQUAT(T_WORLD_SOLE * data.oMf[robot.sole_frames[side]].inverse())
    pin.framesForwardKinematics(robot.model, data, q)
    return q, data


def held_by_the_sole(robot: Robot, side: Side, q: np.ndarray) -> np.ndarray:
    """Z (6 + n, n): velocities of the floating robot that leave the sole where it is."""
    data = robot.model.createData()
    pin.computeJointJacobians(robot.model, data, q)
    J = pin.getFrameJacobian(robot.model, data, robot.sole_frames[side], pin.LOCAL)
    return np.concatenate([-np.linalg.solve(J[:, :6], J[:, 6:]), np.eye(robot.n)])


def potential_energy(robot: Robot, side: Side, joints: np.ndarray) -> float:
    q, _ = standing(robot, side, joints)
    return float(pin.computePotentialEnergy(robot.model, robot.model.createData(), q))


def central_difference(function, joints: np.ndarray) -> np.ndarray:
    """Derivative (..., n) of a function of the joint angles."""
    columns = []
    for j in range(len(joints)):
        ahead, behind = joints.copy(), joints.copy()
        ahead[j] += STEP
        behind[j] -= STEP
        columns.append((np.asarray(function(ahead)) - function(behind)) / (2.0 * STEP))
    return np.stack(columns, axis=-1)


def test_the_tree_contains_every_joint_once(any_robot: Robot, side: Side):
    tree = build_support_tree(any_robot, side)
    assert sorted(tree.order) == list(range(any_robot.n))
    names = [tree.model.names[j] for j in range(1, tree.model.njoints)]
    assert names == [any_robot.joint_names[j] for j in tree.order]


def test_frames_are_where_the_floating_robot_has_them(any_robot: Robot, side: Side):
    tree = build_support_tree(any_robot, side)
    tree.place(T_WORLD_SOLE)
    base = any_robot.model.getBodyId(any_robot.spec.base_link)
    pairs = [
        (tree.swing_sole, any_robot.sole_frames[side.other]),
        (tree.hands[0], any_robot.hand_frames[0]),
        (tree.hands[1], any_robot.hand_frames[1]),
        (tree.base, base),
    ]
    for joints in random_angles(any_robot):
        _, expected = standing(any_robot, side, joints)
        data = tree.model.createData()
        pin.framesForwardKinematics(tree.model, data, joints[tree.order])
        for here, there in pairs:
            assert_allclose(data.oMf[here].homogeneous, expected.oMf[there].homogeneous, atol=1e-12)


def test_placing_the_tree_again_replaces_the_last_place(melson: Robot, side: Side):
    once, twice = build_support_tree(melson, side), build_support_tree(melson, side)
    once.place(T_WORLD_SOLE)
    twice.place(T_WORLD_SOLE.inverse())
    twice.place(T_WORLD_SOLE)
    for a, b in zip(once.model.jointPlacements, twice.model.jointPlacements, strict=True):
        assert_allclose(a.homogeneous, b.homogeneous, rtol=0)


def test_the_mass_matrix_is_that_of_the_floating_robot_held_by_its_sole(
    any_robot: Robot, side: Side
):
    """The mass matrix depends on every inertia, so that a misplaced one would change it."""
    tree = build_support_tree(any_robot, side)
    for joints in random_angles(any_robot):
        q, _ = standing(any_robot, side, joints)
        Z = held_by_the_sole(any_robot, side, q)
        full = pin.crba(any_robot.model, any_robot.model.createData(), q, pin.Convention.WORLD)
        held = np.triu(full) + np.triu(full, 1).T  # only its upper half is filled
        expected = (Z.T @ held @ Z)[np.ix_(tree.order, tree.order)]
        M = pin.crba(tree.model, tree.model.createData(), joints[tree.order], pin.Convention.WORLD)
        assert_allclose(np.triu(M), np.triu(expected), atol=1e-10)  # [kg m^2] of up to 1e1


def test_the_model_has_the_mass_and_the_com_of_the_whole_robot(any_robot: Robot, side: Side):
    """The root link too, although a fixed-base model ignores the mass of its root link."""
    tree = build_support_tree(any_robot, side)
    tree.place(T_WORLD_SOLE)
    assert pin.computeTotalMass(tree.model) == pytest.approx(any_robot.mass, rel=1e-12)
    for joints in random_angles(any_robot):
        q, data = standing(any_robot, side, joints)
        expected = pin.centerOfMass(any_robot.model, data, q)
        com = pin.centerOfMass(tree.model, tree.model.createData(), joints[tree.order])
        offset = T_WORLD_SOLE.rotation @ tree.com_offset
        assert_allclose(com + offset, expected, atol=1e-12)


def test_gravity_torques_are_those_of_the_floating_robot_held_by_its_sole(
    any_robot: Robot, side: Side
):
    """Compared with virtual work, Z^T g, and with eq. (24) of the paper, -J_com^T M g."""
    tasks = TreeTasks(any_robot, side)
    tasks.place(T_WORLD_SOLE)
    for joints in random_angles(any_robot):
        q, _ = standing(any_robot, side, joints)
        g = pin.computeGeneralizedGravity(any_robot.model, any_robot.model.createData(), q)
        expected = (held_by_the_sole(any_robot, side, q).T @ g)[tasks.order]
        scale = any_robot.mass * 9.81  # [N] times about 1 m
        tau, _ = tasks.gravity(joints[tasks.order])
        assert_allclose(tau, expected, atol=1e-11 * scale)
        tasks.update(joints[tasks.order])
        weight = any_robot.mass * np.array([0.0, 0.0, -9.81])
        assert_allclose(-tasks.J[9:12].T @ weight, expected, atol=1e-11 * scale)


def test_gravity_torques_are_the_slope_of_the_potential_energy(any_robot: Robot, side: Side):
    tasks = TreeTasks(any_robot, side)
    tasks.place(T_WORLD_SOLE)
    for joints in random_angles(any_robot, 3):
        slope = central_difference(lambda x: potential_energy(any_robot, side, x), joints)
        tau, _ = tasks.gravity(joints[tasks.order])
        # rounding: energies of up to 1e2 J over 2e-6 rad leave 1e-8
        assert_allclose(tau, slope[tasks.order], atol=1e-7)


def test_the_derivative_of_gravity_torques_is_their_difference_quotient(
    any_robot: Robot, side: Side
):
    tasks = TreeTasks(any_robot, side)
    tasks.place(T_WORLD_SOLE)
    for joints in random_angles(any_robot, 3):
        q = joints[tasks.order]
        quotient = central_difference(lambda x: tasks.gravity(x)[0].copy(), q)
        _, derivative = tasks.gravity(q)
        assert_allclose(derivative, quotient, atol=1e-7)  # as above
        assert_allclose(derivative, derivative.T, atol=1e-11)  # the Hessian of an energy


def test_the_sole_may_stand_anywhere_without_changing_torques(any_robot: Robot, side: Side):
    """The sole is moved and turned about the vertical; a tilt would change the torques."""
    tasks = TreeTasks(any_robot, side)
    q = random_angles(any_robot, 1)[0][tasks.order]
    here, _ = (x.copy() for x in tasks.gravity(q))
    tasks.place(T_WORLD_SOLE)
    assert_allclose(tasks.gravity(q)[0], here, atol=1e-11)
