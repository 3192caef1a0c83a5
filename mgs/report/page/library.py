"""Page of a gait library: sortable table, scatter, and links to the pages of its gaits."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from urllib.parse import quote

import mgs
from mgs.core.atomic_files import refuse_taken, replace_file
from mgs.core.progress import StepProgress
from mgs.library.manifest import Value
from mgs.library.query import Table, query, report
from mgs.report.page.html import LIBRARY_SCRIPTS, page_html
from mgs.report.page.write import DEFAULT, PageOptions, write_page

FIRST = (
    *("number", "verdict", "reason", "speed", "zmp_margin", "positive_work"),
    *("cost_of_transport", "torque_ratio", "survived"),
)
LEFT_OUT = ("file", "sha256", "bytes", "samples", "message")
UNITS = {
    "dt": "s",
    "duration": "s",
    "distance": "m",
    "distance_x": "m",
    "distance_y": "m",
    "turn": "rad",
    "speed": "m/s",
    "vx": "m/s",
    "vy": "m/s",
    "wz": "rad/s",
    "zmp_margin": "m",
    "joint_margin": "rad",
    "positive_work": "J",
    "torque_squared": "N^2 m^2 s",
    "max_tilt_deg": "deg",
    "position_error": "m",
    "yaw_error_deg": "deg",
    "sole_slip_max": "m",
    "seconds": "s",
}


def write_library_page(
    folder: Path,
    output: Path,
    n_pages: int = 0,
    options: PageOptions = DEFAULT,
    *,
    force: bool = False,
    progress: StepProgress | None = None,
) -> dict[str, Any]:
    """Write the page of a library.

    Args:
        folder: folder of the library.
        output: HTML file to write; pages of gaits are in a folder beside it, named after it.
        n_pages: number of gaits, the fastest ones that pass first, whose pages are written too.
        options: replays and meshes of these pages.
        force: replace existing files.
        progress: called with the name of a step, and work done and work in all of this step.

    Returns:
        The summary of the library, as `mgs.library.query.report` gives it.

    Raises:
        InputError: the folder contains no library.
        OutputExistsError: the file exists and `force` is False.
    """
    refuse_taken(output, force)
    summary = report(folder)
    table = query(folder, order="speed", reverse=True)
    place = {name: i for i, name in enumerate(table.columns)}
    passing = [row for row in table.rows if row[place["verdict"]] == "pass" and row[place["file"]]]
    pages = output.with_name(f"{output.stem}_pages")
    for done, row in enumerate(passing[:n_pages]):
        motion = folder / str(row[place["file"]])
        write_page([motion], _page_of(pages, row[place["number"]]), options, force=True)
        if progress is not None:
            progress("pages", done + 1, min(n_pages, len(passing)))
    title = f"Gait library {folder.resolve().name}"
    data = library_data(table, summary, pages)
    data |= {"kind": "library", "mgs": mgs.__version__, "title": title}
    replace_file(output, page_html(title, data, LIBRARY_SCRIPTS).encode())
    return summary


def library_data(table: Table, summary: dict[str, Any], pages: Path) -> dict[str, Any]:
    """Everything that the page shows; columns without any value are left out."""
    first = [name for name in FIRST if name in table.columns]  # a library may be an old one
    order = [*first, *(name for name in table.columns if name not in FIRST)]
    kept = [
        i
        for i in map(table.columns.index, order)
        if table.columns[i] not in LEFT_OUT and any(row[i] is not None for row in table.rows)
    ]
    number = table.columns.index("number")
    existing = {path.name for path in pages.iterdir()} if pages.is_dir() else set()
    rows: list[list[Value]] = []
    for row in table.rows:
        page = _page_of(pages, row[number])
        link = quote(f"{pages.name}/{page.name}") if page.name in existing else None
        rows.append([*(row[i] for i in kept), link])
    columns = [table.columns[i] for i in kept]
    return {"columns": columns, "units": UNITS, "rows": rows, "facts": _facts(summary)}


def _page_of(pages: Path, number: Value) -> Path:
    return pages / f"{number}.html"


def _facts(summary: dict[str, Any]) -> list[list[str]]:
    verdicts = ", ".join(f"{n} {verdict}" for verdict, n in summary["verdicts"].items())
    reasons = ", ".join(f"{reason} ({n})" for reason, n in summary["reasons"].items())
    damaged = summary["damaged_files"]
    facts = [
        ["Gaits", f"{summary['made']} of {summary['gaits']} made: {verdicts}"],
        ["Reasons", reasons or "none: every gait passes"],
        ["Physics", str(summary["physics"])],
        ["Files", f"{len(damaged)} are damaged or missing" if damaged else "all are intact"],
    ]
    for name, (low, high) in summary["ranges_of_passes"].items():
        if low is not None:
            facts.append([name, f"{low:.4g} to {high:.4g} {UNITS.get(name, '')} (gaits that pass)"])
    return facts
