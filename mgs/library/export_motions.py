"""Motions of a library in the format of another program: one file each, and a table of them.

OUT/export.json says what they were made from, so that an export that was interrupted is continued
with the same choices only. A file takes its name when it is complete. OUT/index.csv lists all files
with their velocities; OUT/grid.json, on request, has the files by velocity.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import mgs
from mgs.core.atomic_files import replace_file
from mgs.core.errors import ConfigError, MgsError, OutputExistsError
from mgs.core.input_files import is_inside, read_text
from mgs.core.progress import Progress
from mgs.gait import WalkGait, parse_gait
from mgs.library.manifest import is_whole, reading
from mgs.library.query import query
from mgs.library.velocity import has_velocity, velocity_of
from mgs.motion import Motion
from mgs.motion.cycle import find_cycle
from mgs.motion_file import read_motion
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import Options, find_format
from mgs.robot.unit import load_unit

ABOUT, INDEX, GRID = "export.json", "index.csv", "grid.json"
COLUMNS = ["number", "file", "sha256", "verdict", "vx", "vy", "wz"]
HEAD = ("number", "file", "verdict", "vx", "vy", "wz", "step_vx", "step_vy", "step_wz")
Velocity = tuple[float, float, float]


@dataclass(frozen=True)
class Conversion:
    """What a user chose for the export of a library."""

    fmt: str
    options: Options = field(default_factory=Options)
    fps: float | None = None
    cycle: bool = False  # two steps of each walk instead of all of it
    unit: Path | None = None
    feed_forward: bool = False

    def identity(self) -> dict[str, Any]:
        """Everything that the files depend on besides the library, as plain data."""
        options = self.options
        motors = None
        if options.motors is not None:
            motors = {name: spec.model_dump(mode="json") for name, spec in options.motors.items()}
        return {
            "mgs version": mgs.__version__,
            "format": self.fmt,
            "fps": self.fps,
            "cycle": self.cycle,
            "feed-forward": self.feed_forward,
            "unit": None if self.unit is None else read_text(self.unit),
            "joints": None if options.joints is None else list(options.joints),
            "order": options.order,
            "links": options.links,
            "motors": motors,
            "approach": options.approach,
            "tolerance": options.tolerance,
        }


@dataclass
class ExportSummary:
    """What became of the motions of a library."""

    written: int = 0
    kept: int = 0  # of an earlier run
    failed: dict[int, str] = field(default_factory=dict)  # message by number of the gait
    missing: list[Velocity] = field(default_factory=list)  # of a full grid
    double: list[Velocity] = field(default_factory=list)  # that several gaits have
    grid: tuple[int, int, int] | None = None  # numbers of velocities vx, vy, wz; None: no grid

    @property
    def is_whole(self) -> bool:
        """Whether every motion was written, and the grid is full."""
        return not (self.failed or self.missing or self.double)


def export_motions(
    folder: Path,
    out: Path,
    chosen: Conversion,
    where: str | None = None,
    *,
    resume: bool = False,
    grid: bool = False,
    progress: Progress | None = None,
) -> ExportSummary:
    """Write the motions of a library, or those that meet a condition, to a folder.

    A motion that cannot be written is counted with its message, and the others follow.

    Args:
        folder: folder of the library, which is only read.
        out: folder for the files; new unless `resume` is set.
        chosen: format and its options.
        where: condition on the gaits; None: all that have a motion file.
        resume: continue an earlier export with the same choices; what is there is kept.
        grid: write the files by velocity too. Every combination of the velocities that the sweep
            asks for should have one motion; those without are counted.
        progress: called with motions done and motions in all.

    Raises:
        ConfigError: no such format, a choice is malformed, `where` is no condition, or the earlier
            export was made with other choices.
        OutputExistsError: the folder is there and `resume` is not set.
        MgsError: no gait meets the condition, or nothing can be written.
    """
    suffix = find_format(chosen.fmt).suffix
    condition = "file is not None" if where is None else f"({where}) and file is not None"
    table = query(folder, condition, COLUMNS)
    rows: list[dict[str, Any]] = [dict(zip(COLUMNS, row, strict=True)) for row in table.rows]
    if not rows:
        raise MgsError(f"{folder}: no gait with a motion file meets the condition")
    _begin(out, {"library": str(folder.resolve()), "where": where, **chosen.identity()}, resume)
    asked = asked_velocities(folder)
    summary, index, files = ExportSummary(), [], dict[int, str]()
    for done, row in enumerate(rows):
        number, name = int(row["number"]), f"{int(row['number']):06d}{suffix}"
        try:
            if (out / name).exists():
                summary.kept += 1
            else:
                _export(_motion(folder, row), out / name, chosen)
                summary.written += 1
        except MgsError as error:
            summary.failed[number] = str(error)
            continue
        finally:
            if progress is not None:
                progress(done + 1, len(rows))
        files[number] = name
        figures = [row[column] for column in COLUMNS[3:]]
        index.append([number, name, *figures, *asked.get(number, ("", "", ""))])
    replace_file(out / INDEX, _csv(index))
    if grid:
        _write_grid(out, asked, files, summary)
    return summary


def _begin(out: Path, identity: Mapping[str, Any], resume: bool) -> None:
    """Make the folder, or see that it is one of the same export."""
    path = out / ABOUT
    if not resume:
        if out.exists():
            raise OutputExistsError(out, "use --resume to continue an earlier export")
        replace_file(path, json.dumps(identity, indent=2, allow_nan=False).encode())
        return
    if not path.exists():
        raise ConfigError(out, f"holds no {ABOUT} of an earlier export; leave --resume out")
    try:
        found = json.loads(read_text(path, kind="a description of an export"))
    except ValueError as error:
        raise ConfigError(path, f"is damaged: {error}") from error
    asked = json.loads(json.dumps(identity, allow_nan=False))
    known = found if isinstance(found, dict) else {}
    if differ := [name for name in asked if known.get(name) != asked[name]]:
        raise ConfigError(
            out, f"was exported with other choices ({', '.join(differ)} differ); use another folder"
        )


def _motion(folder: Path, row: Mapping[str, Any]) -> Motion:
    path = folder / str(row["file"])
    if not is_inside(path, [folder]) or not is_whole(folder, row["file"], row["sha256"]):
        raise MgsError(f"{path}: missing or damaged; make it again with mgs batch run --resume")
    return read_motion(path)


def _export(motion: Motion, path: Path, chosen: Conversion) -> None:
    export_motion(
        motion,
        path,
        chosen.fmt,
        find_cycle(motion) if chosen.cycle else None,
        fps=chosen.fps,
        options=chosen.options,
        unit=None if chosen.unit is None else load_unit(chosen.unit, motion.robot),
        feed_forward=chosen.feed_forward,
    )


def asked_velocities(folder: Path) -> dict[int, Velocity]:
    """Velocities of the steps of all gaits of a sweep over walks of equal steps, by their numbers.

    Gaits that could not be made are among them. Of other sweeps there are none.
    """
    with reading(folder) as manifest:
        identity = manifest.identity()
        keys = [k for k in json.loads(identity["keys"]) if k.startswith("walk.")]
    gait = parse_gait(identity["base gait"], folder)
    if not has_velocity(gait) or "walk.sizes" in keys:
        return {}
    assert isinstance(gait, WalkGait)
    names = [key.partition(".")[2] for key in keys]
    found = {}
    for number, *values in query(folder, None, ["number", *keys]).rows:
        walk = gait.walk.model_copy(update=dict(zip(names, values, strict=True)))
        found[int(str(number))] = velocity_of(walk)
    return found


def _csv(index: list[list[Any]]) -> bytes:
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerows([HEAD, *index])
    return stream.getvalue().encode()


def _write_grid(
    out: Path, asked: dict[int, Velocity], files: dict[int, str], summary: ExportSummary
) -> None:
    """Write the files by velocity; combinations that are missing are null, and counted."""
    if not asked:
        raise ConfigError("--grid", "the gaits of this library are no walks of equal steps")
    axes = [sorted({velocity[k] for velocity in asked.values()}) for k in range(3)]
    summary.grid = len(axes[0]), len(axes[1]), len(axes[2])
    by_velocity: dict[Velocity, str] = {}
    for number, name in files.items():
        if asked[number] in by_velocity:
            summary.double.append(asked[number])
        by_velocity[asked[number]] = name
    cells = [(x, y, w) for x in axes[0] for y in axes[1] for w in axes[2]]
    summary.missing = [velocity for velocity in cells if velocity not in by_velocity]
    table = [[[by_velocity.get((x, y, w)) for w in axes[2]] for y in axes[1]] for x in axes[0]]
    content = {"vx": axes[0], "vy": axes[1], "wz": axes[2], "files": table}
    replace_file(out / GRID, json.dumps(content, indent=1, allow_nan=False).encode())
