"""Motions moved in the plane: what lies on the ground moves, and is met, with them."""

from __future__ import annotations

import cmath
import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mgs.core.contact import Side
from mgs.core.geometry import planar_middle
from mgs.core.scene import Ball, Box, Scene
from mgs.motion import Motion
from mgs.pipeline.join import Displacement, displacement, join, moved
from mgs.robot import load_robot
from tests.support.motions import standing
from tests.support.strategies import numbers

MELSON = load_robot("melson")
BOX = Box(x=0.3, y=-0.1, yaw=0.2, length=0.2, width=0.1, height=0.05)
BALL = Ball(x=0.2, y=0.1, radius=0.03, mass=0.05, time=0.25, direction=0.3, speed=1.0)
poses = st.tuples(numbers(-2.0, 2.0), numbers(-2.0, 2.0), numbers(-3.0, 3.0)).map(np.array)


@pytest.fixture(scope="module")
def still() -> Motion:
    """Half a second on both feet, beside a box and a ball."""
    motion = standing(MELSON, 0.5)
    n = motion.n_samples
    widths = {"com": 3, "com_ref": 3, "zmp": 2, "zmp_ref": 2, "torque": MELSON.n, "torso_ref": 4}
    arrays = {name: np.zeros((n, width)) for name, width in widths.items()}
    hands = {"hands": np.zeros((n, 2, 7)), "hands_ref": np.zeros((n, 2, 3))}
    scene = Scene((BOX,), (BALL,))
    return dataclasses.replace(motion, torso=np.zeros((n, 7)), scene=scene, **arrays, **hands)


@settings(max_examples=20)
@given(poses, numbers(-0.04, 0.2))
def test_boxes_balls_and_footsteps_move_as_complex_numbers_do(still, pose, rise):
    z, turn = complex(pose[0], pose[1]), cmath.exp(1j * pose[2])
    out = moved(still, Displacement(pose, rise))
    box, ball = out.scene.boxes[0], out.scene.balls[0]
    assert np.abs(box.corners @ [1, 1j] - (z + turn * (BOX.corners @ [1, 1j]))).max() < 1e-12
    assert box.height == pytest.approx(BOX.height + rise)
    assert abs(complex(ball.x, ball.y) - (z + turn * complex(BALL.x, BALL.y))) < 1e-12
    assert abs(cmath.exp(1j * ball.direction) - turn * cmath.exp(1j * BALL.direction)) < 1e-12
    for step, old in zip(out.footsteps, still.footsteps, strict=True):
        assert abs(complex(step.x, step.y) - (z + turn * complex(old.x, old.y))) < 1e-12
        assert step.z == pytest.approx(old.z + rise)
    assert np.allclose(out.soles[..., 2] - still.soles[..., 2], rise)
    assert np.allclose(out.q[:, 2] - still.q[:, 2], rise)


@settings(max_examples=20)
@given(poses, numbers(-0.04, 0.2))
def test_a_displacement_and_its_inverse_lead_back(still, pose, rise):
    by = Displacement(pose, rise)
    there = moved(still, by)
    back = moved(there, by.inverse)
    for name in ("com", "zmp", "soles", "soles_ref", "hands"):
        assert np.abs(getattr(back, name) - getattr(still, name)).max() < 1e-12, name
    found = displacement(there, still)  # leads from one to the other
    middles = [planar_middle(m.soles_ref[0]) for m in (moved(still, found), there)]
    assert np.abs(middles[0] - middles[1]).max() < 1e-12
    assert found.rise == pytest.approx(rise)


def test_balls_of_a_later_part_are_struck_later_and_boxes_are_met_once(still):
    motion = join([still, still, moved(still, Displacement(np.array([1.0, 0.0, 0.0])))])
    assert motion.n_samples == 3 * still.n_samples - 2
    assert [ball.time for ball in motion.scene.balls] == pytest.approx([0.25, 0.75, 1.25])
    assert len(motion.scene.boxes) == 2
    assert [step.side for step in motion.footsteps] == [Side.LEFT, Side.RIGHT]
