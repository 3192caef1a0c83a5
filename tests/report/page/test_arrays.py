"""Packed arrays, decoded here by numpy alone."""

from __future__ import annotations

import base64

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from mgs.report.page.arrays import Packed, packed, packed_codes

TABLES = arrays(
    np.float64,
    st.tuples(st.integers(1, 20), st.integers(1, 4)),
    elements=st.floats(-1e6, 1e6, allow_nan=False),
)


def unpacked(entry: Packed) -> NDArray[np.float64]:
    raw = np.frombuffer(base64.b64decode(entry["data"]), dtype=f"<{entry['type']}")
    table = raw.reshape(entry["rows"], entry["columns"]).astype(np.float64)
    if "scale" not in entry:
        return table
    return table * np.array(entry["scale"]) + np.array(entry["offset"])


@given(TABLES)
def test_sixteen_bits_keep_a_number_to_half_a_step_of_its_column(table: NDArray[np.float64]):
    half = 0.5 * np.ptp(table, axis=0) / 65534
    rounding = 1e-9 * (1.0 + np.abs(table).max())  # of the arithmetic
    assert (np.abs(unpacked(packed(table)) - table) <= half + rounding).all()


@given(TABLES)
def test_thirty_two_bits_keep_seven_digits(table: NDArray[np.float64]):
    np.testing.assert_allclose(unpacked(packed(table, "f4")), table, rtol=1e-7, atol=1e-38)


def test_numbers_that_are_not_finite_stay_what_they_are():
    entry = packed([[1.0, np.nan], [np.inf, 2.0]])
    np.testing.assert_array_equal(unpacked(entry), [[1.0, np.nan], [np.inf, 2.0]])


def test_a_constant_column_is_exact():
    assert (unpacked(packed(np.full((5, 2), 0.3))) == 0.3).all()


@pytest.mark.parametrize("kind", ["u1", "u2"])
def test_codes_are_kept_as_they_are(kind: str):
    codes = np.array([0, 1, 255])
    np.testing.assert_array_equal(unpacked(packed_codes(codes, kind))[:, 0], codes)  # type: ignore[arg-type]
