"""Dask without its log: workers that come and go are our business, not the terminal's."""

from __future__ import annotations

import dask


def silence() -> None:
    """Have Dask log nothing, here and in its processes; to be called before it is imported."""
    dask.config.set({"logging": {"distributed": "critical", "distributed.nanny": "critical"}})
