"""How a ball was struck: when, by how fast a sole, and how it went on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.geometry import wrap_angle
from mgs.core.scene import Ball

STRUCK = 0.05  # [m/s] at which a ball counts as struck
AFTER = 0.1  # [s] from contact to the measurement of its speed


@dataclass(frozen=True)
class Strike:
    """One ball; speeds and directions along the ground. A ball not struck has no time."""

    time: float | None  # of contact [s]
    sole_speed: float  # of the faster sole, just before contact [m/s]
    ball_speed: float  # some time after contact [m/s]
    direction_error_deg: float  # of the ball's velocity then


def measure_strike(ball: Ball, states: Array, soles: Array, dt: float) -> Strike:
    """Strike of a ball with states (M, 6), by soles (M, 2, 7)."""
    speed = np.hypot(states[:, 3], states[:, 4])
    moving = np.flatnonzero(speed > STRUCK)
    if not len(moving):
        return Strike(None, 0.0, float(speed.max()), 180.0)
    k = int(moving[0])
    later = min(k + round(AFTER / dt), len(states) - 1)
    before = max(k - 1, 1)
    steps = np.linalg.norm(soles[before, :, :2] - soles[before - 1, :, :2], axis=1)
    direction = np.arctan2(states[later, 4], states[later, 3])
    return Strike(
        time=float(k * dt),
        sole_speed=float(steps.max() / dt),
        ball_speed=float(speed[later]),
        direction_error_deg=float(np.degrees(wrap_angle(direction - ball.direction))),
    )
