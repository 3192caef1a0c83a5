"""References and an independent simulation for preview control."""

from __future__ import annotations

import numpy as np

from mgs.com_generator import ComTrajectory
from mgs.com_generator.preview import follow_zmp, preview_gains
from mgs.gait import ComParameters

GRAVITY = 9.81


DT, HEIGHT = 0.01, 0.27  # [s], [m] as on Melson
TUNINGS = [  # dt [s], height [m], weight_error, weight_jerk
    (0.01, 0.27, 1.0, 1e-6),
    (0.01, 0.8, 1.0, 1e-6),
    (0.005, 0.27, 1.0, 1e-8),
    (0.02, 0.5, 10.0, 1e-6),
]


def follow(
    zmp_ref: np.ndarray, dt: float = DT, height: float = HEIGHT, **com: float
) -> ComTrajectory:
    return follow_zmp(zmp_ref, np.full(len(zmp_ref), height), dt, ComParameters(**com))


def steps_after(seconds: float, dt: float = DT, n_steps: int = 4) -> np.ndarray:
    """A reference (N, 2) that jumps ahead and from side to side every 0.6 s, between two rests."""
    rest, step = round(seconds / dt), round(0.6 / dt)
    x = np.concatenate([np.zeros(rest), np.repeat(0.05 * np.arange(1, n_steps + 1), step)])
    y = np.concatenate([np.zeros(rest), np.repeat(0.04 * (-1.0) ** np.arange(n_steps), step)])
    ref = np.column_stack([x, y])
    return np.concatenate([ref, np.repeat(ref[-1:], rest, axis=0)])


def cart_table(dt: float, height: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A, B and C of a cart under a jerk that is constant over dt."""
    A = np.array([[1.0, dt, dt**2 / 2.0], [0.0, 1.0, dt], [0.0, 0.0, 1.0]])
    return A, np.array([dt**3 / 6.0, dt**2 / 2.0, dt]), np.array([1.0, 0.0, -height / GRAVITY])


def augmented(dt: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    """The servo's system: sum of errors and increments of the state."""
    A, B, C = cart_table(dt, height)
    At = np.zeros((4, 4))
    At[0, 0], At[0, 1:], At[1:, 1:] = 1.0, C @ A, A
    return At, np.concatenate([[C @ B], B])[:, None]


def simulate(zmp_ref: np.ndarray, dt: float, height: float, com: ComParameters) -> np.ndarray:
    """States (N, 3, 2) by the servo's formula, one sample after the other."""
    gains = preview_gains(dt, height, com.preview, com.weight_error, com.weight_jerk)
    A, B, C = cart_table(dt, height)
    x = np.zeros((3, 2))
    total = np.zeros(2)
    states = []
    n_preview = round(com.preview / dt)
    for k in range(len(zmp_ref)):
        states.append(x.copy())
        total = total + C @ x - zmp_ref[k]
        u = -gains.G_i * total - gains.G_x @ x
        for j in range(1, n_preview + 1):
            u = u - gains.G_p[j - 1] * zmp_ref[min(k + j, len(zmp_ref) - 1)]
        x = A @ x + np.outer(B, u)
    return np.array(states)
