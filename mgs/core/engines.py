"""The physics engines: which are installed, and why one is missing and what to do about it.

The module imports no engine, so that every command can tell quickly what is there.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import platform
import sys
from dataclasses import asdict, dataclass
from typing import Literal

EngineName = Literal["pybullet", "mujoco"]
ENGINES: tuple[EngineName, ...] = ("pybullet", "mujoco")
LAST_WHEEL = (3, 11)  # latest Python for which PyBullet 3.2.7 has a wheel, on Linux on x86_64


@dataclass(frozen=True)
class MissingEngine:
    """A physics engine that is not installed.

    Attributes:
        engine: name of the engine.
        cause: why it is not installed.
        remedy: what to do about it.
    """

    engine: EngineName
    cause: str
    remedy: str

    def __str__(self) -> str:
        return f"{self.engine} is MISSING: {self.cause}; {self.remedy}"

    def to_dict(self) -> dict[str, str]:
        """Convert to plain data."""
        return asdict(self)


def available_engines() -> tuple[EngineName, ...]:
    """Engines whose package is installed; imports none of them."""
    return tuple(name for name in ENGINES if importlib.util.find_spec(name) is not None)


def engine_versions() -> dict[str, str]:
    """Version of each installed engine by name; "unknown" where the package does not state it."""
    return {name: _version(name) for name in available_engines()}


def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return "unknown"


def missing_engines() -> tuple[MissingEngine, ...]:
    """Engines that are not installed, each with cause and remedy."""
    there = available_engines()
    return tuple(_missing(name) for name in ENGINES if name not in there)


def _missing(name: EngineName) -> MissingEngine:
    python, system = sys.version_info[:2], (platform.system(), platform.machine())
    if name == "mujoco" or (python <= LAST_WHEEL and system == ("Linux", "x86_64")):
        return MissingEngine(name, "its package is not installed", f"pip install {name}")
    here = f"Python {python[0]}.{python[1]} on {' '.join(system)}"
    return MissingEngine(
        name,
        f"there is no ready-made package of PyBullet for {here}, so that mgs is installed without "
        "it",
        "use Python 3.10 or 3.11 on Linux on x86_64, or build it with a C++ compiler, which takes "
        "about a quarter of an hour: pip install pybullet",
    )
