"""Fixtures of the simulation tests."""

from __future__ import annotations

import pytest

from mgs.sim import ENGINES, EngineName


@pytest.fixture(params=ENGINES)
def engine_name(request: pytest.FixtureRequest) -> EngineName:
    """Every engine in turn, if it is installed."""
    name: EngineName = request.param
    pytest.importorskip(name)
    return name
