"""Playing a motion to an engine, open loop.

The robot is put down on its soles in its first posture and settles there; then its servos follow
the plan, interpolated between samples by cubics that meet positions and velocities; then they hold
the last posture for a while. Nothing that happens is fed back to the targets.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.core.errors import DivergenceError
from mgs.core.geometry import sole_corners
from mgs.core.progress import Progress
from mgs.motion import Motion
from mgs.motion.servo_commands import Commands
from mgs.robot import Robot, Servos
from mgs.sim.conditions import Conditions
from mgs.sim.effort import Effort
from mgs.sim.engine import Engine
from mgs.sim.measure import angle_between
from mgs.sim.servo import Driven, ServoModel
from mgs.sim.settings import Settings

FALL_TILT = float(np.radians(45.0))  # of the torso's vertical against the plan's
FALL_HEIGHT = 0.6  # of the base above the ground, relative to the plan's
AFTER_FALL = 1.0  # [s] that a replay goes on after a fall


@dataclass(frozen=True, eq=False)
class Recording:
    """State and torques at the samples of a motion and of its tail, from the settled start on."""

    plan: NDArray[np.intp]  # (M,) sample of the motion; the last one stays during the tail
    q: Array  # (M, 7 + n) as in `Robot`
    torque: Array  # (M, n) mean over the sampling period before [N m]
    contacts: Array  # (M, 2, 5) of the soles in the last step, as `Engine.contacts` has them
    balls: Array  # (M, b, 6) positions and velocities of balls
    effort: Effort


def play(
    motion: Motion,
    engine: Engine,
    settings: Settings,
    progress: Progress | None = None,
    servos: Servos | None = None,
    commands: Commands | None = None,
    conditions: Conditions | None = None,
) -> Recording:
    """Settle, play and hold; ends early, some time after a fall. `settings.dt` divides `motion.dt`.

    Args:
        motion: the plan.
        engine: made for its own servos, or for servos evaluated outside if there are any.
        settings: how to simulate.
        progress: called with samples done and samples in all.
        servos: servos that are evaluated outside the engine; None for the engine's own.
        commands: what servos are told; None for the planned joint angles.
        conditions: late and offset commands; None for neither.

    Raises:
        DivergenceError: the simulation diverged.
    """
    robot, n_steps = motion.robot, round(motion.dt / settings.dt)
    plan = np.arange(motion.n_samples + round(settings.tail / motion.dt))
    plan = np.minimum(plan, motion.n_samples - 1)
    drive = _driver(engine, settings, servos)
    if conditions is not None:
        drive = _disturbed(drive, conditions, settings.dt)
    effort, targets = Effort(robot.torque_limit, settings.dt), Targets(motion, n_steps, commands)
    on_soles = motion.gait.is_balanced
    floor = min(f.z for f in motion.footsteps[:2])
    engine.place(on_ground(robot, motion.q[0], floor) if on_soles else motion.q[0])
    torque = np.zeros((n_steps, robot.n))
    for _ in range(round(settings.settle / motion.dt)):
        torque, _ = drive(*targets.begin)
    q, torques, contacts = [_read(engine, 0.0)], [torque.mean(axis=0)], [engine.contacts()]
    balls = [engine.balls()]
    end, data, (_, up_plan) = len(plan), robot.model.createData(), poses_along(robot, motion.q)
    payload = motion.payload
    for k in range(1, len(plan)):
        if payload is not None:
            engine.carry(payload[plan[k]])
        torque, limited = drive(*targets.before(k))
        effort.add(torque, limited)
        q.append(_read(engine, k * motion.dt))
        torques.append(torque.mean(axis=0))
        contacts.append(engine.contacts())
        balls.append(engine.balls())
        _, up = poses_along(robot, q[k][None], data)
        if (
            on_soles
            and end == len(plan)
            and fallen(up[0], up_plan[plan[k]], q[k][2], motion.q[plan[k], 2])
        ):
            end = min(end, k + 1 + round(AFTER_FALL / motion.dt))
        if progress is not None:
            progress(k, len(plan) - 1)
        if k + 1 >= end:
            break
    return Recording(
        plan[: len(q)],
        np.array(q),
        np.array(torques),
        np.array(contacts),
        np.array(balls),
        effort,
    )


Drive = Callable[[Array, Array], Driven]


def _driver(engine: Engine, settings: Settings, servos: Servos | None) -> Drive:
    """The function that makes physics steps towards positions and velocities (k, n)."""
    if servos is None:
        return engine.drive
    model = ServoModel(servos, settings.dt)
    return lambda position, velocity: model.drive(engine, position)


def _disturbed(drive: Drive, conditions: Conditions, dt: float) -> Drive:
    """A drive whose commands arrive late, in whole steps, and with the joints' zeros off."""
    late = round(conditions.latency / dt)
    told: list[Array] = []  # positions and velocities (late, 2, n) that are under way

    def disturbed(position: Array, velocity: Array) -> Driven:
        rows = np.stack([position + conditions.joint_offset, velocity], axis=1)
        before = told.pop() if told else np.repeat(rows[:1], late, axis=0)
        rows = np.concatenate([before, rows])
        told.append(rows[len(rows) - late :])
        return drive(rows[: len(position), 0], rows[: len(position), 1])

    return disturbed


def _read(engine: Engine, t: float) -> Array:
    q = engine.read()
    if not np.isfinite(q).all():
        raise DivergenceError(f"the simulation diverged at t = {t:.3f} s; try a smaller step")
    return q


def on_ground(robot: Robot, q: Array, height: float = 0.0) -> Array:
    """Configuration (7 + n,) like q, its lowest sole corner at a height [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    lowest = np.inf
    for side, frame in zip(Side, robot.sole_frames, strict=True):
        spec, pose = robot.sole_spec(side), data.oMf[frame]
        corners = sole_corners(np.zeros(3), spec.length, spec.width)
        heights = pose.translation[2] + corners @ pose.rotation[2, :2]
        lowest = min(lowest, float(heights.min()))
    out = q.copy()
    out[2] += height - lowest
    return out


def fallen(up: Array, up_plan: Array, height: Array, height_plan: Array) -> NDArray[np.bool_]:
    """Where (...) the torso's vertical (..., 3) or the base's height (...) [m] gave up the plan."""
    down = (angle_between(up, up_plan) > FALL_TILT) | (height < FALL_HEIGHT * height_plan)
    return np.asarray(down)


def poses_along(robot: Robot, q: Array, data: pin.Data | None = None) -> tuple[Array, Array]:
    """Soles (M, 2, 7) and the world's vertical seen from the torso (M, 3) at q (M, 7 + n)."""
    data = robot.model.createData() if data is None else data
    soles, up = np.empty((len(q), 2, 7)), np.empty((len(q), 3))
    for k, row in enumerate(q):
        pin.framesForwardKinematics(robot.model, data, row)
        for side, frame in enumerate(robot.sole_frames):
            soles[k, side] = pin.SE3ToXYZQUAT(data.oMf[frame])
        up[k] = data.oMf[robot.torso_frame].rotation[2]
    return soles, up


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
