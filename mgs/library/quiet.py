"""Dask without its log messages, which would mix with the progress bar."""

from __future__ import annotations

import dask


def silence() -> None:
    """Switch off all log messages of Dask; call it before `distributed` is imported."""
    names = ("distributed", "distributed.nanny", "asyncio", "tornado", "tornado.application")
    dask.config.set({"logging": dict.fromkeys(names, "critical")})
