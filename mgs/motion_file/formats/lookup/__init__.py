"""Tables of walks by velocity: one file with the cycles of many walks, for a policy to look up.

Each module has `write(walks, path, options) -> Written`; its docstring states the layout.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from mgs.motion_file.formats.format import Options, Written
from mgs.motion_file.formats.lookup import open_duck_poly, toddlerbot_zmp
from mgs.motion_file.formats.lookup.walk import Walk

__all__ = ["LOOKUPS", "Lookup", "Walk"]


@dataclass(frozen=True)
class Lookup:
    """A kind of table, and the module that writes it."""

    name: str
    summary: str  # one line
    suffix: str
    module: ModuleType
    fps: float  # that its readers expect [Hz]

    def write(self, walks: Sequence[Walk], path: Path, options: Options) -> Written:
        """Write the table where nothing is yet.

        Raises:
            ConfigError: the walks do not fit together.
        """
        written: Written = self.module.write(walks, path, options)
        return written

    @property
    def layout(self) -> str:
        """Description of its files."""
        return (self.module.__doc__ or "").strip()


LOOKUPS: dict[str, Lookup] = {
    table.name: table
    for table in (
        Lookup(
            "open-duck-poly", "polynomials of the Open Duck playground",
            ".pkl", open_duck_poly, fps=50.0,
        ),
        Lookup(
            "toddlerbot-zmp", "lookup table of ToddlerBot's ZMP walk",
            ".pkl", toddlerbot_zmp, fps=50.0,
        ),
    )
}  # fmt: skip
