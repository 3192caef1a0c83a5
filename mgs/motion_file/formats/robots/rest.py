"""Formats for motions that begin and end at rest, whose players cannot repeat a cycle."""

from __future__ import annotations

from mgs.core.errors import ConfigError
from mgs.motion.sampled import SampledMotion


def refuse_cycle(sampled: SampledMotion, name: str, reason: str) -> None:
    """Raise ConfigError for a cycle."""
    if sampled.cycle is not None:
        raise ConfigError("--cycle", f"format {name} holds whole motions: {reason}")
