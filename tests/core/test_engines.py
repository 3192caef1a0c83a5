"""Tests of what mgs says about physics engines that are not installed."""

from __future__ import annotations

import importlib.metadata
import platform
import sys

import pytest

from mgs.core import engines
from mgs.core.engines import available_engines, engine_versions, missing_engines


def install(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    """Let only these engines be installed."""
    monkeypatch.setattr(
        engines.importlib.util, "find_spec", lambda name: object() if name in names else None
    )


@pytest.mark.parametrize(
    ("python", "system", "has_package"),
    [
        ((3, 11), ("Linux", "x86_64"), True),
        ((3, 12), ("Linux", "x86_64"), False),
        ((3, 13), ("Linux", "x86_64"), False),
        ((3, 11), ("Linux", "aarch64"), False),
        ((3, 11), ("Darwin", "arm64"), False),
    ],
)
def test_the_cause_and_the_remedy_depend_on_python_and_system(
    monkeypatch, python, system, has_package
):
    install(monkeypatch, "mujoco")
    monkeypatch.setattr(sys, "version_info", (*python, 0, "final", 0))
    monkeypatch.setattr(platform, "system", lambda: system[0])
    monkeypatch.setattr(platform, "machine", lambda: system[1])
    (missing,) = missing_engines()
    assert missing.engine == "pybullet" and "pip install pybullet" in missing.remedy
    assert (missing.cause == "its package is not installed") is has_package
    if not has_package:
        assert f"Python {python[0]}.{python[1]} on {system[0]} {system[1]}" in missing.cause
        assert "3.10 or 3.11" in missing.remedy
    assert str(missing).startswith("pybullet is MISSING: ")
    assert set(missing.to_dict()) == {"engine", "cause", "remedy"}


def test_a_missing_mujoco_is_installed_like_any_package(monkeypatch):
    install(monkeypatch, "pybullet")
    (missing,) = missing_engines()
    assert (missing.engine, missing.remedy) == ("mujoco", "pip install mujoco")


def test_an_engine_without_metadata_is_there_all_the_same(monkeypatch):
    def fail(name: str):
        raise importlib.metadata.PackageNotFoundError(name)

    install(monkeypatch, "mujoco")
    monkeypatch.setattr(importlib.metadata, "version", fail)
    assert engine_versions() == {"mujoco": "unknown"}


def test_an_engine_is_installed_or_missing():
    there = available_engines()
    assert tuple(engine_versions()) == there
    assert {*there, *(engine.engine for engine in missing_engines())} == set(engines.ENGINES)
