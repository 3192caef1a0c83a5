"""The verdict on a motion as plain data for the script of a page."""

from __future__ import annotations

from typing import Any

from mgs.judge.motion_checks import Check
from mgs.judge.verdict import Verdict
from mgs.sim import Replay


def verdict_data(verdict: Verdict) -> dict[str, Any]:
    """Every check with value, limit, unit, place and worst moment; which engines were asked."""
    moments = {name: time for replay in verdict.replays for name, time in worst_moments(replay)}
    return {
        "passed": verdict.passed,
        "engines": list(verdict.engines),
        "checks": [_check(check, moments) for check in verdict.checks],
    }


def worst_moments(replay: Replay) -> list[tuple[str, float | None]]:
    """Names of the checks of a replay that have a worst moment of their own, with its time [s]."""
    return [
        (f"{replay.engine}_upright", replay.fall_time if replay.fell else replay.max_tilt_time),
        (f"{replay.engine}_saturation", replay.torque_saturation_time),
        (f"{replay.engine}_position", float(replay.trace.t[-1])),
        (f"{replay.engine}_yaw", float(replay.trace.t[-1])),
    ]


def _check(check: Check, moments: dict[str, float | None]) -> dict[str, Any]:
    time = check.time if check.time is not None else moments.get(check.name)
    return check.to_dict() | {"time": time}
