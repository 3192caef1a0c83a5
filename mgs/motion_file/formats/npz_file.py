"""NumPy's npz files, bounded and without objects: reading one runs no code of whoever wrote it."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.errors import MotionFileError
from mgs.core.input_files import read_bytes
from mgs.core.limits import MAX_RECORDING
from mgs.motion_file.formats.recorded import decoding


def write_npz(path: Path, arrays: Mapping[str, Any]) -> None:
    """Write arrays by name; the same arrays give the same bytes."""
    with path.open("wb") as stream:  # given a path, NumPy would add a suffix to it
        np.savez(stream, **arrays)


def read_npz(path: Path, empty: tuple[str, ...] = ()) -> dict[str, Any]:
    """Arrays of an npz file by name.

    Args:
        path: the file.
        empty: names of entries that are pickled, which hold nothing that is wanted; left out.

    Raises:
        ConfigError: the file is missing or not a regular file.
        MotionFileError: it is no npz file, too large, or an array holds objects.
    """
    stream = io.BytesIO(read_bytes(path, MAX_RECORDING, "a recorded motion"))
    with decoding(path, "a NumPy npz file of numbers and texts"):
        with zipfile.ZipFile(stream) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
        if size > MAX_RECORDING:
            raise MotionFileError(path, f"larger than {MAX_RECORDING // 1_000_000} MB unpacked")
        stream.seek(0)
        with np.load(stream, allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files if name not in empty}
