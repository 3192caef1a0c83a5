"""One run at a time in a folder: a lock that the operating system releases when a process ends."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import socket
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from mgs.core.errors import MgsError

LOCK = ".lock"


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of an existing folder.

    Raises:
        MgsError: another run holds the lock; the message names its process. Or the lock is a link,
            whose target would be written, or a pipe, or another thing that is no file.
    """
    with _opened(folder / LOCK) as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            stream.seek(0)
            holder = stream.read(200).strip() or "another process"
            raise MgsError(
                f"{folder}: {holder} is writing this library; wait until it ends, or stop it"
            ) from error
        stream.truncate(0)
        stream.write(f"process {os.getpid()} on {socket.gethostname()}")
        stream.flush()
        yield


def _opened(path: Path) -> TextIO:
    """Stream of a lock file, to be read and written; it is made if it is missing."""
    flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    try:
        number = os.open(path, flags, 0o666)
        if stat.S_ISREG(os.fstat(number).st_mode):
            return os.fdopen(number, "r+", encoding="utf-8", errors="replace")
        os.close(number)
    except OSError as error:
        if error.errno not in (errno.ELOOP, errno.ENXIO, errno.EISDIR):
            raise
    raise MgsError(f"{path}: a link, a folder or a device instead of a lock file; remove it")
