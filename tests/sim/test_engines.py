"""Both engines against Pinocchio: they must simulate the robot that was planned for."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from mgs.errors import SimulationError
from mgs.sim import DEFAULTS, ENGINES, EngineName, available_engines
from mgs.sim.audit import audit, random_q
from mgs.sim.engine import make_engine
from mgs.sim.model import joint_axis, simulation_urdf
from tests.sim.motions import melson

Array = NDArray[np.float64]


@pytest.fixture(params=ENGINES)
def name(request: pytest.FixtureRequest) -> EngineName:
    """Every engine; those that are not installed are skipped."""
    pytest.importorskip(request.param)
    return request.param  # type: ignore[no-any-return]


def test_forward_kinematics_and_com_equal_pinocchios_at_random_postures(name):
    robot, rng = melson(), np.random.default_rng(1)
    data = robot.model.createData()
    engine = make_engine(name, robot, DEFAULTS[name])
    for _ in range(10):
        q = random_q(robot, rng)
        engine.place(q)
        model = engine.inspect()
        com = pin.centerOfMass(robot.model, data, q)
        np.testing.assert_allclose(model.com, com, atol=1e-9)
        for joint, pose in enumerate(model.links, start=1):
            expected = data.oMi[joint]
            actual = pin.XYZQUATToSE3(pose)
            np.testing.assert_allclose(actual.homogeneous, expected.homogeneous, atol=1e-9)
    engine.close()


def test_reading_returns_what_was_placed(name):
    robot = melson()
    q = random_q(robot, np.random.default_rng(2))
    engine = make_engine(name, robot, DEFAULTS[name])
    engine.place(q)
    np.testing.assert_allclose(pin.difference(robot.model, q, engine.read()), 0, atol=1e-9)
    engine.close()


def test_pybullet_keeps_the_inertias_of_the_urdf():
    """Its joint-space mass matrix is an oracle for every inertia at once."""
    pytest.importorskip("pybullet")
    robot = melson()
    engine = make_engine("pybullet", robot, DEFAULTS["pybullet"])
    q = random_q(robot, np.random.default_rng(3))
    engine.place(q)
    mass = np.array(
        engine._p.calculateMassMatrix(engine._body, q[7:].tolist(), physicsClientId=engine._client)
    )
    expected = pin.crba(robot.model, robot.model.createData(), q)
    order = [robot.joint_names.index(name) for name in bullet_order(engine)]
    joints = 6 + np.array(order)
    np.testing.assert_allclose(mass[6:, 6:], expected[np.ix_(joints, joints)], atol=1e-7)


def test_mujoco_keeps_the_inertias_of_the_urdf():
    """Its joint-space mass matrix, less the servos' armature, is an oracle for every inertia."""
    mujoco = pytest.importorskip("mujoco")
    robot = melson()
    engine = make_engine("mujoco", robot, DEFAULTS["mujoco"])
    q = random_q(robot, np.random.default_rng(3))
    engine.place(q)
    full = np.zeros((robot.model.nv, robot.model.nv))
    mujoco.mj_fullM(engine._model, full, engine._data.qM)
    joints = engine._angles - 1  # the free joint has one velocity less than positions
    expected = pin.crba(robot.model, robot.model.createData(), q)[6:, 6:] + np.diag(robot.armature)
    np.testing.assert_allclose(full[np.ix_(joints, joints)], expected, atol=1e-7)
