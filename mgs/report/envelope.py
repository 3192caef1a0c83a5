"""Map of a speed envelope over step time and step length: passing walks, reasons of failure."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mgs.report.canvas import (
    BLACK,
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    TICK,
    VERMILION,
    legend_above,
    new_figure,
    style_axes,
)
from mgs.search.envelope import Envelope, Probe

ROOM = 1.15  # range of the axes as a multiple of the longest step that passes
SERVO_WORDS = {"ideal": "ideal", "model": "modelled", "pd": "PD"}
N_SPEEDS = 5  # least number of lines of equal speed


def plot_envelope(envelope: Envelope) -> Figure:
    """Draw all probes, the longest steps that pass, and lines of equal speed."""
    figure = new_figure(7.2, 4.6)
    axes = figure.add_subplot()
    robot = str(envelope.gait.robot).rpartition("/")[2]
    style_axes(
        axes,
        title=f"{robot}: steps that pass in {' and '.join(envelope.engines)}, "
        f"{SERVO_WORDS[envelope.servo]} servos",
        xlabel="step time [s]",
        ylabel="step length [m]",
    )
    limits = {time: probe for time, probe in envelope.limits().items() if probe is not None}
    longest = max((p.step_length for p in limits.values()), default=0.1)
    top = ROOM * max([longest, *_just_too_long(envelope, longest)])
    _draw_probes(axes, envelope, top)
    if limits:
        lengths = [probe.step_length for probe in limits.values()]
        label = "longest that passes; its least ZMP margin"
        axes.plot(list(limits), lengths, color=INK, linewidth=1.2, label=label)
        for probe in limits.values():
            axes.annotate(
                f"{1e3 * (probe.zmp_margin or 0.0):.0f} mm",
                (probe.step_time, probe.step_length),
                xytext=(7, -9),
                textcoords="offset points",
                fontsize=TICK,
                color=INK,
            )
    times = sorted({probe.step_time for probe in envelope.probes})
    right = times[-1] + 0.06 * (times[-1] - times[0] + 0.1)
    axes.set(xlim=(times[0] - 0.06 * (times[-1] - times[0] + 0.1), right), ylim=(0.0, top))
    _draw_speeds(axes, 2.0 * max((p.speed for p in limits.values()), default=top))
    fastest = envelope.fastest
    if fastest is not None:
        spot = (fastest.step_time, fastest.step_length)
        label = f"fastest: {fastest.speed:.2f} m/s, Fr {envelope.froude(fastest):.3f}"
        axes.plot(
            *spot, "o", markersize=12, fillstyle="none", color=BLACK, linestyle="none", label=label
        )
    legend_above(figure, [axes], columns=3)
    return figure


def _just_too_long(envelope: Envelope, longest: float) -> list[float]:
    """Shortest failing step of each step time, if it is close to the steps that pass."""
    shortest: dict[float, float] = {}
    for probe in envelope.probes:
        if not probe.passed:
            known = shortest.get(probe.step_time, np.inf)
            shortest[probe.step_time] = min(known, probe.step_length)
    return [length for length in shortest.values() if length < 2.0 * longest]


def _draw_probes(axes: Axes, envelope: Envelope, top: float) -> None:
    groups: dict[str, list[Probe]] = {}
    for probe in envelope.probes:
        if probe.step_length <= top:
            groups.setdefault(_fate(probe), []).append(probe)
    for fate, (marker, colour) in FATES.items():
        if fate in groups:
            xy = np.array([(p.step_time, p.step_length) for p in groups[fate]])
            axes.plot(*xy.T, marker, color=colour, markersize=5.5, linestyle="none", label=fate)


FATES = {
    "passes": ("o", GREEN),
    "out of reach": ("x", BLUE),
    "servo speed or torque too low": ("v", ORANGE),
    "falls": ("X", VERMILION),
    "other check fails": ("s", PURPLE),
}


def _fate(probe: Probe) -> str:
    if probe.passed:
        return "passes"
    if probe.zmp_margin is None:
        return "out of reach"
    if any(name.endswith(("_upright", "_diverged")) for name in probe.failed):
        return "falls"
    servo = ("joint_speed", "joint_torque", "joint_torque_rms")
    if any(name in servo or name.endswith("_saturation") for name in probe.failed):
        return "servo speed or torque too low"
    return "other check fails"


def _draw_speeds(axes: Axes, most: float) -> None:
    """Draw lines of equal speed up to `most` [m/s], labelled at the edge of the axes."""
    (_, right), (_, top) = axes.get_xlim(), axes.get_ylim()
    step = _round_number(most / N_SPEEDS)
    for speed in np.arange(step, most, step):
        axes.plot([0.0, right], [0.0, speed * right], color=FAINT, linewidth=0.6, linestyle=":")
        x, y = (right, speed * right) if speed * right < top else (top / speed, top)
        axes.annotate(
            f"{speed:g} m/s", (x, y), xytext=(-2, -9), textcoords="offset points",
            fontsize=TICK - 1.5, color=FAINT, ha="right",
        )  # fmt: skip


def _round_number(x: float) -> float:
    """Largest number of the form 1, 2 or 5 times a power of ten that does not exceed x."""
    power = 10.0 ** np.floor(np.log10(x))
    return float(max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= x))
