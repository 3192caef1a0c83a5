"""mgs export."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.common import force_option, json_option, motion_argument, print_json

if TYPE_CHECKING:
    from mgs.motion import Motion
    from mgs.motion.cycle import Cycle


@click.command()
@motion_argument
@click.option(
    "--format", "fmt", type=click.Choice(["csv", "npz"]), default="csv", show_default=True,
    help="Text with one line per sample, or NumPy arrays.",
)  # fmt: skip
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False, path_type=Path),
    help="File to write; default: beside FILE.mcap, named like it.",
)  # fmt: skip
@click.option(
    "--cycle", "as_cycle", is_flag=True,
    help="Two steps from the middle of a walk, made exactly periodic, instead of all of it.",
)  # fmt: skip
@force_option
@json_option
def export(
    file: Path, fmt: str, output: Path | None, as_cycle: bool, force: bool, as_json: bool
) -> None:
    """Write joint angles and velocities for other tools.

    Names of joints are in the head of the file; units are s, rad and rad/s. With --cycle the sample
    after the last one is the first one again: repeat it for as long as the robot shall walk.

    \b
    Examples:
      mgs export walk.mcap
      mgs export walk.mcap --format npz -o walk.npz
      mgs export walk.mcap --cycle -o cycle.csv
    """  # noqa: D301
    from mgs.core.errors import OutputExistsError
    from mgs.motion.cycle import find_cycle
    from mgs.motion_file import read_motion
    from mgs.motion_file.export import export_motion

    path = output or file.with_suffix(f".{fmt}")
    if path.exists() and not force:
        raise OutputExistsError(path)
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
    click.echo(
        f"{click.format_filename(path)}\n"
        f"  {samples} samples of {motion.dt:g} s, {motion.robot.n} joints"
    )
    if cycle is not None:
        x, y, yaw = cycle.displacement
        click.echo(
            f"  cycle of {samples * motion.dt:g} s, from {cycle.start * motion.dt:.2f} s on: "
            f"{x:+.4f} m ahead, {y:+.4f} m to the left, {yaw:+.4f} rad of turn\n"
            f"  {cycle.joint} differed by {cycle.mismatch:.2g} rad from the next cycle, which is "
            "spread over this one"
        )


def _figures(motion: Motion, cycle: Cycle) -> dict[str, object]:
    return {
        "start": cycle.start * motion.dt,
        "period": cycle.n_samples * motion.dt,
        "displacement": cycle.displacement.tolist(),
        "mismatch": cycle.mismatch,
        "joint": cycle.joint,
    }
