"""Spans of equal values, against a walk through the values one by one."""

from __future__ import annotations

import numpy as np
import pytest

from mgs.core.spans import span_starts, spans


@pytest.mark.parametrize("seed", range(5))
def test_spans_tile_the_values_and_end_where_the_value_changes(seed: int):
    rng = np.random.default_rng(seed)
    values = np.repeat(rng.integers(0, 3, size=12), rng.integers(1, 4, size=12))
    expected = [0, *(k for k in range(1, len(values)) if values[k] != values[k - 1])]
    assert span_starts(values) == expected
    found = spans(values)
    assert [k for start, end in found for k in range(start, end)] == list(range(len(values)))
    assert [start for start, _ in found] == expected
    assert all(len(set(values[start:end])) == 1 for start, end in found)


def test_values_that_never_change_are_one_span():
    assert spans(np.zeros(4)) == [(0, 4)]
    assert spans(np.array([True])) == [(0, 1)]
