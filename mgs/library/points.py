"""The points of a sweep: the values of the varied keys for each gait of a library."""

from __future__ import annotations

import csv
import difflib
import io
import itertools
import json
import math
import re
import sqlite3
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mgs.core.errors import ConfigError
from mgs.core.foreign import told_as
from mgs.core.input_files import is_file, read_text
from mgs.core.limits import MAX_GAITS, MAX_VALUES
from mgs.core.short_text import shown
from mgs.core.yaml_text import parse_yaml
from mgs.gait import Gait, find_gait, parse_gait
from mgs.gait.find import refuse_outside
from mgs.library.condition import compile_condition, quoted
from mgs.library.solved import solved
from mgs.library.sweep import Axis, Sweep, load_sweep
from mgs.library.velocity import VELOCITIES

Point = tuple[Any, ...]
WHOLE = re.compile(r"-?(0|[1-9][0-9]{0,15})")
DECIMAL = re.compile(r"-?(0|[1-9][0-9]*)\.[0-9]+")


@dataclass(frozen=True, eq=False)
class Plan:
    """All gaits of a sweep, in the order of their numbers."""

    source: str  # the sweep file, for messages
    sweep: Sweep
    base: Path  # file of the base gait
    base_text: str
    base_gait: Gait
    keys: tuple[str, ...]
    points: list[Point] = field(repr=False)  # a value for each of `keys`
    n_filtered: int = 0  # number of points that the filters exclude

    def assignments(self, number: int) -> tuple[str, ...]:
        """Changes that turn the base gait into a gait, in the form of `mgs generate --set`."""
        return tuple(
            f"{key}={json.dumps(value)}"  # a JSON text is the YAML of the same value
            for key, value in zip(self.keys, self.points[number], strict=True)
        )

    @property
    def robots(self) -> list[str]:
        """Names of the robots of all gaits, in the order of their first gait."""
        if "robot" in self.keys:
            index = self.keys.index("robot")
            return list(dict.fromkeys(point[index] for point in self.points))
        assert self.base_gait.robot is not None
        return [self.base_gait.robot]


def plan_sweep(path: Path) -> Plan:
    """Read a sweep file and make its points.

    Raises:
        ConfigError: sweep file, table or base gait is malformed, a key or a name in a filter is
            unknown, no robot is named, or the sweep has no points or more than a library can hold.
    """
    with told_as(lambda what: ConfigError(path, f"no gaits can be made of this sweep: {what}")):
        return _planned(path)


def _planned(path: Path) -> Plan:
    """The plan of a sweep; see `plan_sweep`."""
    sweep = load_sweep(path)
    base = find_gait(_beside(path, sweep.base), path.parent)
    text = read_text(base)
    gait = parse_gait(text, base)
    table_keys, rows = _read_table(_table(path, sweep.table)) if sweep.table else ((), [()])
    keys = (*table_keys, *sweep.axes)
    _check_values(path, sweep, rows)
    _check_keys(path, gait, table_keys, tuple(sweep.axes))
    _refuse_too_many(path, _count(sweep, len(rows)), len(keys))
    points = [row + point for row in rows for point in _points(sweep)]
    if "robot" in keys:
        _check_robots(path, {point[keys.index("robot")] for point in points})
    elif gait.robot is None:
        raise ConfigError(path, f"{base} names no robot; add axes.robot: [NAME]")
    kept = list(_filtered(path, sweep.filters, gait, keys, points))
    if not kept:
        raise ConfigError(path, f"no gait is left: the filters exclude all {len(points)} points")
    if set(keys) & set(VELOCITIES):
        keys, kept = solved(path, gait, keys, kept)
    return Plan(str(path), sweep, base, text, gait, keys, kept, len(points) - len(kept))


def _beside(sweep: Path, name: str) -> str | Path:
    """Gait file: one beside the sweep file is preferred to one in the working folder."""
    return name if is_file(sweep.parent / name) or not is_file(Path(name)) else Path(name).resolve()


def _table(sweep: Path, name: str) -> Path:
    """Table that a sweep file names; raises ConfigError where it leads to another folder."""
    path = sweep.parent / name
    refuse_outside(path, (sweep.parent, Path()), f"{sweep}: table: {name}")
    return path


def _refuse_too_many(path: Path, n_points: int, n_keys: int) -> None:
    if n_points > MAX_GAITS:
        raise ConfigError(path, f"asks for {n_points} gaits; at most {MAX_GAITS} are allowed")
    if n_points * n_keys > MAX_VALUES:
        raise ConfigError(
            path,
            f"asks for {n_points} gaits with {n_keys} varied keys each; at most {MAX_VALUES} "
            f"values are allowed; use fewer keys or at most {MAX_VALUES // n_keys} gaits",
        )


def _check_keys(path: Path, gait: Gait, table_keys: tuple[str, ...], axes: tuple[str, ...]) -> None:
    known = flat(gait.model_dump())
    known |= dict.fromkeys(VELOCITIES)
    problems = []
    for key in (*table_keys, *axes):
        if not key.isprintable():
            problems.append(f"axes.{shown(key)}: contains control characters")
            continue
        parents = {key[:i] for i, c in enumerate(key) if c == "."}
        unset = any(known.get(parent, parent) is None for parent in parents)
        if key not in known and not unset:
            problems.append(
                f"axes.{key}: gaits of the kind {gait.motion} have no such key; {_near(key, known)}"
            )
    for key in set(table_keys) & set(axes):
        problems.append(f"axes.{key}: this key is also a column of the table")
    for key in ("mgs", "motion"):
        if key in (*table_keys, *axes):
            problems.append(f"axes.{key}: cannot be varied")
    if len(set(table_keys)) < len(table_keys):
        problems.append(f"table: a key occurs twice: {', '.join(table_keys)}")
    if problems:
        raise ConfigError(path, problems)


def _check_values(path: Path, sweep: Sweep, rows: list[Point]) -> None:
    """Refuse values that no gait file can hold, such as infinity."""
    lists = {f"axes.{key}": axis.values or [] for key, axis in sweep.axes.items()}
    for key, found in (lists | {"table": [x for row in rows for x in row]}).items():
        for value in found:
            try:
                json.dumps(value, allow_nan=False)
            except (TypeError, ValueError) as error:
                raise ConfigError(
                    path, f"{key}: {shown(value)} is not a value that a gait file can hold"
                ) from error


def _near(key: str, known: Iterable[str]) -> str:
    close = difflib.get_close_matches(key[:60], list(known), n=1)
    return f"did you mean {close[0]!r}?" if close else f"known keys: {', '.join(sorted(known))}"


def _check_robots(path: Path, robots: set[Any]) -> None:
    bad = [robot for robot in robots if not isinstance(robot, str) or not robot]
    if bad:
        raise ConfigError(path, f"axes.robot: {bad[0]!r} is not the name of a robot")


def flat(tree: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """Values of nested dictionaries by dotted key."""
    found: dict[str, Any] = {}
    for key, value in tree.items():
        if isinstance(value, dict):
            found |= flat(value, f"{prefix}{key}.")
        else:
            found[f"{prefix}{key}"] = value
    return found


def _read_table(path: Path) -> tuple[tuple[str, ...], list[Point]]:
    """Keys and rows of a CSV file; every field is read as YAML, as in a gait file."""
    text = read_text(path, kind="a table")
    if "\r" in text.replace("\r\n", ""):
        remedy = "save it with the line ends of Unix or Windows"
        raise ConfigError(
            path, f"its lines end as on old Macs, with carriage returns alone; {remedy}"
        )
    try:
        lines = [row for row in csv.reader(io.StringIO(text, newline="")) if row]
    except csv.Error as error:
        raise ConfigError(path, f"not a CSV file: {error}") from error
    if len(lines) < 2:
        raise ConfigError(path, "needs a first row with keys, and rows with their values")
    keys = tuple(key.strip() for key in lines[0])
    rows = []
    for number, line in enumerate(lines[1:], start=2):
        if len(line) != len(keys):
            raise ConfigError(path, f"row {number} has {len(line)} fields, the first {len(keys)}")
        rows.append(tuple(_field(text, f"{path}: row {number}") for text in line))
    return keys, rows


def _field(text: str, source: str) -> Any:
    """Value of a field; plain decimal numbers, which are most, do not need the YAML parser."""
    if WHOLE.fullmatch(text):
        return int(text)
    return float(text) if DECIMAL.fullmatch(text) else parse_yaml(text, source)


def _count(sweep: Sweep, n_rows: int) -> int:
    """Number of points before the filters are applied."""
    if sweep.samples is not None:
        return sweep.samples
    return n_rows * math.prod(_length(axis) for axis in sweep.axes.values())


def _length(axis: Axis) -> int:
    if axis.values is not None:
        return len(axis.values)
    if axis.integers is not None:
        return axis.integers[1] - axis.integers[0] + 1
    return int((axis.linspace or axis.logspace or [0.0, 0.0, 0.0])[2])


def _points(sweep: Sweep) -> Iterator[Point]:
    if sweep.samples is None:
        return itertools.product(*(values(axis) for axis in sweep.axes.values()))
    draws = _draws(sweep.sampling, len(sweep.axes), sweep.samples, sweep.seed)
    columns = [_drawn(axis, u) for axis, u in zip(sweep.axes.values(), draws.T, strict=True)]
    return zip(*columns, strict=True)


def values(axis: Axis) -> list[Any]:
    """All values of an axis with a finite number of values, as plain Python objects."""
    if axis.values is not None:
        return axis.values
    if axis.integers is not None:
        return list(range(axis.integers[0], axis.integers[1] + 1))
    space = np.linspace if axis.linspace is not None else np.geomspace
    first, last, count = axis.linspace or axis.logspace or (0.0, 0.0, 0)
    numbers: list[float] = space(first, last, int(count)).tolist()
    if all(x == round(x) for x in numbers):
        return [round(x) for x in numbers]  # keys that count something do not accept 2.0
    return numbers


def _draws(sampling: str, n_axes: int, n: int, seed: int) -> NDArray[np.float64]:
    """Random points (n, n_axes) in the unit cube."""
    from scipy.stats import qmc

    generator = np.random.default_rng(seed)
    if sampling == "latin_hypercube":
        return np.asarray(qmc.LatinHypercube(n_axes, seed=generator).random(n))
    with warnings.catch_warnings():  # counts that are not powers of 2 are allowed
        warnings.simplefilter("ignore", UserWarning)
        return np.asarray(qmc.Sobol(n_axes, seed=generator).random(n))


def _drawn(axis: Axis, u: NDArray[np.float64]) -> list[Any]:
    """Values of an axis at positions u (n,) from 0 to 1; listed values have equal shares."""
    if axis.uniform is not None:
        low, high = axis.uniform
        return [float(x) for x in low + u * (high - low)]
    if axis.log_uniform is not None:
        low, high = np.log(axis.log_uniform)
        return [float(x) for x in np.exp(low + u * (high - low))]
    known = values(axis)
    return [known[min(int(x * len(known)), len(known) - 1)] for x in u]


def _filtered(
    path: Path, filters: list[str], gait: Gait, keys: tuple[str, ...], points: list[Point]
) -> Iterator[Point]:
    """Points that fulfil every filter, which may use any key of the gait."""
    known = flat(gait.model_dump()) | dict.fromkeys(keys)
    names = list(known)
    sql, parameters = [], []
    for text in filters:
        part, constants = compile_condition(text, names, f"{path}: filters")
        sql.append(part)
        parameters += constants
    if not sql:
        yield from points
        return
    columns = ", ".join(f"? AS {quoted(name)}" for name in names)
    query = f"SELECT {' AND '.join(sql)} FROM (SELECT {columns})"
    with sqlite3.connect(":memory:") as connection:
        for point in points:
            known |= zip(keys, point, strict=True)
            row = [plain(value) for value in known.values()]
            try:
                found = connection.execute(query, (*parameters, *row)).fetchone()[0]
            except sqlite3.Error as error:
                raise ConfigError(path, f"filters: cannot be evaluated: {error}") from error
            if found:
                yield point


def plain(value: Any) -> int | float | str | None:
    """Convert a value for the database; lists and mappings become JSON."""
    fits = not isinstance(value, int) or abs(value) < 2**63
    return value if fits and isinstance(value, int | float | str | None) else json.dumps(value)
