"""Hard limits of joint position and speed in the closed-loop IK.

A joint that would leave its range or exceed its speed is held at the limit, and the rest of the
body takes over: of all steps that meet the tasks and keep the limits, the one nearest to the free
step is taken.

    min 1/2 ||dq - dq_free||^2 + 1/2 ||J_low (dq - dq_free)||^2
    s.t.  J dq = error,   low <= dq <= high

This is the problem that F. Flacco, A. De Luca and O. Khatib solve by saturation in the null space
("Control of redundant robots under hard joint constraints: saturation in the null space", IEEE
Trans. Robotics 31(3), 2015), as a quadratic program.
"""

from __future__ import annotations

import daqp
import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.ik_solver.qp import EQUALITY, SOLVED, TOLERANCE
from mgs.robot import Robot

APPROACH_TIME = 0.1  # [s] a joint nears its limit by at most the remaining way in this time
MISS_WEIGHT = 1e6  # of squared task errors where no step within the limits meets the tasks
SPEED_SHARE = 1.0 - 1e-9  # of the speed limit, so that rounded differences keep it too


class JointBounds:
    """Bounds of the joints of one support tree, and the steps that keep them.

    Attributes:
        held: number of steps that the bounds have changed.
    """

    def __init__(
        self, robot: Robot, order: NDArray[np.intp], rows: NDArray[np.intp], dt: float
    ) -> None:
        """Reserve the buffers.

        Args:
            robot: the robot, whose ranges and speeds bound the joints.
            order: (n,) joints of the robot in the order of the tree.
            rows: (r,) rows of the task Jacobian that belong to a task; rows of zeros make the
                equalities of a quadratic program dependent.
            dt: sampling period [s].
        """
        self.lower, self.upper = robot.lower[order], robot.upper[order]
        self.stride = SPEED_SHARE * robot.speed_limit[order] * dt
        self._approach = min(1.0, dt / APPROACH_TIME)
        self._rows = rows
        n, m = len(order), len(rows)
        self._n = n
        self._sense = np.zeros(n + m, np.int32)
        self._sense[n:] = EQUALITY
        self._high, self._low = np.empty(n + m), np.empty(n + m)
        self.held = 0

    def are_kept(self, q: Array, path: Array) -> bool:
        """Whether joint angles path (N, n) that follow q (n,) keep ranges and speeds."""
        in_range = np.all((path >= self.lower) & (path <= self.upper))
        strides = np.abs(np.diff(path, axis=0, prepend=q[None]))
        return bool(in_range and np.all(strides <= self.stride))

    def limit(
        self, dq: Array, q: Array, q_last: Array, J: Array, error: Array, J_low: Array | None
    ) -> Array:
        """The step (n,) within the bounds that is nearest to dq (n,) and meets the tasks.

        A joint slows down before the end of its range. Only where the tasks need the rest of the
        range at once, it may stop there abruptly. Where no step within the bounds meets the tasks,
        their squared error is least.

        Args:
            dq: the free step [rad].
            q: (n,) joint angles before the step.
            q_last: (n,) joint angles of the sample before, from which speeds count; NaN: any speed.
            J: (m, n) task Jacobian.
            error: (m,) task error that the step removes.
            J_low: (l, n) weighted Jacobian of a lower task whose step is kept as far as possible;
                None: no such task.

        Raises:
            ArithmeticError: the quadratic program has no solution, which bounds alone rule out.
        """
        slowest, fastest = q_last - self.stride, q_last + self.stride
        lower, upper = np.minimum(self.lower, q), np.maximum(self.upper, q)  # no jump into a range
        gentle_low = q + self._approach * (lower - q)
        gentle_high = q + self._approach * (upper - q)
        x = q + dq
        if np.all((x >= np.fmax(slowest, gentle_low)) & (x <= np.fmin(fastest, gentle_high))):
            return dq
        self.held += 1
        H = np.eye(self._n)
        if J_low is not None:
            H += J_low.T.dot(J_low)
        A, b = np.ascontiguousarray(J[self._rows]), error[self._rows]
        for low, high in ((gentle_low, gentle_high), (lower, upper)):
            box = (np.fmax(slowest, low) - q, np.fmin(fastest, high) - q)
            step = self._solve(H, -H.dot(dq), A, b, *box)
            if step is not None:
                return np.clip(step, *box)
        H += MISS_WEIGHT * A.T.dot(A)
        step = self._solve(H, -H.dot(dq), A[:0], b[:0], *box)
        if step is None:
            raise ArithmeticError("no joint step lies within the bounds")
        return np.clip(step, *box)

    def _solve(
        self, H: Array, g: Array, A: Array, b: Array, low: Array, high: Array
    ) -> Array | None:
        """The minimiser (n,), or None where equalities and bounds contradict each other."""
        n, size = self._n, self._n + len(b)
        self._high[:n], self._low[:n] = high, low
        self._high[n:size], self._low[n:size] = b, b
        x, _, flag, _ = daqp.solve(
            H, g, A, self._high[:size], self._low[:size], self._sense[:size], primal_tol=TOLERANCE
        )
        return np.asarray(x) if flag == SOLVED else None
