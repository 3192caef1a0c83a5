"""Common style of all figures, and atomic writing of their files.

Only the objects of matplotlib are used: no pyplot, no global state, no display.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Literal

import matplotlib as mpl
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Figure
from matplotlib.text import Text
from PIL import Image  # installed with matplotlib

from mgs.core.atomic_files import refuse_taken, replace_file
from mgs.core.contact import Side

Format = Literal["png", "svg"]

# M. Okabe and K. Ito, "Color Universal Design", 2008: distinguishable with any colour vision.
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"
SIDE_COLOURS = {Side.LEFT: BLUE, Side.RIGHT: VERMILION}
INK, FAINT, GRID = "0.15", "0.55", "0.91"

DPI = 130
TITLE, LABEL, TICK = 9.5, 9.0, 8.0  # font sizes [pt]


class ShownFigure(Figure):
    """Figure that a notebook displays without pyplot and magic commands."""

    def _repr_png_(self) -> bytes:
        """PNG picture of the figure, for notebooks."""
        return render(self, "png")


def new_figure(width: float, height: float) -> Figure:
    """Create an empty figure of a given size [inch] with constrained layout."""
    return ShownFigure(figsize=(width, height), dpi=DPI, layout="constrained", facecolor="white")


def style_axes(
    axes: Axes, *, title: str = "", note: str = "", xlabel: str = "", ylabel: str = ""
) -> None:
    """Style frame and grid of axes; write `title` above left and `note` above right."""
    axes.set_title(title, loc="left", fontsize=TITLE, color=INK)
    axes.set_title(note, loc="right", fontsize=TICK, color=FAINT)
    axes.set_xlabel(xlabel, fontsize=LABEL, color=INK)
    axes.set_ylabel(ylabel, fontsize=LABEL, color=INK)
    axes.tick_params(labelsize=TICK, colors=INK, length=3, width=0.6)
    axes.grid(True, color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    for name, spine in axes.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(FAINT)


def legend_above(figure: Figure, axes: Iterable[Axes], *, columns: int = 6) -> None:
    """Draw one legend above all axes, with each label once."""
    entries: dict[str, Artist] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    if entries:
        figure.legend(
            list(entries.values()),
            list(entries),
            loc="outside upper left",
            ncols=columns,
            fontsize=LABEL,
            frameon=False,
            handlelength=1.8,
            columnspacing=1.6,
        )


def figure_paths(folder: Path, names: Iterable[str], fmt: Format, *, force: bool) -> list[Path]:
    """Paths of the files of figures; call this before the work that the figures need.

    Raises:
        OutputExistsError: one of the files exists and `force` is False.
    """
    paths = [Path(folder) / f"{name}.{fmt}" for name in names]
    for path in paths:
        refuse_taken(path, force)
    return paths


def save_figures(
    figures: Mapping[str, Figure],
    folder: Path,
    fmt: Format = "png",
    *,
    force: bool = False,
    few_colours: bool = False,
) -> list[Path]:
    """Write figures into a folder; the same figure gives the same bytes.

    Args:
        figures: figures by name; the name is also the file name without extension.
        folder: folder for the files, created if missing.
        fmt: file format, png or svg.
        force: replace existing files.
        few_colours: write a PNG with a colour palette, which has a third of the size.

    Raises:
        OutputExistsError: a file exists and `force` is False; then nothing is written.
        MgsError: a file cannot be written.
    """
    paths = figure_paths(folder, figures, fmt, force=force)
    for path, figure in zip(paths, figures.values(), strict=True):
        replace_file(path, render(figure, fmt, few_colours))
    return paths


def render(figure: Figure, fmt: Format, few_colours: bool = False) -> bytes:
    """Bytes of the file of a figure; see `save_figures` for the arguments."""
    stream = io.BytesIO()
    # without date, version and random identifiers
    metadata = {"Software": None} if fmt == "png" else {"Date": None, "Creator": None}
    for text in figure.findobj(Text):  # a name with a dollar sign is no formula
        text.set_parse_math("mathdefault" in text.get_text())
    with mpl.rc_context({"svg.hashsalt": "mgs"}):
        figure.savefig(stream, format=fmt, metadata=metadata)
    if few_colours and fmt == "png":
        image = Image.open(stream).convert("RGB")
        # one pass of k-means prevents that pale areas get a neighbouring hue
        image = image.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=1, dither=Image.Dither.NONE)
        stream = io.BytesIO()
        image.save(stream, "png", optimize=True)
    return stream.getvalue()
