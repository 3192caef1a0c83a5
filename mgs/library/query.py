"""Queries on a gait library: rows by a condition, a summary, and the gait nearest to a velocity."""

from __future__ import annotations

import csv
import io
import json
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.errors import ConfigError, InputError, MgsError
from mgs.core.foreign import told_as
from mgs.core.input_files import is_inside
from mgs.core.short_text import shown
from mgs.library.condition import compile_condition, quoted
from mgs.library.manifest import Manifest, Value, connect, is_whole, reading

HEAVY = "checks"  # column that is shown on request only
TURN_RADIUS = 0.1  # [m]


@dataclass(frozen=True)
class LibraryGait:
    """One gait of a library."""

    number: int
    file: Path
    vx: float  # [m/s] along the heading
    vy: float  # [m/s] to the left
    wz: float  # [rad/s] to the left
    figures: dict[str, Value]  # all columns of its row


class GaitLibrary:
    """The gaits of a library, by velocity.

    vx, vy and wz of a gait are the mean velocity of the point midway between its soles, from the
    first lift-off to the last touch-down, in the frame of their mean heading.

    Args:
        folder: folder of the library, which is only read.
        where: condition on the gaits that are considered; default: gaits that pass.
        turn_radius: weight of the yaw rate in the distance between velocities [m]: a difference of
            1 rad/s counts as much as one of `turn_radius` m/s.

    Raises:
        InputError: the folder contains no library.
        ConfigError: `where` is not a condition on the columns, or `turn_radius` is negative.
        MgsError: no gait fulfils `where`.
    """

    def __init__(
        self, folder: str | Path, where: str = "verdict == 'pass'", turn_radius: float = TURN_RADIUS
    ) -> None:
        from scipy.spatial import KDTree

        if not (math.isfinite(turn_radius) and turn_radius >= 0.0):
            raise ConfigError(
                "turn_radius", f"has to be a finite length of at least 0 m, found {turn_radius}"
            )
        self.folder, self.turn_radius = Path(folder), turn_radius
        self._connection = connect(self.folder)
        condition = f"({where}) and file is not None"
        columns = ["number", "vx", "vy", "wz"]
        with told_as(lambda what: InputError(f"{folder}: no sound gait library: {what}")):
            found = list(_select(Manifest(self._connection), columns, condition))
            if not found:
                raise MgsError(f"{folder}: no gait of this library fulfils {where}")
            self._numbers = [int(row[0]) for row in found]
            velocities = np.array([row[1:] for row in found], dtype=np.float64)
            self._tree = KDTree(velocities * self._scale)

    @property
    def _scale(self) -> tuple[float, float, float]:
        return 1.0, 1.0, self.turn_radius

    def __len__(self) -> int:
        """Number of gaits that are considered."""
        return len(self._numbers)

    @property
    def numbers(self) -> tuple[int, ...]:
        """Numbers of the gaits that are considered."""
        return tuple(self._numbers)

    def nearest(self, *, vx: float = 0.0, vy: float = 0.0, wz: float = 0.0) -> LibraryGait:
        """Find the gait whose velocity is nearest to vx, vy [m/s] and wz [rad/s].

        Raises:
            ConfigError: a velocity is not a finite number.
        """
        wanted = np.array([vx, vy, wz], dtype=np.float64)
        if not np.isfinite(wanted).all():
            raise ConfigError("nearest", f"vx={vx}, vy={vy}, wz={wz} is not finite")
        return self.gait(self._numbers[int(self._tree.query(wanted * self._scale)[1])])

    def gait(self, number: int) -> LibraryGait:
        """Gait of a number; raises InputError if the library has no motion file of it."""
        cursor = self._connection.execute("SELECT * FROM gaits WHERE number = ?", (number,))
        names = [name for name, *_ in cursor.description]
        row = cursor.fetchone()
        figures = dict(zip(names, row, strict=True)) if row else {}
        if not figures.get("file"):
            raise InputError(f"{self.folder}: contains no motion file of gait {number}")
        path = self.folder / figures["file"]
        if not is_inside(path, [self.folder]):
            raise InputError(f"{self.folder}: {shown(figures['file'])} is not in this folder")
        return LibraryGait(number, path, figures["vx"], figures["vy"], figures["wz"], figures)

    def close(self) -> None:
        """Close the manifest."""
        self._connection.close()


@dataclass(frozen=True)
class Table:
    """Rows of a library with the names of their columns."""

    columns: tuple[str, ...]
    rows: list[tuple[Value, ...]]


def query(
    folder: Path,
    where: str | None = None,
    columns: list[str] | None = None,
    order: str | None = None,
    reverse: bool = False,
    limit: int | None = None,
) -> Table:
    """Find the rows that fulfil a condition.

    Args:
        folder: folder of the library.
        where: condition in the form of `mgs.library.condition`; None: all rows.
        columns: names of the columns; None: all columns but the list of single checks.
        order: column or expression that the rows are sorted by; None: number of the gait.
        reverse: sort in descending order.
        limit: largest number of rows; None: no limit.

    Raises:
        InputError: the folder contains no library.
        ConfigError: a condition is malformed or a column is unknown.
    """
    with reading(folder) as manifest:
        known = [name for name in manifest.columns if name != HEAVY]
        names = columns if columns is not None else known
        return Table(tuple(names), list(_select(manifest, names, where, order, reverse, limit)))


def _select(
    manifest: Manifest,
    columns: list[str],
    where: str | None = None,
    order: str | None = None,
    reverse: bool = False,
    limit: int | None = None,
) -> Iterator[tuple[Any, ...]]:
    for name in columns:
        if name not in manifest.columns:
            known = ", ".join(sorted(manifest.columns))
            raise ConfigError("--columns", f"no column {name!r}; known columns: {known}")
    text = f"SELECT {', '.join(map(quoted, columns))} FROM gaits"
    parameters: list[int | float | str] = []
    if where is not None:
        condition, parameters = compile_condition(where, manifest.columns, "--where")
        text += f" WHERE {condition}"
    key, constants = compile_condition(order or "number", manifest.columns, "--order")
    text += f" ORDER BY {key} {'DESC' if reverse else 'ASC'}, number"
    parameters = [*parameters, *constants]
    if limit is not None:
        text += " LIMIT ?"
        parameters = [*parameters, limit]
    return manifest.connection.execute(text, parameters)


def to_csv(table: Table) -> bytes:
    """Convert a table to CSV: names in the first row, empty fields for missing values."""
    stream = io.StringIO(newline="")
    writer = csv.writer(stream)
    writer.writerow(table.columns)
    writer.writerows(table.rows)
    return stream.getvalue().encode()


def to_parquet(table: Table) -> bytes:
    """Convert a table to Parquet; raises MgsError if pyarrow is missing."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise MgsError(
            "Parquet needs pyarrow: pip install 'mgs[parquet]', or use --format csv"
        ) from error
    columns = zip(*table.rows, strict=True) if table.rows else [()] * len(table.columns)
    arrays = {
        name: _of_one_kind(list(values))
        for name, values in zip(table.columns, columns, strict=True)
    }
    stream = io.BytesIO()
    pyarrow.parquet.write_table(pyarrow.table(arrays), stream)
    return stream.getvalue()


def _of_one_kind(values: list[Any]) -> list[Any]:
    """Convert values to one type, as Parquet requires: floats if all are numbers, else text."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        return [None if value is None else float(value) for value in values]
    if len(kinds) > 1:
        return [None if value is None else str(value) for value in values]
    return values


def report(folder: Path) -> dict[str, Any]:
    """Summarize a library: verdicts, reasons, ranges of figures, and damaged files.

    Raises:
        InputError: the folder contains no library.
    """
    with reading(folder) as manifest:
        identity = manifest.identity()
        states = manifest.states()
        keys = [key for key in _keys(identity) if key in manifest.columns]
        ranges = {
            name: _range(manifest, name)
            for name in ("vx", "vy", "wz", "zmp_margin", "torque_ratio", "joint_speed_ratio")
        }
        kernels = [row[0] for row in _select(manifest, ["kernel"], "kernel is not None")]
        shares = {key: _shares(manifest, key) for key in keys}
        damaged = [file for *_, file, sha256 in states if not is_whole(folder, file, sha256)]
        return {
            "folder": str(folder),
            "gaits": int(identity["number of gaits"]),
            "made": len(states),
            "physics": identity["physics"],
            "mgs_version": identity["mgs version"],
            "verdicts": dict(Counter(verdict for _, verdict, *_ in states)),
            "reasons": dict(Counter(reason for _, _, reason, *_ in states if reason).most_common()),
            "kernels": dict(Counter(kernels)),
            "ranges_of_passes": ranges,
            "passes_by_value": shares,
            "damaged_files": damaged,
        }


def _keys(identity: dict[str, str]) -> list[str]:
    keys: list[str] = json.loads(identity["keys"])
    return keys


def _range(manifest: Manifest, name: str) -> list[float | None]:
    column = quoted(name)
    return list(
        manifest.connection.execute(
            f"SELECT MIN({column}), MAX({column}) FROM gaits WHERE verdict = 'pass'"
        ).fetchone()
    )


def _shares(manifest: Manifest, key: str) -> list[dict[str, Any]]:
    """Number of gaits, and of gaits that pass, for each value of a key."""
    column = quoted(key)
    rows = manifest.connection.execute(
        f"SELECT {column}, COUNT(*), SUM(verdict = 'pass') FROM gaits GROUP BY {column}"
    )
    return [{"value": value, "gaits": n, "pass": passes} for value, n, passes in rows]
