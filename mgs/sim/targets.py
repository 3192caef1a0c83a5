"""What servos are told at every physics step of a replay."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.motion import Motion
from mgs.motion.servo_commands import Commands
from mgs.sim.conditions import Conditions
from mgs.sim.settings import Settings


def targets_along(
    motion: Motion, settings: Settings, commands: Commands | None = None
) -> tuple[Array, Array]:
    """Joint angles and speeds (K, n) that servos are told at the end of each physics step.

    The first posture is held while the robot settles, then come the motion and the last posture.

    Args:
        motion: the plan.
        settings: physics step, which divides `motion.dt`, and how long both postures are held.
        commands: what servos are told; None for the planned joint angles.
    """
    n_steps, n_tail = round(motion.dt / settings.dt), round(settings.tail / motion.dt)
    targets = Targets(motion, n_steps, commands)
    blocks = [targets.begin] * round(settings.settle / motion.dt)
    blocks += [targets.before(k) for k in range(1, motion.n_samples + n_tail)]
    position, velocity = (np.concatenate(rows) for rows in zip(*blocks, strict=True))
    return position, velocity


def disturbed_targets(
    position: Array, velocity: Array, conditions: Conditions, dt: float
) -> tuple[Array, Array]:
    """Targets (K, n) that arrive late, in whole steps of dt [s], with the joints' zeros off."""
    late = np.maximum(np.arange(len(position)) - round(conditions.latency / dt), 0)
    return position[late] + conditions.joint_offset, velocity[late]


class Targets:
    """Joint targets at the end of every simulation step: cubic Hermite between samples."""

    def __init__(self, motion: Motion, n_steps: int, commands: Commands | None = None) -> None:
        """Prepare to divide every sampling period into n_steps; None: the planned joint angles."""
        s, h = np.arange(1, n_steps + 1) / n_steps, motion.dt
        position = [
            1 + s**2 * (2 * s - 3),
            h * s * (1 - s) ** 2,
            s**2 * (3 - 2 * s),
            h * s**2 * (s - 1),
        ]
        velocity = [
            6 * s * (s - 1) / h,
            1 + s * (3 * s - 4),
            6 * s * (1 - s) / h,
            s * (3 * s - 2),
        ]
        self._position, self._velocity = np.stack(position, axis=1), np.stack(velocity, axis=1)
        if commands is None:
            self._q = motion.q[:, FLOATING_BASE_NQ:]
            self._v = motion.v[:, FLOATING_BASE_NV:]
        else:
            self._q = commands.position
            self._v = _central_differences(commands.position, motion.dt)
        self.begin, self._end = _hold(self._q[0], n_steps), _hold(self._q[-1], n_steps)

    def before(self, k: int) -> tuple[Array, Array]:
        """Positions and velocities (n_steps, n) on the way from sample k - 1 to sample k."""
        if k >= len(self._q):
            return self._end
        knots = np.stack([self._q[k - 1], self._v[k - 1], self._q[k], self._v[k]])
        return self._position @ knots, self._velocity @ knots


def _hold(joints: Array, n_steps: int) -> tuple[Array, Array]:
    position = np.tile(joints, (n_steps, 1))
    return position, np.zeros_like(position)


def _central_differences(x: Array, dt: float) -> Array:
    """Rates (N, n) of x (N, n), at rest before the first and after the last sample."""
    padded = np.concatenate([x[:1], x, x[-1:]])
    return np.asarray((padded[2:] - padded[:-2]) / (2.0 * dt))
