"""Arrays of numbers as base64 text for a page, little-endian, which its script decodes.

An array is stored with 16 bits per number, scaled column by column, so that the error is at most
1/131068 of the range of its column; positions, which may cover a long way, are stored with 32 bits.
"""

from __future__ import annotations

import base64
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

STEPS = 65534  # number of steps between the smallest and the largest value of a column

Packed = dict[str, Any]


def packed(values: ArrayLike, kind: Literal["i2", "f4"] = "i2") -> Packed:
    """Encode an array (N,) or (N, m) with 16 (i2) or 32 bits (f4) per number.

    Numbers that are not finite are kept by f4; an array that has some is stored so.
    """
    array = np.asarray(values, dtype=np.float64)
    table = array.reshape(len(array), -1)
    if kind == "f4" or not np.isfinite(table).all():
        return _entry("f4", table, table.astype("<f4"))
    low, high = _bounds(table)
    scale = (high - low) / STEPS  # 0 in a column of equal numbers
    codes = np.rint((table - low) / np.where(scale > 0.0, scale, 1.0)) - STEPS // 2
    offset = low + scale * (STEPS // 2)
    entry = _entry("i2", table, codes.astype("<i2"))
    return entry | {"scale": scale.tolist(), "offset": offset.tolist()}


def packed_codes(values: ArrayLike, kind: Literal["u1", "u2"]) -> Packed:
    """Encode whole numbers (N,) or (N, m) from 0 to 255 (u1) or 65535 (u2) as they are."""
    table = np.asarray(values).reshape(len(np.asarray(values)), -1)
    return _entry(kind, table, table.astype(f"<{kind}"))


def _bounds(table: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if not len(table):
        return np.zeros(table.shape[1]), np.zeros(table.shape[1])
    return table.min(axis=0), table.max(axis=0)


def _entry(kind: str, table: NDArray[Any], content: NDArray[Any]) -> Packed:
    text = base64.b64encode(np.ascontiguousarray(content).tobytes()).decode("ascii")
    return {"type": kind, "rows": table.shape[0], "columns": table.shape[1], "data": text}
