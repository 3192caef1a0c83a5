"""One line that says what a large object is; an array is shown by its type and shape."""

from __future__ import annotations

import dataclasses
import reprlib
from typing import Any


class _Short(reprlib.Repr):
    """Cuts long values; `reprlib` finds the method for a value by the name of its type."""

    def __init__(self) -> None:
        super().__init__()
        self.maxtuple = self.maxlist = self.maxdict = 3
        self.maxstring = self.maxother = 60

    def repr_ndarray(self, array: Any, level: int) -> str:
        return f"<{array.dtype} {array.shape}>"


def short_repr(record: Any) -> str:
    """Name of a dataclass and all its fields in short; to be its `__repr__`."""
    short = _Short()
    fields = (f"{f.name}={short.repr(getattr(record, f.name))}" for f in dataclasses.fields(record))
    return f"{type(record).__name__}({', '.join(fields)})"
