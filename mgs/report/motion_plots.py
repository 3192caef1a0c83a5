"""All plots of a motion, as written by `mgs plot`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from mgs.core.progress import Progress
from mgs.motion import Motion
from mgs.report.balance import plot_balance
from mgs.report.canvas import Format, figure_paths, save_figures
from mgs.report.ground import plot_above
from mgs.report.joints import plot_positions, plot_torques, plot_velocities

MOTION_PLOTS: dict[str, Callable[[Motion], Figure]] = {
    "above": plot_above,
    "balance": plot_balance,
    "joint_positions": plot_positions,
    "joint_velocities": plot_velocities,
    "joint_torques": plot_torques,
}


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
    for name, plot in MOTION_PLOTS.items():
        paths += save_figures({name: plot(motion)}, folder, fmt, force=force)
        if progress is not None:
            progress(len(paths), len(MOTION_PLOTS))
    return paths
