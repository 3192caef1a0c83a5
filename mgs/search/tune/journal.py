"""Journal of a search: one line of JSON for each step of Optuna, written by one process at a time.

Optuna's own files need a lock file beside them, which a killed process leaves behind, and cannot
be continued after a line that was cut off.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from optuna.storages.journal import BaseJournalBackend

from mgs.core.atomic_files import refuse_taken
from mgs.core.errors import InputError, MgsError
from mgs.core.input_files import read_bytes
from mgs.core.limits import MAX_JOURNAL

FIRST = b'{"op_code"'  # what a line of Optuna begins with


class Journal(BaseJournalBackend):  # type: ignore[misc]
    """Steps of a search, in memory and in a file."""

    def __init__(self, stream: BinaryIO, steps: list[dict[str, Any]]) -> None:
        self._stream, self.steps = stream, steps

    def read_logs(self, log_number_from: int) -> list[dict[str, Any]]:
        """Steps from a number on."""
        return self.steps[log_number_from:]

    def append_logs(self, logs: list[dict[str, Any]]) -> None:
        """Add steps, in one write, so that an interrupt cannot cut it in two."""
        self._stream.write("".join(f"{json.dumps(step)}\n" for step in logs).encode())
        os.fsync(self._stream.fileno())
        self.steps.extend(logs)


@contextlib.contextmanager
def open_journal(path: Path) -> Iterator[Journal]:
    """Journal in a file, which is made if it is missing; a last line that was cut off is removed.

    Raises:
        InputError: the file is too large, or not a journal.
        MgsError: another search writes it, or it is no regular file.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    refuse_taken(path, force=True)  # it is written, so it must not be a link, a pipe or a device
    with path.open("a+b", buffering=0) as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise MgsError(f"{path}: another search is writing this journal") from error
        steps, size = _steps(path, read_bytes(path, MAX_JOURNAL, "a journal"))
        stream.truncate(size)
        yield Journal(stream, steps)


def _steps(path: Path, data: bytes) -> tuple[list[dict[str, Any]], int]:
    """Steps of a journal, and the size of their lines [bytes]."""
    steps, size = [], 0
    for number, line in enumerate(data.splitlines(keepends=True), start=1):
        if not line.endswith(b"\n") and FIRST.startswith(line[: len(FIRST)]):
            break  # the process was killed while it wrote this line
        try:
            step = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise InputError(f"{path}: not the journal of a search, see line {number}") from error
        if not isinstance(step, dict):
            raise InputError(f"{path}: not the journal of a search, see line {number}")
        steps.append(step)
        size += len(line)
    return steps, size
