"""Forces at corners against what statics says of one sole, of two and of a slope of friction."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.geometry import polygon_margins
from mgs.judge.wrench_feasibility import FRICTION, missing_wrenches

SOLE = np.array([[0.05, 0.03, 0.0], [-0.05, 0.03, 0.0], [-0.05, -0.03, 0.0], [0.05, -0.03, 0.0]])
WEIGHT = 30.0


def wrench_at(point: np.ndarray, force: np.ndarray) -> np.ndarray:
    return np.concatenate([force, np.cross(point, force)])


def missing(corners: np.ndarray, wrench: np.ndarray) -> float:
    return float(missing_wrenches(corners[None], wrench[None])[0])


@given(st.floats(-0.08, 0.08), st.floats(-0.05, 0.05))
def test_a_sole_bears_a_weight_whose_centre_of_pressure_is_on_it(x: float, y: float):
    margin = float(polygon_margins([[x, y]], SOLE[:, :2])[0])
    lacking = missing(SOLE, wrench_at(np.array([x, y, 0.0]), np.array([0.0, 0.0, WEIGHT])))
    if margin > 1e-6:
        assert lacking < 1e-6
    elif margin < -1e-6:
        assert lacking > 1e-6


@given(st.floats(0.0, 2.0 * np.pi), st.floats(0.0, 1.0))
def test_a_sole_holds_against_a_pull_inside_its_friction_cone(angle: float, ratio: float):
    pull = ratio * WEIGHT
    force = np.array([pull * np.cos(angle), pull * np.sin(angle), WEIGHT])
    lacking = missing(SOLE, wrench_at(np.zeros(3), force))
    if ratio > FRICTION + 1e-6:
        assert lacking > 1e-6
    if ratio < FRICTION * np.cos(np.pi / 8) - 1e-6:  # the pyramid lies inside the cone
        assert lacking < 1e-6


def test_two_soles_at_different_heights_bear_what_neither_of_them_can():
    upper = SOLE + np.array([0.25, 0.1, 0.05])
    both = np.concatenate([SOLE, upper])
    between = wrench_at(np.array([0.125, 0.05, 0.025]), np.array([0.0, 0.0, WEIGHT]))
    assert missing(both, between) < 1e-6
    assert missing(SOLE, between) > 1.0
    assert missing(upper, between) > 1.0
    beyond = wrench_at(np.array([0.125, 0.4, 0.0]), np.array([0.0, 0.0, WEIGHT]))
    assert missing(both, beyond) > 1.0


def test_the_ground_does_not_pull():
    assert missing(SOLE, np.array([0.0, 0.0, -WEIGHT, 0.0, 0.0, 0.0])) == pytest.approx(WEIGHT)
