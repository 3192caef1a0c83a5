"""Bounds of support phases: rounding, and the refusal of phases that are too short."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.errors import ConfigError
from mgs.gait import KickGait
from mgs.motion_planner import plan_motion
from mgs.motion_planner.phases import MIN_SAMPLES, phase_bounds
from mgs.robot import load_robot


@given(st.lists(st.floats(0.06, 3.0), min_size=1, max_size=50), st.sampled_from([0.005, 0.01]))
def test_every_bound_is_within_half_a_sample_of_its_time(seconds: list[float], dt: float):
    bounds = phase_bounds([("key", duration) for duration in seconds], dt)
    assert bounds[0] == 0
    times = np.array([sum(seconds[:i]) for i in range(len(seconds) + 1)])
    assert np.abs(dt * np.array(bounds) - times).max() <= 0.5 * dt + 1e-9
    assert all(type(bound) is int for bound in bounds)


@pytest.mark.parametrize("short", [0, 1, 2])
def test_the_phase_that_is_too_short_is_named_with_the_least_duration(short: int):
    durations = [(f"walk.key_{i}", 1.0) for i in range(3)]
    durations[short] = (f"walk.key_{short}", 0.04)
    with pytest.raises(ConfigError) as caught:
        phase_bounds(durations, 0.01)
    assert str(caught.value) == (
        f"walk.key_{short}: 0.04 s is fewer than {MIN_SAMPLES} samples of dt = 0.01 s; use at "
        "least 0.05 s or a smaller dt"
    )
    durations[short] = (f"walk.key_{short}", 0.05)
    assert len(phase_bounds(durations, 0.01)) == 4


@pytest.mark.parametrize("key", ["shift", "lead_in", "lead_out"])
def test_a_phase_of_a_kick_that_is_too_short_is_named(key: str):
    kick = {
        "mgs": 1,
        "motion": "kick",
        "dt": 0.1,
        "kick": {"lead_in": 0.5, "lead_out": 0.5, key: 0.3},
    }
    with pytest.raises(ConfigError, match=rf"^kick\.{key}: 0\.3 s is fewer than 5 samples"):
        plan_motion(load_robot("melson"), KickGait.model_validate(kick))
