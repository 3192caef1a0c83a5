"""Motions to replay, conditions to replay them in, and what is compared of a replay."""

from __future__ import annotations

import numpy as np

from mgs.robot import Robot
from mgs.sim.conditions import Conditions
from tests.support.motions import DT, swaying


def side_to_side(robot, amplitude, seconds):
    """The base moves sideways and back."""
    t = np.arange(round(seconds / DT) + 1) * DT
    return swaying(robot, amplitude * np.outer(np.sin(np.pi * t / seconds) ** 2, [0.0, 1.0, 0.0]))


def figures(result):
    """All figures that depend on the simulation alone."""
    return {key: value for key, value in result.to_json().items() if key != "wall_seconds"}


def nominal(robot: Robot) -> Conditions:
    n = robot.n
    return Conditions(
        friction=1.0,
        slope=np.zeros(2),
        mass=np.ones(n + 1),
        com=np.zeros(3),
        gain=np.ones(n),
        supply=1.0,
        joint_offset=np.zeros(n),
        latency=0.0,
        bumps=np.zeros((0, 3)),
        sag=1.0,
    )
