"""Joint angles for other tools: CSV and NumPy's npz.

CSV: a head line `time, position.JOINT ..., velocity.JOINT ...`, then one line per sample; numbers
read back exactly. npz: `time` (N,), `position` and `velocity` (N, n), `joint_names` (n,) and `dt`;
of a cycle also its `displacement` (3,), x, y and yaw. Units are s, rad, rad/s and m.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from mgs.core.arrays import Array
from mgs.core.atomic_files import refuse_taken, replacing
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.errors import ConfigError, MgsError
from mgs.core.wrong_type import given_path
from mgs.motion import Motion
from mgs.motion.cycle import Cycle, find_cycle
from mgs.motion_file.read import read_motion


def export_motion(
    motion: Motion, path: Path, fmt: str, cycle: Cycle | None = None, *, force: bool = False
) -> None:
    """Write the joint angles of a motion, or of one cycle of it.

    Args:
        motion: what to write.
        path: the file; its folder is made if missing.
        fmt: a key of `FORMATS`.
        cycle: of this motion; None: all of it.
        force: replace an existing file.

    Raises:
        OutputExistsError: there is a file and `force` is not set.
        MgsError: the file cannot be written.
    """
    refuse_taken(path, force)
    try:
        with replacing(path) as stream:
            FORMATS[fmt](motion, cycle, stream)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise MgsError(f"{path}: cannot be written: {reason}") from error


def export(
    motion: Motion | str | Path,
    path: str | Path,
    format: str | None = None,
    *,
    cycle: bool = False,
    force: bool = False,
) -> Path:
    """Write the joint angles and velocities of a motion for other tools.

    Args:
        motion: a motion or the path of a motion file.
        path: the file to write; its folder is made if missing.
        format: "csv" or "npz"; None: the one that the path ends with.
        cycle: two steps from the middle of a walk, made exactly periodic, instead of all of it.
        force: replace an existing file.

    Returns:
        The file.

    Raises:
        ConfigError: there is no such format.
        MotionFileError: the motion file is missing or damaged.
        CycleError: the motion has no two steps that could be repeated.
        OutputExistsError: there is a file and `force` is not set.
        MgsError: the file cannot be written.
        TypeError: an argument has a wrong type.
    """
    path = given_path(path)
    wanted = path.suffix.removeprefix(".") if format is None else format
    if wanted not in FORMATS:
        raise ConfigError("format", f"{wanted!r} is unknown; use {' or '.join(FORMATS)}")
    given = read_motion(motion)
    export_motion(given, path, wanted, find_cycle(given) if cycle else None, force=force)
    return path


def _joints(motion: Motion, cycle: Cycle | None) -> tuple[Array, Array, Array]:
    """Sample times (N,) [s], joint positions (N, n) [rad] and velocities (N, n) [rad/s]."""
    if cycle is None:
        position, velocity = motion.q[:, FLOATING_BASE_NQ:], motion.v[:, FLOATING_BASE_NV:]
    else:
        position, velocity = cycle.position, cycle.velocity
    return np.round(motion.dt * np.arange(len(position)), 9), position, velocity


def _write_csv(motion: Motion, cycle: Cycle | None, stream: BinaryIO) -> None:
    time, position, velocity = _joints(motion, cycle)
    names = motion.robot.joint_names
    head = [f"{quantity}.{name}" for quantity in ("position", "velocity") for name in names]
    text = io.TextIOWrapper(stream, encoding="utf-8", newline="", write_through=True)
    writer = csv.writer(text)
    writer.writerow(["time", *head])
    writer.writerows(
        [time[k].item(), *position[k].tolist(), *velocity[k].tolist()] for k in range(len(time))
    )
    text.detach()  # the stream is closed by who opened it


def _write_npz(motion: Motion, cycle: Cycle | None, stream: BinaryIO) -> None:
    time, position, velocity = _joints(motion, cycle)
    arrays: dict[str, Any] = {"time": time, "position": position, "velocity": velocity}
    arrays |= {"joint_names": np.array(motion.robot.joint_names), "dt": motion.dt}
    if cycle is not None:
        arrays["displacement"] = cycle.displacement
    np.savez(stream, **arrays)


FORMATS: dict[str, Callable[[Motion, Cycle | None, BinaryIO], None]] = {
    "csv": _write_csv,
    "npz": _write_npz,
}
