"""Tests with third-party humanoids, if their packages are installed: pip install "mgs[robots]"."""

from __future__ import annotations

import pytest

from mgs.core.errors import ConfigError
from mgs.gait import load_gait
from mgs.judge.motion_checks import check_motion
from mgs.pipeline import run_stages
from mgs.robot.init import init_robot
from mgs.robot.soundness import check_robot
from tests.support.packages import file_of


@pytest.mark.parametrize(
    ("package", "name", "joints"),
    [
        ("example-robot-data", "talos_data/robots/talos_reduced.urdf", 30),
        ("example-robot-data", "g1_description/urdf/g1_29dof_rev_1_0.urdf", 29),
        ("example-robot-data", "alexander_v1.lowerBodyOnly.urdf", 13),
        ("icub-models", "robots/iCubGazeboV2_7/model.urdf", 32),
    ],
)
def test_it_walks_without_editing(package: str, name: str, joints: int):
    robot = init_robot(file_of(package, name)).robot
    assert robot.n == joints
    assert [finding.name for finding in check_robot(robot) if not finding.ok] == []
    motion = run_stages(robot, load_gait("walk"), "walk").motion
    assert [check.name for check in check_motion(motion) if not check.ok] == []


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("bolt_description/robots/bolt.urdf", "point feet"),
        ("cassie_description/robots/cassie_v2.sdf", "closed loops"),
        ("anymal_b_simple_description/robots/anymal.urdf", "two legs"),
    ],
)
def test_a_robot_without_two_soles_is_refused(name: str, reason: str):
    with pytest.raises(ConfigError, match=reason):
        init_robot(file_of("example-robot-data", name))
