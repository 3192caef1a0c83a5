"""Files that are either complete or not there, in place of regular files only."""

from __future__ import annotations

import contextlib
import secrets
import shutil
import stat
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

from mgs.core.errors import MgsError, OutputExistsError


def refuse_taken(path: Path, force: bool) -> None:
    """Refuse to write where something is that must not be replaced.

    Raises:
        OutputExistsError: something is there and `force` is not set.
        MgsError: `force` is set, and what is there is no regular file: a folder, a device, a pipe
            or a link, whose target may be anywhere.
    """
    try:
        mode = path.lstat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return
    if not force:
        raise OutputExistsError(path)
    if not stat.S_ISREG(mode):
        kinds = {stat.S_IFLNK: "a link", stat.S_IFDIR: "a folder"}
        kind = kinds.get(stat.S_IFMT(mode), "a device or a pipe")
        raise MgsError(f"{path}: {kind}, which is never replaced; use -o to write elsewhere")


def part_of(path: Path) -> Path:
    """Where the content of a file is written before it takes the file's name."""
    return path.with_name(f".mgs-{secrets.token_hex(8)}.part")


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """Stream into a file beside `path` that takes its place when all went well, else vanishes.

    Raises:
        MgsError: something other than a regular file is in its place.
    """
    refuse_taken(path, force=True)
    with _new_folders(path.parent):
        part = part_of(path)
        try:
            with part.open("x+b") as stream:
                yield stream
            part.replace(path)
        finally:  # after KeyboardInterrupt too
            part.unlink(missing_ok=True)


@contextlib.contextmanager
def replacing_path(path: Path, *, folder: bool, force: bool = False) -> Iterator[Path]:
    """Path beside `path` for a file or folder that takes its place when all went well.

    Args:
        path: the file or folder.
        folder: True: what is given is an empty folder; False: nothing is there.
        force: True: a folder at `path` is replaced if no other files are in it than the new ones.

    Raises:
        OutputExistsError: something is there and `force` is not set.
        MgsError: a link, a device or a pipe is there, a folder in the place of a file, or a folder
            with other files.
    """
    refuse_place(path, folder, force)
    with _new_folders(path.parent):
        part = part_of(path)
        try:
            if folder:
                part.mkdir()
            yield part
            refuse_place(path, folder, force)
            if folder and path.is_dir():
                _replace_folder(path, part)
            else:
                part.replace(path)
        finally:  # after KeyboardInterrupt too
            if part.is_dir():
                shutil.rmtree(part, ignore_errors=True)
            part.unlink(missing_ok=True)


def refuse_place(path: Path, folder: bool, force: bool) -> None:
    """Refuse to write a file, or a folder, as `replacing_path` would; for a check before the work.

    Raises:
        OutputExistsError, MgsError: as `replacing_path`.
    """
    if not (folder and force and path.is_dir() and not path.is_symlink()):
        refuse_taken(path, force)


def _replace_folder(path: Path, part: Path) -> None:
    if others := sorted(_files_below(path) - _files_below(part)):
        raise MgsError(
            f"{path}: holds {others[0]}, which is not replaced; use -o to write elsewhere"
        )
    former = part_of(path)
    path.replace(former)
    try:
        part.replace(path)
    except OSError:
        former.replace(path)
        raise
    shutil.rmtree(former)


def _files_below(folder: Path) -> set[str]:
    """Everything in a folder but the folders in it, by its path from there."""
    entries = (path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir())
    return {path.relative_to(folder).as_posix() for path in entries}


def replace_file(path: Path, content: bytes) -> None:
    """Write a file, its folder too if missing, in place of what is there.

    Raises:
        MgsError: it cannot be written; what was there before still is.
    """
    replace_files(path.parent, {path.name: content})


def replace_files(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write several files of a folder, all of them or none, in place of what is there.

    Args:
        folder: made if missing.
        contents: content of each file by its name.

    Raises:
        MgsError: they cannot be written; what was there before still is.
    """
    for name in contents:
        refuse_taken(folder / name, force=True)
    parts = {name: part_of(folder / name) for name in contents}
    try:
        with _new_folders(folder):
            try:
                for name, content in contents.items():
                    parts[name].write_bytes(content)
                for name, part in parts.items():
                    part.replace(folder / name)
            finally:
                for part in parts.values():
                    part.unlink(missing_ok=True)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        path = folder if len(contents) > 1 else folder / next(iter(contents))
        raise MgsError(f"{path}: cannot be written: {reason}") from error


@contextlib.contextmanager
def _new_folders(folder: Path) -> Iterator[None]:
    """Make a folder and those above it; those that are new vanish again after an exception."""
    new = [path for path in (folder, *folder.parents) if not path.exists()]  # innermost first
    folder.mkdir(parents=True, exist_ok=True)
    try:
        yield
    except BaseException:
        with contextlib.suppress(OSError):  # someone else has put something there
            for path in new:
                path.rmdir()
        raise
