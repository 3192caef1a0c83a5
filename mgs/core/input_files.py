"""Reading of input files: regular files only, up to a stated size.

A device or a FIFO would never end or never begin, so its kind is looked at before it is opened.
"""

from __future__ import annotations

import contextlib
import os
import stat
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import BinaryIO

from mgs.core.errors import ConfigError
from mgs.core.limits import MAX_FILE

UTF_16 = (b"\xff\xfe", b"\xfe\xff")


@contextlib.contextmanager
def opened(path: Path) -> Iterator[BinaryIO]:
    """Stream of a regular file.

    Raises:
        ConfigError: there is no such file, it cannot be read, or it is of another kind.
    """
    with _opened(path) as stream:
        yield stream


def _opened(path: Path) -> BinaryIO:
    try:
        mode = path.stat().st_mode
        if not stat.S_ISREG(mode):
            kind = "a directory" if stat.S_ISDIR(mode) else "a device or a pipe"
            raise ConfigError(path, f"{kind}, not a regular file")
        # another program may have put a FIFO there since, which must not block
        number = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        if not stat.S_ISREG(os.fstat(number).st_mode):
            os.close(number)
            raise ConfigError(path, "not a regular file")
        return os.fdopen(number, "rb")
    except OSError as error:
        raise ConfigError(path, (error.strerror or str(error)).lower()) from error
    except ValueError as error:  # the name contains a zero byte or half a character
        raise ConfigError(path, f"not the name of a file: {error}") from error


def read_bytes(path: Path, limit: int, kind: str) -> bytes:
    """Content of a regular file.

    Args:
        path: the file.
        limit: largest size [bytes].
        kind: what such files are, for messages.

    Raises:
        ConfigError: the file is missing, too large, or not a regular file.
    """
    with opened(path) as stream:
        try:
            data = stream.read(limit + 1)
        except OSError as error:
            raise ConfigError(path, (error.strerror or str(error)).lower()) from error
    if len(data) > limit:
        raise ConfigError(path, f"larger than {limit // 1000} kB, too large for {kind}")
    return data


def read_text(path: Path, limit: int = MAX_FILE, kind: str = "a gait or robot file") -> str:
    """Text of a file, without the byte order mark that some editors put at its start.

    Raises:
        ConfigError: it is missing, too large, not a regular file or not UTF-8.
    """
    data = read_bytes(path, limit, kind)
    if data.startswith(UTF_16):
        raise ConfigError(path, "not a text file in UTF-8 but in UTF-16; save it as UTF-8")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ConfigError(path, f"not a text file (byte {error.start} is not UTF-8)") from error


def is_file(path: Path) -> bool:
    """Whether a file exists at a path; False also for a name that is too long for the system."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_inside(path: Path, folders: Iterable[Path]) -> bool:
    """Whether a path, with all links followed, lies in one of some folders."""
    try:
        found = path.resolve()
        return any(found.is_relative_to(folder.resolve()) for folder in folders)
    except (OSError, RuntimeError, ValueError):  # a loop of links, a name that no file can have
        return False
