"""Files of third-party packages, for tests that are skipped where a package is not installed."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import pytest


def file_of(package: str, name: str) -> Path:
    """Path of the file of an installed package whose path ends with a name; else the test skips."""
    try:
        files = importlib.metadata.files(package) or []
    except importlib.metadata.PackageNotFoundError:
        pytest.skip(f"{package} is not installed")
    for file in files:
        path = Path(str(file.locate())).resolve()
        if file.as_posix().endswith(name) and path.is_file():
            return path
    pytest.skip(f"{package} has no {name}")
