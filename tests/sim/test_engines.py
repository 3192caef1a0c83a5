"""Both engines against Pinocchio: they must simulate the robot that was planned for."""

from __future__ import annotations

import dataclasses
from contextlib import closing

import numpy as np
import pinocchio as pin
import pytest

from mgs.core import engines
from mgs.core.errors import SimulationError
from mgs.sim import DEFAULTS, available_engines
from mgs.sim.audit import audit, random_q
from mgs.sim.engine import make_engine

EXACT = 1e-6  # [m], [rad], [kg m^2]; PyBullet keeps the base's inertial frame in single precision


def test_an_engine_has_pinocchios_links_com_and_inertia_at_random_postures(engine_name, any_robot):
    rng = np.random.default_rng(1)
    data = any_robot.model.createData()
    with closing(make_engine(engine_name, any_robot, DEFAULTS[engine_name])) as simulator:
        for _ in range(10):
            q = random_q(any_robot, rng)
            simulator.place(q)
            model = simulator.inspect()
            com = pin.centerOfMass(any_robot.model, data, q)
            links = [placement.homogeneous for placement in data.oMi.tolist()[1:]]
            upper = np.triu(pin.crba(any_robot.model, data, q)[6:, 6:])
            np.testing.assert_allclose(model.com, com, atol=EXACT)
            np.testing.assert_allclose(np.triu(model.inertia), upper, atol=EXACT)
            poses = [pin.XYZQUATToSE3(pose).homogeneous for pose in model.links]
            np.testing.assert_allclose(poses, links, atol=EXACT)


def test_reading_returns_what_was_placed(engine_name, any_robot):
    q = random_q(any_robot, np.random.default_rng(2))
    with closing(make_engine(engine_name, any_robot, DEFAULTS[engine_name])) as simulator:
        simulator.place(q)
        np.testing.assert_allclose(
            pin.difference(any_robot.model, q, simulator.read()), 0.0, atol=EXACT
        )


def heavier(robot, joint):
    """The robot with 2 g more at the CoM of one link."""
    robot = dataclasses.replace(robot, model=robot.model.copy())
    inertia = robot.model.inertias[joint]
    robot.model.inertias[joint] = pin.Inertia(inertia.mass + 0.002, inertia.lever, inertia.inertia)
    return robot


def lopsided(robot, joint):
    """The robot with the CoM of its heaviest link 20 mm aside."""
    robot = dataclasses.replace(robot, model=robot.model.copy())
    robot.model.inertias[joint].lever += np.array([0.0, 0.02, 0.0])
    return robot


def bloated(robot, joint):
    """The robot with twice the rotational inertia in one link."""
    robot = dataclasses.replace(robot, model=robot.model.copy())
    inertia = robot.model.inertias[joint]
    robot.model.inertias[joint] = pin.Inertia(inertia.mass, inertia.lever, 2.0 * inertia.inertia)
    return robot


def displaced(robot, joint):
    """The robot with one joint 2 mm aside."""
    robot = dataclasses.replace(robot, model=robot.model.copy())
    robot.model.jointPlacements[joint].translation += np.array([0.002, 0.0, 0.0])
    return robot


def turned(robot, joint):
    """The robot with one joint turned back to front, which reverses its sense."""
    robot = dataclasses.replace(robot, model=robot.model.copy())
    placement = robot.model.jointPlacements[joint]
    placement.rotation = placement.rotation @ np.diag([-1.0, -1.0, 1.0])
    return robot


def narrower(robot, joint):
    """The robot with one joint range cut."""
    upper = robot.upper.copy()
    upper[joint - 2] -= 0.01
    return dataclasses.replace(robot, upper=upper)


def renamed(robot, joint):
    """The robot with another name for one joint."""
    names = list(robot.joint_names)
    names[joint - 2] = "another"
    return dataclasses.replace(robot, joint_names=tuple(names))


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (heavier, "mass"),
        (lopsided, "CoM"),
        (bloated, "inertia"),
        (displaced, "link of waist_yaw"),
        (turned, "link of waist_yaw"),
        (narrower, "torque limit of waist_yaw"),
        (renamed, "another"),
    ],
)
def test_the_audit_rejects_another_robot(engine_name, melson, change, complaint):
    waist = melson.model.getJointId("waist_yaw")
    with closing(make_engine(engine_name, melson, DEFAULTS[engine_name])) as simulator:
        audit(simulator, melson, engine_name)
        with pytest.raises(SimulationError, match=complaint):
            audit(simulator, change(melson, waist), engine_name)


def test_a_torque_is_never_above_the_stall_torque(engine_name, melson):
    """Targets a whole radian away ask of every servo all it has, and no more."""
    q = melson.standing_q
    target = np.tile(q[7:] + 1.0, (20, 1))
    with closing(make_engine(engine_name, melson, DEFAULTS[engine_name])) as simulator:
        simulator.place(q)
        torque = np.abs(simulator.drive(target, np.zeros_like(target)))
    assert (torque <= melson.torque_limit * (1 + 1e-9)).all()
    np.testing.assert_allclose(torque[0], melson.torque_limit, rtol=1e-6)


def test_a_missing_engine_is_named(monkeypatch, melson):
    monkeypatch.setattr(engines.importlib.util, "find_spec", lambda name: None)
    assert available_engines() == ()
    with pytest.raises(SimulationError, match="mujoco is not installed"):
        make_engine("mujoco", melson, DEFAULTS["mujoco"])


def test_an_unknown_engine_is_refused(melson):
    with pytest.raises(SimulationError, match="pybullet, mujoco"):
        make_engine("bullet", melson, DEFAULTS["mujoco"])


def test_importing_the_simulation_imports_no_engine():
    import subprocess
    import sys

    code = "import sys, mgs.sim; print([m for m in ('pybullet', 'mujoco') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
