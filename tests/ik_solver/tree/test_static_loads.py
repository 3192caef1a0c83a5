"""Gravity torques on two soles: balance, contact limits, least torque, continuity."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import linprog, minimize

from mgs.com_generator import ComTrajectory, generate_com
from mgs.core.constants import FRICTION
from mgs.core.contact import Side, Support
from mgs.gait import load_gait
from mgs.ik_solver.tree.static_loads import StaticLoads, loaded_gravity, shared_wrenches
from mgs.ik_solver.tree.tasks import TreeTasks
from mgs.ik_solver.tree.wrench_cones import wrench_cones
from mgs.motion.dynamics import analyse, place_on_soles
from mgs.motion_planner import plan_motion
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories
from tests.support.strategies import walk_gait

SHARINGS = ("shared", "optimal")
GRAVITY = 9.81


@pytest.fixture(scope="module")
def walk(melson: Robot) -> Stages:
    """A turning walk: soles at different yaws."""
    gait = walk_gait(n_steps=2, step_length=0.04, step_yaw=0.15, double_support=0.5)
    return run_stages(melson, gait)


@pytest.fixture(scope="module")
def trees(melson: Robot) -> tuple[TreeTasks, TreeTasks]:
    return TreeTasks(melson, Side.LEFT), TreeTasks(melson, Side.RIGHT)


def tree_at(
    trees: tuple[TreeTasks, TreeTasks], tasks: TaskTrajectory, k: int, root: Side | None = None
) -> TreeTasks:
    side = Side(tasks.root[k]) if root is None else root
    trees[side].place(pin.XYZQUATToSE3(tasks.soles[k, side]))
    return trees[side]


def wrenches_at(
    robot: Robot, stages: Stages, loads: StaticLoads, tree: TreeTasks, k: int
) -> np.ndarray:
    """Wrenches (2, 6) about the world origin on left and right sole."""
    tau, _ = tree.gravity(stages.joints.angles[k, tree.order])
    wrench, _ = loads.at(k, tau, tree.swing_jacobian())
    com, weight = stages.com.position[k], robot.mass * GRAVITY
    total = np.array([0.0, 0.0, weight, weight * com[1], -weight * com[0], 0.0])
    out = np.empty((2, 6))
    out[tree.tree.side.other], out[tree.tree.side] = wrench, total - wrench
    return out


def in_sole(stages: Stages, k: int, side: Side, wrench: np.ndarray) -> np.ndarray:
    """A wrench about the world origin, expressed about the sole's centre in the sole's axes."""
    return pin.XYZQUATToSE3(stages.tasks.soles[k, side]).actInv(pin.Force(wrench)).vector


def double_samples(stages: Stages, step: int = 7) -> np.ndarray:
    return np.flatnonzero(stages.tasks.support == Support.DOUBLE)[::step]


# --- statics ----------------------------------------------------------------------------------


@pytest.mark.parametrize("sharing", SHARINGS)
def test_torques_are_those_of_rnea_with_the_contact_wrenches_applied(
    melson: Robot, walk: Stages, trees, sharing
):
    """Without acceleration the floating base needs no force and the joints need tau."""
    loads = StaticLoads(melson, walk.tasks, walk.com, sharing)
    model, data = melson.model, melson.model.createData()
    rest = np.zeros(model.nv)
    for k in double_samples(walk):
        tree = tree_at(trees, walk.tasks, k)
        wrenches = wrenches_at(melson, walk, loads, tree, k)
        q = walk.motion.q[k]
        pin.forwardKinematics(model, data, q)
        external = pin.StdVec_Force()
        external.extend([pin.Force.Zero() for _ in range(model.njoints)])
        for side in Side:
            joint = model.frames[melson.sole_frames[side]].parentJoint
            external[joint] = data.oMi[joint].actInv(pin.Force(wrenches[side]))
        expected = pin.rnea(model, data, q, rest, rest, external)
        tau, _ = loaded_gravity(tree, loads, k, walk.joints.angles[k, tree.order])
        assert_allclose(tau, expected[6:][tree.order], atol=1e-4)  # the IK leaves 1e-5 m
        assert np.abs(expected[:6]).max() < 1e-3  # [N], [N m]: the soles carry the weight


def test_the_shared_torques_are_those_of_the_dynamics_at_rest(melson: Robot, walk: Stages, trees):
    """The motion stands still in the pose of one sample."""
    loads = StaticLoads(melson, walk.tasks, walk.com, "shared")
    for k in double_samples(walk, 23):
        tree = tree_at(trees, walk.tasks, k)
        still = np.tile(walk.joints.angles[k], (3, 1))
        soles = np.tile(walk.tasks.soles[k], (3, 1, 1))
        q = place_on_soles(melson, still, np.full(3, walk.tasks.root[k], np.int8), soles)
        torque = analyse(melson, q, 0.01, np.full(3, walk.tasks.load_left[k])).torque[1]
        tau, _ = loaded_gravity(tree, loads, k, still[0, tree.order])
        assert_allclose(tau, torque[tree.order], atol=1e-4)


def test_the_least_torque_keeps_friction_rectangle_and_load_of_both_soles(
    melson: Robot, walk: Stages, trees
):
    """In a slow walk the shared pressure lies inside the soles: no rectangle is widened."""
    loads = StaticLoads(melson, walk.tasks, walk.com, "optimal")
    weight = melson.mass * GRAVITY
    used = 0.0
    for k in double_samples(walk, 3):
        tree = tree_at(trees, walk.tasks, k)
        both = wrenches_at(melson, walk, loads, tree, k)
        shares = (walk.tasks.load_left[k], 1.0 - walk.tasks.load_left[k])
        for side in Side:
            fx, fy, fz, mx, my, _ = in_sole(walk, k, side, both[side])
            spec, near = melson.sole_spec(side), 1e-6 * weight
            assert fz == pytest.approx(shares[side] * weight, abs=1e-9 * weight)
            assert max(abs(fx), abs(fy)) <= FRICTION * fz + near
            shared = in_sole(walk, k, side, loads_of_shared(melson, walk, k)[side])
            assert abs(mx) <= max(0.5 * spec.width * fz, abs(shared[3])) + near
            assert abs(my) <= max(0.5 * spec.length * fz, abs(shared[4])) + near
            used = max(used, abs(fy))
    assert used > 0.02 * weight  # the freedom is used


def loads_of_shared(robot: Robot, stages: Stages, k: int) -> np.ndarray:
    weight = robot.mass * GRAVITY
    return shared_wrenches(weight, stages.tasks, stages.com.position)[k]


def test_a_wrench_is_in_the_cone_exactly_if_four_corner_forces_make_it(melson: Robot, walk: Stages):
    """Oracle: a linear program over friction pyramids at the corners of the sole."""
    k, side = int(double_samples(walk)[9]), Side.RIGHT
    both = shared_wrenches(melson.mass * GRAVITY, walk.tasks, walk.com.position)
    U = wrench_cones(melson, side, walk.tasks, both)[k]
    T_world_sole = pin.XYZQUATToSE3(walk.tasks.soles[k, side])
    spec = melson.sole_spec(side)
    rays = []
    for x in (-0.5 * spec.length, 0.5 * spec.length):
        for y in (-0.5 * spec.width, 0.5 * spec.width):
            for fx in (-FRICTION, FRICTION):
                for fy in (-FRICTION, FRICTION):
                    f = np.array([fx, fy, 1.0])
                    rays.append(np.concatenate([f, np.cross([x, y, 0.0], f)]))
    rays = np.array(rays).T
    rng = np.random.default_rng(5)
    inside = 0
    for _ in range(300):
        local = rng.normal(size=6) * [0.25, 0.25, 0.0, 0.012, 0.02, 0.006] + [0, 0, 1, 0, 0, 0]
        found = linprog(np.zeros(rays.shape[1]), A_eq=rays, b_eq=local).status == 0
        rows = U @ T_world_sole.act(pin.Force(local)).vector
        assert (rows.max() <= 0.0) == found or abs(rows.max()) < 1e-9
        inside += found
    assert 50 < inside < 250


def test_the_least_torque_is_the_optimum_that_a_general_solver_finds(
    melson: Robot, walk: Stages, trees
):
    loads = StaticLoads(melson, walk.tasks, walk.com, "optimal")
    weight = melson.mass * GRAVITY
    both = shared_wrenches(weight, walk.tasks, walk.com.position)
    cones = [wrench_cones(melson, side, walk.tasks, both) for side in Side]
    rng = np.random.default_rng(2)
    gains = []
    for k in rng.choice(double_samples(walk, 1), 12, replace=False):
        if not 0.02 < walk.tasks.load_left[k] < 0.98:
            continue
        tree = tree_at(trees, walk.tasks, k)
        side = tree.tree.side
        tau, _ = tree.gravity(walk.joints.angles[k, tree.order])
        J = tree.swing_jacobian()
        shared, total = both[k, side.other], both[k].sum(axis=0)
        U_other, U_root = cones[side.other][k], cones[side][k]
        centre = walk.tasks.soles[k, side.other, :3]

        def wrench(y, shared=shared, centre=centre):
            force = np.array([y[0], y[1], 0.0])
            moment = np.cross(centre, force) + 0.1 * y[2:]
            return shared + np.concatenate([force, moment])

        def cost(y, tau=tau, J=J, wrench=wrench):
            return 0.5 * np.sum((tau - J.T @ wrench(y)) ** 2)

        limits = [
            {"type": "ineq", "fun": lambda y, U=U_other, w=wrench: -U @ w(y)},
            {"type": "ineq", "fun": lambda y, U=U_root, w=wrench, s=total: -U @ (s - w(y))},
        ]
        found = minimize(
            cost, np.zeros(5), constraints=limits, method="SLSQP",
            options={"ftol": 1e-14, "maxiter": 500},
        )  # fmt: skip
        loaded, _ = loaded_gravity(tree, loads, k, walk.joints.angles[k, tree.order])
        assert 0.5 * loaded @ loaded == pytest.approx(found.fun, rel=1e-4)
        gains.append(1.0 - found.fun / cost(np.zeros(5)))
    assert len(gains) >= 5 and max(gains) > 0.01


# --- gradient and continuity ------------------------------------------------------------------


@pytest.mark.parametrize("sharing", SHARINGS)
@pytest.mark.parametrize("side", list(Side))
def test_the_gradient_of_the_gravity_task_is_that_of_finite_differences(
    melson: Robot, walk: Stages, trees, sharing, side: Side
):
    """The minimum over the wrench is included: its derivative is that at the minimiser."""
    loads = StaticLoads(melson, walk.tasks, walk.com, sharing)
    on_side = [k for k in double_samples(walk, 11) if walk.tasks.root[k] == side]
    assert len(on_side) > 2

    def cost(tree: TreeTasks, k: int, q: np.ndarray) -> float:
        tau, _ = loaded_gravity(tree, loads, k, q)
        return 0.5 * float(tau @ tau)

    for k in on_side:
        tree = tree_at(trees, walk.tasks, k)
        q = walk.joints.angles[k, tree.order]
        tau, derivative = loaded_gravity(tree, loads, k, q)
        steps = 1e-5 * np.eye(melson.n)
        ahead = np.array([cost(tree, k, q + dq) for dq in steps])
        behind = np.array([cost(tree, k, q - dq) for dq in steps])
        # the damping of the free components: 1e-6 of them
        assert_allclose(tau @ derivative, (ahead - behind) / 2e-5, atol=2e-5)


@pytest.mark.parametrize("sharing", SHARINGS)
def test_torques_do_not_depend_on_the_root_of_the_tree(melson: Robot, walk: Stages, trees, sharing):
    """While both soles stand on the ground, both trees give the same torques."""
    tasks = walk.tasks
    swapped = TaskTrajectory(**{**vars(tasks), "root": (1 - tasks.root).astype(np.int8)})
    both = [StaticLoads(melson, t, walk.com, sharing) for t in (tasks, swapped)]
    for k in double_samples(walk):
        torques = []
        for t, loads in zip((tasks, swapped), both, strict=True):
            tree = tree_at(trees, t, k)
            tau, out = loaded_gravity(tree, loads, k, walk.joints.angles[k, tree.order])[0], []
            out = np.empty(melson.n)
            out[tree.order] = tau
            torques.append(out)
        assert_allclose(*torques, atol=1e-4)  # [N m]


@pytest.mark.parametrize("sharing", SHARINGS)
def test_torques_are_continuous_through_all_phases(melson: Robot, sharing):
    """Halving the period halves the largest change from sample to sample."""
    jumps = []
    for dt in (0.01, 0.005):
        gait = walk_gait(n_steps=2, step_length=0.05, dt=dt)
        stages = run_stages(melson, gait)
        loads = StaticLoads(melson, stages.tasks, stages.com, sharing)
        torques = np.empty_like(stages.joints.angles)
        pair = TreeTasks(melson, Side.LEFT), TreeTasks(melson, Side.RIGHT)
        for k, q in enumerate(stages.joints.angles):
            tree = tree_at(pair, stages.tasks, k)
            torques[k, tree.order] = loaded_gravity(tree, loads, k, q[tree.order])[0]
        jumps.append(np.abs(np.diff(torques, axis=0)).max())
    assert jumps[1] < 0.6 * jumps[0]


def test_in_single_support_the_torques_are_those_of_gravity_alone(
    melson: Robot, walk: Stages, trees
):
    for sharing in SHARINGS:
        loads = StaticLoads(melson, walk.tasks, walk.com, sharing)
        single = walk.tasks.support != Support.DOUBLE
        assert not loads.loaded[single].any()
        assert loads.loaded[double_samples(walk)].mean() > 0.9


# --- in the closed-loop IK --------------------------------------------------------------------


def torques_of(robot: Robot, sharing: str) -> np.ndarray:
    settings = ("ik.gamma_joint=0.35", "ik.gamma_grav=1.6", f"ik.double_support={sharing}")
    one_com = "com.passes=0"  # not one corrected for either scheme
    return run_stages(robot, load_gait("melson/s3", (*settings, one_com))).motion.torque


@pytest.mark.parametrize("sharing", SHARINGS)
def test_a_walk_needs_less_torque_than_with_the_scheme_of_the_article(melson: Robot, sharing):
    """Peak and RMS torque of all joints over the motion, by inverse dynamics.

    The scheme of the article switches the minimization of torques off in double support.
    """
    paper, ours = torques_of(melson, "off"), torques_of(melson, sharing)
    assert np.abs(ours).max() < 0.99 * np.abs(paper).max()
    assert np.mean(ours**2) < 0.96 * np.mean(paper**2)


@pytest.mark.parametrize("sharing", SHARINGS)
def test_tasks_are_met_with_every_rule_of_load_sharing(melson: Robot, sharing):
    gait = walk_gait(n_steps=2, step_length=0.05, ik={"gamma_grav": 1.6, "double_support": sharing})
    motion = run_stages(melson, gait).motion
    assert np.abs(motion.com - motion.com_ref).max() < 2e-4
    assert np.abs(motion.soles - motion.soles_ref).max() < 1e-4


def test_off_may_be_written_without_quotes_in_yaml():
    gait = load_gait("melson/walk_5cm", ("ik.double_support=off",))
    assert gait.ik.double_support == "off"


def test_computing_the_loads_changes_no_input(melson: Robot):
    tasks = plan_trajectories(plan_motion(melson, walk_gait(n_steps=1)))
    com: ComTrajectory = generate_com(melson, tasks, walk_gait(n_steps=1).com)
    before = tasks.soles.copy(), com.position.copy()
    StaticLoads(melson, tasks, com, "optimal")
    assert np.array_equal(before[0], tasks.soles) and np.array_equal(before[1], com.position)
