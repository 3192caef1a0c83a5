"""What a physics engine must offer for open-loop replay, and the choice of one.

Heavy packages are imported by `make_engine` only, so that mgs works with either engine missing.
"""

from __future__ import annotations

from typing import Protocol

from mgs.core.arrays import Array
from mgs.core.engines import available_engines, missing_engines
from mgs.core.errors import SimulationError
from mgs.core.foreign import told_as
from mgs.core.scene import EMPTY, Scene
from mgs.robot import Robot
from mgs.sim.audit import EngineModel, audit
from mgs.sim.conditions import Conditions
from mgs.sim.servo import Driven, DryFriction, JointState
from mgs.sim.settings import ENGINES, EngineName, ServoName, Settings


class Engine(Protocol):
    """One robot on level ground at z = 0, and what else is on it.

    Its joints are driven either by the engine's own servos (`mgs.sim.settings.OWN_SERVOS`) or, for
    servos evaluated outside, pushed by torques; which of the two is settled when the engine is
    made. q is (7 + n,) as in `Robot`: base position, base quaternion xyzw, joint angles.
    """

    @property
    def version(self) -> str:
        """Version of the engine's package."""

    def place(self, q: Array) -> None:
        """Put the robot at q, at rest."""

    def drive(self, position: Array, velocity: Array) -> Array:
        """Make k steps with the engine's servos aiming at (k, n) joint states after each step.

        Returns:
            What the servos did (k, m), which `torques` understands.
        """

    def torques(self, driven: Array) -> Driven:
        """Torques of what `drive` has given in any number of steps (k, m)."""

    def joints(self) -> JointState:
        """Current state of the joints."""

    @property
    def rotors(self) -> Array:
        """Inertia (n,) that the engine adds at the joints for the rotors [kg m^2]."""

    def push(
        self, torque: Array, free_speed: Array, friction: DryFriction | None = None
    ) -> JointState:
        """Make one step with torques (n,) [N m] that would be zero at free_speed (n,) [rad/s].

        Dry friction is no part of these torques.
        """

    def carry(self, payload: Array) -> None:
        """From now on weights of masses (2,) [kg] pull at the left and the right hand."""

    def read(self) -> Array:
        """Current q (7 + n,); not finite once the simulation has diverged."""

    def contacts(self) -> Array:
        """What the floor does to the soles (2, 5) in the last step.

        Force x, y, z [N], and the first moments of its vertical part, sums of z force times x and
        times y [N m]: divided by the vertical force they are the centre of pressure.
        """

    def balls(self) -> Array:
        """Positions and velocities (b, 6) of the balls of the scene."""

    def inspect(self) -> EngineModel:
        """The robot as the engine understands it, at the current q."""

    def close(self) -> None:
        """Free the engine; idempotent."""


def make_engine(
    name: EngineName,
    robot: Robot,
    settings: Settings,
    servo: ServoName = "ideal",
    conditions: Conditions | None = None,
    scene: Scene = EMPTY,
) -> Engine:
    """Engine with robot and scene loaded, the robot's model proven equal to Pinocchio's.

    Of `conditions` floor and servo gains are the engine's part; the robot is given as disturbed.

    Raises:
        SimulationError: the engine is unknown or not installed, refuses the robot, or has loaded
            another one.
    """
    require(name)
    with told_as(lambda what: SimulationError(f"{name} cannot load {robot.spec.name}: {what}")):
        engine = _load(name, robot, settings, servo, conditions, scene)
        try:
            audit(engine, robot, name)
        except BaseException:
            engine.close()
            raise
        return engine


def require(name: EngineName) -> None:
    """Raise SimulationError unless the engine is known and installed."""
    if name not in ENGINES:
        raise SimulationError(f"no physics engine {name!r}; there are: {', '.join(ENGINES)}")
    for engine in missing_engines():
        if engine.engine == name:
            raise SimulationError(
                f"{name} is not installed: {engine.cause}; {engine.remedy}; installed: "
                f"{', '.join(available_engines()) or 'none'}"
            )


def _load(
    name: EngineName,
    robot: Robot,
    settings: Settings,
    servo: ServoName,
    conditions: Conditions | None,
    scene: Scene,
) -> Engine:
    if name == "pybullet":
        from mgs.sim.pybullet import PybulletEngine

        return PybulletEngine(robot, settings, servo, conditions, scene)
    from mgs.sim.mujoco import MujocoEngine

    return MujocoEngine(robot, settings, servo, conditions, scene)
