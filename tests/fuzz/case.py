"""One malformed input: files, and the command that reads them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Case:
    """Files in an empty folder, and a command about them."""

    kind: str
    files: dict[str, bytes]
    command: tuple[str, ...]


def write(case: Case, folder: Path) -> None:
    """Write the files of a case into a folder."""
    for name, data in case.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
