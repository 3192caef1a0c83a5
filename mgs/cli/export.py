"""The command mgs export."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mgs.cli.common import FiniteRange, force_option, json_option, motion_argument, print_json, say
from mgs.motion_file.formats import FORMATS

if TYPE_CHECKING:
    from mgs.motion_file.export import Exported
    from mgs.robot.orders import Order

WIDTH = max(len(name) for name in FORMATS) + 2
LIST = "\n".join(f"  {name:<{WIDTH}}{found.summary}" for name, found in FORMATS.items())


def _print_layout(ctx: click.Context, _: click.Parameter, name: str | None) -> None:
    """Print the description of a format and end the command."""
    if name is None or ctx.resilient_parsing:
        return
    say(FORMATS[name].layout)
    ctx.exit()


@click.command(epilog=f"\b\nFormats:\n{LIST}")
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
@click.option(
    "--fps", type=FiniteRange(min=0.0, min_open=True),
    help="Frames per second [Hz]. Default: the rate that readers of the format expect, else the "
    "planned samples.",
)  # fmt: skip
@click.option(
    "--joints", metavar="NAMES",
    help="Names of the joints to write, separated by commas, in this order; or @FILE with one name "
    "per line. Default: all joints in the order of the format.",
)  # fmt: skip
@click.option(
    "--order", type=click.Choice(["depth-first", "breadth-first"]),
    help="Order of joints and links: depth-first as MuJoCo counts them, breadth-first as Isaac Lab "
    "does. Default: the order that the format is defined with.",
)  # fmt: skip
@click.option(
    "--links", type=click.Choice(["moving", "all"]), default="moving", show_default=True,
    help="Links to write: moving ones, into which fixed links are merged, or all links of the "
    "URDF.",
)  # fmt: skip
@click.option(
    "--cycle", "as_cycle", is_flag=True,
    help="Export two steps from the middle of a walk, made exactly periodic, instead of the whole "
    "motion.",
)  # fmt: skip
@click.option(
    "--layout", type=click.Choice(list(FORMATS)), metavar="NAME", is_eager=True,
    expose_value=False, callback=_print_layout,
    help="Print the description of a format and exit.",
)  # fmt: skip
@force_option
@json_option
def export(
    file: Path,
    fmt: str,
    output: Path | None,
    fps: float | None,
    joints: str | None,
    order: Order | None,
    links: Any,
    as_cycle: bool,
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
    """  # noqa: D301
    from mgs.core.atomic_files import refuse_place
    from mgs.motion.cycle import find_cycle
    from mgs.motion_file import read_motion
    from mgs.motion_file.export import export_motion
    from mgs.motion_file.formats import Options

    suffix = FORMATS[fmt].suffix
    path = output or file.with_suffix(suffix if fmt in ("csv", "npz") else f".{fmt}{suffix}")
    refuse_place(path, not suffix, force)
    options = Options(None if joints is None else _joint_names(joints), order, links)
    motion = read_motion(file)
    cycle = find_cycle(motion) if as_cycle else None
    exported = export_motion(motion, path, fmt, cycle, fps=fps, options=options, force=force)
    if as_json:
        print_json(_figures(exported))
    else:
        _tell(exported)


def _joint_names(text: str) -> tuple[str, ...]:
    """Names of joints in a text, or in the file that it names after @."""
    if text.startswith("@"):
        from mgs.core.input_files import read_text

        return tuple(read_text(Path(text[1:]), kind="a list of joints").replace(",", "\n").split())
    return tuple(name.strip() for name in text.split(",") if name.strip())


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
