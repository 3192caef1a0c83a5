"""Motions of the experiments of Mistry et al. in physics, with the servos of robot.yaml.

The servos are told the planned joint angles only, without feed-forward of their load, so that they
lag behind and give way to gravity as position-controlled joints do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.motion import Motion
from mgs.sim.engine import make_engine
from mgs.sim.playback import play
from mgs.sim.prepare import prepare
from mgs.sim.servo import servo_figures
from mgs.sim.settings import OWN_SERVOS, EngineName

ENGINE: EngineName = "mujoco"
FIRST, LAST = 0.25, 0.9  # part of a motion in which its waves have their full amplitude


@dataclass(frozen=True, eq=False)
class Played:
    """What CoM and right hand did in physics; N samples of the motion."""

    times: Array  # (N,) [s]
    com: Array  # (N, 3) [m]
    hand: Array  # (N, 3) [m]
    fell: bool


def play_motion(motion: Motion) -> Played:
    """Execute a motion open loop in MuJoCo."""
    robot = motion.robot
    prepared = prepare(motion, ENGINE, None, "model", feed_forward=False)
    own = "model" in OWN_SERVOS[ENGINE]
    servos = None if own else servo_figures(robot, "model", prepared.settings)
    simulator = make_engine(ENGINE, robot, prepared.settings, "model", None, motion.scene)
    try:
        recording = play(prepared, simulator, servos)
    finally:
        simulator.close()
    n = min(motion.n_samples, len(recording.q))
    data = robot.model.createData()
    com, hand = np.empty((2, n, 3))
    for k, q in enumerate(recording.q[:n]):
        com[k] = pin.centerOfMass(robot.model, data, q)
        pin.framesForwardKinematics(robot.model, data, q)
        hand[k] = data.oMf[robot.hand_frames[Side.RIGHT]].translation
    return Played(motion.times[:n], com, hand, n < motion.n_samples)


def lag_and_droop(reference: Array, actual: Array, dt: float) -> tuple[float, float]:
    """Lag [s] and constant offset [m] of a coordinate (N,) behind its reference (N,).

    The lag is the shift that leaves the smallest mean square difference, interpolated by a parabola
    between samples.
    """
    n = len(actual)
    window = slice(round(FIRST * n), round(LAST * n))
    shifts = np.arange(0, round(0.25 / dt))
    wanted = [reference[window.start - s : window.stop - s] for s in shifts]
    offsets = [float(np.mean(actual[window] - w)) for w in wanted]
    costs = np.array(
        [np.mean((actual[window] - w - o) ** 2) for w, o in zip(wanted, offsets, strict=True)]
    )
    best = int(np.argmin(costs))
    if 0 < best < len(costs) - 1:
        before, here, after = costs[best - 1 : best + 2]
        part = 0.5 * (before - after) / (before - 2.0 * here + after)
    else:
        part = 0.0
    return float((best + part) * dt), offsets[best]
