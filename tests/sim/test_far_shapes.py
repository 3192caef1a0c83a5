"""Shapes far from the ground are left out of MuJoCo's contacts, and nothing changes by it."""

from __future__ import annotations

from contextlib import closing

import numpy as np
import pytest

from mgs.core.scene import Ball, Scene
from mgs.sim import DEFAULTS, replay
from mgs.sim.far_shapes import FarShapes
from mgs.sim.mujoco import MujocoEngine
from tests.support.motions import leaning
from tests.support.replays import side_to_side

pytest.importorskip("mujoco")


@pytest.mark.parametrize("kind", ["swaying", "falling"])
def test_a_replay_is_the_same_to_the_last_bit(melson, monkeypatch, kind):
    """A falling robot brings shapes near the ground one after the other, until they touch it."""
    motion = side_to_side(melson, 0.03, 0.5) if kind == "swaying" else leaning(melson, 0.5, 1.0)
    with_all = []
    found = replay(motion, "mujoco")
    monkeypatch.setattr(FarShapes, "leave_out", lambda *_: with_all.append(1))
    expected = replay(motion, "mujoco")
    assert with_all
    assert (found.fell, expected.fell) == (kind == "falling",) * 2
    np.testing.assert_array_equal(found.trace.q, expected.trace.q)
    np.testing.assert_array_equal(found.trace.contacts, expected.trace.contacts)


def counted(engine):
    """Heights [m] of the shapes that are counted, and of those that are left out."""
    robot = engine._model.geom_bodyid > 0
    heights = engine._data.geom_xpos[robot, 2]
    counts = engine._model.geom_contype[robot] != 0
    return heights[counts], heights[~counts]


def test_a_standing_robot_counts_its_feet_and_a_lying_one_everything(melson):
    targets = np.tile(melson.posture, (20, 1))
    with closing(MujocoEngine(melson, DEFAULTS["mujoco"])) as engine:
        engine.place(melson.standing_q)
        engine.drive(targets, np.zeros_like(targets))
        near, far = counted(engine)
        assert 2 < len(near) < len(far)
        assert near.max() < far.max()
        lying = melson.standing_q.copy()
        lying[2], lying[3:7] = 0.05, [0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)]
        engine.place(lying)
        engine.drive(targets, np.zeros_like(targets))
        assert len(counted(engine)[1]) == 0
        engine.place(melson.standing_q)
        engine.drive(targets, np.zeros_like(targets))
        np.testing.assert_array_equal(counted(engine)[1].shape, far.shape)


def test_with_a_ball_about_all_shapes_count(melson):
    scene = Scene(balls=(Ball(0.3, 0.0, 0.04, 0.05, 0.0, 0.0, 1.0),))
    targets = np.tile(melson.posture, (20, 1))
    with closing(MujocoEngine(melson, DEFAULTS["mujoco"], scene=scene)) as engine:
        engine.place(melson.standing_q)
        engine.drive(targets, np.zeros_like(targets))
        assert len(counted(engine)[1]) == 0
