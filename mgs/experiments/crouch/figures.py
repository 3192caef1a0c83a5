"""Figures of the crouch experiment."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.experiments.crouch.claims import IN_WORDS
from mgs.experiments.crouch.runs import COMAN, IDENTIFIED, JUDGED, MELSON, MOTIONS, Sweep
from mgs.experiments.crouch.study import Study
from mgs.report.canvas import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, Figure, save_figures
from mgs.report.panels import Line, Panel, draw_panels

NAMES = ("crouch_torque", "crouch_power")
LOOKS = {  # colour and line width; wide lines stay visible below others
    "ik1": (ORANGE, 4.0),
    "ik2": (PURPLE, 3.2),
    "ik3": (SKY, 2.6),
    "clik": (BLUE, 2.0),
    "ik5": (GREEN, 1.5),
    "ik4": (BLACK, 0.9),
}
KNEE = "mean knee angle [deg]"
RANGE = (0.0, 110.0)  # [deg]


def write_figures(study: Study, folder: Path, *, force: bool) -> list[Path]:
    """Write all figures into a folder."""
    figures = {"crouch_torque": plot_torque(study), "crouch_power": plot_power(study)}
    return save_figures(figures, folder, force=force)


def plot_torque(study: Study) -> Figure:
    """Draw the squared torques of COMAN over the knee angle, all methods, one motion a panel."""
    panels = []
    for motion in MOTIONS:
        by_method = {sweep.method: sweep for sweep in study.of(COMAN, motion)}
        lines = []
        for method, (colour, width) in LOOKS.items():
            if method in by_method:
                x, y = _points(by_method[method])
                lines.append(Line(x, y, method, colour, width=width, marker="o"))
        title = f"COMAN, {IN_WORDS[motion]}"
        unit = "sum tau^2 [(N m)^2]"
        panels.append(Panel(tuple(lines), unit, title, xlabel=KNEE, xlim=RANGE))
    return draw_panels(panels, height=2.6)


def plot_power(study: Study) -> Figure:
    """Draw the electric power of Melson with identified servos over the knee angle."""
    lines = []
    for motion, colour in zip(MOTIONS, (GREEN, BLUE, BLACK), strict=True):
        x, y = _points(study[MELSON, motion, JUDGED])
        lines.append(Line(x, y, IN_WORDS[motion], colour, marker="o"))
    title = f"Melson with servos {IDENTIFIED}, {JUDGED}"
    return draw_panels([Panel(tuple(lines), "electric power [W]", title, xlabel=KNEE)], height=3.0)


def _points(sweep: Sweep) -> tuple[np.ndarray, np.ndarray]:
    """Knee angles [deg] and costs of the feasible runs."""
    made = sweep.made
    return np.array([run.knee_deg for run in made]), np.array([run.cost for run in made])
