"""Figures of the Melson experiments, similar to figures 3 to 10 of the article."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.experiments.melson.runs import DRIFT_JOINT, SCENARIOS, Study, angle_of, drift_series
from mgs.report.canvas import BLACK, SKY, VERMILION, Figure, save_figures
from mgs.report.panels import Line, Panel, draw_panels, shade_single_support
from mgs.report.poses import Pose, plot_poses
from mgs.report.robot_drawing import FRONT, RIGHT_SIDE

JOINTS = ("hip_roll", "knee_pitch", "ankle_roll")
NAMES = (*JOINTS, "scenario_poses", "drift", "drift_poses")
LOOKS = {"S1": ("0.65", 3.4), "S2": (SKY, 2.2), "S3": (VERMILION, 1.2)}  # colour, line width
DRIFT_LOOKS = {"gamma_joint 0": (VERMILION, "-", "o"), "gamma_joint 1": (BLACK, "-", "s")}


def write_figures(study: Study, folder: Path, *, force: bool) -> list[Path]:
    """Write all figures into a folder."""
    figures = {joint: plot_joint(study, joint) for joint in JOINTS}
    figures["scenario_poses"] = plot_scenario_poses(study)
    figures["drift"] = plot_drift(study)
    figures["drift_poses"] = plot_drift_poses(study)
    return save_figures(figures, folder, force=force)


def plot_joint(study: Study, joint: str) -> Figure:
    """Draw gravity torque and angle of a joint of the left leg in the three scenarios."""
    tasks = study.scenarios["S1"].tasks
    t = study.scenarios["S1"].motion.times
    shades = shade_single_support(t, tasks.support)
    i = study.robot.joint_names.index(f"left_{joint}")

    def lines(series: dict[str, Array]) -> tuple[Line, ...]:
        return tuple(
            Line(t, series[name], name, colour, width=width)  # wide lines stay visible below others
            for name, (colour, width) in LOOKS.items()
        )

    torques = {name: torque[:, i] for name, torque in study.torques.items()}
    title = f"left {joint.replace('_', ' ')}"
    panels = [
        Panel(lines(torques), "torque [N m]", f"{title}: gravity torque", shades=shades),
        Panel(lines(angle_of(study, joint)), "angle [deg]", f"{title}: angle", shades=shades),
    ]
    gains = ", ".join(f"{k} {gj:g} and {gg:g}" for k, (gj, gg) in SCENARIOS.items())
    return draw_panels(panels, height=2.4, caption=f"gamma_joint and gamma_grav: {gains}")


def plot_scenario_poses(study: Study) -> Figure:
    """Draw each scenario in the middle of both single supports, from the side and the front."""
    support = study.scenarios["S1"].tasks.support
    poses = []
    for view in (RIGHT_SIDE, FRONT):
        for side in Side:
            sample = int(np.median(np.flatnonzero(support == Support.single(side))))
            for name, stages in study.scenarios.items():
                title = f"{name}, {side.label} SSP" if view is RIGHT_SIDE else ""
                poses.append(Pose(stages.motion.q[sample], view, title))
    return plot_poses(study.robot, poses, columns=6, rows=("from the right", "from the front"))


def plot_drift(study: Study) -> Figure:
    """Draw the drifting joint over the whole walk, and at equal phases of the steps."""
    i = study.robot.joint_names.index(DRIFT_JOINT)
    traces, samples = [], []
    for name, stages in study.drift.items():
        colour, style, marker = DRIFT_LOOKS[name]
        angles: Array = np.degrees(stages.joints.angles[:, i])
        traces.append(Line(stages.motion.times, angles, name, colour, style, width=1.0))
        series = drift_series(study)[name]
        steps = 2.0 * np.arange(len(series))
        samples.append(Line(steps, series, name, colour, style, marker=marker))
    title = DRIFT_JOINT.replace("_", " ")
    settled = samples[-1].y[1:]
    bounds = np.concatenate([line.y[1:] for line in samples])
    margin = 0.15 * float(np.ptp(bounds))
    return draw_panels(
        [
            Panel(tuple(traces), "angle [deg]", f"{title} over the whole walk"),
            Panel(
                tuple(samples),
                "angle [deg]",
                f"{title} at the start of left single supports",
                note=f"gamma_joint 1 settles at {settled[-1]:.2f} deg; first sample outside axes",
                xlabel="number of steps",
                ylim=(float(bounds.min()) - margin, float(bounds.max()) + margin),
            ),
        ],
        height=2.5,
    )


def plot_drift_poses(study: Study) -> Figure:
    """Draw the first and the last pose of the long walk for both gains, as figure 9 does."""
    poses = [
        Pose(
            stages.motion.q[-1],
            view,
            name,
            "from the front" if view is FRONT else "from the right",
            ghost=stages.motion.q[0],
        )
        for name, stages in study.drift.items()
        for view in (FRONT, RIGHT_SIDE)
    ]
    caption = "last pose after 30 steps; dashed: first pose"
    return plot_poses(study.robot, poses, columns=4, caption=caption)
