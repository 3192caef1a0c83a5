"""Files that are either complete or not there."""

from __future__ import annotations

import contextlib
import secrets
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from mgs.core.errors import MgsError


def part_of(path: Path) -> Path:
    """Where the content of a file is written before it takes the file's name."""
    return path.with_name(f".mgs-{secrets.token_hex(8)}.part")


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """Stream into a file beside `path` that takes its place when all went well, else vanishes."""
    new_folders = [folder for folder in path.parents if not folder.exists()]  # innermost first
    path.parent.mkdir(parents=True, exist_ok=True)
    part = part_of(path)
    try:
        with part.open("x+b") as stream:
            yield stream
        part.replace(path)
    except BaseException:  # KeyboardInterrupt too
        part.unlink(missing_ok=True)
        with contextlib.suppress(OSError):  # someone else has put something there
            for folder in new_folders:
                folder.rmdir()
        raise


def replace_file(path: Path, content: bytes) -> None:
    """Write a file, its folder too if missing, in place of what is there.

    Raises:
        MgsError: it cannot be written; what was there before still is.
    """
    part = part_of(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            part.write_bytes(content)
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise MgsError(f"{path}: cannot be written: {reason}") from error
