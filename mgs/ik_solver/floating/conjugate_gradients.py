"""Iterations of ik2 by conjugate gradients on the configurations that meet the hard tasks.

Eq. (4) of S. Faraji and A. J. Ijspeert, "Singularity-tolerant inverse kinematics for bipedal
robots", IEEE Robotics and Automation Letters, 2017, "solved via conjugate gradient method where
each iteration is solved similar to (2) with same damping mechanism". The paper prints no formula;
this is the preconditioned method of E. Polak and G. Ribiere with restarts. With the cost
1/2 |E_s|_Q^2, its gradient -J_s^T Q E_s, and H = J_s^T Q J_s + R:

    n       solution of (2) without soft tasks, which meets J_h n = E_h
    g     = -J_s^T Q (E_s - J_s n),  the gradient after this step
    s       solution of (2) for g with J_h s = 0
    beta  = max(0, g . (s - s_last) / (g_last . s_last)),     p = s + beta T p_last
    alpha = -g . p / (p^T (H - R) p),                        dq = n + alpha p

T projects onto the null space of J_h in the norm of H. The damped step s is the gradient with H as
preconditioner; alpha is the exact minimum along p of the linearised tasks, without damping.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.ik_solver.qp import solve_equality

LARGEST_STEP = 0.1  # [rad] and [m] largest entry of alpha p; a line search may not go farther


class ConjugateGradients:
    """Iterations within one sample; `reset` begins the next sample."""

    def __init__(self, damping: Array) -> None:
        self.damping = damping  # (6 + n,) diagonal of R
        self.reset()

    def reset(self) -> None:
        """Forget the directions of the last sample."""
        self._last: tuple[Array, Array, float] | None = None  # p, s and g . s

    def step(self, H: Array, g: Array, A: Array, b: Array) -> Array:
        """Step dq (6 + n,) for the quadratic model H (6 + n, 6 + n), g and hard rows A dq = b."""
        zero = np.zeros_like(b)
        n = solve_equality(H, np.zeros_like(g), A, b)
        g = g + H @ n - self.damping * n
        s = solve_equality(H, g, A, zero)
        p, slope = s, float(g @ s)
        if self._last is not None:
            p_last, s_last, slope_last = self._last
            beta = float(g @ (s - s_last)) / slope_last if slope_last < 0.0 else 0.0
            if beta > 0.0:
                p = s + beta * solve_equality(H, -H @ p_last, A, zero)
                if g @ p >= 0.0:
                    p = s
        self._last = (p, s, slope)
        return n + self._length(H, g, p) * p

    def _length(self, H: Array, g: Array, p: Array) -> float:
        """Factor alpha of the direction p."""
        largest = float(np.abs(p).max())
        if largest == 0.0:
            return 0.0
        most = LARGEST_STEP / largest
        curvature = float(p @ (H @ p) - p @ (self.damping * p))
        return min(most, -float(g @ p) / curvature) if curvature > 0.0 else min(most, 1.0)
