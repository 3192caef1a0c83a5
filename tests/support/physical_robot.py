"""A robot in MuJoCo that differs from its description as one physical robot does.

Each joint has a stiffness of its own, a gear with play and a zero that is off. The play is a
deadband of the servo: within it the motor turns and the joint is free. A robot.yaml in which each
joint has a servo of its own describes this, so that nothing of mgs.robot.unit is used.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.motion import Motion
from mgs.robot import Robot
from mgs.sim.engine import make_engine
from mgs.sim.playback import play
from mgs.sim.prepare import prepare
from mgs.sim.servo import servo_figures
from mgs.sim.settings import DEFAULTS

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Unit:
    """True figures (n,) of a physical robot."""

    stiffness: Array  # factors on the described stiffness
    backlash: Array  # [rad]
    offset: Array  # [rad]


def drawn(robot: Robot, seed: int, joints: tuple[str, ...] | None = None) -> Unit:
    """Stiffness +-20 %, play 0.5 deg, offsets 1 deg, of all joints or some."""
    rng = np.random.default_rng(seed)
    n = robot.n
    has = np.array([joints is None or name in joints for name in robot.joint_names])
    return Unit(
        stiffness=1.0 + 0.2 * rng.uniform(-1.0, 1.0, n),
        backlash=np.radians(np.full(n, 0.5)),
        offset=np.radians(rng.choice([-1.0, 1.0], n)) * has,
    )


def as_built(robot: Robot, unit: Unit) -> Robot:
    """The robot with these servos."""
    servos, joints = {}, {}
    for i, name in enumerate(robot.joint_names):
        spec = robot.spec.servos[robot.spec.joints[name]]
        stiffness = float(spec.spring * unit.stiffness[i])
        deadband = spec.deadband + 0.5 * float(unit.backlash[i])
        servos[name] = spec.model_copy(
            update={"stiffness": stiffness, "compliance_slope": None, "deadband": deadband}
        )
        joints[name] = name
    spec = robot.spec.model_copy(update={"servos": servos, "joints": joints})
    return dataclasses.replace(robot, spec=spec)


@dataclass(frozen=True)
class Executed:
    """What the joints of a physical robot did at the samples of a motion."""

    position: Array  # (N, n) [rad]
    torque: Array  # (N, n) [N m]
    fell: bool


def execute(motion: Motion, commands: Array, unit: Unit) -> Executed:
    """Commands (N, n) [rad] executed open loop."""
    robot = as_built(motion.robot, unit)
    q = motion.q.copy()
    q[:, FLOATING_BASE_NQ:] = commands + unit.offset
    v = motion.v.copy()
    v[:, FLOATING_BASE_NV:] = np.gradient(q[:, FLOATING_BASE_NQ:], motion.dt, axis=0)
    told = dataclasses.replace(motion, robot=robot, q=q, v=v)
    prepared = prepare(told, "mujoco", DEFAULTS["mujoco"], "model", feed_forward=False)
    settings = prepared.settings
    engine = make_engine("mujoco", robot, settings, "model", None, motion.scene)
    try:
        recording = play(prepared, engine, servo_figures(robot, "model", settings), None, None)
    finally:
        engine.close()
    n = min(motion.n_samples, len(recording.q))
    height = recording.q[:n, 2] / motion.q[:n, 2]
    fell = len(recording.q) < motion.n_samples or bool((height < 0.6).any())
    return Executed(recording.q[:n, FLOATING_BASE_NQ:], recording.torque[:n], fell)
