"""Figure of a motion compared with a log: joint errors over time, and what the figures explain."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from mgs.judge.logged.comparison import Comparison

COLUMNS = 3


def plot_comparison(comparison: Comparison, title: str) -> Figure:
    """One panel for each joint: measured minus planned angle, and what is left of it [deg]."""
    joints = comparison.joints
    rows = -(-len(joints) // COLUMNS)
    figure = Figure(figsize=(12.0, 1.0 + 1.7 * rows), layout="constrained")
    axes = figure.subplots(rows, COLUMNS, sharex=True, squeeze=False)
    for i, ax in enumerate(axes.flat):
        if i >= len(joints):
            ax.set_visible(False)
            continue
        read = np.isfinite(comparison.before[:, i])
        times = comparison.times[read]
        ax.axhline(0.0, color="0.8", linewidth=0.8)
        for values, label, colour in (
            (comparison.before, "measured - planned", "tab:red"),
            (comparison.after, "not explained", "tab:blue"),
        ):
            ax.plot(times, np.degrees(values[read, i]), color=colour, linewidth=0.9, label=label)
        ax.set_title(joints[i].name, fontsize=9)
        ax.tick_params(labelsize=7)
    for ax in axes[:, 0]:
        ax.set_ylabel("error [deg]", fontsize=8)
    for ax in axes[-1]:
        ax.set_xlabel("time [s]", fontsize=8)
    axes.flat[0].legend(fontsize=7)
    figure.suptitle(title, fontsize=10)
    return figure
