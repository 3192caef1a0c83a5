"""Sides and supports: the vocabulary of all stages."""

from __future__ import annotations

import pytest

from mgs.core.contact import Side, Support


@pytest.mark.parametrize("side", list(Side))
def test_a_side_is_the_other_of_its_other(side: Side):
    assert side.other is not side
    assert side.other.other is side
    assert side.sign * side.other.sign == -1
    assert Side[side.label.upper()] is side


def test_left_has_positive_y_and_comes_first_in_arrays():
    assert [(side.label, side.sign, int(side)) for side in Side] == [
        ("left", 1, 0),
        ("right", -1, 1),
    ]


def test_supports_know_their_soles():
    assert Support.DOUBLE.sides == (Side.LEFT, Side.RIGHT)
    for side in Side:
        assert Support.single(side).sides == (side,)
        assert Support.single(side).label == side.label


def test_a_double_support_is_no_support_at_all_in_a_truth_test():
    """Its value is 0, so that code must compare and never say `if support`."""
    assert not Support.DOUBLE
    assert Support.LEFT and Support.RIGHT
