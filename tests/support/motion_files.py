"""Motions of random numbers, and whether two motions are the same bit for bit."""

from __future__ import annotations

from typing import Any

import numpy as np

from mgs.core.contact import Footstep, Side
from mgs.core.plugins import Origin
from mgs.motion import Motion
from mgs.motion.provenance import Corrections, FilterReport, Provenance, ZmpError
from mgs.robot import Robot
from tests.support.strategies import walk_gait

DT = 0.0123  # [s]; no multiple of it but 0 is a whole number of milliseconds
ARRAYS = ("q", "v", "torque", "com", "com_ref", "zmp", "zmp_ref", "torso", "torso_ref")
SIDED = ("soles", "soles_ref", "hands", "hands_ref")
EXTREMES = (-0.0, 5e-324, 1.7976931348623157e308, 0.1)


def random_motion(robot: Robot, n_samples: int = 25, seed: int = 0) -> Motion:
    """Random numbers, among them the awkward ones, wherever a motion has numbers."""
    rng = np.random.default_rng(seed)
    n = robot.n

    def numbers(*shape: int) -> np.ndarray[Any, np.dtype[np.float64]]:
        values = rng.normal(size=(n_samples, *shape))
        values.flat[: len(EXTREMES)] = EXTREMES[: values.size]
        return values

    q = rng.uniform(-1.5, 1.5, size=(n_samples, 7 + n))
    q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1, keepdims=True)
    return Motion(
        robot=robot,
        gait=walk_gait(dt=DT, step_length=0.1 + 0.2, com={"weight_jerk": 1e-6}),
        gait_name="größe/test",
        dt=DT,
        footsteps=(Footstep(Side.LEFT, 0.1 + 0.2, 1 / 3, -0.1), Footstep(Side.RIGHT, 0.0, -0.1, 3)),
        support=rng.integers(0, 3, n_samples).astype(np.int8),
        q=q,
        v=numbers(6 + n),
        torque=numbers(n),
        com=numbers(3),
        com_ref=numbers(3),
        zmp=numbers(2),
        zmp_ref=numbers(2),
        soles=numbers(2, 7),
        soles_ref=numbers(2, 7),
        hands=numbers(2, 7),
        hands_ref=numbers(2, 3),
        torso=numbers(7),
        torso_ref=numbers(4),
        provenance=Provenance(
            Origin("clik", "mgs", "0.3"),
            Origin("qp", "elsewhere", "1.0"),
            tuning={"gamma_joint": 0.35, "iterations": None, "weights": [1.0, 1e-6]},
            report={"newton_updates": 3},
            zmp_error=FilterReport(ZmpError(1e-3, 2e-3), ZmpError(1e-4, 2e-4), 2),
            refined=Corrections((0.5, 0.25), ("mujoco",)),
            parts=(Provenance(Origin("ik4", "mgs", "0.3")),),
        ),
    )


def assert_same(a: Motion, b: Motion) -> None:
    for name in (*ARRAYS, *SIDED, "support"):
        x, y = getattr(a, name), getattr(b, name)
        assert (x.dtype, x.shape, x.tobytes()) == (y.dtype, y.shape, y.tobytes()), name
    for name in ("gait", "gait_name", "dt", "footsteps", "provenance"):
        assert getattr(a, name) == getattr(b, name), name
    assert (a.robot.yaml, a.robot.urdf) == (b.robot.yaml, b.robot.urdf)
    assert a.robot.joint_names == b.robot.joint_names
