"""Robots drafted from MJCF, against MuJoCo's own compile of the same file."""

from __future__ import annotations

import re
import time
from pathlib import Path

import mujoco
import numpy as np
import pytest

from mgs.core import limits
from mgs.core.errors import ConfigError
from mgs.gait import load_gait
from mgs.judge.motion_checks import check_motion
from mgs.pipeline import run_stages
from mgs.robot import load_robot
from mgs.robot.init import DraftFolder, init_robot, write_robot
from mgs.robot.soundness import check_robot
from tests.support.mjcf import Twins, compiled
from tests.support.mjcf_biped import CUBE, mjcf
from tests.support.packages import file_of

STAND = """<keyframe>
  <key name="fallen" qpos="{base} {zeros}"/>
  <key name="stand" qpos="{base} {legs} {legs} 0 {arm} {arm2}"/>
</keyframe>"""


def saved(text: str, folder: Path) -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / "biped.xml"
    path.write_text(text)
    (folder / "foot.obj").write_text(CUBE)
    return path


def drafted(text: str, folder: Path) -> DraftFolder:
    return init_robot(saved(text, folder))


def stand() -> str:
    """A keyframe with bent knees and lowered forearms, beside another one."""
    legs = "0 0 -0.4 0.7 -0.3 0"
    return STAND.format(
        base="0 0 0.9 1 0 0 0", zeros=" ".join(["0"] * 19), legs=legs, arm="0.2 0.5 -1.1",
        arm2="0.2 -0.5 -1.1",
    )  # fmt: skip


def assert_twins(draft: DraftFolder, path: Path, inertia: float = 1e-6) -> None:
    """Mass, CoM, link poses and joint-space inertia at random postures are MuJoCo's."""
    robot, rng = draft.robot, np.random.default_rng(1)
    twins = Twins(robot, compiled(path))
    assert robot.mass == pytest.approx(twins.mass(), rel=1e-9)
    for _ in range(10):
        data = twins.pose(rng.uniform(robot.lower, robot.upper))
        assert np.abs(twins.link_errors()).max() < 1e-9  # [m] and [rad]
        np.testing.assert_allclose(data.com[0], twins.com(), atol=1e-9)
        upper = np.triu(data.M[6:, 6:])
        M = upper + np.triu(upper, 1).T
        assert np.abs(M - twins.inertia()).max() < inertia * np.abs(M).max()


# --- a biped with what a URDF cannot say ----------------------------------------------------------


def test_the_robot_is_the_one_that_mujoco_compiles(tmp_path: Path):
    path = saved(mjcf(), tmp_path)
    draft = init_robot(path)
    assert draft.robot.n == 19
    assert [len(joints) for joints in draft.robot.spec.groups.values()] == [6, 6, 3, 3, 1]
    assert_twins(draft, path)
    assert [finding.name for finding in check_robot(draft.robot) if not finding.ok] == []


def test_torques_rotors_and_friction_are_those_of_the_model(tmp_path: Path):
    robot = drafted(mjcf(), tmp_path).robot
    servo = {name: robot.spec.servos[robot.spec.joints[name]] for name in robot.joint_names}
    assert servo["left_knee"].stall_torque == 150.0  # ctrlrange times gear
    assert servo["left_ankle_roll"].stall_torque == 90.0  # forcerange
    assert servo["left_knee"].armature == 0.02
    assert servo["left_knee"].viscous_friction == 0.8
    assert (servo["left_elbow"].armature, servo["left_elbow"].friction) == (0.005, 0.3)
    assert "stall_torque" in draft_line(robot.yaml, "left_elbow")  # no actuator: a guess


def draft_line(yaml: str, joint: str) -> str:
    """Comment on the servo of a joint in robot.yaml."""
    (name,) = re.findall(rf"^  {joint}: (\S+-guess\S*)$", yaml, re.MULTILINE)
    (line,) = (line for line in yaml.splitlines() if line.startswith(f"  {name}: {{"))
    return line.partition("# guess: ")[2]


def test_angles_are_those_of_mujoco_although_joints_have_references(tmp_path: Path):
    robot = drafted(mjcf(), tmp_path).robot
    j = robot.joint_names.index("left_hip_pitch")
    assert np.degrees([robot.lower[j], robot.upper[j]]) == pytest.approx([-100.0, 60.0])


def test_the_keyframe_bends_the_arms(tmp_path: Path):
    robot = drafted(mjcf(stand()), tmp_path).robot
    at = dict(zip(robot.joint_names, robot.posture, strict=True))
    assert at["left_elbow"] == pytest.approx(-1.1)
    assert at["right_shoulder_roll"] == pytest.approx(-0.5)
    assert at["left_knee"] > 0.2


def test_excluded_pairs_do_not_collide(tmp_path: Path):
    pairs = drafted(mjcf(), tmp_path).robot.spec.ignore_collisions
    assert ["left_thigh", "pelvis"] in [sorted(pair) for pair in pairs]


def test_its_default_walk_passes_the_static_checks(tmp_path: Path):
    write_robot(drafted(mjcf(stand()), tmp_path), tmp_path / "robot")
    motion = run_stages(load_robot(tmp_path / "robot"), load_gait("walk"), "walk").motion
    assert [check.name for check in check_motion(motion) if not check.ok] == []


def test_the_base_may_hang_on_the_world_by_any_joints(tmp_path: Path):
    slides = "".join(f'<joint type="slide" axis="{a}"/>' for a in ("1 0 0", "0 1 0", "0 0 1"))
    draft = drafted(mjcf(pelvis=slides + '<joint axis="0 0 1"/>'), tmp_path)
    assert "4 joints between the world and body pelvis removed" in " ".join(draft.notes)
    assert draft.robot.n == 19


def test_what_else_stands_in_the_world_is_left_out(tmp_path: Path):
    ball = '<body name="ball"><freejoint/><geom type="sphere" size="0.1"/></body>'
    draft = drafted(mjcf(worldbody=ball), tmp_path)
    assert "bodies that are no part of the robot left out: ball" in draft.notes
    assert draft.robot.mass == pytest.approx(drafted(mjcf(), tmp_path).robot.mass, rel=1e-12)


def test_included_files_count(tmp_path: Path):
    whole = mjcf(stand())
    defaults = whole[whole.index("<default>") : whole.rindex("</default>") + len("</default>")]
    path = saved(whole.replace(defaults, '<include file="parts/defaults.xml"/>'), tmp_path)
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "defaults.xml").write_text(f"<mujocoinclude>{defaults}</mujocoinclude>")
    assert init_robot(path).urdf == drafted(whole, tmp_path / "whole").urdf


def test_joints_that_a_constraint_couples_turn_together(tmp_path: Path):
    """With the references of both joints, as MuJoCo's own constraint says."""
    equality = '<joint joint1="right_hip_pitch" joint2="left_hip_pitch" polycoef="0 1 0 0 0"/>'
    path = saved(mjcf(equality=equality), tmp_path)
    robot = init_robot(path).robot
    assert set(robot.followers) == {"right_hip_pitch"}
    model = compiled(path)
    data = mujoco.MjData(model)
    q = robot.posture + 0.1
    assert robot.coupling is not None
    robot.coupling.complete(q)
    for name, angle in zip(robot.joint_names, q, strict=True):
        data.qpos[model.joint(name).qposadr[0]] = angle
    mujoco.mj_forward(model, data)
    rows = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    assert rows.sum() == 1
    assert np.abs(data.efc_pos[rows]).max() < 1e-12  # [rad], of MuJoCo's constraint


def test_a_constraint_that_is_not_active_couples_nothing(tmp_path: Path):
    equality = '<joint joint1="right_knee" joint2="left_knee" active="false"/>'
    assert not drafted(mjcf(equality=equality), tmp_path).robot.followers


# --- refused, with the reason ---------------------------------------------------------------------

BALL = (
    '<body name="{side}_toe" pos="0.1 0 -0.05"><joint name="{side}_toe" type="ball"/>'
    '<geom type="sphere" size="0.01"/></body>'
)
REFUSED = {
    "an element that MuJoCo does not know": (
        mjcf(worldbody="<bdy/>"), "MuJoCo says: .*unrecognized element",
    ),
    "a class that is not defined": (
        mjcf(worldbody='<geom class="no" size="1"/>'), "MuJoCo says: .*default class",
    ),
    "no XML": ("<mujoco><worldbody>", "not valid XML"),
    "no body": ("<mujoco><worldbody/></mujoco>", "it has no body"),
    "a ball joint": (mjcf(toes=BALL), "joint left_toe is a ball joint; replace it by three hinges"),
    "a closed loop": (
        mjcf(equality='<connect body1="left_foot" body2="right_foot" anchor="0 0 0"/>'),
        "closed loop: the bodies left_foot and right_foot",
    ),
    "a coupling that is not linear": (
        mjcf(equality='<joint joint1="left_knee" joint2="left_hip_yaw" polycoef="0 1 2 0 0"/>'),
        "joint left_knee follows joint left_hip_yaw by a polynomial of higher order",
    ),
    "copies": (
        mjcf(worldbody='<replicate count="9"><geom size="1"/></replicate>'),
        "it has elements <replicate>",
    ),
    "generated meshes": (
        mjcf(asset='<mesh name="foot" builtin="sphere" params="30"/>'), "generated meshes",
    ),
    "a mass that is that of a missing mesh": (
        mjcf(asset='<mesh name="foot" file="lost.obj"/>'),
        "body left_foot has no <inertial>, and its mesh 'lost.obj' was not found",
    ),
    "a document type": ("<!DOCTYPE mujoco><mujoco/>", "declares a document type"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "reason"), REFUSED.values(), ids=REFUSED)
def test_it_is_refused(text: str, reason: str, tmp_path: Path):
    with pytest.raises(ConfigError, match=reason):
        drafted(text, tmp_path)


def test_files_elsewhere_stay_closed(tmp_path: Path):
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "foot.obj").write_text(CUBE)
    (outside / "part.xml").write_text("<mujocoinclude/>")
    for name in ("../outside/part.xml", str(outside / "part.xml")):
        path = saved(mjcf(f'<include file="{name}"/>'), tmp_path / "model")
        with pytest.raises(ConfigError, match=r"included file .* is not found in the folder"):
            init_robot(path)
    path.write_text(mjcf(asset='<mesh name="foot" file="../outside/foot.obj"/>'))
    with pytest.raises(ConfigError, match="was not found"):
        init_robot(path)
    scaled = '<mesh name="foot" file="foot.obj" scale="0.1 0.05 0.015"/>'
    (path.parent / "foot.obj").unlink()
    path.write_text(mjcf(asset=scaled))
    assert init_robot(path, package_paths=(outside,)).robot.n == 19


def test_a_file_that_includes_itself_is_refused(tmp_path: Path):
    path = saved(mjcf('<include file="biped.xml"/>'), tmp_path)
    with pytest.raises(ConfigError, match=r"'biped\.xml' is included twice"):
        init_robot(path)


def test_a_deep_or_long_model_is_refused_before_mujoco_sees_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(mujoco.MjSpec, "from_string", None)
    deep = "<body>" * limits.MAX_XML_NESTING + "</body>" * limits.MAX_XML_NESTING
    start = time.process_time()
    for text, reason in (
        (mjcf(worldbody=deep), "nested too deeply"),
        (mjcf(worldbody="<body/>" * (limits.MAX_LINKS + 1)), f"at most {limits.MAX_LINKS}"),
        (mjcf(worldbody="<geom/>" * (limits.MAX_XML_ELEMENTS + 1)), "elements"),
    ):
        with pytest.raises(ConfigError, match=reason):
            drafted(text, tmp_path)
    assert time.process_time() - start < 20.0  # [s], of the limit in docs/security.md


# --- public models, if their packages are installed -----------------------------------------------


@pytest.mark.parametrize(
    ("package", "name", "joints"),
    [
        ("mjlab", "unitree_g1/xmls/g1.xml", 29),
        ("holosoma", "robots/t1/t1_29dof.xml", 29),
        ("dm_control", "suite/humanoid.xml", 21),
    ],
)
def test_a_public_model_is_the_one_that_mujoco_compiles(package: str, name: str, joints: int):
    path = file_of(package, name)
    draft = init_robot(path)
    assert draft.robot.n == joints
    assert_twins(draft, path)
