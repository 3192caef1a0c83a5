"""The plots of one motion as figures; `mgs.plot`."""

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
from mgs.report.motion_plots import MOTION_PLOTS


class Figures(dict[str, Figure]):
    """Figures by name; a notebook shows them one below the other."""

    def __repr__(self) -> str:
        return f"<Figures: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        """All figures as images in the page itself."""
        return "".join(
            f'<img alt="{escape(name)}" src="data:image/png;base64,'
            f'{base64.b64encode(render(figure, "png")).decode()}"/>'
            for name, figure in self.items()
        )

    def save(self, folder: str | Path, fmt: Format = "png", *, force: bool = False) -> list[Path]:
        """Write a file for each figure into a folder; see `save_figures` for the errors."""
        return save_figures(self, Path(folder), fmt, force=force)


def plot(motion: Motion | str | Path, names: str | Iterable[str] | None = None) -> Figures:
    """Draw footsteps, ZMP, CoM and joints of a motion against their limits.

    Args:
        motion: a motion or the path of a motion file.
        names: which plots, keys of `MOTION_PLOTS`; None: all of them.

    Returns:
        The figures by name: `mgs.plot(motion)["above"]` is one, `.save(folder)` writes them.

    Raises:
        ConfigError: there is no plot of that name.
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
    given = read_motion(motion)
    return Figures({name: MOTION_PLOTS[name](given) for name in asked})
