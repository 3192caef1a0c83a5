"""Figures 3 to 10 of the article on Melson, from our runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.experiments.melson.drift_claims import DRIFT_JOINT, drift_series
from mgs.experiments.melson.runs import Study, Walk, peak
from mgs.gait import WalkGait
from mgs.report.canvas import BLACK, SKY, VERMILION, Figure, save_figures
from mgs.report.panels import Line, Panel, draw_panels, shade_single_support
from mgs.report.poses import Pose, plot_poses
from mgs.report.robot_drawing import FRONT, RIGHT_SIDE

JOINTS = {3: "hip_roll", 4: "knee_pitch", 5: "ankle_roll"}  # by number of the figure
STRIPS = {6: "S1", 7: "S2", 8: "S3"}
NAMES = (*(f"figure_{number}" for number in range(3, 11)), "every_support")
LOOKS = {"S1": ("0.65", 3.4), "S2": (SKY, 2.2), "S3": (VERMILION, 1.2)}  # colour, line width
DRIFT_LOOKS = {"S1": (VERMILION, "o"), "S2": (BLACK, "s")}
SNAPSHOTS = 8  # poses in a strip


def write_figures(study: Study, folder: Path, *, force: bool) -> list[Path]:
    """Write all figures into a folder."""
    figures = {f"figure_{number}": plot_joint(study, number) for number in JOINTS}
    figures |= {f"figure_{number}": plot_strip(study, number) for number in STRIPS}
    figures |= {"figure_9": plot_end_poses(study), "figure_10": plot_drift(study)}
    figures["every_support"] = plot_every_support(study)
    return save_figures(figures, folder, force=force, few_colours=True)


def gains_of(walk: Walk) -> str:
    """Gains of the null-space motion of a run."""
    gait = walk.stages.motion.gait
    assert isinstance(gait, WalkGait)
    ik = gait.ik
    return f"gamma_joint {ik.gamma_joint:g}, gamma_grav {ik.gamma_grav:g}"


def plot_joint(study: Study, number: int) -> Figure:
    """Draw torque and position of a joint of the left leg, as figures 3 to 5 do."""
    joint = JOINTS[number]
    first = study.short["S1"]
    t, i = first.stages.motion.times, first.column(Side.LEFT, joint)
    shades = shade_single_support(t, first.stages.tasks.support)

    def lines(series: dict[str, Array]) -> tuple[Line, ...]:
        return tuple(
            Line(t, series[name], name, colour, width=width)  # wide lines stay visible below others
            for name, (colour, width) in LOOKS.items()
        )

    torques = {name: walk.gravity[:, i] for name, walk in study.short.items()}
    whole = {name: walk.stages.motion.torque[:, i] for name, walk in study.short.items()}
    angles = {name: walk.angles[:, i] for name, walk in study.short.items()}
    panels = [
        Panel(lines(torques), "torque [N m]", "gravity torque in single support", shades=shades),
        Panel(lines(whole), "torque [N m]", "torque by inverse dynamics", shades=shades),
        Panel(lines(angles), "angle [deg]", "position", shades=shades),
    ]
    title = f"left {joint.replace('_', ' ')}"
    return draw_panels(panels, height=1.9, caption=f"as Fig. {number} of the article: {title}")


def plot_strip(study: Study, number: int) -> Figure:
    """Draw snapshots of one scenario from the side and the front, as figures 6 to 8 do."""
    walk = study.short[STRIPS[number]]
    motion = walk.stages.motion
    samples = np.linspace(0, motion.n_samples - 1, SNAPSHOTS).round().astype(int)
    poses = [
        Pose(motion.q[k], view, f"{motion.times[k]:.1f} s" if view is RIGHT_SIDE else "")
        for view in (RIGHT_SIDE, FRONT)
        for k in samples
    ]
    caption = f"as Fig. {number} of the article: scenario {STRIPS[number]}, {gains_of(walk)}"
    return plot_poses(
        study.robot,
        poses,
        columns=SNAPSHOTS,
        rows=("from the right", "from the front"),
        caption=caption,
    )


def plot_every_support(study: Study) -> Figure:
    """Draw the peak torques of the support leg in each phase of the walk of eight steps."""
    panels = []
    for joint in (JOINTS[3], JOINTS[4]):
        lines = []
        for name, walk in study.longer.items():
            peaks = [
                peak(walk.gravity[samples, walk.column(side, joint)])
                for side, samples in walk.supports
            ]
            phases = np.arange(1.0, len(peaks) + 1.0)
            colour, width = LOOKS[name]
            lines.append(Line(phases, np.array(peaks), name, colour, width=width, marker="o"))
        title = f"{joint.replace('_', ' ')} of the support leg"
        xlabel = "single support phase; odd: left, even: right"
        panels.append(Panel(tuple(lines), "peak of the gravity torque [N m]", title, xlabel=xlabel))
    return draw_panels(panels, columns=2, height=3.0, caption="walk of eight steps; ours")


def plot_end_poses(study: Study) -> Figure:
    """Draw the first and the last pose of the long walk for both gains, as figure 9 does."""
    poses = [
        Pose(
            walk.stages.motion.q[-1],
            view,
            gains_of(walk).split(",")[0],
            "from the front" if view is FRONT else "from the right",
            ghost=walk.stages.motion.q[0],
        )
        for walk in study.long.values()
        for view in (FRONT, RIGHT_SIDE)
    ]
    caption = "as Fig. 9 of the article: last pose after 30 steps; dashed: first pose"
    return plot_poses(study.robot, poses, columns=4, caption=caption)


def plot_drift(study: Study) -> Figure:
    """Draw the drifting joint over the whole walk, as figure 10 does, and once in every stride."""
    i = study.robot.joint_names.index(DRIFT_JOINT)
    series = drift_series(study)
    traces, samples = [], []
    for name, walk in study.long.items():
        colour, marker = DRIFT_LOOKS[name]
        label = gains_of(walk).split(",")[0]
        traces.append(Line(walk.stages.motion.times, walk.angles[:, i], label, colour, width=1.0))
        steps = 2.0 * np.arange(len(series[name]))
        samples.append(Line(steps, series[name], label, colour, marker=marker))
    bounds = np.concatenate([line.y[1:] for line in samples])
    margin = 0.15 * float(np.ptp(bounds))
    return draw_panels(
        [
            Panel(tuple(traces), "angle [deg]", "whole walk"),
            Panel(
                tuple(samples),
                "angle [deg]",
                "at the start of each left single support",
                note="first sample outside the axes",
                xlabel="number of steps",
                ylim=(float(bounds.min()) - margin, float(bounds.max()) + margin),
            ),
        ],
        height=2.5,
        caption=f"as Fig. 10 of the article: {DRIFT_JOINT.replace('_', ' ')}",
    )
