"""Motions for `repair.py`, damaged in all ways at once: what sloppy retargeting makes of them.

The base is 30 mm too low, all or half of the time; it slides to and fro at 50 mm/s; all joints
tremble by 10 mrad; and the joint that is nearest to the end of its range is bent beyond it.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from clean_motions import resample, shipped
from seeded_defects import span

import mgs
from mgs.judge.audit import GivenMotion

MOTIONS = (
    "melson/walk_practical", "melson/walk_arc", "melson/walk_sideways", "melson/walk_backward",
    "melson/walk_mixed", "melson/turn_in_place", "melson/walk_5cm", "melson/squat", "melson/bow",
    "melson/sway", "melson/kick", "coman/walk_forward", "coman/walk_arc", "coman/walk_sideways",
    "coman/walk_fastest", "coman/walk", "coman/sway", "coman/bow", "coman/kick", "coman/wave",
)  # fmt: skip
# Others than those that the repair was tuned on
OTHERS = (
    "melson/walk_fastest", "melson/walk_to_pose", "melson/figure_eight", "melson/walk_kick_walk",
    "melson/walk_turn_walk", "melson/walk_swinging", "melson/hand_eight", "melson/wave",
    "melson/squat_stretched", "melson/get_ready", "coman/hand_eight",
)  # fmt: skip
GENERIC = tuple(
    f"generic/{name}"
    for name in ("walk", "arc", "sideways", "turn", "squat", "sway", "kick", "bow", "wave")
)
DEPTH, SLIDE, TREMBLE = 0.03, 0.05, 0.01  # [m], [m/s], [rad]
LONGEST = 8.0  # [s]


def undamaged(name: str, rate: float, robot: str | None = None) -> GivenMotion:
    """The first seconds of a shipped gait, positions alone; `robot` executes generic gaits."""
    motion = shipped(name) if robot is None else mgs.generate(robot, name)
    given = resample(motion, rate, 0.0, min(motion.duration, LONGEST))
    return dataclasses.replace(given, joint_velocity=None, base_linear=None, base_angular=None)


def damaged(given: GivenMotion, rng: np.random.Generator) -> GivenMotion:
    """The motion with all four kinds of damage."""
    q, t, robot = given.q.copy(), given.dt * np.arange(given.n_samples), given.robot
    low = span(given, rng, 2.0, 4.0) if rng.random() < 0.5 else np.ones(given.n_samples)
    q[:, 2] -= DEPTH * low
    period, turn = rng.uniform(0.8, 1.6), rng.uniform(-np.pi, np.pi)
    slide = SLIDE * (np.abs((t + 0.5 * period) % period - 0.5 * period) - 0.25 * period)
    q[:, :2] += np.outer(slide, [np.cos(turn), np.sin(turn)])
    room = np.minimum(given.joints - robot.lower, robot.upper - given.joints)
    k, j = np.unravel_index(int(np.argmin(room)), room.shape)
    upper = robot.upper[j] - given.joints[k, j] < given.joints[k, j] - robot.lower[j]
    bend = float(room[k, j]) + rng.uniform(0.03, 0.1)
    around = np.clip(1.0 - np.abs(t - t[k]) / 0.3, 0.0, 1.0)
    q[:, 7 + j] += (1.0 if upper else -1.0) * bend * around * around * (3.0 - 2.0 * around)
    q[:, 7:] += rng.normal(0.0, TREMBLE, given.joints.shape)
    return dataclasses.replace(given, q=q)
