"""Verdicts and replays in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from mgs.core.short_text import clipped

if TYPE_CHECKING:
    from mgs.judge.motion_checks import Check
    from mgs.judge.servo_cases import ServoSweep
    from mgs.motion.energy import Energy
    from mgs.sim import Agreement, Replay


def line(check: Check) -> str:
    """One check with its value and its limit."""
    mark = "ok  " if check.ok else "FAIL"
    time = "" if check.time is None else f"  at {check.time:.2f} s"
    where = f"  {check.where}" if check.where else ""
    figure = f"{check.value:.4g} {check.unit} (limit {check.limit:.4g})"
    return f"{mark} {check.name:22s} {figure}{time}{where}"


def survival(figures: dict[str, Any]) -> str:
    """Number of random replays in which the robot stays up."""
    low, high = figures["wilson_95"]
    text = (
        f"{figures['engine']}, {figures['servo']} servos, ranges {figures['ranges']}, "
        f"seed {figures['seed']}: the robot stays up in {figures['survived']} of {figures['n']} "
        f"replays, 95 % confidence interval {low:.3f} to {high:.3f}"
    )
    worst = figures["offenders"]
    if worst:
        told = (f"{o['parameter']} ({o['probability']:.2f})" for o in worst[:3])
        text += f"; falls correlate with {', '.join(told)}"
    return text


def energy_words(energy: Energy) -> str:
    """Work and torques of a motion, and its cost of transport if the robot travels."""
    text = (
        f"positive joint work {energy.positive_work:.3g} J, "
        f"squared torques {energy.torque_squared:.3g} N^2 m^2 s"
    )
    cost = energy.cost_of_transport
    return text if cost is None else f"{text}, cost of transport {cost:.3f}"


def yaw_words(checks: Sequence[Check]) -> str | None:
    """Moment about the vertical against the one that friction gives; None: there is no such check.

    Args:
        checks: the static checks of a motion.
    """
    for check in checks:
        if check.name == "yaw_friction":
            return (
                f"moment about the vertical {check.value:.3g} N m of {check.limit:.3g} N m that "
                f"the sole can bear at {check.time:.2f} s, {check.where}"
            )
    return None


def agreement(found: Agreement) -> str:
    """Differences between two engines."""
    apart = (
        f"sole loads {100.0 * found.load:.0f} % of the weight (RMS), ZMP "
        f"{1e3 * found.zmp:.1f} mm (RMS), tilt {found.tilt_deg:.1f} deg, "
        f"final pose {1e3 * found.end_position:.1f} mm and {found.end_yaw_deg:.1f} deg"
    )
    fate = "" if found.same_fate else "; they DISAGREE on whether the robot falls"
    return f"differences between {' and '.join(found.engines)}: {apart}{fate}"


def servo_words(replay: Replay) -> str:
    """Servos of a replay and the kind of their commands."""
    sag, time = math.degrees(replay.settings.sag), replay.settings.damping_time
    servos = {
        "ideal": "ideal servos",
        "model": "modelled servos",
        "pd": f"PD servos (sag {sag:.3g} deg, damping time {1e3 * time:.3g} ms)",
    }[replay.servo]
    return f"{servos}, feed-forward" if replay.feed_forward else servos


def sources(replays: Sequence[Replay]) -> list[str]:
    """Modelled servos whose figures are not identified ones, in a line for all replays."""
    found = {name: source for replay in replays for name, source in replay.servo_sources.items()}
    stated = [name for name, source in found.items() if not source.startswith("identified")]
    if not stated:
        return []
    told = "; ".join(f"{name}: {found[name]}" for name in stated)
    return [f"modelled servos that were not identified by measurements: {told}"]


def sentence(replay: Replay) -> str:
    """Figures of one replay."""
    x, y = replay.distance
    planned_x, planned_y = replay.planned_distance
    fate = f"FELL at {replay.fall_time:.2f} s" if replay.fell else "stays up"
    servos = servo_words(replay)
    if replay.unit is not None:
        commands = "corrected" if replay.corrected else "not corrected"
        servos += f", robot {clipped(replay.unit, 40)} with commands {commands} for it"
    if replay.command_clipped_joint is not None:
        servos += (
            f" (commands clipped by up to {replay.command_clipped_deg:.1f} deg at the limit of "
            f"{replay.command_clipped_joint})"
        )
    return (
        f"{replay.engine} {replay.version}, {servos}: {fate}; displacement ({x:+.3f}, {y:+.3f}) m, "
        f"planned ({planned_x:+.3f}, {planned_y:+.3f}) m, yaw error "
        f"{replay.yaw_error_deg:+.2f} deg, largest tilt {replay.max_tilt_deg:.1f} deg, "
        f"sole slip {1e3 * replay.sole_slip_max:.1f} mm, "
        f"joint error {replay.joint_error_rms_deg:.2f} deg RMS, longest torque saturation "
        f"{1e3 * replay.torque_saturation:.0f} ms; computing time {replay.wall_seconds:.1f} s"
    )


def servo_sweep(sweep: ServoSweep) -> list[str]:
    """Sags at which the motion passes, one line for each kind of commands and each friction."""
    rows = dict.fromkeys((o.case.assumed_stiffness, o.case.friction) for o in sweep.outcomes)
    lines = []
    for assumed, friction in rows:
        commands = "planned angles"
        if assumed is not None:
            commands = f"feed-forward for {assumed:g} times the stiffness"
        swept = [
            outcome.case.sag_deg
            for outcome in sweep.outcomes
            if (outcome.case.assumed_stiffness, outcome.case.friction) == (assumed, friction)
        ]
        passing = sweep.passing(assumed, friction)
        lines.append(
            f"{sweep.engine}, PD servos, {commands}, friction {friction:g}: "
            f"{_ranges(passing, swept)}"
        )
    return lines


def _ranges(passing: tuple[float, ...], swept: list[float]) -> str:
    """Sags at which a motion passes in words, neighbours in `swept` joined to ranges."""
    runs: list[list[float]] = []
    for value in swept:
        if value not in passing:
            runs.append([])
        else:
            runs = runs or [[]]
            runs[-1].append(value)
    texts = [f"{r[0]:g}" if len(r) == 1 else f"{r[0]:g} to {r[-1]:g}" for r in runs if r]
    if not texts:
        return f"passes at no sag from {swept[0]:g} to {swept[-1]:g} deg"
    return f"passes at sags of {' and '.join(texts)} deg"
