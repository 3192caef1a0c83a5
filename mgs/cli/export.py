"""The command mgs export."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.common import FiniteRange, force_option, json_option, motion_argument, print_json, say
from mgs.cli.export_options import Choice, export_options
from mgs.cli.layout_option import layout_option, listing
from mgs.motion_file.formats import FORMATS

if TYPE_CHECKING:
    from mgs.motion_file.export import Exported


@click.command(epilog=listing("Formats", FORMATS))
@motion_argument
@click.option(
    "--format", "fmt", type=click.Choice(list(FORMATS)), default="csv", show_default=True,
    metavar="NAME", help="Name of the format, see below.",
)  # fmt: skip
@click.option(
    "-o", "--output", type=click.Path(path_type=Path),
    help="File or folder to write. Default: path of FILE.mcap with the name and the ending of the "
    "format.",
)  # fmt: skip
@export_options
@click.option(
    "--cycle", "as_cycle", is_flag=True,
    help="Export two steps from the middle of a walk, made exactly periodic, instead of the whole "
    "motion.",
)  # fmt: skip
@layout_option(FORMATS)
@click.option(
    "--lead-in", metavar="S", type=FiniteRange(0.1, 60.0),
    help="Duration of a way from the posture of --lead-in-from to the first frame, written before "
    "it [s]. Default: none.",
)  # fmt: skip
@click.option(
    "--lead-in-from", metavar="POSTURE",
    help="Posture at the beginning of --lead-in: half-sitting, zero, or a YAML file with angles by "
    "name of the joint [rad]. Default: half-sitting.",
)  # fmt: skip
@force_option
@json_option
def export(
    file: Path,
    fmt: str,
    output: Path | None,
    choice: Choice,
    as_cycle: bool,
    lead_in: float | None,
    lead_in_from: str | None,
    force: bool,
    as_json: bool,
) -> None:
    """Write a motion for other programs: trainers, servos, spreadsheets.

    Reads FILE.mcap. What is written, the order of joints and links and the rate are printed; the
    layout of a format is shown by --layout NAME. A cycle (--cycle) can be repeated without end.
    Exit code 1 if no two steps of the motion are similar enough for a cycle.

    \b
    Examples:
      mgs export walk.mcap
      mgs export walk.mcap --format npz -o walk.npz
      mgs export walk.mcap --cycle -o cycle.csv
      mgs export walk.mcap --format unitree-csv --fps 50
      mgs export walk.mcap --format jtc --lead-in 3
      mgs export walk.mcap --format dynamixel --motors motors.yaml --unit number_7.yaml
    """  # noqa: D301
    from mgs.core.atomic_files import refuse_place
    from mgs.motion.cycle import find_cycle
    from mgs.motion_file import read_motion
    from mgs.motion_file.export import LeadIn, export_motion
    from mgs.robot.start_posture import HALF_SITTING, start_posture
    from mgs.robot.unit import load_unit

    suffix = FORMATS[fmt].suffix
    path = output or file.with_suffix(suffix if fmt in ("csv", "npz") else f".{fmt}{suffix}")
    if lead_in_from is not None and lead_in is None:
        raise click.UsageError("--lead-in-from needs --lead-in, the duration of the way.")
    refuse_place(path, not suffix, force)
    options = choice.options(fmt)
    motion = read_motion(file)
    cycle = find_cycle(motion) if as_cycle else None
    exported = export_motion(
        motion,
        path,
        fmt,
        cycle,
        fps=choice.fps,
        options=options,
        unit=None if choice.unit is None else load_unit(choice.unit, motion.robot),
        feed_forward=choice.feed_forward,
        lead_in=None
        if lead_in is None
        else LeadIn(lead_in, start_posture(motion.robot, lead_in_from or HALF_SITTING)),
        force=force,
    )
    if as_json:
        print_json(_figures(exported))
    else:
        _tell(exported)


def _tell(exported: Exported) -> None:
    """Print what was written."""
    sampled, written = exported.sampled, exported.written
    say(
        f"{click.format_filename(exported.path)}\n"
        f"  {sampled.n_frames} samples of {sampled.interval:g} s, {len(written.joints)} joints"
    )
    say(f"  joints    {', '.join(written.joints)}")
    if written.links:
        say(f"  links     {', '.join(written.links)}")
    for note in written.notes:
        say(f"  note      {note}")
    if (cycle := sampled.cycle) is not None:
        dt = sampled.motion.dt
        x, y, yaw = cycle.displacement
        say(
            f"  cycle of {cycle.n_samples * dt:g} s, taken at {cycle.start * dt:.2f} s; "
            f"displacement {x:+.4f} m forward, {y:+.4f} m to the left, turn {yaw:+.4f} rad\n"
            f"  largest difference to the next cycle {cycle.mismatch:.2g} rad ({cycle.joint}); it "
            "was removed evenly along the cycle"
        )


def _figures(exported: Exported) -> dict[str, object]:
    sampled, written, cycle = exported.sampled, exported.written, exported.sampled.cycle
    dt = sampled.motion.dt
    return {
        "file": str(exported.path),
        "format": exported.format.name,
        "samples": sampled.n_frames,
        "dt": sampled.interval,
        "fps": sampled.fps,
        "joints": list(written.joints),
        "links": list(written.links),
        "notes": list(written.notes),
        "cycle": None
        if cycle is None
        else {
            "start": cycle.start * dt,
            "period": cycle.n_samples * dt,
            "displacement": cycle.displacement.tolist(),
            "mismatch": cycle.mismatch,
            "joint": cycle.joint,
        },
    }
