"""Every shipped gait: it passes, in every engine, and not by luck of the solver's settings."""

from __future__ import annotations

import dataclasses

import pytest

from mgs.judge.motion_checks import check_motion
from mgs.judge.verdict import replay_checks
from mgs.sim import DEFAULTS, replay


def test_a_shipped_gait_passes_every_static_check(shipped):
    failed = [check.name for check in check_motion(shipped.stages.motion) if not check.ok]
    assert failed == []


def test_a_shipped_sequence_passes_every_static_check(shipped_sequence):
    assert [check.name for check in check_motion(shipped_sequence) if not check.ok] == []


@pytest.mark.slow
@pytest.mark.parametrize("servo", ["ideal", "model"])
def test_a_shipped_sequence_passes_with_either_kind_of_servo(shipped_sequence, engine_name, servo):
    result = replay(shipped_sequence, engine_name, servo=servo)
    assert [check.name for check in replay_checks(result) if not check.ok] == []
    assert result.max_tilt_deg < 3.0


@pytest.mark.slow
@pytest.mark.parametrize("change", ["default", "half the step", "twice the iterations"])
def test_a_shipped_gait_passes_at_other_solver_settings_too(shipped, engine_name, change):
    settings = DEFAULTS[engine_name]
    if change == "half the step":
        settings = dataclasses.replace(settings, dt=settings.dt / 2)
    elif change == "twice the iterations":
        settings = dataclasses.replace(settings, iterations=2 * settings.iterations)
    result = replay(shipped.stages.motion, engine_name, settings)
    assert [check.name for check in replay_checks(result) if not check.ok] == []
    assert (result.max_tilt_deg if result.is_balanced else result.end_tilt_deg) < 5.0


@pytest.mark.slow
def test_a_shipped_walk_passes_with_the_servos_of_its_robot_too(shipped_walk, engine_name):
    result = replay(shipped_walk.stages.motion, engine_name, servo="model")
    assert [check.name for check in replay_checks(result) if not check.ok] == []
    assert result.max_tilt_deg < 3.0
