"""Motions for other programs, in the formats of `mgs.motion_file.formats`."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mgs.core.arrays import Array
from mgs.core.atomic_files import refuse_place, replacing_path
from mgs.core.errors import ConfigError, MgsError
from mgs.core.foreign import told_as
from mgs.core.short_repr import short_repr
from mgs.core.short_text import clipped
from mgs.core.wrong_type import given_path
from mgs.motion import Motion
from mgs.motion.commanded import commanded
from mgs.motion.cycle import Cycle, find_cycle
from mgs.motion.lead_in import with_lead_in
from mgs.motion.sampled import SampledMotion, sample
from mgs.motion_file.formats import FORMATS, Format, Options, Written, find_format
from mgs.motion_file.read import read_motion
from mgs.robot import read_motors, servos_of
from mgs.robot.orders import Order
from mgs.robot.start_posture import HALF_SITTING, start_posture
from mgs.robot.unit import Unit, load_unit, servos_of_unit


@dataclass(frozen=True, eq=False)
class LeadIn:
    """A way to the first frame of a motion."""

    seconds: float  # duration [s]
    start: Array  # joint angles (n,) at its beginning [rad]

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class Exported:
    """What an export has written, and where."""

    path: Path
    format: Format
    sampled: SampledMotion
    written: Written

    __repr__ = short_repr


def export_motion(
    motion: Motion,
    path: Path,
    fmt: str,
    cycle: Cycle | None = None,
    *,
    fps: float | None = None,
    options: Options | None = None,
    unit: Unit | None = None,
    feed_forward: bool = False,
    lead_in: LeadIn | None = None,
    force: bool = False,
) -> Exported:
    """Write a motion, or one cycle of it.

    Args:
        motion: what to write.
        path: the file or folder; the folder that it is in is made if missing.
        fmt: a key of `FORMATS`.
        cycle: of this motion; None: all of it.
        fps: frames per second [Hz]; None: those that readers of the format expect (of a cycle, the
            nearest rate at which it is a whole number of frames), or the planned samples.
        options: joints, order, motors and so on; None: those of the format and of robot.yaml.
        unit: corrections of one physical robot, for which joint angles become commands; None: none.
        feed_forward: write commands that compensate the yielding of the servos of robot.yaml, with
            the stiffness of the unit where it states one.
        lead_in: way to the first frame, which is written before it; None: none.
        force: replace an existing file, or a folder in which nothing else is.

    Raises:
        ConfigError: no such format or joint, the rate does not fit, or the lead-in is too short.
        OutputExistsError: there is a file and `force` is not set.
        MgsError: the file cannot be written, or a library that the format needs is not installed.
    """
    chosen = find_format(fmt)
    refuse_place(path, not chosen.suffix, force)
    rate = chosen.fps if fps is None else fps
    sampled = sample(motion, rate, cycle, closed=chosen.closed, nearest=fps is None)
    servos = servos_of(motion.robot) if feed_forward else None
    if servos is not None and unit is not None:
        servos = servos_of_unit(servos, unit)
    options = options or Options()
    remarks = (*options.remarks, *_remarks(unit, feed_forward))
    options = dataclasses.replace(options, remarks=remarks)
    frames = commanded(sampled, unit, servos)
    if lead_in is not None:
        commands = None if unit is None else unit.command_for(lead_in.start)
        frames = with_lead_in(frames, lead_in.seconds, lead_in.start, commands)
    exported = write_sampled(frames, path, chosen, options, force=force)
    written = exported.written
    told = dataclasses.replace(written, notes=(*options.remarks, *written.notes))
    return dataclasses.replace(exported, written=told)


def _remarks(unit: Unit | None, feed_forward: bool) -> tuple[str, ...]:
    """What readers of a file should know of its joint angles."""
    remarks = []
    if feed_forward:
        remarks.append("joint angles are feed-forward commands for the servos of robot.yaml")
    if unit is not None:
        name = clipped(unit.name, 100)  # one line without control characters
        remarks.append(f"joint angles are commands corrected for the physical robot {name}")
    return tuple(remarks)


def write_sampled(
    sampled: SampledMotion,
    path: Path,
    fmt: Format,
    options: Options | None = None,
    *,
    force: bool = False,
) -> Exported:
    """Write frames of a motion; see `export_motion` for arguments and errors."""

    def failed(reason: str) -> MgsError:
        return MgsError(f"{path}: cannot be written as {fmt.name}: {reason}")

    try:
        with replacing_path(path, folder=not fmt.suffix, force=force) as part, told_as(failed):
            written = fmt.write(sampled, part, options or Options())
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise MgsError(f"{path}: cannot be written: {reason}") from error
    return Exported(path, fmt, sampled, _with_rate(written, sampled, fmt))


def _with_rate(written: Written, sampled: SampledMotion, fmt: Format) -> Written:
    """What was written, with a note if its rate is not the one that readers expect."""
    if fmt.fps is None or abs(sampled.fps - fmt.fps) < 1e-6 * fmt.fps:
        return written
    note = f"{sampled.fps:.6g} frames per second; readers of {fmt.name} often take {fmt.fps:g}"
    return dataclasses.replace(written, notes=(*written.notes, note))


def export(
    motion: Motion | str | Path,
    path: str | Path,
    format: str | None = None,
    *,
    fps: float | None = None,
    joints: Sequence[str] | None = None,
    order: Order | None = None,
    cycle: bool = False,
    motors: str | Path | None = None,
    unit: str | Path | None = None,
    feed_forward: bool = False,
    lead_in: float | None = None,
    lead_in_from: str | Path = HALF_SITTING,
    force: bool = False,
) -> Path:
    """Write a motion for other programs.

    Args:
        motion: a motion or the path of a motion file.
        path: the file or folder to write; the folder that it is in is made if missing.
        format: such as "csv", "npz" or "unitree-csv", see `mgs export --help`; None: csv or npz,
            whichever the path ends with.
        fps: frames per second [Hz]; None: those that readers of the format expect, or the planned
            samples.
        joints: names of the joints to write, in this order; None: all, in the order of the format.
        order: "depth-first" or "breadth-first" order of joints and links; None: that of the format.
        cycle: two steps from the middle of a walk, made exactly periodic, instead of all of it.
        motors: file of the motors on the bus; None: those of robot.yaml.
        unit: file with the corrections of one physical robot; None: none.
        feed_forward: write commands that compensate the yielding of the servos of robot.yaml.
        lead_in: duration of a way to the first frame, written before it [s]; None: none.
        lead_in_from: posture at its beginning: "half-sitting", "zero" or a file, see
            `mgs.robot.start_posture`.
        force: replace an existing file.

    Returns:
        The file or folder.

    Raises:
        ConfigError: there is no such format or joint, or the rate does not fit.
        MotionFileError: the motion file is missing or damaged.
        CycleError: the motion has no two steps that could be repeated.
        OutputExistsError: there is a file and `force` is not set.
        MgsError: the file cannot be written.
        TypeError: an argument has a wrong type.
    """
    path = given_path(path)
    wanted = path.suffix.removeprefix(".") if format is None else format
    if format is None and wanted not in ("csv", "npz"):
        raise ConfigError(
            "format",
            f"{path.name} does not end with .csv or .npz; name one of {', '.join(FORMATS)}",
        )
    find_format(wanted)
    given = read_motion(motion)
    options = Options(
        joints=None if joints is None else tuple(joints),
        order=order,
        motors=None if motors is None else read_motors(Path(motors)),
        motors_file=str(motors or ""),
    )
    export_motion(
        given,
        path,
        wanted,
        find_cycle(given) if cycle else None,
        fps=fps,
        options=options,
        unit=None if unit is None else load_unit(Path(unit), given.robot),
        feed_forward=feed_forward,
        lead_in=None
        if lead_in is None
        else LeadIn(lead_in, start_posture(given.robot, str(lead_in_from))),
        force=force,
    )
    return path
