"""Figures of the preview control study; see the package."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.experiments.preview.design import Design
from mgs.experiments.preview.study import SOFT, STEP_BEFORE, STIFF, Study, follow, stepping
from mgs.gait import ComParameters
from mgs.report.canvas import (
    BLACK,
    BLUE,
    FAINT,
    GREEN,
    ORANGE,
    PURPLE,
    VERMILION,
    Figure,
    save_figures,
)
from mgs.report.panels import Line, Panel, draw_panels

NAMES = ("gains", "preview_windows", "loop", "step", "fast_steps")
WINDOWS = {0.4: VERMILION, 0.8: ORANGE, 1.6: GREEN}  # [s] -> colour
WEIGHTS = {SOFT: (VERMILION, "o"), STIFF: (BLUE, "x")}
MM = 1e3  # of a metre


def write_figures(study: Study, folder: Path, *, force: bool) -> list[Path]:
    """Write all figures into a folder."""
    plots = (plot_gains, plot_windows, plot_loop, plot_step, plot_fast_steps)
    figures = {name: plot(study) for name, plot in zip(NAMES, plots, strict=True)}
    return save_figures(figures, folder, force=force, few_colours=True)


def plot_gains(study: Study) -> Figure:
    """Draw the preview gains of the example of the paper over the time ahead."""
    servo = study.cart.servo
    longer = servo.parameters.model_copy(update={"preview": 2.5})
    G_p = -dataclasses.replace(servo, parameters=longer).gains.G_p
    ahead = np.arange(1, len(G_p) + 1) * servo.dt
    title = "preview gains, CoM height 0.814 m, weight_jerk 1e-6"
    note = "as the figure of the preview gains in the paper"
    line = Line(ahead, G_p, colour=BLUE)
    return draw_panels(
        [Panel((line,), "-G_p [1/s^3]", title, note, xlabel="time ahead [s]")], height=2.6
    )


def plot_windows(study: Study) -> Figure:
    """Draw ZMP and CoM of the example of the paper with the long and the short preview window."""
    reference, panels = study.cart.reference(), []
    t = np.arange(len(reference)) * study.cart.dt
    for axis, name in enumerate(("x", "y")):
        for cart in (study.cart, study.short_cart):
            zmp, com = cart.follow()
            lines = (
                Line(t, com[:, axis], "CoM", PURPLE),
                Line(t, zmp[:, axis], "ZMP", GREEN, width=2.0),
                Line(t, reference[:, axis], "reference", BLACK, "--", width=1.0),
            )
            title = f"preview {cart.preview:g} s" if axis == 0 else ""
            panels.append(Panel(lines, f"{name} [m]", title, xlim=(1.5, 8.0)))
    caption = "as the two figures of the paper with these preview windows; steps are ours"
    return draw_panels(panels, columns=2, height=2.4, caption=caption)


def plot_loop(study: Study) -> Figure:
    """Draw the poles of the closed loop, and the preview gains over the time ahead."""
    turn = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 200)
    poles = [Line(np.cos(turn), np.sin(turn), colour=FAINT, style="--", width=0.9)]
    gains = []
    for servo in (study.soft, study.stiff):
        weight = servo.parameters.weight_jerk
        colour, marker = WEIGHTS[weight]
        roots = servo.closed_loop().poles()
        label = f"weight_jerk {weight:g}"
        poles.append(Line(roots.real, roots.imag, label, colour, "", marker=marker))
        G_p = np.abs(servo.gains.G_p)
        ahead = np.arange(1, len(G_p) + 1) * servo.dt
        gains.append(Line(ahead, G_p / G_p.max(), label, colour))
    return draw_panels(
        [
            Panel(
                tuple(poles),
                "imaginary part",
                "poles of the closed loop",
                "dashed: unit circle",
                xlabel="real part",
                xlim=(-0.05, 1.08),
                ylim=(-0.6, 0.6),
                equal=True,
            ),
            Panel(
                tuple(gains),
                "|G_p| / largest |G_p|",
                "preview gains",
                xlabel="time ahead [s]",
                logarithmic=True,
            ),
        ],
        columns=2,
        height=3.6,
    )


def plot_step(study: Study) -> Figure:
    """Draw the response to a step that is known in advance, also with shorter preview windows."""
    t = (np.arange(len(study.step)) - STEP_BEFORE) * study.soft.dt
    reference = Line(t, MM * study.step, "reference", BLACK, "--", width=1.0)
    answer = (
        Line(t, MM * study.com, "CoM", PURPLE, width=2.0),
        Line(t, MM * study.answers[SOFT], "ZMP", GREEN),
        reference,
    )
    shorter = [
        Line(t, MM * _answer(study, window), f"ZMP, window {window:g} s", colour)
        for window, colour in WINDOWS.items()
    ]
    xlabel, xlim = "time from the step [s]", (-1.5, 1.5)
    return draw_panels(
        [
            Panel(
                answer, "x [mm]", "step that is known 1.6 s in advance", xlabel=xlabel, xlim=xlim
            ),
            Panel(
                (*shorter, reference),
                "x [mm]",
                "the same step with shorter preview windows",
                xlabel=xlabel,
                xlim=xlim,
            ),
        ],
        height=2.6,
        caption=f"weight_jerk {SOFT:g}",
    )


def plot_design(design: Design) -> Figure:
    """Draw the poles of the closed loop of a gait's generator, and its step response."""
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    circle = Line(np.cos(turn), np.sin(turn), colour=FAINT, style="--", width=0.9)
    roots = np.array(design.poles)
    poles = Line(roots.real, roots.imag, colour=VERMILION, style="", marker="o")
    step = Line(design.time, (design.time >= 0.0).astype(float), "reference", BLACK, "--")
    answer = (
        Line(design.time, design.com, "CoM", PURPLE, width=2.0),
        Line(design.time, design.zmp, "ZMP", GREEN),
        step,
    )
    response = Panel(
        answer,
        "part of the step",
        "response to a step of the ZMP reference",
        xlabel="time from the step [s]",
        xlim=(-2.0, 2.0),
    )
    caption = f"{design.gait}, generator {design.generator}"
    if not design.poles:
        return draw_panels([response], height=3.4, caption=caption)
    loop = Panel(
        (circle, poles),
        "imaginary part",
        "poles of the closed loop",
        "dashed: unit circle",
        xlabel="real part",
        equal=True,
    )
    return draw_panels([loop, response], columns=2, height=3.6, caption=caption)


def _answer(study: Study, window: float) -> Array:
    """ZMP (N,) [m] in the step response with another preview window [s]."""
    parameters = ComParameters(preview=window, weight_jerk=SOFT)
    return follow(dataclasses.replace(study.soft, parameters=parameters), study.step)[0]


def plot_fast_steps(study: Study) -> Figure:
    """Draw the ZMP on steps of 0.5 s for both weights of the jerk, and its error."""
    window = stepping(study)
    t = np.flatnonzero(window) * study.fast.dt
    reference = study.fast.zmp_ref[window]
    zmps, gaps = [], []
    for weight, (colour, _) in WEIGHTS.items():
        zmp, label = study.fast_zmp[weight][window], f"weight_jerk {weight:g}"
        zmps.append(Line(t, MM * zmp[:, 1], label, colour))
        gaps.append(Line(t, MM * np.linalg.norm(zmp - reference, axis=1), label, colour))
    zmps.append(Line(t, MM * reference[:, 1], "reference", BLACK, "--", width=1.0))
    return draw_panels(
        [
            Panel(tuple(zmps), "y [mm]", "ZMP of the cart-table on steps of 0.5 s"),
            Panel(tuple(gaps), "distance [mm]", "distance of the ZMP from its reference"),
        ],
        height=2.4,
    )
