"""Which formats can be tried on this machine."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterable
from typing import Any

import pytest

LIBRARIES = {"protomotions": "torch", "lerobot": "pyarrow"}


def needs_library(names: Iterable[str]) -> list[Any]:
    """Names of formats as parameters of a test, skipped where a library of theirs is missing."""
    return [
        pytest.param(
            name,
            marks=pytest.mark.skipif(
                importlib.util.find_spec(LIBRARIES.get(name, "mgs")) is None,
                reason=f"format {name} needs {LIBRARIES.get(name)}, which is not installed",
            ),
        )
        for name in names
    ]
