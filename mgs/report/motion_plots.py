"""All plots of a motion, as written by `mgs plot`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from matplotlib.figure import Figure

from mgs.core.progress import Progress
from mgs.motion import Motion
from mgs.report.balance import plot_balance
from mgs.report.canvas import Format, figure_paths, save_figures
from mgs.report.ground import plot_above
from mgs.report.joints import plot_positions, plot_torques, plot_velocities
from mgs.report.title import add_title, static_verdict, title_line

MOTION_PLOTS: dict[str, Callable[[Motion], Figure]] = {
    "above": plot_above,
    "balance": plot_balance,
    "joint_positions": plot_positions,
    "joint_velocities": plot_velocities,
    "joint_torques": plot_torques,
}


def draw_plots(motion: Motion, names: Iterable[str]) -> Iterator[tuple[str, Figure]]:
    """Draw plots one after the other, each with gait, robot and static verdict above it.

    Args:
        motion: motion to plot.
        names: keys of `MOTION_PLOTS`.
    """
    title = title_line(motion, static_verdict(motion))
    for name in names:
        yield name, add_title(MOTION_PLOTS[name](motion), title)


def plot_motion(
    motion: Motion,
    folder: Path,
    fmt: Format = "png",
    *,
    force: bool = False,
    progress: Progress | None = None,
) -> list[Path]:
    """Write all plots of a motion into a folder.

    Args:
        motion: motion to plot.
        folder: folder for the files, created if missing; one file per entry of `MOTION_PLOTS`.
        fmt: file format, png or svg.
        force: replace existing files.
        progress: function that is called with the number of written plots and of all plots.

    Returns:
        Paths of the files.

    Raises:
        OutputExistsError: a file exists and `force` is False; then nothing is written.
        MgsError: a file cannot be written.
    """
    figure_paths(folder, MOTION_PLOTS, fmt, force=force)
    paths = []
    for name, figure in draw_plots(motion, MOTION_PLOTS):
        paths += save_figures({name: figure}, folder, fmt, force=force)
        if progress is not None:
            progress(len(paths), len(MOTION_PLOTS))
    return paths
