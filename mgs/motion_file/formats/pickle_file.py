"""Pickles of plain containers and NumPy arrays: written for every NumPy, read without running code.

A pickle is a program that the reader runs, so a pickle from outside may do anything. Here it gets
stand-ins of a few functions, which make arrays of numbers; every other name is an error before
anything is called, and only arrays are given a state. Files that joblib wrote without compression
are read too: joblib puts an array behind a record that describes it (`NumpyArrayWrapper`), outside
of the pickle.

NumPy 2 names its modules anew, and a reader with NumPy before 1.26 does not know them. What is
written here has the former names, which every NumPy knows.
"""

from __future__ import annotations

import collections
import io
import pickle
from pathlib import Path
from typing import Any, BinaryIO, ClassVar

import numpy as np

from mgs.core.errors import MotionFileError
from mgs.core.input_files import read_bytes
from mgs.core.limits import MAX_RECORDING
from mgs.motion_file.formats.recorded import decoding

# Beginnings of what zlib, gzip, bzip2, xz, lz4 and lzma write; no pickle begins so.
COMPRESSED = (b"x", b"\x1f\x8b", b"BZh", b"\xfd7zXZ", b"\x04\x22M\x18", b"]\x00")


# The classes in Python, whose steps can be replaced; type checkers know them as closed ones.
PICKLER: Any = vars(pickle)["_Pickler"]
UNPICKLER: Any = vars(pickle)["_Unpickler"]


class _Portable(PICKLER):  # type: ignore[misc]
    """Pickler that gives NumPy's modules the names that every version knows."""

    def save_global(self, obj: Any, name: str | None = None) -> None:
        """Write the name of a function or class."""
        if getattr(obj, "__module__", "") == "numpy._core.multiarray":
            self.write(pickle.GLOBAL + f"numpy.core.multiarray\n{obj.__name__}\n".encode())
            self.memoize(obj)
        else:
            super().save_global(obj, name)


def write_pickle(path: Path, content: object) -> None:
    """Write containers and arrays as a pickle of protocol 4; same content, same bytes."""
    stream = io.BytesIO()
    _Portable(stream, protocol=4).dump(content)
    path.write_bytes(stream.getvalue())


def read_pickle(path: Path) -> Any:
    """Containers and arrays of a pickle, or of a file that joblib wrote without compression.

    Raises:
        ConfigError: the file is missing, too large or not a regular file.
        MotionFileError: it is no pickle, or holds anything but plain containers and arrays.
    """
    data = read_bytes(path, MAX_RECORDING, "a recorded motion")
    if data.startswith(COMPRESSED):
        raise MotionFileError(
            path, "compressed by joblib; write it anew with joblib.dump(..., compress=0)"
        )
    with decoding(path, "a pickle of plain data and arrays"):
        found = _Restricted(io.BytesIO(data), len(data)).load()
        _refuse_strangers(found)
    return found


class _Wrapper:
    """Stand-in for joblib's record of an array, which follows it in the file."""

    dtype: Any = None
    shape: Any = ()
    order: Any = "C"
    numpy_array_alignment_bytes: Any = None

    def array(self, stream: BinaryIO, left: int) -> Any:
        """The array behind the record.

        Args:
            stream: where it begins.
            left: bytes of the file from there on.
        """
        shape = tuple(int(n) for n in self.shape)
        size = np.dtype(self.dtype).itemsize
        for n in shape:
            size *= n
        if any(n < 0 for n in shape) or size > left:
            raise pickle.UnpicklingError(f"an array of shape {shape} is not in the file")
        if self.numpy_array_alignment_bytes is not None:
            stream.read(int.from_bytes(stream.read(1), "little"))
        return _frombuffer(stream.read(size), self.dtype, shape, self.order)


class _ArrayType:
    """Stand-in for NumPy's class of arrays, which would make an array of any size."""


def _empty(kind: Any, shape: Any, letter: Any) -> Any:
    """Array without entries, which its state fills."""
    if kind is not _ArrayType or tuple(shape) != (0,):
        raise pickle.UnpicklingError(f"it makes an array as no pickle does: {letter!r}")
    return np.empty(0, dtype=np.int8)


def _frombuffer(data: Any, dtype: Any, shape: Any, order: Any) -> Any:
    """Array of the bytes of its entries."""
    kind = np.dtype(dtype)
    if kind.hasobject:
        raise pickle.UnpicklingError("an array holds objects")
    array = np.frombuffer(data, kind)
    return np.reshape(array, shape, order="F" if order == "F" else "C")


def _scalar(dtype: Any, data: Any = b"") -> Any:
    """Single number of an array's type."""
    return _frombuffer(data, dtype, (), "C")[()]


def _encode(text: Any, encoding: Any) -> bytes:
    """Bytes, which protocol 2 writes as a text."""
    if encoding != "latin1" or not isinstance(text, str):
        raise pickle.UnpicklingError("it encodes a text as no pickle of bytes does")
    return text.encode("latin1")


def _no_bytes() -> bytes:
    """No bytes at all, which protocol 2 writes as a call."""
    return b""


ALLOWED = {
    ("__builtin__", "bytes"): _no_bytes,
    ("numpy", "ndarray"): _ArrayType,
    ("numpy", "dtype"): np.dtype,
    ("_codecs", "encode"): _encode,
    ("collections", "OrderedDict"): collections.OrderedDict,
    ("joblib.numpy_pickle", "NumpyArrayWrapper"): _Wrapper,
}
for _core in ("numpy.core", "numpy._core"):
    ALLOWED |= {
        (f"{_core}.multiarray", "_reconstruct"): _empty,
        (f"{_core}.multiarray", "scalar"): _scalar,
        (f"{_core}.numeric", "_frombuffer"): _frombuffer,
    }


class _Restricted(UNPICKLER):  # type: ignore[misc]
    """Unpickler that makes plain containers and arrays only."""

    dispatch: ClassVar[dict[int, Any]] = dict(UNPICKLER.dispatch)

    def __init__(self, stream: io.BytesIO, size: int) -> None:
        super().__init__(stream)
        self.stream, self.size = stream, size

    def find_class(self, module: str, name: str) -> Any:
        """Stand-in of a name; raises UnpicklingError if there is none."""
        if (module, name) not in ALLOWED:
            raise pickle.UnpicklingError(f"it names {module}.{name}, which is no plain data")
        return ALLOWED[module, name]

    def persistent_load(self, pid: Any) -> Any:
        """Refuse a reference to something outside of the file."""
        raise pickle.UnpicklingError("it refers to something outside of the file")

    def load_build(self) -> None:
        """Give an array or a record its state; a record becomes the array behind it."""
        target = self.stack[-2]
        if not isinstance(target, np.ndarray | np.dtype | _Wrapper):
            raise pickle.UnpicklingError(f"it changes {type(target).__name__}")
        super().load_build()
        if isinstance(target, _Wrapper):
            self._end_frame()
            self.stack[-1] = target.array(self.stream, self.size - self.stream.tell())

    def _end_frame(self) -> None:
        """Go on behind what has been decoded; protocol 4 reads ahead in frames."""
        frame = self._unframer.current_frame
        if frame is not None and frame.read(1):
            raise pickle.UnpicklingError("an array is not where joblib puts it")

    dispatch[pickle.BUILD[0]] = load_build


def _refuse_strangers(found: Any) -> None:
    """Refuse arrays of objects and anything that is no plain data, wherever it is."""
    plain = (bool, int, float, complex, str, bytes, np.generic, type(None))
    pending, seen = [found], set[int]()
    while pending:
        entry = pending.pop()
        if isinstance(entry, np.ndarray):
            if entry.dtype.hasobject:
                raise pickle.UnpicklingError("an array holds objects")
        elif isinstance(entry, dict | list | tuple | set | frozenset):
            if id(entry) not in seen:
                seen.add(id(entry))
                pending += entry
                pending += entry.values() if isinstance(entry, dict) else ()
        elif not isinstance(entry, plain):
            raise pickle.UnpicklingError(f"it holds a {type(entry).__name__}, no plain data")
