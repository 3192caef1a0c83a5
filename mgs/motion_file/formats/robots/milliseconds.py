"""Whole milliseconds, in which some files hold their times."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError

MILLISECOND = 1e-3  # [s]


def whole_milliseconds(times: Array, interval: float) -> list[int]:
    """Round times (T,) [s] to milliseconds; no two become the same.

    Raises:
        ConfigError: the frames are less than a millisecond apart.
    """
    if interval < MILLISECOND * (1.0 - 1e-9):
        raise ConfigError("fps", "the file has whole milliseconds; use at most 1000 Hz")
    return [int(t) for t in np.rint(times / MILLISECOND)]
