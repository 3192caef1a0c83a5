"""Coupled joints: how they are read, which limits they leave, and what a robot folder may say."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from mgs.core.errors import ConfigError
from mgs.robot import Robot, build_robot, load_robot
from mgs.robot.coupling import read_followers
from mgs.robot.init import init_robot, write_robot
from mgs.robot.soundness import check_robot
from tests.support.bipeds import Biped
from tests.support.nao_like import nao_like


@pytest.fixture(scope="module")
def nao(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    return robot_of(nao_like(), tmp_path_factory.mktemp("nao"))


def robot_of(urdf: str, folder: Path) -> Robot:
    path = folder / "robot.urdf"
    path.write_text(urdf)
    write_robot(init_robot(path), folder / "robot")
    return load_robot(folder / "robot")


def mimicking(joint: str, leader: str, values: str = "", text: str | None = None) -> str:
    """A biped in which a joint mimics another one."""
    mimic = f'<mimic joint="{leader}" {values}/>'
    pattern = rf'(<joint name="{joint}".*?)(<limit)'
    return re.sub(pattern, rf"\g<1>{mimic}\g<2>", text or Biped().urdf(), count=1)


def test_a_chain_of_followers_is_resolved():
    urdf = """<robot name="a">
      <joint name="a" type="revolute"/>
      <joint name="b" type="revolute"><mimic joint="a" multiplier="2" offset="0.1"/></joint>
      <joint name="c" type="revolute"><mimic joint="b" multiplier="-3" offset="0.5"/></joint>
      <joint name="d" type="fixed"><mimic joint="a"/></joint>
    </robot>"""
    found = read_followers(ElementTree.fromstring(urdf))
    assert set(found) == {"b", "c"}
    for a in (0.0, 0.7):
        b = 2.0 * a + 0.1
        assert found["b"].angle(a) == pytest.approx(b)
        assert found["c"].angle(a) == pytest.approx(-3.0 * b + 0.5)
    assert found["c"].leader == "a"


def test_a_leg_with_coupled_joints_keeps_them(nao: Robot):
    assert nao.n == 22
    assert set(nao.followers) == {"RHipYawPitch"}
    assert "RHipYawPitch" not in nao.spec.joints
    assert nao.servo_of("RHipYawPitch") == nao.servo_of("LHipYawPitch")
    assert [finding.name for finding in check_robot(nao) if not finding.ok] == []


def test_every_joint_keeps_its_own_limits_wherever_the_motors_are(tmp_path: Path):
    """Among random angles of the motors within their limits, followers too stay within theirs."""
    text = mimicking("left_ankle_pitch", "left_knee_pitch", 'multiplier="-0.8" offset="0.01"')
    robot = robot_of(text, tmp_path)
    coupling = robot.coupling
    assert coupling is not None
    rng = np.random.default_rng(0)
    q = rng.uniform(robot.lower, robot.upper, (500, robot.n))
    coupling.complete(q)
    assert np.all((q >= robot.lower) & (q <= robot.upper))
    own = np.array([robot.lower, robot.upper])
    coupling.complete(own)  # the ends are reached exactly
    j = robot.joint_names.index("left_ankle_pitch")
    assert sorted(own[:, j]) == [robot.lower[j], robot.upper[j]]
    assert robot.lower[j] == pytest.approx(-1.6)
    assert robot.upper[robot.joint_names.index("left_knee_pitch")] < 2.3  # -0.8 * 2.3 + 0.01 < -1.6


def test_motors_get_the_torques_that_do_the_same_work(nao: Robot):
    coupling = nao.coupling
    assert coupling is not None
    rng = np.random.default_rng(0)
    torque, speed = rng.normal(size=(2, 50, nao.n))
    moved = speed @ coupling.S.T
    power = np.sum(torque * moved, axis=1)
    at_motors = coupling.at_motors(torque)
    np.testing.assert_allclose(np.sum(at_motors * speed, axis=1), power, atol=1e-12)
    assert not at_motors[:, coupling.followers].any()


BAD = {
    "a servo of a follower": (
        "joints:", "joints:\n  RHipYawPitch: {servo}", "RHipYawPitch follows another joint",
    ),
    "another angle of a follower": (
        "posture:", "posture:\n  RHipYawPitch: 0.2", r"posture\.RHipYawPitch: it follows joint",
    ),
    "a follower that is locked": (
        "groups:", "locked: {{RHipYawPitch: 0.0}}\ngroups:", "only RHipYawPitch is locked",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("old", "new", "reason"), BAD.values(), ids=BAD)
def test_a_folder_that_contradicts_the_coupling_is_refused(
    nao: Robot, old: str, new: str, reason: str
):
    new = new.format(servo=next(iter(nao.spec.servos)))
    yaml = re.sub(rf"^{old}", new, nao.yaml, count=1, flags=re.MULTILINE)
    assert yaml != nao.yaml
    with pytest.raises(ConfigError, match=reason):
        build_robot(yaml, nao.urdf, "robot.yaml")


@pytest.mark.parametrize(
    ("joint", "leader", "values", "reason"),
    [
        ("left_knee_pitch", "left_shoulder_pitch", "", "no joint of the legs"),
        ("left_knee_pitch", "left_hip_pitch", 'multiplier="0"', "no joint of the legs"),
        (
            "left_knee_pitch",
            "left_hip_yaw",
            'multiplier="0.01" offset="-0.02"',
            "have no common range",
        ),
        ("left_knee_pitch", "nothing", "", "no joint of the legs"),
        ("left_knee_pitch", "left_hip_yaw", 'multiplier="k"', "is not a number"),
    ],
)
def test_a_leader_outside_the_legs_is_refused(
    joint: str, leader: str, values: str, reason: str, tmp_path: Path
):
    with pytest.raises(ConfigError, match=reason):
        robot_of(mimicking(joint, leader, values), tmp_path)


def test_joints_that_mimic_each_other_are_refused(tmp_path: Path):
    text = mimicking("left_hip_pitch", "left_knee_pitch")
    text = mimicking("left_knee_pitch", "left_hip_pitch", text=text)
    with pytest.raises(ConfigError, match="no joint of the legs that moves by itself"):
        robot_of(text, tmp_path)
