"""The commands mgs library query, export, lookup and report."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mgs.cli.common import (
    force_option,
    json_option,
    print_json,
    progress_bars,
    say,
    with_progress,
)
from mgs.cli.export_options import Choice, export_options
from mgs.cli.lookup import lookup
from mgs.motion_file.formats import FORMATS

if TYPE_CHECKING:
    from mgs.library.query import Table

SHOWN = [
    *("number", "verdict", "reason", "robot", "ik.solver", "speed", "vx", "vy", "wz"),
    *("zmp_margin", "torque_ratio", "survived", "file"),
]
MOST_VALUES = 12  # largest number of values of a key that are listed one by one

folder_argument = click.argument(
    "folder", metavar="DIR", type=click.Path(exists=True, file_okay=False, path_type=Path)
)
where_option = click.option(
    "--where", metavar="CONDITION",
    help='Condition that selects gaits, e.g. "speed > 0.1 and survived". Default: all gaits.',
)  # fmt: skip
columns_option = click.option(
    "--columns", metavar="NAME,NAME",
    help="Columns to output, separated by commas; mgs library query DIR --names lists their "
    "names. Default: all columns except the results of single checks.",
)  # fmt: skip


@click.group()
def library() -> None:
    """Query, export and summarize a gait library made by mgs batch run.

    DIR is the folder of the library. No command changes it.

    \b
    Examples:
      mgs library query outputs/speeds --where "speed > 0.1 and survived"
      mgs library export outputs/speeds --format csv -o speeds.csv
      mgs library report outputs/speeds
    """  # noqa: D301


@library.command(short_help="Print the gaits that meet a condition.")
@folder_argument
@where_option
@columns_option
@click.option(
    "--order", metavar="COLUMN",
    help="Column, or arithmetic expression of columns, by which the gaits are sorted. Default: "
    "number.",
)  # fmt: skip
@click.option("--reverse", is_flag=True, help="Sort in descending order.")
@click.option(
    "--limit",
    metavar="N",
    type=click.IntRange(1),
    help="Largest number of gaits to print. Default: no limit.",
)
@click.option("--names", is_flag=True, help="Print the names of all columns instead of the gaits.")
@json_option
def query(
    folder: Path,
    where: str | None,
    columns: str | None,
    order: str | None,
    reverse: bool,
    limit: int | None,
    names: bool,
    as_json: bool,
) -> None:
    """Print the gaits of a library that meet a condition.

    A condition is a column that is true or false, such as `survived`, or compares columns, numbers
    and 'texts' in quotes by ==, !=, <, <=, >, >=, in [..] or is None. Conditions are joined by and,
    or, not; columns and numbers by +, -, *, / and abs(). A comparison with a missing value is
    false, e.g. with `survived` in a library without replays.

    \b
    Examples:
      mgs library query outputs/speeds --where "speed > 0.1 and survived" --order speed --reverse
      mgs library query outputs/speeds --where "ik.solver == 'ik4' and vx > 0.1" --limit 3
      mgs library query outputs/speeds --where "verdict == 'infeasible'" --columns number,message
      mgs library query outputs/speeds --names
    """  # noqa: D301
    from mgs.library import query as look
    from mgs.library.manifest import reading

    if names:
        with reading(folder) as manifest:
            found = list(manifest.columns)
        print_json(found) if as_json else say("\n".join(found))
        return
    asked = _names(columns) if columns else (None if as_json else SHOWN)
    table = look.query(folder, where, asked, order, reverse, limit)
    if as_json:
        rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
        print_json({"folder": str(folder), "gaits": len(rows), "rows": rows})
    else:
        _print(table)


@library.command(short_help="Write the table or the motions of a library.")
@folder_argument
@click.option(
    "--format", "kind", type=click.Choice(["csv", "parquet"]),
    help="Format of the table to write.",
)  # fmt: skip
@click.option(
    "--motions", metavar="NAME", type=click.Choice(list(FORMATS)),
    help="Format in which all motions are written, instead of a table: a name that mgs export "
    "--help lists.",
)  # fmt: skip
@click.option(
    "-o", "--output", type=click.Path(path_type=Path),
    help="File of the table, or folder of the motions. Default: DIR.csv, DIR.parquet or DIR-NAME.",
)  # fmt: skip
@where_option
@columns_option
@click.option(
    "--cycle", "as_cycle", is_flag=True,
    help="Write two steps from the middle of each walk, made exactly periodic.",
)  # fmt: skip
@click.option(
    "--grid", is_flag=True,
    help="Write grid.json too, the files by velocity; exit code 1 unless every combination of the "
    "velocities of the sweep has one motion.",
)  # fmt: skip
@click.option(
    "--resume", is_flag=True,
    help="Continue an export of motions that was interrupted; files that are there are kept.",
)  # fmt: skip
@export_options
@force_option
@json_option
@click.pass_context
def export(
    ctx: click.Context,
    folder: Path,
    kind: str | None,
    motions: str | None,
    output: Path | None,
    where: str | None,
    columns: str | None,
    as_cycle: bool,
    grid: bool,
    resume: bool,
    choice: Choice,
    force: bool,
    as_json: bool,
) -> None:
    """Write the table of a library, or all its motions, for other tools.

    The table (--format) has one row per gait: its values, its verdict and its figures. Motions
    (--motions) are written to a new folder, one file each, with index.csv, which has their
    velocities; the options from --fps on are those of mgs export. Exit code 1 if a motion could
    not be written.

    \b
    Examples:
      mgs library export outputs/speeds --format csv
      mgs library export outputs/speeds --format parquet -o passed.parquet --where "survived"
      mgs library export outputs/speeds --motions open-duck --cycle --grid -o speeds-duck
      mgs library export outputs/speeds --motions dynamixel --motors motors.yaml --resume
    """  # noqa: D301
    if (kind is None) == (motions is None):
        raise click.UsageError("Give --format for the table, or --motions for the motions.")
    if motions is not None:
        conversion = motions, choice, as_cycle
        ctx.exit(_export_motions(folder, output, conversion, where, grid, resume, as_json))
    assert kind is not None
    from mgs.core.atomic_files import refuse_taken, replace_file
    from mgs.library import query as look

    path = output or folder.with_name(f"{folder.resolve().name}.{kind}")
    refuse_taken(path, force)
    table = look.query(folder, where, _names(columns) if columns else None)
    content = look.to_csv(table) if kind == "csv" else look.to_parquet(table)
    replace_file(path, content)
    if as_json:
        print_json({"file": str(path), "gaits": len(table.rows), "columns": list(table.columns)})
    else:
        say(f"{click.format_filename(str(path))}: {len(table.rows)} gaits")


@library.command(short_help="Print a summary of a library, or write its page.")
@folder_argument
@click.option(
    "-o", "--output", metavar="FILE.html", type=click.Path(dir_okay=False, path_type=Path),
    help="Page (HTML) to write: sortable table of all gaits and scatter of their figures. Default: "
    "no page.",
)  # fmt: skip
@click.option(
    "--pages", "n_pages", metavar="N", type=click.IntRange(0, 10_000), default=0,
    help="Number of gaits whose own pages are written too, the fastest gaits that pass first, as "
    "by mgs report; about 1 MB each. The page of the library links to them. Default: 0.",
)  # fmt: skip
@force_option
@json_option
@click.pass_context
def report(
    ctx: click.Context,
    folder: Path,
    output: Path | None,
    n_pages: int,
    force: bool,
    as_json: bool,
) -> None:
    """Print a summary of a library and verify its motion files; write its page.

    The summary has the number of gaits by verdict and by reason, the ranges of the figures of the
    gaits that pass, and the share of passes for each value of the sweep. Every motion file is
    compared with its content hash. Exit code 1 if a file is damaged or missing.

    \b
    Examples:
      mgs library report outputs/speeds
      mgs library report outputs/speeds -o speeds.html --pages 20
    """  # noqa: D301
    from mgs.library import query as look

    if n_pages and output is None:
        raise click.UsageError("--pages needs -o FILE.html, the page that links to them")
    if output is None:
        found = look.report(folder)
    else:
        from mgs.report.page.library import write_library_page

        with progress_bars() as tell:
            found = write_library_page(folder, output, n_pages, force=force, progress=tell)
    if as_json:
        print_json(found)
    else:
        _print_report(found)
        if output is not None:
            say(f"{click.format_filename(str(output))}: open it in a web browser")
    ctx.exit(1 if found["damaged_files"] else 0)


def _export_motions(
    folder: Path,
    output: Path | None,
    conversion: tuple[str, Choice, bool],
    where: str | None,
    grid: bool,
    resume: bool,
    as_json: bool,
) -> int:
    """Write the motions of a library and tell what became of them; gives the exit code."""
    from mgs.library.export_motions import Conversion, export_motions

    motions, choice, as_cycle = conversion
    out = output or folder.with_name(f"{folder.resolve().name}-{motions}")
    chosen = Conversion(
        motions, choice.options(motions), choice.fps, as_cycle, choice.unit, choice.feed_forward
    )
    summary = with_progress(
        "motions",
        lambda bar: export_motions(
            folder, out, chosen, where, resume=resume, grid=grid, progress=bar
        ),
    )
    if as_json:
        print_json({"folder": str(out), "format": motions, **asdict(summary)})
        return 0 if summary.is_whole else 1
    kept = f", {summary.kept} kept" if summary.kept else ""
    say(f"{click.format_filename(str(out))}: {summary.written} motions written{kept}")
    for number, message in list(summary.failed.items())[:MOST_VALUES]:
        say(f"  gait {number}: {message}")
    if (more := len(summary.failed) - MOST_VALUES) > 0:
        say(f"  and {more} more")
    if summary.grid is not None:
        x, y, w = summary.grid
        say(f"  grid of {x} x {y} x {w} velocities: {len(summary.missing)} are missing")
        for title, found in (("missing", summary.missing), ("several", summary.double)):
            for vx, vy, wz in found[:MOST_VALUES]:
                say(f"  {title}: vx {vx:g}, vy {vy:g} m/s, wz {wz:g} rad/s")
    return 0 if summary.is_whole else 1


def _names(columns: str) -> list[str]:
    return [name.strip() for name in columns.split(",")]


def _print(table: Table) -> None:
    """Print the columns side by side, each as wide as its widest cell."""
    cells = [list(table.columns), *([_cell(value) for value in row] for row in table.rows)]
    widths = [min(40, max(map(len, column))) for column in zip(*cells, strict=True)]
    for line in cells:
        say("  ".join(c.ljust(w) for c, w in zip(line, widths, strict=True)).rstrip())
    say(f"{len(table.rows)} gaits")


def _cell(value: object) -> str:
    if value is None:
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else " ".join(str(value).split())


def _print_report(found: dict[str, Any]) -> None:
    say(
        f"{click.format_filename(found['folder'])}: {found['made']} of {found['gaits']} gaits "
        f"made, physics {found['physics']}, mgs {found['mgs_version']}"
    )
    for verdict, n in found["verdicts"].items():
        say(f"{n:8d}  {verdict}")
    for reason, n in found["reasons"].items():
        say(f"{n:8d}      {reason}")
    say("ranges of the gaits that pass:")
    for name, (low, high) in found["ranges_of_passes"].items():
        if low is not None:
            say(f"  {name:18s} {low:.4g} to {high:.4g}")
    say("number of passes by value:")
    for key, shares in found["passes_by_value"].items():
        if len(shares) <= MOST_VALUES:
            told = ", ".join(f"{_cell(s['value'])}: {s['pass']}/{s['gaits']}" for s in shares)
        else:
            told = f"{len(shares)} values"
        say(f"  {key:24s} {told}")
    damaged = found["damaged_files"]
    if damaged:
        say(f"{len(damaged)} files are damaged or missing, e.g. {damaged[0]}; make them "
                   "again with mgs batch run --resume")  # fmt: skip
    else:
        say("all files are intact")


library.add_command(lookup)
