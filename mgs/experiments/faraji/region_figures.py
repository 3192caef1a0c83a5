"""Figures 5 and 6 of Faraji and Ijspeert: safety region, gamma, and the current of the knee."""

from __future__ import annotations

import numpy as np

from mgs.experiments.faraji.electric import current_of_joints
from mgs.experiments.faraji.runs import MANY, STRETCHED, Key, Run, Study
from mgs.report.canvas import BLACK, BLUE, ORANGE, VERMILION, Figure
from mgs.report.panels import Line, Panel, draw_panels

SPEED_MAX = 4.0  # [rad/s] of the ellipse
SPAN = (1.5, 3.5)  # [s] range of the time axes
VARIANTS = (  # label, key of the variant, colour and width
    ("ellipse, gamma 10", "", BLACK, 2.2),
    ("polygon, gamma 10", "polygon", BLUE, 1.2),
    ("ellipse, gamma 0", "gamma 0", ORANGE, 1.4),
)
MM = 1e3


def _runs(study: Study) -> list[tuple[str, Run, str, float]]:
    return [
        (label, study[Key(STRETCHED, "ik4", MANY, variant)], colour, width)
        for label, variant, colour, width in VARIANTS
    ]


def plot_region(study: Study) -> Figure:
    """Draw figure 5: CoM heights (A), their excerpt at an escape (B) and phase planes (C)."""
    j = study.joint("KneeSag")[0]
    heights = []
    for label, run, colour, width in _runs(study):
        t, z = run.times[run.window], MM * run.stages.motion.com[run.window, 2]
        heights.append(Line(t, z, label, colour, width=width))
    run = study[Key(STRETCHED, "ik4")]
    wanted = MM * run.stages.motion.com_ref[run.window, 2]
    heights.append(Line(run.times[run.window], wanted, "reference", VERMILION, "--", width=1.0))
    low, high = study.robot.lower[j], study.robot.upper[j]
    turn = np.linspace(0.0, 2.0 * np.pi, 400)
    x = np.degrees(0.5 * (low + high) + 0.5 * (high - low) * np.cos(turn))
    edge = Line(x, SPEED_MAX * np.sin(turn), "ellipse", VERMILION, "--", width=1.0)
    panels: list[Panel | None] = [
        Panel(tuple(heights), "CoM height [mm]", "Fig. 5A: squat above reach, ik4", xlim=SPAN),
        Panel(tuple(heights), "CoM height [mm]", "Fig. 5B: leaving", xlim=(2.3, 2.8)),
        None,
    ]
    for label, run, _, _ in _runs(study):
        angle, speed = run.joints[run.window, j], run.speeds()[:, j]
        path = Line(np.degrees(angle[1:]), speed, "left knee", BLACK, width=1.0)
        panels.append(
            Panel(
                (edge, path),
                "speed [rad/s]",
                f"Fig. 5C: {label}",
                xlabel="angle [deg]",
                xlim=(-5.0, 115.0),
            )
        )
    return draw_panels(panels, columns=3, height=2.8, width=12.0)


def plot_current(study: Study) -> Figure:
    """Draw figure 6: speed, current and torque of the left knee with gamma 10 and gamma 0."""
    j = study.joint("KneeSag")[0]
    rows: dict[str, list[Line]] = {"speed [rad/s]": [], "current [A]": [], "torque [N m]": []}
    for label, variant, colour in (("gamma 0", "gamma 0", VERMILION), ("gamma 10", "", BLACK)):
        run = study[Key(STRETCHED, "ik4", MANY, variant)]
        t = run.times[run.window]
        found = {
            "speed [rad/s]": np.append(run.speeds()[:, j], np.nan),
            "current [A]": current_of_joints(study.robot, run)[:, j],
            "torque [N m]": run.stages.motion.torque[run.window, j],
        }
        for name, y in found.items():
            rows[name].append(Line(t, y, label, colour, width=1.3))
    title = (
        "Fig. 6: left knee, squat above reach, ik4; motor model, negative current: power flows back"
    )
    panels: list[Panel | None] = [
        Panel(tuple(lines), name, title if i == 0 else "", xlim=SPAN)
        for i, (name, lines) in enumerate(rows.items())
    ]
    return draw_panels(panels, height=2.0)
