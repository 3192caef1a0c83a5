"""Tables of numbers in text files, separated by commas, read within bounds."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

import numpy as np

from mgs.core.arrays import Array
from mgs.core.input_files import opened
from mgs.core.limits import MAX_CHANNELS, MAX_RECORDING, MAX_SAMPLES
from mgs.core.short_text import shown
from mgs.motion_file.formats.recorded import Reading


@contextmanager
def opened_text(path: Path) -> Iterator[TextIO]:
    """Text of a regular file; raises ConfigError if there is none, MotionFileError if too large."""
    with opened(path) as stream:
        size = stream.seek(0, io.SEEK_END)
        if size > MAX_RECORDING:
            raise Reading(path).error(f"larger than {MAX_RECORDING // 1_000_000} MB")
        stream.seek(0)
        text = io.TextIOWrapper(stream, encoding="utf-8-sig", newline="")
        try:
            yield text
        except UnicodeDecodeError as error:
            raise Reading(path).error("not a text file in UTF-8") from error
        finally:
            text.detach()


def number_table(reading: Reading, stream: TextIO, head: bool) -> tuple[list[str], Array]:
    """Head line, if there is one, and numbers (T, C) of a table.

    Raises:
        MotionFileError: a line has another length or something that is no finite number, or the
            table is empty or too large.
    """
    lines = csv.reader(stream)
    titles: list[str] = []
    rows: list[Array] = []
    try:
        if head:
            titles = next(lines, [])
        for line in lines:
            if line:
                rows.append(_row(reading, lines.line_num, line, len(titles) or _width(rows)))
            if len(rows) > MAX_SAMPLES:
                raise reading.error(f"more than {MAX_SAMPLES} lines")
    except csv.Error as error:
        raise reading.error(f"line {lines.line_num}: {error}") from error
    if not rows:
        raise reading.error("no line of numbers")
    return titles, np.array(rows)


def _width(rows: list[Array]) -> int:
    return len(rows[0]) if rows else 0


def _row(reading: Reading, number: int, line: list[str], width: int) -> Array:
    if (width and len(line) != width) or len(line) > MAX_CHANNELS:
        wanted = width or f"at most {MAX_CHANNELS}"
        raise reading.error(f"line {number} has {len(line)} columns; it should have {wanted}")
    try:
        row = np.array([float(cell) for cell in line])
    except ValueError as error:
        wrong = next(cell for cell in line if not _is_number(cell))
        raise reading.error(f"line {number}: {shown(wrong, 40)} is no number") from error
    if not np.isfinite(row).all():
        raise reading.error(f"line {number} has a value that is not finite")
    return row


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
