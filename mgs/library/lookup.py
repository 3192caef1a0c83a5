"""Walks of a gait library as one table by velocity, from which a policy looks up."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mgs.core.atomic_files import replacing_path
from mgs.core.errors import ConfigError, MgsError
from mgs.core.plugins import unknown_name
from mgs.core.progress import Progress
from mgs.library.query import GaitLibrary
from mgs.motion_file import read_motion
from mgs.motion_file.formats import Options, Written
from mgs.motion_file.formats.lookup import LOOKUPS, Walk
from mgs.motion_file.formats.lookup.walk import walk_of


def walks_of(
    folder: Path, where: str, fps: float, digits: int, progress: Progress | None = None
) -> list[Walk]:
    """Cycles of the gaits of a library that fulfil a condition.

    Args:
        folder: folder of the library.
        where: condition on the columns of the library.
        fps: frames per second [Hz].
        digits: after the point, to which velocities are rounded.
        progress: called with the number of gaits that are done, and of all.

    Raises:
        InputError: the folder contains no library, or a file of it is missing.
        ConfigError: the condition is wrong, or the rate does not fit a gait.
        MgsError: no gait fulfils the condition, or one has no two steps that could be repeated.
    """
    library = GaitLibrary(folder, where)
    try:
        found = []
        for done, number in enumerate(library.numbers):
            if progress is not None:
                progress(done, len(library))
            file = library.gait(number).file
            try:
                found.append(walk_of(read_motion(file), fps, digits))
            except ConfigError as error:
                raise ConfigError(file, error.problems) from error
        return found
    finally:
        library.close()


def write_lookup(
    walks: Sequence[Walk], path: Path, name: str, options: Options | None = None, *, force: bool
) -> Written:
    """Write a table of walks.

    Args:
        walks: what it holds.
        path: the file; its folder is made if missing.
        name: a key of `LOOKUPS`.
        options: joints; None: those of the table.
        force: replace an existing file.

    Raises:
        ConfigError: no such table, or the walks do not fit together.
        OutputExistsError: there is a file and `force` is not set.
        MgsError: the file cannot be written.
    """
    if name not in LOOKUPS:
        known = unknown_name(name, list(LOOKUPS)).replace("is not installed", "is unknown")
        raise ConfigError("format", known)
    try:
        with replacing_path(path, folder=False, force=force) as part:
            return LOOKUPS[name].write(walks, part, options or Options())
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise MgsError(f"{path}: cannot be written: {reason}") from error
