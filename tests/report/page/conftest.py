"""A short walk, a walk that fails a check, and hostile names, for the tests of pages."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.gait import load_gait
from mgs.motion import Motion
from mgs.pipeline import run_stages
from mgs.robot import Robot

HOSTILE = "</script><img src=x onerror=alert(1)>\"'$& {{DATA}} \\g<0>\u2028"
BROKEN_JOINT, BROKEN_TIME = "left_elbow_pitch", 1.5  # [s]


@pytest.fixture(scope="session")
def walk(melson: Robot) -> Motion:
    changes = ("com.preview=0.8", "walk.lead_in=0.8", "walk.lead_out=0.8", "walk.n_steps=2")
    return run_stages(melson, load_gait("melson/walk_practical", changes), "short walk").motion


@pytest.fixture(scope="session")
def broken(walk: Motion) -> Motion:
    """The walk with one joint beyond its limit at one instant, and a hostile name."""
    q, joint = walk.q.copy(), walk.robot.joint_names.index(BROKEN_JOINT)
    k = round(BROKEN_TIME / walk.dt)
    q[k, FLOATING_BASE_NQ + joint] = walk.robot.upper[joint] + np.radians(3.0)
    return dataclasses.replace(walk, q=q, gait_name=HOSTILE)
