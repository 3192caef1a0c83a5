"""Robots whose legs have coupled joints: inverse kinematics, torques and physics."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import mgs
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError
from mgs.ik_solver.tree.static_loads import loaded_gravity
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.judge.motion_checks import check_motion
from mgs.motion import Motion
from mgs.motion_file.read import read_info
from mgs.robot import Robot, load_robot
from mgs.robot.init import init_robot, write_robot
from mgs.sim.engine import make_engine
from mgs.sim.settings import DEFAULTS, ENGINES, EngineName
from tests.support.nao_like import nao_like


@pytest.fixture(scope="module")
def nao(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    folder = tmp_path_factory.mktemp("nao")
    (folder / "nao.urdf").write_text(nao_like())
    write_robot(init_robot(folder / "nao.urdf"), folder / "robot")
    return load_robot(folder / "robot")


@pytest.fixture(scope="module")
def walk(nao: Robot) -> Motion:
    return mgs.generate(nao, "walk", walk__n_steps=4)


@pytest.fixture(scope="module")
def turn(nao: Robot) -> Motion:
    return mgs.generate(nao, "walk", walk__n_steps=4, walk__step_yaw=0.2, walk__step_length=0.0)


@pytest.fixture(scope="module")
def kick(nao: Robot) -> Motion:
    return mgs.generate(nao, "melson/kick", kick__com_height=0.25)


MOTIONS = ["walk", "turn", "kick"]


@pytest.fixture
def motion(request: pytest.FixtureRequest) -> Motion:
    found: Motion = request.getfixturevalue(request.param)
    return found


@pytest.mark.parametrize("side", Side)
def test_task_jacobians_are_derivatives_by_the_angles_of_the_motors(nao: Robot, side: Side):
    tree, step = TreeTasks(nao, side), 1e-6
    tree.place(pin.SE3.Identity())
    rng = np.random.default_rng(0)
    q = rng.uniform(nao.lower, nao.upper)[tree.order]
    assert len(tree.order) == nao.n - 1
    tree.update(q)
    J = tree.J.copy()
    J_torso = tree.torso_error(np.eye(3))[0].copy()

    def at(i: int, sign: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        moved = q.copy()
        moved[i] += sign * step
        tree.update(moved)
        return tree.f.copy(), tree.R.copy(), tree.data.oMf[tree.tree.torso].rotation.copy()

    for i in range(len(q)):
        (f1, R1, T1), (f0, R0, T0) = at(i, 1.0), at(i, -1.0)
        np.testing.assert_allclose((f1 - f0) / (2 * step), J[:12, i], atol=1e-7)
        np.testing.assert_allclose(pin.log3(R1 @ R0.T) / (2 * step), J[12:15, i], atol=1e-7)
        np.testing.assert_allclose(pin.log3(T1 @ T0.T) / (2 * step), J_torso[:, i], atol=1e-7)


def test_gravity_torques_of_motors_are_derivatives_of_the_potential_energy(nao: Robot):
    tree, step = TreeTasks(nao, Side.LEFT), 1e-5
    tree.place(pin.SE3.Identity())
    q = nao.posture[tree.order] + 0.1
    tau, derivative = (x.copy() for x in loaded_gravity(tree, None, 0, q))

    def height(x: np.ndarray) -> float:
        tree.update(x)
        return float(tree.f[11])

    weight = nao.mass * 9.81
    for i, unit in enumerate(step * np.eye(len(q))):
        slope = weight * (height(q + unit) - height(q - unit)) / (2 * step)
        assert slope == pytest.approx(tau[i], abs=1e-6)  # [N m]
        there, here = (loaded_gravity(tree, None, 0, q + s * unit)[0].copy() for s in (1.0, -1.0))
        np.testing.assert_allclose((there - here) / (2 * step), derivative[:, i], atol=1e-6)


@pytest.mark.parametrize("motion", MOTIONS, indirect=True)
@pytest.mark.slow_if("turn")
def test_the_equality_of_coupled_joints_holds_in_the_file(motion: Motion, tmp_path: Path):
    read = mgs.read_motion(mgs.write_motion(motion, tmp_path / "motion.mcap"))
    left, right = (read.robot.joint_names.index(f"{s}HipYawPitch") for s in "LR")
    joints = read.q[:, FLOATING_BASE_NQ:]
    assert np.abs(joints[:, left] - joints[:, right]).max() < 1e-9  # [rad]
    if motion.footsteps[-1].yaw or motion.gait_name.endswith("kick"):
        assert np.ptp(joints[:, left]) > 1e-4  # and they do turn
    assert read.robot.n == joints.shape[1] == 22
    assert not read.torque[:, right].any()
    told = json.loads(read_info(tmp_path / "motion.mcap")["metadata"]["followers"])
    assert told == {"RHipYawPitch": {"leader": "LHipYawPitch", "multiplier": 1.0, "offset": 0.0}}


@pytest.mark.parametrize("motion", MOTIONS, indirect=True)
@pytest.mark.slow_if("turn")
def test_its_motions_pass_the_static_checks(motion: Motion):
    assert [check.name for check in check_motion(motion) if not check.ok] == []


@pytest.mark.slow
def test_motors_do_the_work_that_the_energy_of_the_robot_shows(turn: Motion):
    """In single support no other force works, so that motor power is the rate of the energy."""
    walk, robot, data = turn, turn.robot, turn.robot.model.createData()
    energy = np.array(
        [
            pin.computeKineticEnergy(robot.model, data, q, v)
            + pin.computePotentialEnergy(robot.model, data, q)
            for q, v in zip(walk.q, walk.v, strict=True)
        ]
    )
    rate = np.gradient(energy, walk.dt)
    power = np.sum(walk.torque * walk.v[:, FLOATING_BASE_NV:], axis=1)
    single = walk.support != Support.DOUBLE
    gap = np.abs(rate - power)[single]
    # where a joint is held at a limit its acceleration jumps, and differences miss it by a sample
    assert np.quantile(gap, 0.8) < 0.02 * np.abs(power).max()
    hip = robot.joint_names.index("LHipYawPitch")
    by_hips = walk.torque[:, hip] * walk.v[:, FLOATING_BASE_NV + hip]
    without = np.abs(rate - power + by_hips)[single]
    assert np.quantile(without, 0.8) > 3.0 * np.quantile(gap, 0.8)  # so that it is no small part


@pytest.mark.parametrize("solver", ["ik1", "ik2", "ik3", "ik4", "ik5"])
def test_hard_and_soft_tasks_keep_coupled_joints_together(nao: Robot, solver: str):
    motion = mgs.generate(nao, "generic/squat", ik__solver=solver)
    left, right = (nao.joint_names.index(f"{s}HipYawPitch") for s in "LR")
    joints = motion.q[:, FLOATING_BASE_NQ:]
    assert np.abs(joints[:, left] - joints[:, right]).max() < 1e-9  # [rad]
    assert np.ptp(joints, axis=0).max() > 0.1  # it squats
    assert [check.name for check in check_motion(motion) if not check.ok] == []


@pytest.mark.parametrize("solver", ["prioritized", "prioritized-acceleration", "trajectory"])
def test_solvers_that_move_every_joint_by_itself_say_so(nao: Robot, solver: str):
    with pytest.raises(ConfigError, match=r"joints of nao_like are coupled \(RHipYawPitch\)"):
        mgs.generate(nao, "walk", ik__solver=solver)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("motion", MOTIONS, indirect=True)
@pytest.mark.slow_if("walk", "turn", "pybullet")
def test_it_stays_up_in_physics(motion: Motion, engine: EngineName):
    verdict = mgs.validate(motion, physics=engine)
    assert verdict.passed, str(verdict)


@pytest.mark.parametrize("engine", ENGINES)
def test_engines_turn_both_joints_by_the_torque_of_one_motor(nao: Robot, engine: EngineName):
    """Pushed at the motor alone, in the air, the follower turns with it."""
    physics = make_engine(engine, nao, DEFAULTS[engine], "model")
    try:
        q = nao.standing_q.copy()
        q[2] += 1.0
        physics.place(q)
        left, right = (nao.joint_names.index(f"{s}HipYawPitch") for s in "LR")
        torque = np.zeros(nao.n)
        torque[left] = 0.5
        gaps, turned = [], 0.0
        for _ in range(50):
            position = physics.push(torque, nao.no_load_speed).position
            gaps.append(abs(position[left] - position[right]))
            turned = position[left] - nao.posture[left]
        assert turned > 0.01
        assert max(gaps) < 0.02 * turned
    finally:
        physics.close()
