"""ZMP preview control: the CoM motion whose ZMP follows a reference known in advance.

Cart-table model and servo of Kajita et al., "Biped walking pattern generation by using preview
control of zero-moment point", ICRA 2003; gains after Katayama et al., Int. J. Control 41(3), 1985.
One horizontal axis, state x = (c, dc/dt, d2c/dt2), jerk u held over dt:

    x[k+1] = A x[k] + B u[k]
    p[k]   = C x[k]                     C = (1, 0, -com_height / g)
    u[k]   = -G_i s[k] - G_x x[k] - w[k]
    s[k]   = s[k-1] + p[k] - p_ref[k]   w[k] = sum_{j=1..N} G_p[j] p_ref[k+j]

Everything but w is a fixed linear recurrence, y[k+1] = M y[k] + f[k] with y[k] = (x[k], s[k]), so
that the whole trajectory is a sum of powers of M. It is taken for all samples and both axes at
once by recursive doubling: Kogge and Stone, "A parallel algorithm for the efficient solution of a
general class of recurrence equations", IEEE Transactions on Computers C-22(8), 1973.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from mgs.com_generator.com_trajectory import ComTrajectory
from mgs.com_generator.riccati import solve_riccati
from mgs.core.arrays import Array
from mgs.core.constants import GRAVITY
from mgs.core.errors import ComNotAtRestError, ConfigError
from mgs.gait import ComParameters
from mgs.robot import Robot
from mgs.trajectory_planner import TaskTrajectory

REST_SPEED, REST_DISTANCE = 2e-3, 1e-3  # [m/s], [m] at which the CoM counts as at rest at the end
SLOWEST = 60.0  # [s] largest time constant of a CoM motion, that of the longest rest of a gait
FORGOTTEN = 1e-30  # remaining fraction of a state below which it has no effect on later states


@dataclass(frozen=True, eq=False)
class PreviewGains:
    """Model and optimal gains of one horizontal axis."""

    A: Array  # (3, 3)
    B: Array  # (3,)
    C: Array  # (3,)
    G_i: float  # on the sum of errors
    G_x: Array  # (3,) on the state
    G_p: Array  # (n_preview,) on the future references


@functools.lru_cache(maxsize=64)
def preview_gains(
    dt: float, com_height: float, preview: float, weight_error: float, weight_jerk: float
) -> PreviewGains:
    """Gains that minimise sum Q_e e^2 + R du^2 (method of Katayama et al.).

    Args:
        dt: sampling period [s].
        com_height: height of the CoM above the ground [m].
        preview: length of the preview window [s].
        weight_error: Q_e.
        weight_jerk: R.

    Raises:
        ConfigError: the Riccati equation has no stabilising solution for these values.
    """
    A = np.array([[1.0, dt, 0.5 * dt**2], [0.0, 1.0, dt], [0.0, 0.0, 1.0]])
    B = np.array([dt**3 / 6.0, 0.5 * dt**2, dt])
    C = np.array([1.0, 0.0, -com_height / GRAVITY])
    At = np.block([[np.ones((1, 1)), C[None] @ A], [np.zeros((3, 1)), A]])
    Bt = np.concatenate([[C @ B], B])[:, None]
    Qt = np.diag([1.0, 0.0, 0.0, 0.0])
    ratio = weight_jerk / weight_error  # nothing else matters
    what = f"dt = {dt} s, com_height = {com_height} m"
    K = _riccati(At, Bt, Qt, ratio, what)
    denominator = ratio + float(Bt[:, 0] @ K @ Bt[:, 0])
    G = (Bt.T @ K @ At)[0] / denominator
    Ac = At - Bt * G
    if not np.all(np.abs(np.linalg.eigvals(Ac)) < np.exp(-dt / SLOWEST)):
        raise _no_gain(what, f"the CoM would come to rest with a time constant above {SLOWEST:g} s")
    G_p = np.empty(max(1, round(preview / dt)))
    G_p[0] = -G[0]
    X = -Ac.T @ K[:, 0]
    for j in range(1, len(G_p)):
        G_p[j] = Bt[:, 0] @ X / denominator
        X = Ac.T @ X
    return PreviewGains(A, B, C, float(G[0]), G[1:].copy(), G_p)


def _riccati(At: Array, Bt: Array, Qt: Array, R: float, what: str) -> Array:
    try:
        return solve_riccati(At, Bt, Qt, R)
    except np.linalg.LinAlgError as error:
        raise _no_gain(what, str(error)) from error


def _no_gain(what: str, reason: str) -> ConfigError:
    return ConfigError(
        "com",
        f"no stabilising preview gain for {what} ({reason}); usual values are dt 0.002 to 0.02, "
        "com.weight_error 1, com.weight_jerk 1e-8 to 1e-6",
    )


@dataclass(frozen=True)
class PreviewControl:
    """The generator `preview`."""

    parameters: ComParameters

    @classmethod
    def from_parameters(cls, parameters: ComParameters) -> PreviewControl:
        """Generator with the tuning of a gait file."""
        return cls(parameters)

    def generate(self, robot: Robot, tasks: TaskTrajectory) -> ComTrajectory:
        """CoM motion that follows the ZMP reference; see `follow_zmp` for the errors."""
        return follow_zmp(tasks.zmp_ref, tasks.com_height, tasks.dt, self.parameters)


def follow_zmp(
    zmp_ref: Array, com_height: Array, dt: float, parameters: ComParameters
) -> ComTrajectory:
    """CoM motion from rest above zmp_ref[0] following zmp_ref (N, 2) at com_height (N,) [m].

    Raises:
        ConfigError: see `preview_gains`.
        ComNotAtRestError: the CoM is not at rest when the motion ends.
    """
    com = respond(zmp_ref, com_height, dt, parameters)
    require_rest(com, zmp_ref[-1])
    return com


def respond(
    zmp_ref: Array, com_height: Array, dt: float, parameters: ComParameters
) -> ComTrajectory:
    """The motion of `follow_zmp`, whether or not it is at rest in the end."""
    gains = preview_gains(
        dt,
        float(com_height[0]),
        parameters.preview,
        parameters.weight_error,
        parameters.weight_jerk,
    )
    # seen from its start: a finite window takes what lies beyond it for the origin
    states = _closed_loop(gains, zmp_ref - zmp_ref[0])  # (N, 3, 2)
    states[:, 0] += zmp_ref[0]
    speed = np.gradient(com_height, dt)
    return ComTrajectory(
        position=np.column_stack([states[:, 0], com_height]),
        velocity=np.column_stack([states[:, 1], speed]),
        acceleration=np.column_stack([states[:, 2], np.gradient(speed, dt)]),
        zmp=np.einsum("j,njk->nk", gains.C, states),
    )


def _closed_loop(gains: PreviewGains, zmp_ref: Array) -> Array:
    """States (N, 3, 2) of both axes under preview control, from rest at the origin.

    With y[k] = (x[k], s[k]) and s[k+1] = s[k] + C x[k+1] - p_ref[k+1]:

        y[k+1] = M y[k] + (-B w[k], -C B w[k] - p_ref[k+1])
        M = ((A - B G_x, -B G_i), (C (A - B G_x), 1 - C B G_i))
    """
    rows = np.column_stack([gains.A - np.outer(gains.B, gains.G_x), -gains.B * gains.G_i])  # of x
    M = np.vstack([rows, gains.C @ rows + [0.0, 0.0, 0.0, 1.0]])
    jerk = _preview_sums(gains.G_p, zmp_ref)[:-1, :, None]
    y = np.zeros((*zmp_ref.shape, 4))  # (N, 2, 4)
    y[1:] = -jerk * np.append(gains.B, gains.C @ gains.B)
    y[..., 3] -= zmp_ref
    return np.ascontiguousarray(np.swapaxes(_accumulate(M, y)[..., :3], 1, 2))


def _accumulate(M: Array, f: Array) -> Array:
    """Sequence y (N, 2, m) with y[0] = f[0] and y[k] = M y[k-1] + f[k]; M (m, m), f (N, 2, m).

    After i rounds y[k] is the sum of M^j f[k-j] over j < 2^i; a stable M lets it end early.
    """
    y, power, window = f, M, 1
    while window < len(f) and np.abs(power).max() > FORGOTTEN:
        y = np.concatenate([y[:window], y[window:] + y[:-window] @ power.T])
        power, window = power @ power, 2 * window
    return y


def _preview_sums(G_p: Array, zmp_ref: Array) -> Array:
    """W (N, 2); past the end the reference keeps its last value."""
    tail = np.repeat(zmp_ref[-1:], len(G_p), axis=0)
    extended = np.concatenate([zmp_ref[1:], tail])
    return np.column_stack([np.correlate(column, G_p, mode="valid") for column in extended.T])


def require_rest(com: ComTrajectory, zmp_end: Array) -> None:
    """Raise ComNotAtRestError unless the CoM ends at rest above zmp_end (2,)."""
    speed = float(np.hypot(*com.velocity[-1, :2]))
    distance = float(np.hypot(*(com.position[-1, :2] - zmp_end)))
    if speed > REST_SPEED or distance > REST_DISTANCE:
        raise ComNotAtRestError(speed, distance, (REST_SPEED, REST_DISTANCE))
