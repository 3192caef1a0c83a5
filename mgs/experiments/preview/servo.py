"""The ZMP preview servo in python-control: closed loop, feedback gains and simulation.

State of the closed loop z[k] = (s[k-1], x[k]), inputs the reference p_ref[k] and the sum w[k] of
previewed references; symbols as in `mgs.com_generator.preview`:

    s[k]   = s[k-1] + C x[k] - p_ref[k]
    u[k]   = -G_i s[k] - G_x x[k] - w[k]
    x[k+1] = A x[k] + B u[k],   p[k] = C x[k]
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mgs.com_generator.preview import PreviewGains, preview_gains
from mgs.core.arrays import Array
from mgs.gait import ComParameters


@dataclass(frozen=True)
class Servo:
    """Preview servo: its settings and the gains that mgs computes for them."""

    dt: float  # [s]
    com_height: float  # [m]
    parameters: ComParameters

    @property
    def gains(self) -> PreviewGains:
        """All gains, computed by mgs."""
        p = self.parameters
        return preview_gains(self.dt, self.com_height, p.preview, p.weight_error, p.weight_jerk)

    @property
    def feedback(self) -> Array:
        """Gains (4,) of (sum of errors, state), computed by mgs."""
        return np.concatenate([[self.gains.G_i], self.gains.G_x])

    def error_system(self) -> tuple[Array, Array, Array, Array]:
        """Matrices A (4, 4), B (4, 1), Q (4, 4), R (1, 1) of the LQ problem in (e, dx)."""
        g = self.gains
        A = np.block([[np.ones((1, 1)), (g.C @ g.A)[None]], [np.zeros((3, 1)), g.A]])
        B = np.concatenate([[g.C @ g.B], g.B])[:, None]
        Q = np.diag([self.parameters.weight_error, 0.0, 0.0, 0.0])
        return A, B, Q, np.array([[self.parameters.weight_jerk]])

    def closed_loop(self) -> Any:
        """Closed loop from (p_ref, w) to p as a `control.StateSpace`."""
        import control

        g = self.gains
        C, B = g.C[None], g.B[:, None]
        A = np.block([[np.ones((1, 1)), C], [-g.G_i * B, g.A - B @ (g.G_i * C + g.G_x[None])]])
        inputs = np.block([[-np.ones((1, 1)), np.zeros((1, 1))], [g.G_i * B, -B]])
        return control.ss(A, inputs, np.hstack([[[0.0]], C]), np.zeros((1, 2)), self.dt)


def lqr_feedback(servo: Servo) -> Array:
    """Feedback gains (4,) by dlqr of python-control."""
    import control

    return np.asarray(control.dlqr(*servo.error_system())[0])[0]


def step_reference(n_before: int, n_after: int, height: float) -> Array:
    """Reference (n_before + n_after,) that jumps from 0 to `height` [m]."""
    return np.repeat([0.0, height], [n_before, n_after])


def simulate(servo: Servo, zmp_ref: Array) -> Array:
    """ZMP (N,) [m] simulated by python-control for zmp_ref (N,) [m], which begins at 0."""
    import control

    G_p = servo.gains.G_p
    future = np.concatenate([zmp_ref[1:], np.full(len(G_p), zmp_ref[-1])])
    w = np.array([G_p @ future[k : k + len(G_p)] for k in range(len(zmp_ref))])
    times = np.arange(len(zmp_ref)) * servo.dt
    response = control.forced_response(servo.closed_loop(), times, np.stack([zmp_ref, w]))
    return np.asarray(response.outputs).ravel()
