"""The nonlinear program of `nonlinear_side` for Ipopt, with symbolic kinematics in CasADi.

It is built once, with exact first and second derivatives; q_prev and references are parameters.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
from nonlinear_side import Ik4Problem, Sample

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV

SERIES = 7  # terms of the exponential map's power series; exact to rounding below 0.5 rad
OPTIONS: dict[str, Any] = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.mu_init": 1e-4,  # the initial guess is close; the default 0.1 moves away from it first
}


class Ipopt:
    """Ipopt with default tolerances and an initial barrier parameter for a close guess."""

    def __init__(self, problem: Ik4Problem) -> None:
        self.problem, run = problem, problem.run
        robot, tasks = run.robot, problem.tasks
        n, nv = robot.n, robot.model.nv
        n_rotations = len(problem.rotations)
        dq, x = ca.SX.sym("dq", nv), ca.SX.sym("x", tasks.m)
        p0, R0, joints0 = ca.SX.sym("p0", 3), ca.SX.sym("R0", 3, 3), ca.SX.sym("joints0", n)
        rotations = [ca.SX.sym(f"R{i}", 3, 3) for i in range(n_rotations)]
        step = ca.SX.sym("step", tasks.m - problem.m_hard)
        joints = dq[FLOATING_BASE_NV:]
        base = _exponential(dq[:3], dq[3:6])
        poses = _poses(robot.model, (p0 + R0 @ base[0], R0 @ base[1]), joints0 + joints)
        f: list[Any] = []
        left = list(rotations)
        for part in tasks.parts[:-1]:
            assert part.frame is not None and part.turns  # soles and torso
            frame = robot.model.frames[part.frame(robot)]
            p, R = _times(poses[frame.parentJoint], frame.placement)
            if part.n_axes:
                f.append(p - x[tasks.rows[part].start : tasks.rows[part].start + 3])
            f.append(_vee(R @ left.pop(0).T))
        com = _com(robot.model, poses)
        # q + t dq = q_prev + (1 + t) dq: the derivative along dq is J(q) dq
        speed = ca.jtimes(com, dq, dq)
        delta = com - x[problem.m_hard :] + run.gamma * (speed - step)
        place = (joints0 + joints - problem.middle) / problem.half
        room = 1.0 - place**2 - (joints / problem.reach) ** 2
        parameters = [p0, ca.vec(R0), joints0, x, step, *(ca.vec(R) for R in rotations)]
        program = {
            "x": dq,
            "p": ca.vertcat(*parameters),
            "f": ca.dot(problem.weights * delta, delta),
            "g": ca.vertcat(*f, room),
        }
        self.solver = ca.nlpsol("ik4", "ipopt", program, OPTIONS)
        self.upper = np.concatenate([np.zeros(problem.m_hard), np.full(n, np.inf)])
        self.lower = np.zeros(problem.m_hard + n)

    def solve(self, sample: Sample) -> tuple[Array, int]:
        """Solve one sample; returns the step dq and the number of iterations."""
        p = self.problem
        p.set(sample)
        q = sample.q_prev
        R0 = pin.Quaternion(q[3:7]).matrix()
        parameters = [q[:3], R0.ravel("F"), q[FLOATING_BASE_NQ:], p.x, p.step]
        parameters += [R.ravel("F") for R in p.rotations]
        found = self.solver(
            x0=sample.dq, p=np.concatenate(parameters), lbg=self.lower, ubg=self.upper
        )
        dq = np.asarray(found["x"], dtype=np.float64)[:, 0]
        return dq, int(self.solver.stats()["iter_count"])


def _exponential(v: Any, w: Any) -> tuple[Any, Any]:
    """Position and rotation of exp6 of a twist, by power series, smooth at w = 0."""
    K, eye = ca.skew(w), ca.SX.eye(3)
    square = ca.dot(w, w)
    a = b = c = 0.0  # sin t / t, (1 - cos t) / t^2, (t - sin t) / t^3
    term: Any = 1.0
    for i in range(SERIES):
        order = 2 * i
        a += term
        b += term / (order + 2)
        c += term / ((order + 2) * (order + 3))
        term = -term * square / ((order + 2) * (order + 3))
    # the terms of b are 1/(2i+2)!, those of c 1/(2i+3)!; `term` is 1/(2i+1)!
    return (eye + b * K + c * (K @ K)) @ v, eye + a * K + b * (K @ K)


def _poses(model: pin.Model, base: tuple[Any, Any], joints: Any) -> list[tuple[Any, Any]]:
    """Position and rotation of every joint frame in the world, for revolute joints on one base."""
    poses: list[tuple[Any, Any]] = [(ca.SX.zeros(3), ca.SX.eye(3)), base]
    for j in range(2, model.njoints):
        axis = _axis(model, j)
        angle = joints[int(model.idx_qs[j]) - FLOATING_BASE_NQ]
        K = np.array(pin.skew(axis))
        turn = ca.DM.eye(3) + ca.sin(angle) * ca.DM(K) + (1.0 - ca.cos(angle)) * ca.DM(K @ K)
        p, R = _times(poses[model.parents[j]], model.jointPlacements[j])
        poses.append((p, R @ turn))
    return poses


def _axis(model: pin.Model, j: int) -> Array:
    """Axis (3,) of a revolute joint in its own frame."""
    data = model.joints[j].createData()
    q = np.zeros(model.nq)
    q[int(model.idx_qs[j])] = 1.0
    model.joints[j].calc(data, q)
    return np.array(pin.log3(pin.SE3(data.M).rotation))


def _times(pose: tuple[Any, Any], placement: pin.SE3) -> tuple[Any, Any]:
    p, R = pose
    return p + R @ ca.DM(placement.translation), R @ ca.DM(placement.rotation)


def _vee(R: Any) -> Any:
    """Half of the skew part of a rotation: to first order its rotation vector."""
    return 0.5 * ca.vertcat(R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])


def _com(model: pin.Model, poses: list[tuple[Any, Any]]) -> Any:
    total, mass = ca.SX.zeros(3), 0.0
    for j in range(1, model.njoints):
        inertia = model.inertias[j]
        p, R = poses[j]
        total += inertia.mass * (p + R @ ca.DM(inertia.lever))
        mass += inertia.mass
    return total / mass
