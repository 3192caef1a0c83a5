"""Static checks of soles that roll: what was planned passes, what was not is found."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from mgs.core.contact import Side, Support
from mgs.gait import load_gait
from mgs.judge.motion_checks import check_motion, zmp_margins
from mgs.motion import Motion
from mgs.pipeline import run_stages
from mgs.robot import Robot

COLLISION_STEP = 400  # collisions are not what these tests look for


@pytest.fixture(scope="module")
def rolling(melson: Robot) -> Motion:
    return run_stages(melson, load_gait("melson/walk_rolling")).motion


def failures(motion: Motion) -> set[str]:
    return {check.name for check in check_motion(motion, None, COLLISION_STEP) if not check.ok}


def test_strides_of_0_8_leg_lengths_on_rolling_feet_keep_every_limit(rolling: Motion):
    assert failures(rolling) == set()
    starts = np.flatnonzero(np.diff((rolling.support == Support.DOUBLE).astype(int)) == 1) + 1
    strides = [abs(float(np.diff(rolling.soles[k, :, 0])[0])) for k in starts]
    heels = 0.07 * 0.45  # [m] at most, by which the centre of a sole on its heel is displaced
    assert sorted(strides)[-3] > 0.8 * 0.2815 - heels


def test_a_sole_that_rolls_though_its_plan_is_level_is_found(rolling: Motion):
    level = rolling.soles_ref.copy()
    level[..., 3:] = [0.0, 0.0, 0.0, 1.0]  # nobody turns in this walk
    found = failures(dataclasses.replace(rolling, soles_ref=level))
    assert {"sole_still", "sole_contact", "sole_rotation"} <= found


def test_behind_the_edge_of_a_sole_that_rolls_nothing_bears(rolling: Motion):
    """The middle of the rear sole is inside while this sole is level, and outside once it rolls."""
    double = rolling.support == Support.DOUBLE
    starts = np.flatnonzero(np.diff(double.astype(int)) == 1) + 1
    ends = np.flatnonzero(np.diff(double.astype(int)) == -1)
    start, end = int(starts[3]), int(ends[ends > starts[3]][0])  # between two of the longest steps
    rear = int(np.argmin(rolling.soles[start, :, 0]))
    middle = np.broadcast_to(rolling.soles[start, rear, :2], (rolling.n_samples, 2))
    margins = zmp_margins(rolling, middle)
    assert margins[start] > 0.0
    assert margins[end] == pytest.approx(
        -0.5 * rolling.robot.sole_spec(Side(rear)).length, abs=1e-3
    )
