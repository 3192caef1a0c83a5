"""Formats of motions for other programs, by name.

`FORMATS` lists them all. A format is imported when it is used, so that a library which one of them
needs costs nobody else anything.
"""

from __future__ import annotations

from mgs.core.errors import ConfigError
from mgs.core.plugins import unknown_name
from mgs.motion_file.formats.format import Format, Options, Written
from mgs.motion_file.formats.learning import LEARNING
from mgs.motion_file.formats.plain import PLAIN
from mgs.motion_file.formats.recorded import RecordedLinks, RecordedMotion
from mgs.motion_file.formats.robots import ROBOTS

__all__ = [
    "FORMATS",
    "Format",
    "Options",
    "RecordedLinks",
    "RecordedMotion",
    "Written",
    "find_format",
]

FORMATS: dict[str, Format] = {f.name: f for f in (*PLAIN, *LEARNING, *ROBOTS)}


def find_format(name: str) -> Format:
    """Format of a name; raises ConfigError if there is none."""
    if name not in FORMATS:
        raise ConfigError(
            "format", unknown_name(name, list(FORMATS)).replace("is not installed", "is unknown")
        )
    return FORMATS[name]
