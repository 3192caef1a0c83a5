"""Plots of a motion as figure objects, for `mgs.plot`."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape
from pathlib import Path

from matplotlib.figure import Figure

from mgs.core.errors import ConfigError
from mgs.core.wrong_type import wrong_type
from mgs.motion import Motion
from mgs.motion_file import read_motion
from mgs.report.canvas import Format, render, save_figures
from mgs.report.motion_plots import MOTION_PLOTS, draw_plots


class Figures(dict[str, Figure]):
    """Figures by name; a notebook displays all of them."""

    def __repr__(self) -> str:
        return f"<Figures: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        """HTML with all figures as embedded images."""
        return "".join(
            f'<img alt="{escape(name)}" src="data:image/png;base64,'
            f'{base64.b64encode(render(figure, "png")).decode()}"/>'
            for name, figure in self.items()
        )

    def save(self, folder: str | Path, fmt: Format = "png", *, force: bool = False) -> list[Path]:
        """Write each figure into a folder; see `save_figures` for the errors."""
        return save_figures(self, Path(folder), fmt, force=force)


def plot(motion: Motion | str | Path, names: str | Iterable[str] | None = None) -> Figures:
    """Draw footsteps, ZMP, CoM and joints of a motion with their limits.

    Args:
        motion: motion, or path of a motion file.
        names: names of plots, keys of `MOTION_PLOTS`; None: all plots.

    Returns:
        Figures by name, e.g. `mgs.plot(motion)["above"]`; `.save(folder)` writes all of them.

    Raises:
        ConfigError: there is no plot with that name.
        MotionFileError: the motion file is missing or damaged.
        TypeError: an argument has a wrong type.
    """
    known = ", ".join(MOTION_PLOTS)
    if not isinstance(names, Iterable | None):
        raise wrong_type("names", f"one or more of {known}", names)
    asked = [names] if isinstance(names, str) else list(MOTION_PLOTS if names is None else names)
    for name in asked:
        if name not in MOTION_PLOTS:
            raise ConfigError("names", f"{name!r} is not a plot; use {known}")
    return Figures(draw_plots(read_motion(motion), asked))
