"""Figures of the experiments of Faraji and Ijspeert, similar to figures 1 to 7 of the paper."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.experiments.faraji.runs import (
    BENT_DEG,
    CROUCHES,
    FEW,
    LEAN,
    MANY,
    SQUAT,
    STRETCHED,
    SWAY,
    TILTING,
    TWIST,
    Key,
    Run,
    Study,
    power,
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
    "A_squat",
    "B_heights_and_knees",
    "B_torque",
    "C_heights_and_knees",
    "D_lean",
    "EF_phase_plane",
    "G_power",
    "H_twist",
)
MM = 1e3
LOOKS = {  # colour and line width; wide lines stay visible below others
    "ik1": (ORANGE, 2.6),
    "ik2": (PURPLE, 1.4),
    "ik3": (SKY, 2.2),
    "ik4": (BLACK, 1.5),
    "ik5": (GREEN, 1.2),
}
SPEED_MAX = 4.0  # [rad/s] range of the speed axis


def write_figures(study: Study, folder: Path, *, force: bool) -> list[Path]:
    """Write all figures into a folder."""
    figures = {
        "A_squat": plot_squat(study),
        "B_heights_and_knees": plot_heights_and_knees(study, STRETCHED, (2.0, 5.0)),
        "B_torque": plot_torque(study),
        "C_heights_and_knees": plot_heights_and_knees(study, TILTING, (1.5, 5.5)),
        "D_lean": plot_lean(study),
        "EF_phase_plane": plot_phase_plane(study),
        "G_power": plot_power(study),
        "H_twist": plot_twist(study),
    }
    return save_figures(figures, folder, force=force)


def _methods(n: int) -> list[str]:
    return list(LOOKS) if n == MANY else ["ik2", "ik4", "ik5"]


def _line(run: Run, y: Array, method: str) -> Line:
    colour, width = LOOKS[method]
    return Line(run.times[run.window][: len(y)], y, method, colour, width=width)


def plot_squat(study: Study) -> Figure:
    """Draw task A: CoM error, error of its derivative, and time per solve."""
    panels: list[Panel | None] = []
    rows = ("error [mm]", "derivative error [mm/s]")
    for row in rows:
        for n in (MANY, FEW):
            lines = []
            for method in _methods(n):
                run = study[Key(SQUAT, method, n, "fine")]
                error = run.com_error() if row == rows[0] else run.com_velocity_error()
                lines.append(_line(run, MM * np.linalg.norm(error, axis=1), method))
            title = f"CoM of the squat, n = {n}" if row == rows[0] else ""
            panels.append(Panel(tuple(lines), row, title, xlim=(2.0, 4.0), logarithmic=True))
    for n in (MANY, FEW):
        times = [1e6 * study[Key(SQUAT, m, n, "fine")].seconds_per_solve for m in _methods(n)]
        x = np.array([float(m.removeprefix("ik")) for m in _methods(n)])
        panels.append(
            Panel(
                (Line(x, np.array(times), "", BLACK, "", marker="o"),),
                "mean time [us]",
                "a solve",
                xlabel="method ik",
            )
        )
    return draw_panels(panels, columns=2, height=2.0, caption="dt 0.002 s")


def plot_heights_and_knees(study: Study, gait: str, span: tuple[float, float]) -> Figure:
    """Draw tasks B and C: height of the CoM and knee angles, with n = 15 and n = 3."""
    left, right = study.joint("KneeSag")
    panels: list[Panel | None] = []
    heights, knees = [], []
    for n in (MANY, FEW):
        runs = {m: study[Key(gait, m, n)] for m in _methods(n)}
        some = runs["ik4"]
        wanted = MM * some.stages.motion.com_ref[some.window, 2]
        lines = [_line(r, MM * r.stages.motion.com[r.window, 2], m) for m, r in runs.items()]
        lines.append(Line(some.times[some.window], wanted, "reference", VERMILION, "--", width=1.0))
        heights.append(
            Panel(tuple(lines), "CoM height [mm]", f"{gait}, n = {n}", xlim=span, ylim=(440, 580))
        )
        angles = []
        for m, r in runs.items():
            for j, style in ((left, "-"), (right, ":"))[: 1 if gait == STRETCHED else 2]:
                y = np.degrees(r.joints[r.window, j])
                colour, width = LOOKS[m]
                label = m if style == "-" else ""
                angles.append(Line(r.times[r.window], y, label, colour, style, width=width))
        note = "" if gait == STRETCHED else "dotted: right knee"
        knees.append(Panel(tuple(angles), "knee [deg]", xlim=span, ylim=(-40.0, 100.0), note=note))
    panels += [*heights, *knees]
    return draw_panels(panels, columns=2, height=2.5)


def plot_torque(study: Study) -> Figure:
    """Draw task B: torque of the left knee with gamma = 10 and gamma = 0."""
    knee = study.joint("KneeSag")[0]
    torques, angles = [], []
    for label, variant, colour in (("gamma 10", "", BLACK), ("gamma 0", "gamma 0", VERMILION)):
        run = study[Key(STRETCHED, "ik4", MANY, variant)]
        t = run.times[run.window]
        torques.append(Line(t, run.stages.motion.torque[run.window, knee], label, colour))
        angles.append(Line(t, np.degrees(run.joints[run.window, knee]), label, colour))
    return draw_panels(
        [
            Panel(tuple(torques), "torque [N m]", "left knee, ik4, squat above reach", xlim=(2, 5)),
            Panel(tuple(angles), "angle [deg]", xlim=(2, 5)),
        ],
        height=2.2,
    )


def plot_lean(study: Study) -> Figure:
    """Draw task D: hip and knee angles of ik2 and ik4."""
    panels: list[Panel | None] = []
    for name, joint in (("hip pitch", "HipSag"), ("knee", "KneeSag")):
        j = study.joint(joint)[0]
        runs = {m: study[Key(LEAN, m)] for m in ("ik2", "ik4")}
        lines = tuple(_line(r, np.degrees(r.joints[r.window, j]), m) for m, r in runs.items())
        limit = study.robot.upper[j] if joint == "HipSag" else study.robot.lower[j]
        t = runs["ik4"].times[runs["ik4"].window]
        bound = Line(t, np.full(len(t), np.degrees(limit)), "limit", VERMILION, "--", width=1.0)
        title = "torso leaning +- 50 deg" if joint == "HipSag" else ""
        panels.append(Panel((*lines, bound), f"{name} [deg]", title))
    return draw_panels(panels, height=2.2)


def plot_phase_plane(study: Study) -> Figure:
    """Draw tasks E and F: speed of the left knee over its angle, with the safety region."""
    j = study.joint("KneeSag")[0]
    low, high = study.robot.lower[j], study.robot.upper[j]
    turn = np.linspace(0.0, 2.0 * np.pi, 400)
    x = np.degrees(0.5 * (low + high) + 0.5 * (high - low) * np.cos(turn))
    edge = Line(x, SPEED_MAX * np.sin(turn), "ellipse", VERMILION, "--", width=1.0)
    panels: list[Panel | None] = []
    for title, variant in (
        ("ellipse, gamma 10", ""),
        ("polygon, gamma 10", "polygon"),
        ("ellipse, gamma 0", "gamma 0"),
    ):
        run = study[Key(STRETCHED, "ik4", MANY, variant)]
        angle, speed = run.joints[run.window, j], run.speeds()[:, j]
        path = Line(np.degrees(angle[1:]), speed, "left knee, ik4", BLACK, width=1.0)
        panels.append(
            Panel((edge, path), "speed [rad/s]", title, xlabel="angle [deg]", xlim=(-5.0, 115.0))
        )
    return draw_panels(panels, columns=3, height=3.0, width=11.0)


def plot_power(study: Study) -> Figure:
    """Draw task G: both measures of power over the CoM height reference."""
    quiet = np.array(power(study[Key(SWAY, "ik4", FEW, "quiet")]))
    values = np.array([power(study[Key(SWAY, "ik4", FEW, f"{h:g}")]) for h in CROUCHES]) - quiet
    x = MM * np.array(CROUCHES)
    xlabel = "CoM height reference relative to z_max [mm]"
    return draw_panels(
        [
            Panel(
                (Line(x, values[:, i], "", BLUE, "-", marker="o"),),
                unit,
                title,
                xlabel=xlabel,
            )
            for i, (title, unit) in enumerate(
                (
                    ("sway with twist: sum |tau qdot|", "mean [W]"),
                    ("sum tau^2; standing still subtracted", "mean [(N m)^2]"),
                )
            )
        ],
        columns=2,
        height=2.6,
    )


def plot_twist(study: Study) -> Figure:
    """Draw task H: angles of both knees."""
    panels: list[Panel | None] = []
    for i, side in enumerate(("left", "right")):
        j = study.joint("KneeSag")[i]
        lines = []
        for method in ("ik1", "ik3", "ik4"):
            run = study[Key(TWIST, method)]
            lines.append(_line(run, np.degrees(run.joints[run.window, j]), method))
        title = "torso yaw +- 45 deg, CoM reference above reach" if i == 0 else ""
        panels.append(Panel(tuple(lines), f"{side} knee [deg]", title, ylim=(-BENT_DEG, BENT_DEG)))
    return draw_panels(panels, height=2.2)
