"""Figures of the experiments of Mistry et al., similar to figures 6 to 9 of the paper."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.contact import Side
from mgs.experiments.mistry.runs import (
    EIGHT,
    PROJECTED,
    SWAY,
    TRACKING,
    VELOCITY,
    WALK,
    Key,
    Study,
    hand_errors,
)
from mgs.report.canvas import BLACK, GREEN, SKY, VERMILION, Figure, save_figures
from mgs.report.panels import Line, Panel, draw_panels, shade_single_support

NAMES = ("sway", "hand_eight", "hand_errors", "handover")
MM = 1e3
LOOKS = {TRACKING: (SKY, 2.4), PROJECTED: (VERMILION, 1.4)}


def write_figures(study: Study, folder: Path, *, force: bool) -> list[Path]:
    """Write all figures into a folder."""
    figures = {
        "sway": plot_sway(study),
        "hand_eight": plot_eight(study),
        "hand_errors": plot_errors(study),
        "handover": plot_handover(study),
    }
    return save_figures(figures, folder, force=force)


def plot_sway(study: Study) -> Figure:
    """Draw the horizontal CoM and its reference."""
    motion = study[Key(SWAY)].motion
    t = motion.times
    panels: list[Panel | None] = []
    for axis, name in ((1, "side to side"), (0, "fore and aft")):
        lines = (
            Line(t, MM * motion.com_ref[:, axis], "reference", GREEN, width=3.0),
            Line(t, MM * motion.com[:, axis], "reached", BLACK, "--", width=1.2),
        )
        middle = MM * float(motion.com_ref[:, axis].mean())
        ylim = (middle - 30.0, middle + 30.0)
        panels.append(Panel(lines, f"{name} [mm]", "CoM" if axis == 1 else "", ylim=ylim))
    return draw_panels(panels, height=2.2)


def plot_eight(study: Study) -> Figure:
    """Draw the figure eight in the frontal plane, for both null-space forms."""
    panels: list[Panel | None] = []
    for form, (colour, width) in LOOKS.items():
        motion = study[Key(EIGHT, VELOCITY, form)].motion
        asked = MM * motion.hands_ref[:, Side.RIGHT]
        reached = MM * motion.hands[:, Side.RIGHT]
        lines = (
            Line(asked[:, 1], asked[:, 2], "reference", GREEN, width=3.0),
            Line(reached[:, 1], reached[:, 2], form, colour, width=width),
        )
        panels.append(
            Panel(lines, "z [mm]", f"right hand, {form} form", xlabel="y [mm]", equal=True)
        )
    return draw_panels(panels, columns=2, height=3.2)


def plot_errors(study: Study) -> Figure:
    """Draw the errors of hand and CoM over time."""
    hands, coms = [], []
    for form, (colour, width) in LOOKS.items():
        stages = study[Key(EIGHT, VELOCITY, form)]
        motion = stages.motion
        t = motion.times
        floor = 1e-9  # [m] least value on the logarithmic axis
        error = np.linalg.norm((motion.com - motion.com_ref)[:, :2], axis=1)
        hands.append(
            Line(t, MM * np.maximum(hand_errors(stages), floor), form, colour, width=width)
        )
        coms.append(Line(t, MM * np.maximum(error, floor), form, colour, width=width))
    return draw_panels(
        [
            Panel(tuple(hands), "error [mm]", "right hand", logarithmic=True),
            Panel(tuple(coms), "error [mm]", "CoM, horizontal", logarithmic=True),
        ],
        height=2.2,
    )


def plot_handover(study: Study) -> Figure:
    """Draw the joint accelerations of a walk with and without handover."""
    lines = []
    for label, variant, colour in (("handover", "", BLACK), ("none", "no handover", VERMILION)):
        stages = study[Key(WALK, VELOCITY, PROJECTED, variant)]
        dt, t = stages.tasks.dt, stages.motion.times
        largest = np.abs(np.diff(stages.joints.angles, 2, axis=0)).max(axis=1) / dt**2
        lines.append(Line(t[1:-1], largest, label, colour, width=1.2))
    stages = study[Key(WALK)]
    shades = shade_single_support(stages.motion.times, stages.tasks.support)
    title = "largest joint acceleration of a walk, projected form"
    return draw_panels([Panel(tuple(lines), "[rad/s^2]", title, shades=shades)], height=2.6)
