"""The manifest of a library: one SQLite file with a row for each gait that has been made.

A row is written in one transaction, in write-ahead mode, after its motion file is complete. So
however a run ends, each row is true, or the hash of its motion file shows that it is not.
"""

from __future__ import annotations

import contextlib
import hashlib
import itertools
import sqlite3
from collections.abc import Iterator, Mapping
from pathlib import Path

from mgs.core.errors import InputError, MgsError
from mgs.core.foreign import told_as
from mgs.core.input_files import is_inside
from mgs.core.limits import MAX_QUERY_STEPS
from mgs.core.short_text import shown
from mgs.library.condition import quoted

MANIFEST = "manifest.sqlite"
GAITS_FOLDER = "gaits"
LOST = "lost"  # verdict on a gait whose computation broke down; not a property of the gait

STEPS_PER_CALL = 1_000_000  # instructions of SQLite between two looks at their number

Value = int | float | str | None
Row = Mapping[str, Value]

# name: SQL type; [unit] and meaning are in docs/libraries.md
COLUMNS = {
    "number": "INTEGER PRIMARY KEY",
    "verdict": "TEXT NOT NULL",
    "reason": "TEXT",
    "message": "TEXT",
    "file": "TEXT",
    "sha256": "TEXT",
    "bytes": "INTEGER",
    "robot": "TEXT",
    "motion": "TEXT",
    "ik.solver": "TEXT",
    "dt": "REAL",
    "samples": "INTEGER",
    "duration": "REAL",
    "distance": "REAL",
    "distance_x": "REAL",
    "distance_y": "REAL",
    "turn": "REAL",
    "speed": "REAL",
    "vx": "REAL",
    "vy": "REAL",
    "wz": "REAL",
    "zmp_margin": "REAL",
    "joint_margin": "REAL",
    "joint_speed_ratio": "REAL",
    "torque_ratio": "REAL",
    "torque_rms_ratio": "REAL",
    "positive_work": "REAL",
    "torque_squared": "REAL",
    "cost_of_transport": "REAL",
    "survived": "INTEGER",
    "max_tilt_deg": "REAL",
    "position_error": "REAL",
    "yaw_error_deg": "REAL",
    "sole_slip_max": "REAL",
    "checks": "TEXT",
    "seconds": "REAL",
    "kernel": "TEXT",
}


class Manifest:
    """An open manifest.

    Every method that writes raises MgsError if the disk is full or cannot be written.

    Attributes:
        columns: names of all columns: those of every library and one for each varied key.
    """

    def __init__(self, connection: sqlite3.Connection) -> None:
        self.connection = connection
        table = connection.execute("PRAGMA table_info(gaits)").fetchall()
        self.columns = tuple(name for _, name, *_ in table)

    def identity(self) -> dict[str, str]:
        """Everything that the library was made from, by name."""
        return dict(self.connection.execute("SELECT name, value FROM identity"))

    def keep(self, row: Row) -> None:
        """Write a row; it replaces an earlier row with the same number."""
        names = ", ".join(map(quoted, row))
        places = ", ".join("?" * len(row))
        self.connection.execute(
            f"INSERT OR REPLACE INTO gaits ({names}) VALUES ({places})", tuple(row.values())
        )

    def states(self) -> list[tuple[int, str, str | None, str | None, str | None]]:
        """Number, verdict, reason, motion file and its hash for every row."""
        query = "SELECT number, verdict, reason, file, sha256 FROM gaits ORDER BY number"
        return self.connection.execute(query).fetchall()


@contextlib.contextmanager
def writing(folder: Path, identity: Mapping[str, str], keys: tuple[str, ...]) -> Iterator[Manifest]:
    """Open the manifest of a folder for writing; create it if missing.

    At the end it becomes a single plain file, which can also be read on a read-only file system.

    Args:
        folder: folder of the library.
        identity: everything that a new library is made from, by name.
        keys: varied keys of a new library.

    Raises:
        MgsError: the manifest cannot be written.
        InputError: the manifest is damaged.
    """
    path = folder / MANIFEST
    with _told(path), contextlib.closing(sqlite3.connect(path, isolation_level=None)) as connection:
        connection.execute("PRAGMA journal_mode=WAL")
        connection.execute("PRAGMA synchronous=NORMAL")  # hashes verify the files
        _create(connection, identity, keys)
        yield Manifest(connection)
        with contextlib.suppress(sqlite3.OperationalError):  # another process is reading it
            connection.execute("PRAGMA journal_mode=DELETE")


def _create(
    connection: sqlite3.Connection, identity: Mapping[str, str], keys: tuple[str, ...]
) -> None:
    """Create the tables in one transaction, unless there is a row already."""
    own = [key for key in keys if key not in COLUMNS]
    columns = [*(f"{quoted(n)} {kind}" for n, kind in COLUMNS.items()), *map(quoted, own)]
    connection.execute("BEGIN IMMEDIATE")
    if not _has_gaits(connection):
        connection.execute("DROP TABLE IF EXISTS identity")
        connection.execute("DROP TABLE IF EXISTS gaits")
        connection.execute("CREATE TABLE identity (name TEXT PRIMARY KEY, value TEXT NOT NULL)")
        connection.execute(f"CREATE TABLE gaits ({', '.join(columns)})")
        connection.executemany("INSERT INTO identity VALUES (?, ?)", identity.items())
    known = Manifest(connection).columns
    for name in [name for name in COLUMNS if name not in known]:  # made by an earlier version
        connection.execute(f"ALTER TABLE gaits ADD COLUMN {quoted(name)} {COLUMNS[name]}")
    connection.execute("COMMIT")


def _has_gaits(connection: sqlite3.Connection) -> bool:
    tables = "SELECT 1 FROM sqlite_master WHERE name = 'gaits'"
    if connection.execute(tables).fetchone() is None:
        return False
    return connection.execute("SELECT 1 FROM gaits LIMIT 1").fetchone() is not None


@contextlib.contextmanager
def reading(folder: Path) -> Iterator[Manifest]:
    """Open the manifest of a library for reading.

    Raises:
        InputError: the manifest is missing or damaged.
    """
    path = folder / MANIFEST
    with (
        told_as(lambda what: InputError(f"{path}: no sound manifest of a gait library: {what}")),
        contextlib.closing(connect(folder)) as connection,
    ):
        yield Manifest(connection)


def connect(folder: Path) -> sqlite3.Connection:
    """Open a read-only connection; raises InputError if there is no manifest."""
    path = folder / MANIFEST
    if not path.is_file():
        raise InputError(
            f"{folder}: no gait library, {MANIFEST} is missing; create one by mgs batch run"
        )
    address = f"{path.resolve().as_uri()}?mode=ro"
    connection = sqlite3.connect(address, uri=True, isolation_level=None, check_same_thread=False)
    try:
        _bound(connection)
        connection.execute("SELECT number, sha256 FROM gaits LIMIT 1")
    except sqlite3.Error as error:
        connection.close()
        raise InputError(f"{path}: no manifest of a gait library: {error}") from error
    return connection


def _bound(connection: sqlite3.Connection) -> None:
    """Let a connection read tables only, for a limited time.

    Raises:
        sqlite3.DatabaseError: the manifest has something other than tables, such as a view, which
            is a program that may never end.
    """
    calls = itertools.count(1)
    connection.set_progress_handler(
        lambda: next(calls) * STEPS_PER_CALL > MAX_QUERY_STEPS, STEPS_PER_CALL
    )
    connection.execute("PRAGMA trusted_schema = OFF")
    odd = connection.execute(
        "SELECT name FROM sqlite_master WHERE type NOT IN ('table', 'index') "
        "OR sql LIKE 'CREATE VIRTUAL%' LIMIT 1"
    ).fetchone()
    if odd is not None:
        raise sqlite3.DatabaseError(f"{shown(odd[0])} is no table")


@contextlib.contextmanager
def _told(path: Path) -> Iterator[None]:
    try:
        yield
    except sqlite3.OperationalError as error:
        raise MgsError(f"{path}: {error}") from error
    except sqlite3.DatabaseError as error:
        raise InputError(f"{path}: no manifest of a gait library: {error}") from error


def holds_gaits(folder: Path) -> bool:
    """Whether a folder has a manifest with rows; raises InputError if it is damaged."""
    if not (folder / MANIFEST).exists():
        return False
    with reading(folder) as manifest:
        return bool(manifest.states())


def is_whole(folder: Path, file: str | None, sha256: str | None) -> bool:
    """Whether the motion file of a row is unchanged; true for a row without a motion file.

    False for a file outside the folder, which a manifest from somebody else may name.
    """
    if file is None or sha256 is None:
        return file is None
    return is_inside(folder / file, [folder]) and _sha256(folder / file) == sha256


def _sha256(path: Path) -> str | None:
    """SHA-256 hash of a file; None if it cannot be read."""
    try:
        with path.open("rb") as stream:
            digest = hashlib.sha256()
            while block := stream.read(1 << 20):
                digest.update(block)
            return digest.hexdigest()
    except OSError:
        return None
