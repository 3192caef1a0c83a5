"""Exceptions of other people's code, which become messages of mgs where that code is called."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

from mgs.core.errors import MgsError
from mgs.core.short_text import shown


@contextlib.contextmanager
def told_as(make: Callable[[str], MgsError]) -> Iterator[None]:
    """Turn every exception that is none of mgs into the one that `make` makes of its description.

    Errors of the system, such as a full disk, stay what they are, and so does lack of memory.
    """
    try:
        yield
    except (MgsError, MemoryError, OSError):
        raise
    except Exception as error:
        raise make(described(error)) from error


def described(error: Exception) -> str:
    """Kind and message of an exception on one line."""
    return f"{type(error).__name__}: {shown(error, 300)}"
