"""Figures 6 to 9 of Mistry et al., from the plan and from physics, and two of our own."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.experiments.mistry.measures import hand_errors
from mgs.experiments.mistry.physics import Played
from mgs.experiments.mistry.runs import (
    EIGHT,
    EQUATION_7,
    EQUATION_16,
    FOOTNOTE_3,
    PROJECTED,
    SWAY,
    TRACKING,
    VELOCITY,
    WALK,
    Key,
    Study,
)
from mgs.motion import Motion
from mgs.report.canvas import BLACK, BLUE, GREEN, ORANGE, SKY, VERMILION, Figure, save_figures
from mgs.report.panels import Line, Panel, draw_panels, shade_single_support

NAMES = (
    "fig6_cog",
    "fig7_hand_series",
    "fig8_hand_plane",
    "fig9_cog_of_hand",
    "hand_errors",
    "switches",
)
MM = 1e3
LOOKS = {
    EQUATION_16: (VERMILION, 1.6),
    FOOTNOTE_3: (ORANGE, 1.0),
    TRACKING: (SKY, 2.4),
    EQUATION_7: (BLACK, 1.0),
}
PLAN, PHYSICS = "plan, eq. (16)", "physics, servos of robot.yaml"


def write_figures(study: Study, folder: Path, *, force: bool) -> list[Path]:
    """Write all figures into a folder."""
    figures = {
        "fig6_cog": plot_cog(study, SWAY, "Fig. 6: CoG of the sway"),
        "fig7_hand_series": plot_hand_series(study),
        "fig8_hand_plane": plot_hand_plane(study),
        "fig9_cog_of_hand": plot_cog(study, EIGHT, "Fig. 9: CoG during the figure eight"),
        "hand_errors": plot_errors(study),
        "switches": plot_switches(study),
    }
    return save_figures(figures, folder, force=force)


def _series(motion: Motion, wanted: Array, planned: Array, played: Played, y: Array) -> list[Line]:
    """Curves (N,) [m] of reference, plan and physics."""
    return [
        Line(motion.times, MM * wanted, "target", GREEN, width=3.0),
        Line(motion.times, MM * planned, PLAN, BLACK, "--", width=1.2),
        Line(played.times, MM * y, PHYSICS, BLUE, width=1.2),
    ]


def plot_cog(study: Study, gait: str, title: str) -> Figure:
    """Draw figures 6 and 9: horizontal CoG over time, and from above."""
    motion, played = study[Key(gait)].motion, study.played[gait]
    panels: list[Panel | None] = []
    for axis, name in ((1, "left-right y [mm]"), (0, "front-back x [mm]")):
        wanted, planned = motion.com_ref[:, axis], motion.com[:, axis]
        lines = _series(motion, wanted, planned, played, played.com[:, axis])
        middle = MM * float(wanted.mean())
        ylim = (middle - 30.0, middle + 30.0) if gait == SWAY else (middle - 5.0, middle + 5.0)
        panels.append(Panel(tuple(lines), name, title if axis == 1 else "", ylim=ylim))
    target = MM * motion.com_ref
    marker = "" if gait == SWAY else "o"  # a target at rest is one point
    above = (
        Line(target[:, 1], target[:, 0], "target", GREEN, width=3.0, marker=marker),
        Line(MM * played.com[:, 1], MM * played.com[:, 0], PHYSICS, BLUE, width=1.2),
    )
    middle = MM * float(motion.com_ref[:, 0].mean())
    side = 30.0 if gait == SWAY else 5.0
    panels.append(
        Panel(
            above,
            "x [mm]",
            "from above",
            xlabel="y [mm]",
            xlim=(-side, side),
            ylim=(middle - 5.0, middle + 5.0),
        )
    )
    return draw_panels(panels, height=2.2)


def plot_hand_series(study: Study) -> Figure:
    """Draw figure 7: position of the right hand over time."""
    motion, played = study[Key(EIGHT)].motion, study.played[EIGHT]
    panels: list[Panel | None] = []
    for axis, name in ((1, "left-right y [mm]"), (2, "vertical z [mm]")):
        wanted = motion.hands_ref[:, Side.RIGHT, axis]
        planned = motion.hands[:, Side.RIGHT, axis]
        lines = _series(motion, wanted, planned, played, played.hand[:, axis])
        panels.append(Panel(tuple(lines), name, "Fig. 7: right hand" if axis == 1 else ""))
    return draw_panels(panels, height=2.4)


def plot_hand_plane(study: Study) -> Figure:
    """Draw figure 8: the figure eight in the frontal plane, from plan and physics."""
    motion, played = study[Key(EIGHT)].motion, study.played[EIGHT]
    tracked = study[Key(EIGHT, VELOCITY, TRACKING)].motion
    wanted = MM * motion.hands_ref[:, Side.RIGHT]
    target = Line(wanted[:, 1], wanted[:, 2], "target", GREEN, width=3.0)
    (_, left, low), (_, right, high) = wanted.min(axis=0) - 5.0, wanted.max(axis=0) + 5.0
    panels: list[Panel | None] = []
    for label, hand, colour in (
        (PLAN, motion.hands[:, Side.RIGHT], VERMILION),
        (PHYSICS, played.hand, BLUE),
        ("plan, tracking form", tracked.hands[:, Side.RIGHT], SKY),
    ):
        line = Line(MM * hand[:, 1], MM * hand[:, 2], label, colour, width=1.4)
        panels.append(
            Panel(
                (target, line),
                "z [mm]",
                "Fig. 8: right hand",
                xlabel="y [mm]",
                xlim=(left, right),
                ylim=(low, high),
                equal=True,
            )
        )
    return draw_panels(panels, columns=3, height=3.2, width=11.0)


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
            Panel(tuple(hands), "error [mm]", "right hand, plan", logarithmic=True),
            Panel(tuple(coms), "error [mm]", "CoM, horizontal, plan", logarithmic=True),
        ],
        height=2.2,
    )


def plot_switches(study: Study) -> Figure:
    """Draw the joint accelerations of a walk with and without handover."""
    lines = []
    for label, form, variant, colour in (
        ("eq. (16)", EQUATION_16, "", VERMILION),
        ("projected, no handover", PROJECTED, "no handover", ORANGE),
        ("projected, handover", PROJECTED, "", BLACK),
    ):
        stages = study[Key(WALK, VELOCITY, form, variant)]
        dt, t = stages.tasks.dt, stages.motion.times
        largest = np.abs(np.diff(stages.joints.angles, 2, axis=0)).max(axis=1) / dt**2
        lines.append(Line(t[1:-1], largest, label, colour, width=1.2))
    stages = study[Key(WALK, VELOCITY, TRACKING)]
    shades = shade_single_support(stages.motion.times, stages.tasks.support)
    title = "largest joint acceleration of a walk (II-B: discontinuities at switches)"
    return draw_panels([Panel(tuple(lines), "[rad/s^2]", title, shades=shades)], height=2.6)
