"""The command mgs export."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.common import force_option, json_option, motion_argument, print_json, say

if TYPE_CHECKING:
    from mgs.motion import Motion
    from mgs.motion.cycle import Cycle


@click.command()
@motion_argument
@click.option(
    "--format", "fmt", type=click.Choice(["csv", "npz"]), default="csv", show_default=True,
    help="Format: csv, a text file with one line per sample; npz, a file of NumPy arrays.",
)  # fmt: skip
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False, path_type=Path),
    help="File to write. Default: path of FILE.mcap with the ending .csv or .npz.",
)  # fmt: skip
@click.option(
    "--cycle", "as_cycle", is_flag=True,
    help="Export two steps from the middle of a walk, made exactly periodic, instead of the whole "
    "motion.",
)  # fmt: skip
@force_option
@json_option
def export(
    file: Path, fmt: str, output: Path | None, as_cycle: bool, force: bool, as_json: bool
) -> None:
    """Write joint angles and velocities of a motion for other tools.

    Reads FILE.mcap. The file that is written contains the names of the joints; units are s, rad
    and rad/s. A cycle (--cycle) can be repeated without end: its first sample follows its last one.
    Exit code 1 if no two steps of the motion are similar enough for a cycle.

    \b
    Examples:
      mgs export walk.mcap
      mgs export walk.mcap --format npz -o walk.npz
      mgs export walk.mcap --cycle -o cycle.csv
    """  # noqa: D301
    from mgs.core.atomic_files import refuse_taken
    from mgs.motion.cycle import find_cycle
    from mgs.motion_file import read_motion
    from mgs.motion_file.export import export_motion

    path = output or file.with_suffix(f".{fmt}")
    refuse_taken(path, force)
    motion = read_motion(file)
    cycle = find_cycle(motion) if as_cycle else None
    export_motion(motion, path, fmt, cycle, force=force)
    samples = motion.n_samples if cycle is None else cycle.n_samples
    if as_json:
        print_json(
            {
                "file": str(path),
                "format": fmt,
                "samples": samples,
                "dt": motion.dt,
                "joints": list(motion.robot.joint_names),
                "cycle": None if cycle is None else _figures(motion, cycle),
            }
        )
        return
    say(
        f"{click.format_filename(path)}\n"
        f"  {samples} samples of {motion.dt:g} s, {motion.robot.n} joints"
    )
    if cycle is not None:
        x, y, yaw = cycle.displacement
        say(
            f"  cycle of {samples * motion.dt:g} s, taken at {cycle.start * motion.dt:.2f} s; "
            f"displacement {x:+.4f} m forward, {y:+.4f} m to the left, turn {yaw:+.4f} rad\n"
            f"  largest difference to the next cycle {cycle.mismatch:.2g} rad ({cycle.joint}); it "
            "was removed evenly along the cycle"
        )


def _figures(motion: Motion, cycle: Cycle) -> dict[str, object]:
    return {
        "start": cycle.start * motion.dt,
        "period": cycle.n_samples * motion.dt,
        "displacement": cycle.displacement.tolist(),
        "mismatch": cycle.mismatch,
        "joint": cycle.joint,
    }
