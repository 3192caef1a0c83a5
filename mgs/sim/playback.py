"""Playing a motion to an engine, open loop.

The robot is put down on its soles in its first posture and settles there; then its servos follow
the plan, interpolated between samples by cubics that meet positions and velocities; then they hold
the last posture for a while. Nothing that happens is fed back to the targets.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.errors import DivergenceError
from mgs.core.progress import Progress
from mgs.motion import Motion
from mgs.robot import Robot, Servos
from mgs.sim.conditions import Conditions
from mgs.sim.effort import Effort
from mgs.sim.engine import Engine
from mgs.sim.poses import fallen, on_ground, poses_along
from mgs.sim.prepare import Prepared
from mgs.sim.servo import Driven, ServoModel, inertia_at_joints
from mgs.sim.targets import disturbed_targets

AFTER_FALL = 1.0  # [s] that a replay goes on after a fall
LOOK = 0.25  # [s] between two looks at whether the robot has fallen, shorter than AFTER_FALL


@dataclass(frozen=True, eq=False)
class Recording:
    """State and torques at the samples of a motion and of its tail, from the settled start on."""

    plan: NDArray[np.intp]  # (M,) sample of the motion; the last one stays during the tail
    q: Array  # (M, 7 + n) as in `Robot`
    soles: Array  # (M, 2, 7) poses of the soles
    up: Array  # (M, 3) the world's vertical seen from the torso
    up_plan: Array  # (M, 3) the same in the plan
    torque: Array  # (M, n) mean over the sampling period before [N m]
    contacts: Array  # (M, 2, 5) as `Engine.contacts` has them in the last step; NaN: not read
    balls: Array  # (M, b, 6) positions and velocities of balls
    effort: Effort


def play(
    prepared: Prepared,
    engine: Engine,
    servos: Servos | None = None,
    conditions: Conditions | None = None,
    progress: Progress | None = None,
    with_contacts: bool = True,
) -> Recording:
    """Settle, play and hold; ends early, some time after a fall.

    Args:
        prepared: the motion and what its servos are told.
        engine: made for its own servos, or for servos evaluated outside if there are any.
        servos: servos that are evaluated outside the engine; None for the engine's own.
        conditions: late and offset commands; None for neither.
        progress: called with samples done and samples in all.
        with_contacts: whether the forces on the soles are read, which takes a tenth of the time.

    Raises:
        DivergenceError: the simulation diverged.
    """
    motion, plan, dt = prepared.motion, prepared.plan, prepared.settings.dt
    targets = prepared.position, prepared.velocity
    if conditions is not None:
        targets = disturbed_targets(*targets, conditions, dt)
    driver = _driver(engine, dt, servos, motion.robot)
    log = _Log(motion, engine, driver, targets, dt, with_contacts)
    log.settle(prepared.settings.settle)
    poses = [poses_along(motion.robot, log.q[0][None])]
    k, end, look = 1, len(plan), max(1, round(LOOK / motion.dt))
    while k < end:
        block = slice(k, min(k + look, end))
        log.add(plan[block], progress, len(plan) - 1)
        q = np.array(log.q[block])
        poses.append(poses_along(motion.robot, q))
        if motion.gait.is_balanced and end == len(plan):
            height = motion.q[plan[block], 2]
            down = np.flatnonzero(fallen(poses[-1][1], prepared.up[block], q[:, 2], height))
            if len(down):
                end = min(end, k + int(down[0]) + 1 + round(AFTER_FALL / motion.dt))
        k = block.stop
    soles, up = (np.concatenate(rows) for rows in zip(*poses, strict=True))
    return log.recording(plan[:k], soles, up, prepared.up[:k])


class Driver(Protocol):
    """Servos: an engine with its own, or such as are evaluated outside."""

    def drive(self, position: Array, velocity: Array) -> Array:
        """Make k steps towards (k, n) joint states; gives what `torques` understands."""

    def torques(self, driven: Array) -> Driven:
        """Torques of what `drive` has given."""


@dataclass(frozen=True, eq=False)
class _Outside:
    """Servos that are evaluated outside the engine, once a step."""

    engine: Engine
    model: ServoModel

    def drive(self, position: Array, velocity: Array) -> Array:
        del velocity
        torque, limited = self.model.drive(self.engine, position)
        return np.hstack([torque, limited if limited is not None else np.zeros_like(torque)])

    def torques(self, driven: Array) -> Driven:
        torque, limited = np.hsplit(driven, 2)
        return Driven(torque, limited > 0.0)


def _driver(engine: Engine, dt: float, servos: Servos | None, robot: Robot) -> Driver:
    if servos is None:
        return engine
    return _Outside(engine, ServoModel(servos, dt, inertia_at_joints(robot)))


@dataclass(eq=False)
class _Log:
    """A replay under way, and what was read after each sampling period."""

    motion: Motion
    engine: Engine
    driver: Driver
    targets: tuple[Array, Array]
    dt: float  # of the physics [s]
    with_contacts: bool
    q: list[Array] = field(default_factory=list)
    torque: list[Array] = field(default_factory=list)
    contacts: list[Array] = field(default_factory=list)
    balls: list[Array] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._n_steps = round(self.motion.dt / self.dt)
        self._done = 0  # physics steps
        self.effort = Effort(self.motion.robot.torque_limit, self.dt)

    def settle(self, duration: float) -> None:
        """Put the robot down, let it settle for a duration [s] and read it."""
        motion = self.motion
        floor = min(f.z for f in motion.footsteps[:2])
        q = motion.q[0]
        self.engine.place(on_ground(motion.robot, q, floor) if motion.gait.is_balanced else q)
        driven = [self._period() for _ in range(round(duration / motion.dt))]
        self._read()
        self._refuse_divergence(1)
        torque = np.zeros(motion.robot.n)
        if driven:
            torque = self.driver.torques(driven[-1]).torque.mean(axis=0)
        self.torque.append(torque[None])

    def add(self, plan: NDArray[np.intp], progress: Progress | None, total: int) -> None:
        """Go on by sampling periods whose ends are samples `plan` of the motion.

        `progress` is called with the periods done and those in all.
        """
        payload, driven = self.motion.payload, []
        for sample in plan:
            if payload is not None:
                self.engine.carry(payload[sample])
            driven.append(self._period())
            self._read()
            if progress is not None:
                progress(len(self.q) - 1, total)
        self._refuse_divergence(len(plan))
        torque, limited = self.driver.torques(np.concatenate(driven))
        self.effort.add(torque, limited)
        self.torque.append(torque.reshape(len(plan), self._n_steps, -1).mean(axis=1))

    def _period(self) -> Array:
        steps = slice(self._done, self._done + self._n_steps)
        self._done = steps.stop
        position, velocity = self.targets
        return self.driver.drive(position[steps], velocity[steps])

    def _read(self) -> None:
        self.q.append(self.engine.read())
        if self.with_contacts:
            self.contacts.append(self.engine.contacts())
        if self.motion.scene.balls:
            self.balls.append(self.engine.balls())

    def _refuse_divergence(self, n: int) -> None:
        """Raise DivergenceError if one of the last n states is not finite."""
        lost = np.flatnonzero(~np.isfinite(self.q[-n:]).all(axis=1))
        if len(lost):
            t = (len(self.q) - n + int(lost[0])) * self.motion.dt
            raise DivergenceError(f"the simulation diverged at t = {t:.3f} s; try a smaller step")

    def recording(
        self, plan: NDArray[np.intp], soles: Array, up: Array, up_plan: Array
    ) -> Recording:
        """All that was read, and what follows from it."""
        m = len(self.q)
        return Recording(
            plan=plan,
            q=np.array(self.q),
            soles=soles,
            up=up,
            up_plan=up_plan,
            torque=np.concatenate(self.torque),
            contacts=np.array(self.contacts) if self.with_contacts else np.full((m, 2, 5), np.nan),
            balls=np.array(self.balls).reshape(m, -1, 6),
            effort=self.effort,
        )
