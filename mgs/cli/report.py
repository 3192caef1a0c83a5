"""The command mgs report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mgs.cli.colour import bad, good
from mgs.cli.common import force_option, json_option, print_json, progress_bars, say
from mgs.cli.servo_options import servo_option

if TYPE_CHECKING:
    from mgs.sim import ServoName


@click.command()
@click.argument(
    "files", metavar="FILE.mcap...", nargs=-1, required=True,
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
)  # fmt: skip
@click.option(
    "--compare", is_flag=True,
    help="Show several motion files side by side with one clock. Without this option one file is "
    "accepted.",
)  # fmt: skip
@click.option(
    "-o", "--output", metavar="FILE.html", type=click.Path(dir_okay=False, path_type=Path),
    help="Page to write; with the ending .rrd, a recording for the viewer Rerun instead. Default: "
    "path of the first motion file with the ending .html; with --compare, comparison.html in its "
    "folder.",
)  # fmt: skip
@click.option(
    "--replay", "engines", metavar="ENGINES",
    help="Physics engines in which each motion is also replayed: mujoco, pybullet or "
    "mujoco,pybullet. The replay appears beside the plan, and in the verdict. Default: no replay.",
)  # fmt: skip
@servo_option
@click.option(
    "--meshes", metavar="DIR", type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Folder with the mesh files that the URDF of the robot names. Only files inside it are "
    "read. Default: links with meshes are shown by their collision shapes.",
)  # fmt: skip
@force_option
@json_option
def report(
    files: tuple[Path, ...],
    compare: bool,
    output: Path | None,
    engines: str | None,
    servo: ServoName,
    meshes: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    """Write a page (HTML) that shows a motion: moving robot, verdict and plots.

    Reads FILE.mcap and writes one file, which a web browser opens from disk without a network. The
    page shows the robot in 3D with its footsteps, centre of mass (CoM), zero-moment point (ZMP) and
    contact forces, the verdict with the worst moment of each check, plots of balance, energy and
    joints, and the origin of the motion.

    Exit code 0 if the page has been written, whatever the verdict; mgs validate tells the verdict
    by its exit code.

    \b
    Examples:
      mgs report walk.mcap
      mgs report walk.mcap -o page.html --replay mujoco
      mgs report --compare slow.mcap fast.mcap -o both.html
      mgs report walk.mcap -o walk.rrd
    """  # noqa: D301
    from mgs.report.page import PageOptions, write_page
    from mgs.sim import choose_engines

    if len(files) > 1 and not compare:
        raise click.UsageError("several files; add --compare to show them side by side")
    if compare and len(files) < 2:
        raise click.UsageError("--compare needs at least two files")
    default = files[0].with_name("comparison.html") if compare else files[0].with_suffix(".html")
    path = output or default
    if path.suffix == ".rrd":
        _write_recording(files, path, engines, force, as_json)
        return
    names = () if engines is None else choose_engines(engines, "--replay")
    options = PageOptions(engines=tuple(names), servo=servo, meshes=meshes)
    with progress_bars() as tell:
        verdicts = write_page(files, path, options, force=force, progress=tell)
    if as_json:
        told = [{"file": v.file, "passed": v.passed, "failed": list(v.failed)} for v in verdicts]
        print_json({"page": str(path), "bytes": path.stat().st_size, "motions": told})
        return
    for verdict in verdicts:
        failed = ", ".join(verdict.failed)
        say(f"{verdict.file}: {bad(f'FAIL: {failed}') if failed else good('PASS')}")
    say(f"{click.format_filename(str(path))}: open it in a web browser")


def _write_recording(
    files: tuple[Path, ...], path: Path, engines: str | None, force: bool, as_json: bool
) -> None:
    """Write a Rerun recording of one motion file."""
    from mgs.report.rerun_recording import write_recording

    if len(files) > 1 or engines is not None:
        raise click.UsageError("a Rerun recording (.rrd) shows one motion without replays")
    write_recording(files[0], path, force=force)
    if as_json:
        print_json({"recording": str(path), "bytes": path.stat().st_size})
    else:
        say(f"{click.format_filename(str(path))}: open it with rerun {path.name}")
