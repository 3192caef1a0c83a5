"""ik1 to ik5 against the problems that define them, solved by other methods.

The oracles take nothing of the solver but its robot: kinematics straight from Pinocchio, linear
problems by numpy's pseudo-inverse of the whole optimality system, eqs. (8) and (9) of Faraji and
Ijspeert by scipy's sequential quadratic programming with differences for gradients.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize

from mgs.com_generator import ComTrajectory
from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError, IkError, JointLimitError
from mgs.gait import BalanceGait, FarajiParameters, Gait, IkParameters
from mgs.ik_solver import solve_ik
from mgs.ik_solver.floating.hard_soft_report import FarajiReport
from mgs.ik_solver.floating.tasks import measure_tasks
from mgs.ik_solver.hard_soft import FarajiIk, FarajiRun
from mgs.ik_solver.qp import kkt_residual
from mgs.motion_planner import plan_motion
from mgs.pipeline import first_com
from mgs.robot import Robot, load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories
from tests.support.strategies import walk_gait

DT, SPEED, GAMMA = 0.01, 4.0, 10.0
Z_MAX = 0.5497  # [m] CoM of coman_legs on straight legs
TILTING = (
    {"task": "torso_roll", "wave": "sine", "amplitude": 0.1745, "frequency": 0.5},
    {"task": "torso_pitch", "wave": "sine", "amplitude": 0.1745, "frequency": 0.5, "phase": 1.5708},
)
Array = np.ndarray


@pytest.fixture(scope="module")
def legs() -> Robot:
    return load_robot("coman_legs")


# --- motions ----------------------------------------------------------------------------------


def squat(
    z: float,
    *more: dict[str, Any],
    dt: float = DT,
    duration: float = 3.0,
    amplitude: float = 0.05,
    ik: dict[str, Any] | None = None,
) -> BalanceGait:
    """A gait whose CoM oscillates about Z_MAX + z at 1 Hz; missed tasks are recorded."""
    channels = [
        {"task": "com_z", "wave": "sine", "amplitude": amplitude, "frequency": 1.0},
        *more,
    ]
    return BalanceGait.model_validate(
        {
            "mgs": 1,
            "motion": "balance",
            "dt": dt,
            "balance": {
                "duration": duration,
                "rest": 0.2,
                "ease": 0.5,
                "com_height": Z_MAX + z,
                "com_tolerance": 0.3,
                "channels": channels,
            },
            "ik": {"on_limit": "record", "solver": "ik4", **(ik or {})},
        }
    )


def inputs(robot: Robot, gait: Gait) -> tuple[TaskTrajectory, ComTrajectory]:
    tasks = plan_trajectories(plan_motion(robot, gait))
    return tasks, first_com(robot, gait, tasks)


def started(robot: Robot, gait: Gait, **changes: Any) -> FarajiRun:
    run = FarajiRun(
        FarajiIk.from_parameters(gait.ik.model_copy(update=changes)), robot, *inputs(robot, gait)
    )
    run.start()
    return run


def whole(robot: Robot, gait: Gait, **changes: Any) -> FarajiRun:
    """A run that has finished its last sample."""
    run = started(robot, gait, **changes)
    for k in range(len(run.configurations)):
        run.step(k)
    return run


@functools.cache
def squatting(method: str, task: str, iterations: int) -> tuple[FarajiRun, FarajiReport]:
    """Tasks B and C of the paper: a CoM out of reach of the legs, without and with a tilt."""
    tuning = {"damping": 1e-2, "speed_max": SPEED, "gamma": GAMMA}
    gait = squat(
        -0.03,
        *(TILTING if task == "C" else ()),
        ik={"solver": method, "iterations": iterations, "faraji": tuning},
    )
    run = whole(load_robot("coman_legs"), gait)
    return run, run.finish().report_of(FarajiReport)


# --- kinematics of the oracles ------------------------------------------------------------------


class Body:
    """Soles, torso and CoM of a robot, hard rows first: (15,) and (3,)."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.model, self.data = robot, robot.model, robot.model.createData()

    def places(self, q: Array) -> tuple[Array, list[pin.SE3], Array]:
        """CoM, soles, rotation of the torso."""
        pin.framesForwardKinematics(self.model, self.data, q)
        com = pin.centerOfMass(self.model, self.data, q).copy()
        soles = [self.data.oMf[frame].copy() for frame in self.robot.sole_frames]
        return com, soles, self.data.oMf[self.robot.torso_frame].rotation.copy()

    def hard_error(self, q: Array, soles: list[pin.SE3], torso: Array) -> Array:
        _, found, R = self.places(q)
        rows = []
        for wanted, actual in zip(soles, found, strict=True):
            rows.append(wanted.translation - actual.translation)
            rows.append(pin.log3(wanted.rotation @ actual.rotation.T))
        return np.concatenate([*rows, pin.log3(torso @ R.T)])

    def jacobians(self, q: Array) -> tuple[Array, Array]:
        """Hard and soft rows, (15, 6 + n) and (3, 6 + n), of world-aligned velocities."""
        model, data = self.model, self.data
        J_com = pin.jacobianCenterOfMass(model, data, q).copy()
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        frames = (*self.robot.sole_frames, self.robot.torso_frame)
        J = [pin.getFrameJacobian(model, data, f, pin.LOCAL_WORLD_ALIGNED).copy() for f in frames]
        return np.vstack([J[0], J[1], J[2][3:]]), J_com

    def tasks(self, q: Array, goal: Array, com: Array, dt: float = DT) -> tuple[Any, ...]:
        """References of two samples: those that q meets, then those of `goal` with another CoM."""
        states = [self.places(q), self.places(goal)]
        coms = np.array([states[0][0], com])
        tasks = TaskTrajectory(
            dt=dt,
            support=np.full(2, Support.DOUBLE, np.int8),
            root=np.full(2, Side.LEFT, np.int8),
            zmp_ref=coms[:, :2],
            load_left=np.full(2, 0.5),
            soles=np.array([[pin.SE3ToXYZQUAT(sole) for sole in state[1]] for state in states]),
            hands=np.full((2, 2, 3), np.nan),
            com_height=coms[:, 2],
            torso=np.array([pin.Quaternion(state[2]).coeffs() for state in states]),
            torso_asked=True,
            com=coms,
        )
        return tasks, ComTrajectory(coms, 0.0 * coms, 0.0 * coms, coms[:, :2])


@dataclass(frozen=True)
class Step:
    """Start and references of one sample."""

    body: Body
    q: Array
    goal: Array  # a configuration within the safety region that meets the hard rows
    com: Array  # reference of the CoM; that of `goal` if it is within reach

    def after(self, method: int, iterations: int, dt: float = DT, **tuning: Any) -> FarajiRun:
        """The solver's step from q."""
        solver = FarajiIk(
            method=method,
            tuning=FarajiParameters(**{"speed_max": SPEED, "gamma": GAMMA, **tuning}),
            iterations=iterations,
            keep=False,
        )
        run = FarajiRun(solver, self.body.robot, *self.body.tasks(self.q, self.goal, self.com, dt))
        run.q = self.q.copy()
        run.step(1)
        return run


def random_step(robot: Robot, seed: int, far: bool, stretched: bool, dt: float = DT) -> Step:
    """A step that the joints can take; with `far` the CoM is well out of reach."""
    rng, body = np.random.default_rng(seed), Body(robot)
    q = robot.standing_q.copy()
    joints = np.clip(robot.posture + rng.uniform(-0.3, 0.3, robot.n), robot.lower, robot.upper)
    if stretched:
        joints[[i for i, name in enumerate(robot.joint_names) if "Knee" in name]] = 0.0
    q[7:] = joints
    # the region of eq. (6), as an interval of each joint
    h, d = 0.5 * (robot.upper - robot.lower), dt * np.minimum(SPEED, robot.speed_limit)
    a, b, m = 1.0 / h**2, 1.0 / d**2, 0.5 * (robot.lower + robot.upper)
    centre = (a * m + b * joints) / (a + b)
    radius = np.sqrt(np.maximum(a + b - a * b * (joints - m) ** 2, 0.0)) / (a + b)
    base = np.zeros(robot.model.nv)
    base[:6] = 0.3 * dt * SPEED * rng.normal(size=6)
    goal = pin.integrate(robot.model, q, base)
    goal[7:] = centre + rng.uniform(-0.6, 0.6, robot.n) * radius
    com = body.places(goal)[0]
    if far:
        direction = rng.normal(size=3)
        com += direction / np.linalg.norm(direction) * rng.uniform(1.0, 4.0) * dt * SPEED
    return Step(body, q, goal, com)


def dense(H: Array, A: Array, g: Array, b: Array) -> Array:
    """Primal unknowns of the optimality system, eq. (2)."""
    K = np.block([[H, A.T], [A, np.zeros((len(b), len(b)))]])
    return (np.linalg.pinv(K, rcond=1e-13) @ np.concatenate([g, b]))[: len(H)]


def in_world(robot: Robot, q: Array) -> Array:
    """Comparable numbers of a configuration; a quaternion has two signs."""
    return np.concatenate([q[:3], pin.Quaternion(q[3:7]).matrix().ravel(), q[7:]])


# --- ik1, ik2, ik3 ------------------------------------------------------------------------------


def test_ik1_takes_the_step_of_the_closed_form(legs: Robot):
    Q, R = np.diag([3.0, 1.0, 0.2]), 1e-3
    for seed in range(10):
        step = random_step(legs, seed, far=seed % 2 == 0, stretched=False)
        body = step.body
        J_h, J_s = body.jacobians(step.q)
        E_h = body.hard_error(step.q, *body.places(step.goal)[1:])
        E_s = step.com - body.places(step.q)[0]
        H = J_s.T @ Q @ J_s + R * np.eye(len(J_h.T))
        expected = pin.integrate(legs.model, step.q, dense(H, J_h, J_s.T @ Q @ E_s, E_h))
        run = step.after(1, 15, damping=R, soft={"com": np.diag(Q).tolist()})
        assert_allclose(in_world(legs, run.q), in_world(legs, expected), atol=1e-8)


def test_ik1_does_not_break_down_where_both_legs_are_straight(legs: Robot):
    """The hard rows depend on each other there; eq. (2) takes the pseudo-inverse."""
    q = legs.standing_q.copy()
    q[7:] = 0.0
    body = Body(legs)
    J_h, J_s = body.jacobians(q)
    assert np.linalg.matrix_rank(J_h, tol=1e-8) < len(J_h)
    for lift in (-0.01, 0.01):
        com = body.places(q)[0] + [0.002, 0.0, lift]
        H = J_s.T @ J_s + 1e-2 * np.eye(len(J_h.T))
        E_s = com - body.places(q)[0]
        expected = pin.integrate(legs.model, q, dense(H, J_h, J_s.T @ E_s, np.zeros(len(J_h))))
        found = Step(body, q, q, com).after(1, 1, damping=1e-2).q
        assert_allclose(in_world(legs, found), in_world(legs, expected), atol=1e-6)


def test_ik3_equals_ik1_inside_the_region(legs: Robot):
    """These steps stay far from the edge of the region."""
    for seed in range(10):
        step = random_step(legs, seed, far=False, stretched=False)
        assert_allclose(step.after(3, 1).q, step.after(1, 1).q, atol=1e-8)


def test_ik3_keeps_the_region_where_ik1_would_leave_it(legs: Robot):
    """The target is farther than one step: the bound is kept, and the step is not that of ik1."""
    for seed in range(10):
        step = random_step(legs, seed, far=True, stretched=False)
        run = step.after(3, 1)
        assert run.region.excess(step.q[7:], run.q[7:]).max() <= 1e-9
        assert np.abs(run.q[7:] - step.after(1, 1).q[7:]).max() > 1e-3


def test_ik2_converges_to_targets_within_reach(legs: Robot):
    """ik2 meets a reachable target; ik1 leaves the nonlinear part of its error."""
    for seed in range(10):
        step = random_step(legs, seed, far=False, stretched=False)
        body, wanted = step.body, step.body.places(step.goal)
        for method, most in ((2, 1e-9), (1, np.inf)):
            q = step.after(method, 15, damping=1e-4).q
            assert np.abs(body.hard_error(q, *wanted[1:])).max() < most
            assert np.linalg.norm(step.com - body.places(q)[0]) < most
        assert np.abs(body.hard_error(q, *wanted[1:])).max() > 1e-6  # ik1 is the last method above


def test_velocities_of_ik2_solve_the_second_problem(legs: Robot):
    """Eq. (5) at the solution, for the velocities of the references."""
    gait = squat(-0.07, *TILTING, duration=2.0, ik={"solver": "ik2", "iterations": 5})
    run = whole(legs, gait)
    tasks, com = inputs(legs, gait)
    velocities = run.finish().velocities
    assert velocities is not None
    body, moving = Body(legs), 0.0
    for k in range(1, tasks.n_samples, 13):
        J_h, J_s = body.jacobians(run.configurations[k])
        H = J_s.T @ J_s + gait.ik.faraji.damping * np.eye(len(J_h.T))
        R = [pin.Quaternion(tasks.torso[i]).matrix() for i in (k - 1, k)]
        hard = np.concatenate([np.zeros(12), pin.log3(R[1] @ R[0].T)])
        soft = com.position[k] - com.position[k - 1]
        expected = dense(H, J_h, J_s.T @ soft, hard)[6:] / DT
        assert_allclose(velocities[k], expected, atol=1e-6)
        moving = max(moving, np.abs(expected).max())
    assert moving > 0.3  # [rad/s]


# --- ik4, ik5: the nonlinear problems ------------------------------------------------------------


class NonlinearProblem:
    """Eqs. (8) and (9) as functions of s, where q is q_prev moved by SCALE s."""

    SCALE, COST, ROWS = 0.01, 1e3, 100.0  # so that all figures are about 1

    def __init__(self, method: int, step: Step, dt: float) -> None:
        self.method, self.step, self.robot = method, step, step.body.robot
        self.soles, self.torso = step.body.places(step.goal)[1:]
        self.com_step = step.com - step.body.places(step.q)[0]
        self.d = dt * np.minimum(SPEED, self.robot.speed_limit)

    def q(self, s: Array) -> Array:
        return pin.integrate(self.robot.model, self.step.q, self.SCALE * s)

    def s(self, q: Array) -> Array:
        return pin.difference(self.robot.model, self.step.q, q) / self.SCALE

    def parts(self, s: Array) -> Array:
        """Terms of the sum of squares (6,) and hard rows (15,)."""
        q, body = self.q(s), self.step.body
        J_com = pin.jacobianCenterOfMass(body.model, body.data, q)
        delta = body.data.com[0] - self.step.com
        epsilon = J_com @ (self.SCALE * s) - self.com_step
        if self.method == 4:
            squared = [delta + GAMMA * epsilon, np.zeros(3)]
        else:
            squared = [delta, np.sqrt(GAMMA) * epsilon]
        return np.concatenate([*squared, self.hard(s)])

    def differences(self, s: Array, h: float = 1e-3) -> Array:
        """Derivative (21, n) of the parts, which one iteration needs twice."""
        if not np.array_equal(self._last[0], s):
            steps = h * np.eye(len(s))
            columns = [(self.parts(s + e) - self.parts(s - e)) / (2.0 * h) for e in steps]
            self._last = (s.copy(), np.array(columns).T)
        return self._last[1]

    _last: tuple[Array, Array] = (np.empty(0), np.empty(0))

    def cost(self, s: Array) -> float:
        return float(np.sum(self.parts(s)[:6] ** 2))

    def cost_gradient(self, s: Array) -> Array:
        return 2.0 * self.parts(s)[:6] @ self.differences(s)[:6]

    def hard(self, s: Array) -> Array:
        return self.step.body.hard_error(self.q(s), self.soles, self.torso)

    def region(self, s: Array) -> Array:
        """Left side of eq. (6) minus 1: 0 or less inside the region."""
        low, high, moved = self.robot.lower, self.robot.upper, self.SCALE * s[6:]
        q = self.step.q[7:] + moved
        return (2.0 * q - (low + high)) ** 2 / (high - low) ** 2 + (moved / self.d) ** 2 - 1.0

    def region_gradient(self, s: Array) -> Array:
        low, high, moved = self.robot.lower, self.robot.upper, self.SCALE * s[6:]
        q = self.step.q[7:] + moved
        slope = 4.0 * (2.0 * q - (low + high)) / (high - low) ** 2 + 2.0 * moved / self.d**2
        return np.hstack([np.zeros((len(q), 6)), np.diag(self.SCALE * slope)])

    def least(self) -> tuple[float, Array]:
        """Least cost and its minimiser, the better of two starts."""
        found: list[tuple[float, Array]] = []
        constraints = [
            {
                "type": "eq",
                "fun": lambda s: self.ROWS * self.hard(s),
                "jac": lambda s: self.ROWS * self.differences(s)[6:],
            },
            {
                "type": "ineq",
                "fun": lambda s: -self.region(s),
                "jac": lambda s: -self.region_gradient(s),
            },
        ]
        for start in (self.step.goal, self.step.q):
            best = minimize(
                lambda s: self.COST * self.cost(s),
                self.s(start),
                jac=lambda s: self.COST * self.cost_gradient(s),
                constraints=constraints,
                method="SLSQP",
                options={"ftol": 1e-12, "maxiter": 100},
            )
            if np.abs(self.hard(best.x)).max() < 1e-7 and self.region(best.x).max() < 1e-7:
                found.append((self.cost(best.x), best.x))
        return min(found, key=lambda pair: pair[0])


@pytest.mark.parametrize("stretched", [False, True], ids=["bent", "stretched"])
@pytest.mark.parametrize("far", [False, True], ids=["reachable", "unreachable"])
@pytest.mark.parametrize("method", [4, 5])
def test_the_cost_of_a_step_is_the_least_one(legs: Robot, method: int, far: bool, stretched: bool):
    """Hard rows and region are met at the least cost.

    An iteration takes the base's part of v = q - q_prev to change as the base does, but for the
    turn of |v| in between. That leaves out a part |v| of the gradient, hence |v|^2 of the cost:
    1.6e-3 with 0.04 rad; measured: 1e-4. Without the derivative of J in J v it would be 1.2e-3.
    """
    for seed in range(4):
        step = random_step(legs, seed, far, stretched)
        problem = NonlinearProblem(method, step, DT)
        least, _ = problem.least()
        for iterations, damping, off in ((50, 1e-8, 0.0), (15, 1e-4, 1e-9), (3, 1e-2, 2e-7)):
            run = step.after(method, iterations, damping=damping)
            s = problem.s(run.q)
            assert not run.elastic
            assert np.abs(problem.hard(s)).max() < 2e-6  # 1e-4 is allowed
            assert problem.region(s).max() <= 1e-9
            assert problem.cost(s) <= least * (1.0 + 5e-4) + 1e-12 + off


@pytest.mark.parametrize("method", [4, 5])
def test_three_iterations_come_close_to_fifty(legs: Robot, method: int):
    """Convergence is quadratic: 2e-9 would remain if the derivative were off by a twentieth."""
    for seed in range(6):
        step = random_step(legs, seed, far=False, stretched=False)
        problem = NonlinearProblem(method, step, DT)
        few, many = (
            problem.cost(problem.s(step.after(method, n, damping=1e-6).q)) for n in (3, 50)
        )
        assert few - many < 1e-10


@pytest.mark.parametrize("method", [4, 5])
def test_ik4_and_ik5_cost_less_than_standing_still(legs: Robot, method: int):
    """The comparison with the least cost is meaningful only then."""
    for seed in range(4):
        step = random_step(legs, seed, far=False, stretched=True)
        problem = NonlinearProblem(method, step, DT)
        cost = problem.cost(problem.s(step.after(method, 15).q))
        assert cost < 0.1 * problem.cost(np.zeros(18))
        goal = problem.cost(problem.s(step.goal))
        assert cost <= goal * (1.0 + 2e-3) + 1e-12


def test_gamma_rows_all_is_eq_8_as_printed(legs: Robot):
    """With gamma on the hard rows, too, these are met to second order only."""
    for seed in range(6):
        step = random_step(legs, seed, far=False, stretched=False)
        body = step.body
        before, wanted = body.places(step.q), body.places(step.goal)
        q = step.after(4, 50, gamma_rows="all", damping=1e-6).q
        J_h, _ = body.jacobians(q)
        v = pin.difference(legs.model, step.q, q)
        turns = [
            pin.log3(b.rotation @ a.rotation.T) for a, b in zip(before[1], wanted[1], strict=True)
        ]
        moved = [b.translation - a.translation for a, b in zip(before[1], wanted[1], strict=True)]
        rows = [row for pair in zip(moved, turns, strict=True) for row in pair]
        xdot_dt = np.concatenate([*rows, pin.log3(wanted[2] @ before[2].T)])
        error = body.hard_error(q, *wanted[1:])
        # iterations end at steps of 1e-9, which count 1 + gamma times
        assert_allclose(error, GAMMA * (J_h @ v - xdot_dt), atol=1e-7)
        assert 1e-6 < np.abs(error).max() < 1e-2
        exact = step.after(4, 50, gamma_rows="soft", damping=1e-6).q
        assert np.abs(body.hard_error(exact, *wanted[1:])).max() < 1e-9


# --- whole motions ------------------------------------------------------------------------------


@pytest.mark.parametrize("iterations", [3, 15])
@pytest.mark.parametrize("task", ["B", "C"])
@pytest.mark.parametrize("method", ["ik3", "ik4", "ik5"])
def test_every_sample_is_within_limits_and_region(
    legs: Robot, method: str, task: str, iterations: int
):
    """Eq. (6) is evaluated from the joint angles alone; the motions reach its bound."""
    run, report = squatting(method, task, iterations)
    joints, low, high = run.finish().angles, legs.lower, legs.upper
    assert np.all((joints >= low) & (joints <= high))
    speed = np.diff(joints, axis=0) / run.dt
    g = (2.0 * joints[1:] - (low + high)) ** 2 / (high - low) ** 2 + (
        speed / np.minimum(SPEED, legs.speed_limit)
    ) ** 2
    assert g.max() <= 1.0 + 1e-9
    assert g.max() > 0.99
    assert report.recovering_samples == 0


@pytest.mark.parametrize("iterations", [3, 15])
@pytest.mark.parametrize("task", ["B", "C"])
@pytest.mark.parametrize("method", ["ik4", "ik5"])
def test_hard_tasks_are_met_while_the_legs_stretch_and_bend_again(
    legs: Robot, method: str, task: str, iterations: int
):
    run, report = squatting(method, task, iterations)
    assert report.elastic_samples == 0
    body = Body(legs)
    soles = body.places(legs.standing_q)[1]
    tasks = inputs(legs, squat(-0.03, *(TILTING if task == "C" else ())))[0]
    worst = 0.0
    for k, q in enumerate(run.configurations):
        torso = pin.Quaternion(tasks.torso[k]).matrix()
        worst = max(worst, np.abs(body.hard_error(q, soles, torso)).max())
    assert worst < 1e-4
    assert_allclose(report.hard_error, worst, atol=1e-9)
    knees = run.configurations[:, [7 + i for i, n in enumerate(legs.joint_names) if "Knee" in n]]
    assert knees.min() < np.radians(5.0)  # the knees stretch
    assert knees[-1].min() > np.radians(20.0)  # and bend again


@pytest.mark.parametrize("task", ["B", "C"])
@pytest.mark.parametrize("method", ["ik3", "ik4", "ik5"])
def test_the_last_quadratic_program_of_a_sample_is_solved(legs: Robot, method: str, task: str):
    tuning = {"damping": 1e-2, "speed_max": SPEED}
    more = TILTING if task == "C" else ()
    run = started(legs, squat(-0.03, *more, ik={"solver": method, "faraji": tuning}))
    solve, last = run.qp.solve, {}

    def remember(*problem: Array) -> Array:
        last["x"] = solve(*problem)
        return last["x"]

    run.qp.solve = remember  # type: ignore[method-assign]
    n, active = legs.model.nv, 0
    for k in range(len(run.configurations)):
        run.step(k)
        if run.qp.elastic:
            continue
        bounds = np.array([run.qp.lower[:n], run.qp.upper[:n]])
        x, lam = last["x"], run.qp.lam
        assert kkt_residual(run.H, run.g, run.A, run.b, bounds, x, lam) < 1e-7
        active += int((np.abs(lam[6:n]) > 1e-6).any())
    assert active > 20  # the bounds matter


def test_a_run_is_deterministic(legs: Robot):
    gait = squat(-0.03, *TILTING, duration=2.0)
    first, second = (whole(legs, gait).configurations for _ in range(2))
    assert np.array_equal(first, second)


def test_a_margin_is_kept_from_every_limit(legs: Robot):
    margin = np.radians(5.0)
    tuning = {"damping": 1e-2, "speed_max": SPEED, "margin": margin}
    run = whole(legs, squat(-0.03, ik={"faraji": tuning}))
    joints = run.configurations[:, 7:]
    assert np.all(joints >= legs.lower + margin - 1e-12)
    assert np.all(joints <= legs.upper - margin + 1e-12)
    knee = legs.joint_names.index("LKneeSag")
    assert joints[:, knee].min() < margin + 0.03  # it reaches the margin


def test_the_polygon_region_is_kept_as_well(legs: Robot):
    tuning = {"damping": 1e-2, "speed_max": SPEED, "region": "polygon"}
    run = whole(legs, squat(-0.03, ik={"faraji": tuning}))
    joints = run.finish().angles
    assert np.all((joints >= legs.lower) & (joints <= legs.upper))
    room = np.minimum(joints - legs.lower, legs.upper - joints)[1:]
    top = np.minimum(SPEED, legs.speed_limit)
    bound = np.minimum(top, 0.02 + 4.0 * top / (legs.upper - legs.lower) * room)
    assert np.all(np.abs(np.diff(joints, axis=0)) / run.dt <= bound + 1e-9)


# --- refusals -----------------------------------------------------------------------------------


@pytest.mark.parametrize(("margin", "joint"), [(0.5, "LHipLat at 0.0000"), (0.98, "margin")])
def test_a_margin_that_excludes_the_posture_is_refused(legs: Robot, margin: float, joint: str):
    """The second margin is more than half the range of a knee, which leaves no range."""
    gait = squat(-0.07, ik={"faraji": {"margin": margin}})
    with pytest.raises(ConfigError, match=joint):
        started(legs, gait)


@pytest.mark.parametrize("method", ["ik1", "ik2", "ik3", "ik4", "ik5"])
def test_zero_iterations_are_refused(method: str):
    parameters = IkParameters(solver=method, iterations=0)  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match=r"ik\.iterations"):
        FarajiIk.from_parameters(parameters)


def test_a_motion_that_leaves_no_hard_task_is_refused(legs: Robot):
    soft = {name: [1.0, 1.0, 1.0] for name in ("soles", "torso", "com")}
    gait = squat(-0.07, ik={"faraji": {"hard": ["hands"], "soft": soft}})
    with pytest.raises(ConfigError, match="hands"):
        started(legs, gait)


def test_hard_tasks_are_met_without_soft_tasks(legs: Robot):
    tuning = {"hard": ["soles", "torso", "com"], "soft": {"hands": [1.0, 1.0, 1.0]}}
    gait = squat(-0.07, amplitude=0.03, ik={"faraji": tuning})
    run = whole(legs, gait)
    assert run.finish().report_of(FarajiReport).elastic_samples == 0
    assert np.abs(measure_tasks(run.tasks, run.targets, run.configurations)).max() < 1e-8


def beyond_reach(method: str, on_limit: str) -> BalanceGait:
    """The CoM as a hard task, 20 mm above what straight legs reach."""
    tuning = {"hard": ["soles", "com"], "soft": {"torso": [1.0, 1.0, 1.0]}, "damping": 1e-2}
    ik = {"solver": method, "on_limit": on_limit, "faraji": tuning}
    return squat(-0.03, duration=2.0, ik=ik)


@pytest.mark.parametrize("method", ["ik1", "ik2", "ik3", "ik4", "ik5"])
def test_a_hard_task_out_of_reach_is_refused(legs: Robot, method: str):
    gait = beyond_reach(method, "refuse")
    with pytest.raises((IkError, JointLimitError)) as error:
        solve_ik(legs, *inputs(legs, gait), gait.ik)
    # the CoM reference exceeds Z_MAX first at about 0.6 s
    if isinstance(error.value, IkError):
        assert 0.2 < error.value.t < 1.5


@pytest.mark.parametrize("method", ["ik1", "ik2", "ik3", "ik4", "ik5"])
def test_on_request_a_hard_task_out_of_reach_is_recorded(legs: Robot, method: str):
    """The report contains its error; the bounds of ik3 to ik5 are kept nevertheless."""
    run = whole(legs, beyond_reach(method, "record"))
    joints = run.finish()
    assert joints.report_of(FarajiReport).hard_error > 5e-3
    assert np.all(np.isfinite(joints.angles))
    if run.solver.is_bounded:
        assert joints.report_of(FarajiReport).elastic_samples > 0
        assert np.all((joints.angles >= legs.lower) & (joints.angles <= legs.upper))


def test_ik1_and_ik2_leave_the_limits_where_ik4_does_not(legs: Robot):
    """They have no bounds, so that their motion is refused."""
    for method in ("ik1", "ik2"):
        gait = squat(-0.03, *TILTING, ik={"solver": method, "on_limit": "refuse"})
        with pytest.raises((JointLimitError, IkError)):
            solve_ik(legs, *inputs(legs, gait), gait.ik)


# --- joints left over ---------------------------------------------------------------------------

STEPS = 30
WALKS = {
    "melson": {"step_length": 0.02, "single_support": 0.5, "double_support": 0.5},
    "coman": {"step_length": 0.05, "single_support": 0.5, "double_support": 0.2},
}


@functools.cache
def walk(name: str, posture_weight: float | None) -> tuple[np.ndarray, np.ndarray, int]:
    """Joint angles, CoM errors, and samples per two steps of a long walk with ik4."""
    ik = {"solver": "ik4", "faraji": {"posture_weight": posture_weight}}
    rests = {"lead_in": 1.8, "lead_out": 1.8}
    gait = walk_gait(dt=0.02, n_steps=STEPS, ik=ik, **rests, **WALKS[name])
    run = whole(load_robot(name), gait)
    two_steps = round(2.0 * (gait.walk.single_support + gait.walk.double_support) / gait.dt)
    return (
        run.finish().angles,
        measure_tasks(run.tasks, run.targets, run.configurations)[:, len(run.E_hard) :],
        two_steps,
    )


def drift(angles: np.ndarray, two_steps: int) -> float:
    """Largest difference of joint angles between equal instants of early and late strides."""
    first = round(1.8 / 0.02) + 2 * two_steps
    last = first + 10 * two_steps
    assert last + two_steps < len(angles) - 1.8 / 0.02
    gap = angles[last : last + two_steps] - angles[first : first + two_steps]
    return float(np.abs(gap).max())


@pytest.mark.parametrize("name", WALKS)
def test_a_long_walk_of_a_redundant_robot_is_periodic(name: str):
    angles, _, two_steps = walk(name, None)
    assert drift(angles, two_steps) < 1e-5  # [rad]; iterations end at steps of 1e-7


def test_without_the_posture_term_a_long_walk_drifts():
    angles, _, two_steps = walk("coman", 0.0)
    assert drift(angles, two_steps) > 1e-2


@pytest.mark.parametrize("name", WALKS)
def test_the_posture_term_hardly_changes_the_soft_com(name: str):
    """The change is below 0.05 mm, where the CoM may deviate by 0.2 mm."""
    with_term, without = walk(name, None)[1], walk(name, 0.0)[1]
    assert np.linalg.norm(with_term - without, axis=1).max() < 5e-5
    assert np.linalg.norm(with_term, axis=1).max() < 2e-4
