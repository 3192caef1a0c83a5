"""Logs of what joints of a robot did, and CSV files of them.

A CSV log has a head line with the names of its columns: `time` [s], a column for each joint with
its angle [rad], named `position.JOINT` or `JOINT`, and, if known, what the joint was told,
`command.JOINT`. A cell is empty where nothing was read. The clock may start anywhere, unless the
column is named `motion_time`: then it is 0 when the first goal was sent. Lines may be at any times.
"""

from __future__ import annotations

import csv
import dataclasses
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.core.atomic_files import refuse_taken, replace_file
from mgs.core.errors import ConfigError
from mgs.core.input_files import read_text
from mgs.core.limits import MAX_LOG, MAX_VALUE
from mgs.core.short_repr import short_repr
from mgs.core.short_text import shown

MOTION_TIME = "motion_time"  # of a log whose clock is that of the motion
TIME_NAMES = (MOTION_TIME, "time", "t", "timestamp", "time_s")
KINDS = ("position", "command")


@dataclass(frozen=True, eq=False)
class JointLog:
    """What joints did at M times, which do not decrease; NaN where nothing was read."""

    source: str
    names: tuple[str, ...]
    times: Array  # (M,) [s], on a clock of its own
    position: Array  # (M, j) [rad]
    command: Array | None  # (M, j) what joints were told [rad]
    is_motion_time: bool = False  # whether the clock is 0 when the first goal was sent

    __repr__ = short_repr


def write_joint_log(
    path: Path,
    names: Sequence[str],
    times: Array,
    position: Array,
    command: Array | None = None,
    *,
    force: bool = False,
) -> None:
    """Write a CSV log; `read_csv_log` reads the same numbers.

    Args:
        path: the file.
        names: of the joints.
        times: (M,), 0 when the first goal was sent [s].
        position: angles (M, n) [rad]; NaN leaves a cell empty.
        command: what the joints were told (M, n) [rad]; None: not known.
        force: replace an existing file.

    Raises:
        OutputExistsError: there is a file and `force` is not set.
        MgsError: it cannot be written.
    """
    refuse_taken(path, force)
    parts = {"position": position} | ({} if command is None else {"command": command})
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow([MOTION_TIME, *(f"{kind}.{name}" for kind in parts for name in names)])
    for time, row in zip(times.tolist(), np.hstack(list(parts.values())).tolist(), strict=True):
        writer.writerow([round(time, 6), *("" if np.isnan(value) else value for value in row)])
    replace_file(path, text.getvalue().encode())


def read_csv_log(path: Path) -> JointLog:
    """Log in a CSV file.

    Raises:
        ConfigError: the file is missing, too large or no such log.
    """
    rows = _rows(path, read_text(path, MAX_LOG, "a log"))
    head = [name.strip() for name in next(rows, (1, []))[1]]
    time = next((i for i, name in enumerate(head) if name.lower() in TIME_NAMES), None)
    if time is None:
        raise ConfigError(
            path,
            "the head line names no column for the time; name it time [s], and the columns of the "
            "joints position.JOINT [rad]",
        )
    table = _numbers(path, head, rows)
    columns: dict[str, dict[str, Array]] = {kind: {} for kind in KINDS}
    for i, name in enumerate(head):
        kind, dot, joint = name.partition(".")
        if i != time:
            of, joint = (kind, joint) if dot and kind in KINDS else ("position", name)
            if joint in columns[of]:
                raise ConfigError(path, f"has the {of} of {joint} in two columns")
            columns[of][joint] = table[:, i]
    log = joint_log(str(path), table[:, time], columns)
    return dataclasses.replace(log, is_motion_time=head[time] == MOTION_TIME)


def joint_log(source: str, times: Array, columns: dict[str, dict[str, Array]]) -> JointLog:
    """Log from its columns, in the order of time.

    Args:
        source: where it is from.
        times: (M,) [s].
        columns: values (M,) by joint, of each of `KINDS`.

    Raises:
        ConfigError: there are no positions, or a time is missing.
    """
    names = tuple(columns["position"])
    if not names or not len(times):
        raise ConfigError(source, "holds no joint angles")
    if not np.isfinite(times).all():
        raise ConfigError(source, "a line has no time")
    order = np.argsort(times, kind="stable")

    def stacked(kind: str) -> Array | None:
        found = columns[kind]
        if not set(names) & set(found):
            return None
        nothing = np.full(len(times), np.nan)
        return np.stack([found.get(name, nothing) for name in names], axis=1)[order]

    position = stacked("position")
    assert position is not None
    if (np.abs(position) > MAX_VALUE).any():
        raise ConfigError(source, f"an angle is larger than {MAX_VALUE:g}")
    return JointLog(source, names, times[order], position, stacked("command"))


def _rows(path: Path, text: str) -> Iterator[tuple[int, list[str]]]:
    """Number and cells of each line that is not empty."""
    rows = csv.reader(io.StringIO(text, newline=""))
    try:
        for row in rows:
            if row:
                yield rows.line_num, row
    except csv.Error as error:
        raise ConfigError(path, f"line {rows.line_num}: {error}") from error


def _numbers(path: Path, head: list[str], rows: Iterator[tuple[int, list[str]]]) -> Array:
    """Values (M, columns) of the lines behind the head."""
    values: list[list[float]] = []
    for line, row in rows:
        if len(row) != len(head):
            raise ConfigError(path, f"line {line} has {len(row)} cells, the head line {len(head)}")
        try:
            values.append([float(cell) if cell.strip() else np.nan for cell in row])
        except ValueError:
            bad = next(i for i, cell in enumerate(row) if not _is_number(cell))
            raise ConfigError(
                path, f"line {line}, column {head[bad]}: {shown(row[bad], 40)} is no number"
            ) from None
    return np.array(values, dtype=np.float64).reshape(-1, len(head))


def _is_number(cell: str) -> bool:
    try:
        float(cell.strip() or "0")
    except ValueError:
        return False
    return True
