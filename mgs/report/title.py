"""Title line of pictures of a motion: gait, robot, duration and what is known of its verdict."""

from __future__ import annotations

from matplotlib.figure import Figure

from mgs.judge.motion_checks import check_motion
from mgs.motion import Motion
from mgs.report.canvas import INK, TITLE

MOST_NAMES = 2  # of failed checks, so that the line fits on every plot
LONG = 55  # characters of a title that has a note beside it


def title_line(motion: Motion, verdict: str = "") -> str:
    """Gait, robot and duration, and the verdict if it is known."""
    text = f"{motion.gait_name} of {motion.robot.spec.name}, {motion.duration:.1f} s"
    return f"{text}: {verdict}" if verdict else text


def static_verdict(motion: Motion) -> str:
    """Result of the static checks in words, with the names of checks that fail."""
    failed = [check.name for check in check_motion(motion) if not check.ok]
    more = f" and {len(failed) - MOST_NAMES} more" if len(failed) > MOST_NAMES else ""
    return f"fails {', '.join(failed[:MOST_NAMES])}{more}" if failed else "static checks pass"


def add_title(figure: Figure, text: str) -> Figure:
    """Write a title line above left of everything that a figure has; returns the figure.

    A long one is broken before the verdict, since a figure may have a note above right.
    """
    if len(text) > LONG:
        text = ":\n".join(text.rsplit(": ", 1))
    if figure.legends:  # the layout has room for one thing above the axes
        legend = figure.legends[0]
        legend.set_title(text)
        legend.get_title().set(color=INK, fontsize=TITLE + 1.0)
        legend.set_alignment("left")
    else:
        figure.suptitle(text, x=0.01, ha="left", fontsize=TITLE + 1.0, color=INK)
    return figure
