"""Figures 1 to 7 of Faraji and Ijspeert, and figure 1 of their abstract, from our runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.experiments.faraji.electric import fitted_line
from mgs.experiments.faraji.measures import report_of
from mgs.experiments.faraji.power_claims import crouch_deg, power_above_quiet, sway_runs
from mgs.experiments.faraji.region_figures import plot_current, plot_region
from mgs.experiments.faraji.runs import (
    FEW,
    LEAN,
    MANY,
    SQUAT,
    STRETCHED,
    TILTING,
    TWIST,
    Key,
    Run,
    Study,
)
from mgs.report.canvas import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    Figure,
    save_figures,
)
from mgs.report.panels import Line, Panel, draw_panels

NAMES = (
    "fig1_squat",
    "fig2_singular",
    "fig3_asymmetric",
    "fig4_lean",
    "fig5_region",
    "fig6_current",
    "fig7_power",
    "abstract_fig1_twist",
)
MM, US = 1e3, 1e6
LOOKS = {  # colour and line width; wide lines stay visible below others
    "ik1": (ORANGE, 2.6),
    "ik2": (PURPLE, 1.4),
    "ik3": (SKY, 2.2),
    "ik4": (BLACK, 1.5),
    "ik5": (GREEN, 1.2),
}
FILTER = 0.1  # [s] over which computing times are filtered


def write_figures(study: Study, folder: Path, *, force: bool) -> list[Path]:
    """Write all figures into a folder."""
    figures = {
        "fig1_squat": plot_squat(study),
        "fig2_singular": plot_singular(study, STRETCHED, "2: squat above reach", (1.5, 3.5)),
        "fig3_asymmetric": plot_singular(study, TILTING, "3: with torso roll, pitch", (1.5, 3.5)),
        "fig4_lean": plot_lean(study),
        "fig5_region": plot_region(study),
        "fig6_current": plot_current(study),
        "fig7_power": plot_power(study),
        "abstract_fig1_twist": plot_twist(study),
    }
    return save_figures(figures, folder, force=force)


def _methods(n: int) -> list[str]:
    return list(LOOKS) if n == MANY else ["ik2", "ik4", "ik5"]


def _line(run: Run, y: Array, method: str) -> Line:
    colour, width = LOOKS[method]
    return Line(run.times[run.window][: len(y)], y, method, colour, width=width)


def _times(run: Run, method: str) -> Line:
    """Time of a solve [us] over the samples, as the median of FILTER seconds."""
    seconds = report_of(run).seconds
    half = max(1, round(0.5 * FILTER / run.dt))
    k = np.arange(run.window.start, run.window.stop)
    around = np.clip(k[:, None] + np.arange(-half, half + 1), 0, len(seconds) - 1)
    return _line(run, US * np.median(seconds[around], axis=1), method)


def plot_squat(study: Study) -> Figure:
    """Draw figure 1: CoM error, error of its derivative, and time of a solve."""
    panels: list[Panel | None] = []
    for name in ("error [mm]", "derivative error [mm/s]", "time of a solve [us]"):
        for n in (MANY, FEW):
            lines = []
            for method in _methods(n):
                run = study[Key(SQUAT, method, n, "fine")]
                if name.startswith("time"):
                    lines.append(_times(run, method))
                    continue
                error = run.com_error() if name.startswith("error") else run.com_velocity_error()
                lines.append(_line(run, MM * np.linalg.norm(error, axis=1), method))
            title = f"Fig. 1: squat, n = {n}" if name.startswith("error") else ""
            panels.append(Panel(tuple(lines), name, title, xlim=(1.5, 3.5), logarithmic=True))
    return draw_panels(panels, columns=2, height=2.0, caption="dt 0.002 s; CoM")


def plot_singular(study: Study, gait: str, title: str, span: tuple[float, float]) -> Figure:
    """Draw figures 2 and 3: height of the CoM, knee angles and time of a solve."""
    knees = study.joint("KneeSag")[: 1 if gait == STRETCHED else 2]
    rows: list[list[Panel | None]] = [[], [], []]
    for n in (MANY, FEW):
        runs = {m: study[Key(gait, m, n)] for m in _methods(n)}
        some = runs["ik4"]
        wanted = MM * some.stages.motion.com_ref[some.window, 2]
        heights = [_line(r, MM * r.stages.motion.com[r.window, 2], m) for m, r in runs.items()]
        times = some.times[some.window]
        heights.append(Line(times, wanted, "reference", VERMILION, "--", width=1.0))
        name = f"Fig. {title}, n = {n}"
        rows[0].append(Panel(tuple(heights), "CoM height [mm]", name, xlim=span, ylim=(440, 580)))
        angles = []
        for m, r in runs.items():
            for j, style in zip(knees, ("-", ":"), strict=False):
                y = np.degrees(r.joints[r.window, j])
                colour, width = LOOKS[m]
                label = m if style == "-" else ""
                angles.append(Line(r.times[r.window], y, label, colour, style, width=width))
        note = "" if gait == STRETCHED else "dotted: right knee"
        ylim = (-40.0, 100.0)
        rows[1].append(Panel(tuple(angles), "knee [deg]", xlim=span, ylim=ylim, note=note))
        solves = tuple(_times(r, m) for m, r in runs.items())
        rows[2].append(Panel(solves, "time of a solve [us]", xlim=span, logarithmic=True))
    return draw_panels([p for row in rows for p in row], columns=2, height=2.2)


def plot_lean(study: Study) -> Figure:
    """Draw figure 4: hip and knee angles of ik2, ik3 and ik4."""
    panels: list[Panel | None] = []
    for name, joint in (("hip pitch", "HipSag"), ("knee", "KneeSag")):
        j = study.joint(joint)[0]
        runs = {m: study[Key(LEAN, m)] for m in ("ik2", "ik3", "ik4")}
        lines = tuple(_line(r, np.degrees(r.joints[r.window, j]), m) for m, r in runs.items())
        limit = study.robot.upper[j] if joint == "HipSag" else study.robot.lower[j]
        t = runs["ik4"].times[runs["ik4"].window]
        bound = Line(t, np.full(len(t), np.degrees(limit)), "limit", VERMILION, "--", width=1.0)
        title = "Fig. 4: torso leaning +- 50 deg, Q = I" if joint == "HipSag" else ""
        panels.append(Panel((*lines, bound), f"{name} [deg]", title))
    return draw_panels(panels, height=2.2)


def plot_power(study: Study) -> Figure:
    """Draw figure 7: electric power over the crouch angle that was reached, with a line."""
    runs = sway_runs(study)
    x = np.array([crouch_deg(study, run) for run in runs])
    power = np.array([power_above_quiet(study, run) for run in runs])
    slope, offset, fit = fitted_line(x, power[:, 0])
    ends = np.array([x.min(), x.max()])
    line = Line(ends, slope * ends + offset, f"line, R^2 = {fit:.2f}", VERMILION, "--", width=1.2)
    points = Line(x, power[:, 0], "electric power", BLUE, "", marker="o")
    work = Line(x, power[:, 1], "sum |tau qdot|", GREEN, "", marker="o")
    return draw_panels(
        [
            Panel(
                (points, line, work),
                "mean power [W]",
                "Fig. 7: sway with twist, quiet stance subtracted",
                xlabel="mean knee angle reached [deg]",
            )
        ],
        height=3.2,
    )


def plot_twist(study: Study) -> Figure:
    """Draw figure 1E of the abstract: angles of both knees."""
    panels: list[Panel | None] = []
    for i, side in enumerate(("left", "right")):
        j = study.joint("KneeSag")[i]
        lines = []
        for method in ("ik1", "ik3", "ik4"):
            run = study[Key(TWIST, method)]
            lines.append(_line(run, np.degrees(run.joints[run.window, j]), method))
        title = "FI-abstract Fig. 1E: torso yaw +- 45 deg, CoM above reach" if i == 0 else ""
        panels.append(Panel(tuple(lines), f"{side} knee [deg]", title, ylim=(-15.0, 15.0)))
    return draw_panels(panels, height=2.2)
