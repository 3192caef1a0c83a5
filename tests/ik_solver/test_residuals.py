"""A trajectory that misses a task is refused at the right time, for the right task."""

from __future__ import annotations

import numpy as np
import pytest

from mgs.core.constants import POSITION_TOLERANCE, ROTATION_TOLERANCE
from mgs.core.errors import IkError
from mgs.ik_solver.residuals import position_rows, refuse_misses, turn_rows

DT = 0.1
TASKS = (position_rows("hand", slice(0, 3)), turn_rows("sole", slice(3, 6)))


def test_errors_within_their_tolerances_are_accepted():
    errors = np.zeros((5, 6))
    errors[:, 1], errors[:, 4] = -POSITION_TOLERANCE, ROTATION_TOLERANCE
    refuse_misses(TASKS, errors, DT)


def test_the_size_of_an_error_is_its_length_and_not_its_largest_entry():
    errors = np.zeros((1, 6))
    errors[0, :3] = 0.7 * POSITION_TOLERANCE
    with pytest.raises(IkError) as caught:
        refuse_misses(TASKS, errors, DT)
    assert caught.value.residual == pytest.approx(0.7 * np.sqrt(3.0) * POSITION_TOLERANCE)


def test_the_first_sample_that_misses_is_named_with_its_worst_task():
    errors = np.zeros((6, 6))
    errors[2, 0] = 2.0 * POSITION_TOLERANCE
    errors[2, 5] = 3.0 * ROTATION_TOLERANCE
    errors[4, 0] = 1.0  # larger, but later
    with pytest.raises(IkError) as caught:
        refuse_misses(TASKS, errors, DT, start=10)
    error = caught.value
    assert (error.task, error.unit, error.tolerance) == (
        "sole orientation",
        "rad",
        TASKS[1].tolerance,
    )
    assert error.t == pytest.approx(12 * DT)
    assert error.residual == pytest.approx(3.0 * ROTATION_TOLERANCE)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_an_error_that_is_not_finite_is_a_miss(value: float):
    errors = np.zeros((3, 6))
    errors[1, 2] = value
    with pytest.raises(IkError, match=r"t = 0\.100 s: hand"):
        refuse_misses(TASKS, errors, DT)
