"""Tests of drafted robot folders, with shipped robots and with bipeds made of boxes."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.core.errors import ConfigError, OutputExistsError
from mgs.core.shipped import shipped_folder
from mgs.gait import load_gait
from mgs.judge.motion_checks import check_motion
from mgs.judge.validate import validate
from mgs.pipeline import run_stages
from mgs.robot import Robot, build_robot, load_robot
from mgs.robot.init import DraftFolder, init_robot, write_robot
from mgs.robot.soundness import check_robot
from tests.support.bipeds import FULL_LEG, Biped

SEVEN = (*FULL_LEG[:4], "ankle_yaw", *FULL_LEG[4:])
TRUNK = ("waist_yaw", "waist_roll", "waist_pitch")


def drafted(biped: Biped | str, folder: Path) -> DraftFolder:
    path = folder / "boxes.urdf"
    path.write_text(biped if isinstance(biped, str) else biped.urdf())
    return init_robot(path)


def unsound(robot: Robot) -> list[str]:
    return [f"{f.name}: {f.figure}" for f in check_robot(robot) if not f.ok]


# --- the robots that ship: their robot.yaml was written by hand ---------------------------------


@pytest.mark.parametrize("name", ["melson", "coman"])
def test_the_draft_of_a_shipped_urdf_agrees_with_its_robot_yaml(name: str):
    draft, written = init_robot(shipped_folder("robots") / name / "robot.urdf"), load_robot(name)
    found, spec = draft.robot.spec, written.spec
    assert found.base_link == spec.base_link
    assert found.torso.link == spec.torso.link
    for side in Side:
        sole, expected = draft.robot.sole_spec(side), written.sole_spec(side)
        assert (sole.link, sole.rpy) == (expected.link, [0.0, 0.0, 0.0])
        assert sole.position == pytest.approx(expected.position, abs=1e-6)
        assert (sole.length, sole.width) == pytest.approx((expected.length, expected.width))
    assert found.groups == spec.groups
    assert not found.locked
    assert unsound(draft.robot) == []


@pytest.mark.parametrize("name", ["melson", "coman"])
def test_the_cleaned_copy_has_the_kinematics_and_masses_of_the_source(name: str):
    text = (shipped_folder("robots") / name / "robot.urdf").read_text()
    original = pin.buildModelFromXML(text, pin.JointModelFreeFlyer())
    model = init_robot(shipped_folder("robots") / name / "robot.urdf").robot.model
    rng = np.random.default_rng(0)
    names = list(model.names)
    assert names == list(original.names)
    for _ in range(5):
        q = pin.neutral(model)
        q[7:] = rng.uniform(model.lowerPositionLimit[7:], model.upperPositionLimit[7:])
        v, a = rng.normal(size=model.nv), rng.normal(size=model.nv)
        np.testing.assert_allclose(
            pin.rnea(model, model.createData(), q, v, a),
            pin.rnea(original, original.createData(), q, v, a),
            atol=1e-9,  # text holds every digit
        )


# --- bipeds of boxes: their builder knows where everything is -----------------------------------


@settings(max_examples=12)
@given(
    size=st.floats(0.25, 1.1),
    length=st.floats(0.2, 0.4),
    width=st.floats(0.08, 0.2),
    ahead=st.floats(0.0, 0.06),
    hip=st.permutations(FULL_LEG[:3]),
    ankle=st.permutations(FULL_LEG[4:]),
    quarter=st.integers(0, 3),
    height=st.floats(-1.0, 1.0),
)
def test_legs_and_soles_of_any_biped_are_found(
    size: float, length: float, width: float, ahead: float, hip: list[str], ankle: list[str],
    quarter: int, height: float, tmp_path_factory: pytest.TempPathFactory,
):  # fmt: skip
    turned = (
        '<link name="world"/><joint name="weld" type="fixed"><parent link="world"/>'
        f'<child link="pelvis"/><origin xyz="0.3 0.1 {height}" rpy="0 0 {quarter * np.pi / 2}"/>'
        "</joint>"
    )
    leg = (*hip, "knee_pitch", *ankle)
    biped = Biped(leg, size=size, sole=(length * size, width * size), extra=[turned])
    biped.ahead = ahead * size
    draft = drafted(biped, tmp_path_factory.mktemp("biped"))
    for side in Side:
        assert draft.robot.spec.groups[f"{side.label}_leg"] == [f"{side.label}_{j}" for j in leg]
        sole = draft.robot.sole_spec(side)
        assert (sole.length, sole.width) == pytest.approx(biped.sole, abs=1e-4)
        assert sole.position == pytest.approx([biped.ahead, 0.0, -0.1 * size], abs=1e-5)
        assert np.allclose(sole.rpy, 0.0, atol=1e-8)
    assert unsound(draft.robot) == []


def test_the_posture_bends_the_knees_forward_under_a_level_trunk(tmp_path: Path):
    robot = drafted(Biped(), tmp_path).robot
    q = robot.standing_q
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    com = pin.centerOfMass(robot.model, data, q)
    assert com[0] == pytest.approx(0.0, abs=1e-5)  # midway between the soles
    R = pin.XYZQUATToSE3(q[:FLOATING_BASE_NQ]).rotation
    np.testing.assert_allclose(R, np.eye(3), atol=1e-6)
    angles = dict(zip(robot.joint_names, robot.posture, strict=True))
    assert 0.3 < angles["left_knee_pitch"] < 1.2
    assert angles["left_knee_pitch"] == pytest.approx(angles["right_knee_pitch"], abs=1e-6)


HARD = {
    "no arms": Biped(arm=(), waist=()),
    "seven joints a leg, three in the waist, a head": Biped(
        leg=SEVEN, waist=TRUNK, head=("neck_yaw", "neck_pitch")
    ),
    "no hip yaw": Biped(leg=FULL_LEG[1:]),
    "no ankle roll": Biped(leg=FULL_LEG[:-1], waist=("waist_roll", "waist_pitch")),
}


@pytest.mark.parametrize("name", HARD)
def test_it_walks_without_editing(name: str, tmp_path: Path):
    draft = drafted(HARD[name], tmp_path)
    assert unsound(draft.robot) == []
    write_robot(draft, tmp_path / "mine")
    robot = load_robot(tmp_path / "mine")
    motion = run_stages(robot, load_gait("walk"), "walk").motion
    assert [c.name for c in check_motion(motion) if not c.ok] == []
    walk = motion.gait.walk
    assert motion.footsteps[-1].x == pytest.approx(5 * walk.step_length)


def test_a_robot_without_arms_has_no_hands(tmp_path: Path):
    draft = drafted(HARD["no arms"], tmp_path)
    assert draft.robot.spec.hands is None
    assert "hands" not in draft.yaml


FINGER = """
<joint name="{side}_finger{i}" type="{kind}"><parent link="{side}_elbow_pitch_link"/>
  <child link="{side}_finger{i}_link"/><origin xyz="0 0.0{i} -0.3"/><axis xyz="1 0 0"/>
  <limit lower="0.1" upper="1" effort="1" velocity="1"/>{mimic}</joint>
<link name="{side}_finger{i}_link"><inertial><mass value="0.02"/>
  <inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def fingers(*kinds: tuple[str, str]) -> list[str]:
    return [
        FINGER.format(side=side, i=i, kind=kind, mimic=mimic.format(side=side))
        for side in ("left", "right")
        for i, (kind, mimic) in enumerate(kinds)
    ]


def test_fingers_are_locked_where_an_arm_branches(tmp_path: Path):
    draft = drafted(Biped(extra=fingers(("revolute", ""), ("revolute", ""))), tmp_path)
    locked = {f"{side}_finger{i}": 0.1 for side in ("left", "right") for i in (0, 1)}
    assert draft.robot.spec.locked == pytest.approx(locked)  # 0 is out of their range
    assert draft.robot.spec.groups["left_arm"][-1] == "left_elbow_pitch"
    assert not set(locked) & set(draft.robot.joint_names)


def test_mimic_joints_are_fixed_and_their_leader_is_locked(tmp_path: Path):
    mimic = '<mimic joint="{side}_finger0" multiplier="2" offset="0.2"/>'
    kinds = ("revolute", ""), ("revolute", mimic), ("prismatic", "")
    draft = drafted(Biped(extra=fingers(*kinds)), tmp_path)
    assert set(draft.robot.spec.locked) == {"left_finger0", "right_finger0"}
    assert "left_finger1" not in draft.urdf
    assert any("left_finger1" in note and "0.2" in note for note in draft.notes)
    assert any("prismatic joint right_finger2" in note for note in draft.notes)


@pytest.mark.parametrize("kind", ["floating", "fixed"])
def test_a_world_link_above_the_base_changes_nothing(kind: str, tmp_path: Path):
    world = (
        f'<link name="world"/><joint name="free" type="{kind}"><parent link="world"/>'
        '<child link="pelvis"/><origin xyz="0 0 1"/></joint>'
    )
    plain, draft = (drafted(Biped(extra=extra), tmp_path) for extra in ([], [world]))
    assert draft.robot.joint_names == plain.robot.joint_names
    np.testing.assert_allclose(draft.robot.posture, plain.robot.posture, atol=1e-6)
    assert draft.robot.mass == pytest.approx(plain.robot.mass)


def test_limits_missing_in_the_urdf_are_guessed_and_marked(tmp_path: Path):
    draft = drafted(Biped(effort=0.0, velocity=1e6), tmp_path)
    lines = [line for line in draft.yaml.splitlines() if "stall_torque:" in line]
    assert lines and all("# guess: stall_torque and no_load_speed" in line for line in lines)
    weight = draft.robot.mass * 9.81
    torque = dict(zip(draft.robot.joint_names, draft.robot.torque_limit, strict=True))
    assert 0.2 * weight < torque["left_knee_pitch"] < weight  # N m of a leg of 0.7 m
    assert torque["left_elbow_pitch"] < torque["left_knee_pitch"]
    for key in ("base_link", "torso", "soles", "hands", "posture", "groups"):
        assert any(
            line.startswith(f"{key}:") and "guess" in line for line in draft.yaml.split("\n")
        )


def test_physically_impossible_inertias_are_corrected(tmp_path: Path):
    head, link, tail = Biped().urdf().partition('<link name="left_hip_yaw_link">')
    flat = head + link + re.sub('mass value="[^"]*"', 'mass value="0"', tail, count=1)
    draft = drafted(flat, tmp_path)
    assert any("raised from 0 kg" in note for note in draft.notes)
    for inertia in draft.robot.model.inertias[1:]:
        low, middle, high = np.linalg.eigvalsh(inertia.inertia)
        assert inertia.mass > 0.0 and low > 0.0 and low + middle >= high * (1.0 - 1e-9)


def test_verdicts_name_the_guesses_that_they_rest_on_until_they_are_confirmed(tmp_path: Path):
    draft = drafted(Biped(effort=0.0), tmp_path)
    guesses = draft.robot.spec.guesses
    assert {"soles", "posture", "hands", "limits"} <= set(guesses)
    assert any(re.fullmatch(r"servos\..+\.stall_torque", key) for key in guesses)
    motion = run_stages(draft.robot, load_gait("walk"), "walk").motion
    verdict = validate(motion, physics="none")
    assert list(verdict.guesses) == verdict.to_dict()["guesses"] == guesses
    confirmed = re.sub(r"^guesses:.*", "", draft.yaml, flags=re.DOTALL | re.MULTILINE)
    assert build_robot(confirmed, draft.urdf, "robot.yaml").spec.guesses == []
    with pytest.raises(ConfigError, match=r"guesses.*'sole' is not a key of this file"):
        build_robot(draft.yaml + "  - sole\n", draft.urdf, "robot.yaml")


def test_a_motor_that_turns_two_joints_of_a_leg_does_so_in_the_walk(tmp_path: Path):
    text = with_follower("left_ankle_pitch", "left_knee_pitch", 'multiplier="-1"')
    draft = drafted(text, tmp_path)
    assert "joint left_ankle_pitch follows left_knee_pitch: one motor turns both" in draft.notes
    assert unsound(draft.robot) == []
    motion = run_stages(draft.robot, load_gait("walk"), "walk").motion
    assert [check.name for check in check_motion(motion) if not check.ok] == []
    knee, ankle = (draft.robot.joint_names.index(f"left_{j}_pitch") for j in ("knee", "ankle"))
    joints = motion.q[:, FLOATING_BASE_NQ:]
    np.testing.assert_allclose(joints[:, ankle], -joints[:, knee], atol=1e-9)


# --- refused files -------------------------------------------------------------------------------

LOOP = """<joint name="rod" type="revolute"><parent link="left_knee_pitch_link"/>
  <child link="left_ankle_roll_link"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
</joint>"""
STRAY = '<joint name="x" type="fixed"><parent link="no"/><child link="pelvis"/></joint>'


def with_follower(name: str, leader: str, values: str = "") -> str:
    """A biped in which a joint mimics another one."""
    head, joint, tail = Biped().urdf().partition(f'<joint name="{name}"')
    mimic = f'<mimic joint="{leader}" {values}/></joint>'
    return head + joint + tail.replace("</joint>", mimic, 1)


REFUSED = {
    "point feet": (Biped(foot_geometry='<sphere radius="0.02"/>'), "point feet .* link left_ankle"),
    "a closed loop": (Biped(extra=[LOOP]), "link left_ankle_roll_link is the child of"),
    "a loop for Gazebo": (
        Biped(extra=[f"<gazebo>{LOOP}</gazebo>"]),
        "closed loop: link left_ankle_roll_link",
    ),
    "a leg that follows an arm": (
        with_follower("left_knee_pitch", "left_shoulder_pitch"),
        "leg joint left_knee_pitch mimics left_shoulder_pitch, which is no joint of the legs",
    ),
    "three joints a leg": (
        Biped(leg=("hip_roll", "hip_pitch", "knee_pitch")),
        "a leg has 3 joints .* at least 5",
    ),
    "a foot without shape": (Biped(foot_geometry="<none/>"), "has no readable shape"),
    "macros": (
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"><xacro:a/></link>'
        "</robot>",
        "xacro macros",
    ),
    "not XML": ("robot", "not valid XML"),
    "another format": ("<model/>", "<model>, not <robot> or <mujoco>"),
    "an SDF": ('<sdf><model><link name="a"/></model></sdf>', "an SDF, not a URDF"),
    "no links": ("<robot name='a'/>", "no links"),
    "two roots": (Biped(extra=['<link name="stray"/>']), "2 root links"),
    "a joint to nowhere": (
        Biped(extra=[STRAY]),
        "joint x: its parent is not a link",
    ),
    "a malformed position": (
        Biped().urdf().replace('xyz="0.0 0.0 -0.315"', 'xyz="0.0 0.0, -0.315"', 1),
        r"left_knee_pitch .*: origin xyz = '0.0 0.0, -0.315' is not three numbers",
    ),
    "a limit that is not a number": (
        Biped().urdf().replace('lower="0.0"', 'lower="low"', 1),
        "left_knee_pitch .*: limit lower = 'low' is not a number",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_an_unsuitable_urdf_is_refused_with_the_reason(name: str, tmp_path: Path):
    biped, reason = REFUSED[name]
    with pytest.raises(ConfigError, match=reason):
        drafted(biped, tmp_path)


def test_a_robot_with_four_feet_is_refused(tmp_path: Path):
    second = Biped(root="second", arm=(), waist=()).urdf()
    links = second.replace('name="left', 'name="hind_left').replace('link="left', 'link="hind_left')
    links = links.replace('name="right', 'name="hind_right').replace(
        'link="right', 'link="hind_right'
    )
    inside = links.partition(">")[2].rpartition("</robot>")[0]
    spine = (
        '<joint name="spine" type="fixed"><parent link="pelvis"/><child link="second"/>'
        '<origin xyz="-0.6 0 0"/></joint>'
    )
    with pytest.raises(ConfigError, match=r"two legs; .* is reached by left_"):
        drafted(Biped(arm=(), waist=(), extra=[inside, spine]), tmp_path)


def test_nothing_is_overwritten_without_force(tmp_path: Path):
    draft = drafted(Biped(), tmp_path)
    write_robot(draft, tmp_path / "mine")
    with pytest.raises(OutputExistsError):
        write_robot(draft, tmp_path / "mine")
    write_robot(draft, tmp_path / "mine", force=True)
    names = {path.name for path in (tmp_path / "mine").iterdir()}
    assert names == {"robot.urdf", "robot.yaml", "README.md"}


@pytest.mark.parametrize("name", ["", " mine", "a\nlocked: {}", "red\x1b[31m", "x" * 101])
def test_a_name_that_is_none_is_refused(name: str, tmp_path: Path):
    path = tmp_path / "some.urdf"
    path.write_text(Biped().urdf())
    with pytest.raises(ConfigError, match="is no name of a robot; use 1 to 100 characters"):
        init_robot(path, name)


def test_line_ends_in_the_name_of_a_urdf_add_nothing_to_robot_yaml(tmp_path: Path):
    """They would end the comment in which the name stands."""
    text = Biped().urdf()
    head = text[: text.index(">", text.index("<robot")) + 1]
    path = tmp_path / "some.urdf"
    path.write_text(text.replace(head, '<robot name="a&#10;locked: {left_knee: 0.0}">', 1))
    draft = init_robot(path)
    assert draft.robot.spec.name == "a locked: {left_knee: 0.0}"
    assert "\nlocked: {left_knee" not in draft.yaml and not draft.robot.spec.locked
