"""A library folder that vanishes again if nothing came of the run that made it."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from mgs.core.errors import MgsError
from mgs.library.lock import LOCK
from mgs.library.manifest import GAITS_FOLDER, MANIFEST, holds_gaits


@contextlib.contextmanager
def library_folder(folder: Path) -> Iterator[None]:
    """Make a library folder if it is missing; remove it after an exception if it holds no gait.

    Raises:
        MgsError: the folder has motion files of gaits but no manifest that knows them.
    """
    if not (folder / MANIFEST).exists() and any((folder / GAITS_FOLDER).glob("*.mcap")):
        raise MgsError(
            f"{folder / GAITS_FOLDER}: holds motion files, but the manifest of the library is "
            "missing; they would be replaced, so use another folder"
        )
    new = [path for path in (folder, *folder.parents) if not path.exists()]  # innermost first
    (folder / GAITS_FOLDER).mkdir(parents=True, exist_ok=True)
    try:
        yield
    except BaseException:
        if new and not any((folder / GAITS_FOLDER).glob("*.mcap")) and not _has_rows(folder):
            _remove(folder, new)
        raise


def _has_rows(folder: Path) -> bool:
    try:
        return holds_gaits(folder)
    except MgsError:  # the manifest has not been finished
        return False


def _remove(folder: Path, new: list[Path]) -> None:
    with contextlib.suppress(OSError):  # someone else has put something there
        for part in (folder / GAITS_FOLDER).glob(".mgs-*.part"):
            part.unlink()
        for name in (MANIFEST, f"{MANIFEST}-wal", f"{MANIFEST}-shm", f"{MANIFEST}-journal", LOCK):
            (folder / name).unlink(missing_ok=True)
        for path in (folder / GAITS_FOLDER, *new):
            path.rmdir()
