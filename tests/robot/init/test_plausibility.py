"""URDFs as they go wrong in public: what is refused, what is mended, and what the user is told."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.gait import load_gait
from mgs.pipeline import run_stages
from mgs.robot import Robot, build_robot, load_robot
from mgs.robot.init import DraftFolder, init_robot, write_robot
from mgs.robot.soundness import check_robot, one_legged_torques
from tests.support.bipeds import Biped

SHIN = "left_knee_pitch_link"


def drafted(text: Biped | str, folder: Path) -> DraftFolder:
    path = folder / "boxes.urdf"
    path.write_text(text if isinstance(text, str) else text.urdf())
    return init_robot(path)


def changed(pattern: str, new: str, text: str | None = None, count: int = 1) -> str:
    """The biped with the matches of a regular expression replaced."""
    text, n = re.subn(pattern, new, text or Biped().urdf(), count=count, flags=re.DOTALL)
    assert n, f"nothing matches {pattern}"
    return text


def in_link(name: str, pattern: str, new: str) -> str:
    return changed(rf'(<link name="{name}">.*?){pattern}', rf"\g<1>{new}")


def in_joint(name: str, pattern: str, new: str, text: str | None = None) -> str:
    return changed(rf'(<joint name="{name}".*?){pattern}', rf"\g<1>{new}", text)


# --- refused, with the place ----------------------------------------------------------------------

REFUSED = {
    "a mass that is an expression": (
        in_link(SHIN, '<mass value="[^"]*"', r'<mass value="${m_shin}"'),
        rf"link {SHIN} \(line \d+\): mass value = '\$\{{m_shin\}}' is not a number; expand",
    ),
    "a mass that is not finite": (
        in_link(SHIN, '<mass value="[^"]*"', '<mass value="inf"'),
        f"link {SHIN} .*: mass value = 'inf' is not finite",
    ),
    "a negative mass": (
        in_link(SHIN, '<mass value="[^"]*"', '<mass value="-1"'), "mass value = '-1' has to be 0",
    ),
    "an inertia that is no number": (
        in_link(SHIN, 'iyy="[^"]*"', 'iyy="1,5"'), "inertia iyy = '1,5' is not a number",
    ),
    "an inertial element without a mass": (
        in_link(SHIN, '<mass value="[^"]*"/>', ""),
        f"link {SHIN}: inertial has no mass; add <mass value>",
    ),
    "an axis without direction": (
        in_joint("left_knee_pitch", '<axis xyz="[^"]*"', '<axis xyz="0 0 0"'),
        "joint left_knee_pitch: axis xyz = '0 0 0' has no direction",
    ),
    "a box of negative size": (
        in_link(SHIN, '<box size="[^"]*"', '<box size="0.1 -0.1 0.1"'),
        r"box size = '0.1 -0.1 0.1' has to be above 0",
    ),
    "an empty name": (
        changed(f'name="{SHIN}"', 'name=""', changed(f'link="{SHIN}"', 'link=""', count=0)),
        "a link has an empty name",
    ),
    "no inertial element": (
        changed("<inertial>.*?</inertial>", "", count=0), "no link has a mass",
    ),
    "a limit that is not a number": (
        in_joint("left_knee_pitch", 'upper="[^"]*"', 'upper="nan"'),
        "joint left_knee_pitch .*: limit upper = 'nan' is not a number",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_a_number_that_cannot_be_taken_is_refused_with_its_place(name: str, tmp_path: Path):
    text, message = REFUSED[name]
    with pytest.raises(ConfigError, match=message):
        drafted(text, tmp_path)


@pytest.mark.parametrize("name", ["a mass that is an expression", "an axis without direction"])
def test_the_urdf_of_a_robot_folder_is_checked_in_the_same_way(name: str, melson: Robot):
    """Urdfdom would drop the inertial element, and an engine would fail on the axis."""
    attribute, value = {
        "a mass that is an expression": ("mass value", "${m}"),
        "an axis without direction": ("axis xyz", "0 0 0"),
    }[name]
    urdf = changed(f'<{attribute}="[^"]*"', f'<{attribute}="{value}"', melson.urdf)
    with pytest.raises(ConfigError, match=r"is not a number|has no direction"):
        build_robot(melson.yaml, urdf, "melson")


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_no_number_of_a_urdf_is_dropped(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
):
    """Any number that does not parse is named; urdfdom would leave its element out in silence."""
    root = ElementTree.fromstring(Biped().urdf())
    parts = [(part, e) for part in root for e in part.iter() if part.tag in ("link", "joint")]
    numbers = [
        (part, element, key) for part, element in parts for key, value in element.attrib.items()
        if key in ("xyz", "rpy", "size", "value", "ixx", "iyy", "izz", "lower", "upper", "effort",
                   "velocity") and value
    ]  # fmt: skip
    part, element, key = data.draw(st.sampled_from(numbers))
    bad = data.draw(st.sampled_from(["${x}", "1,0", "one", "nan", "1 2", "--1", "1e", "0x10"]))
    element.set(key, bad)
    with pytest.raises(ConfigError, match=re.escape(str(part.get("name")))):
        drafted(ElementTree.tostring(root, encoding="unicode"), tmp_path_factory.mktemp("spoilt"))


# --- mended, with a note --------------------------------------------------------------------------


def test_a_shape_of_size_zero_is_left_out(tmp_path: Path):
    text = changed(
        "</link>", '<collision><geometry><sphere radius="0"/></geometry></collision></link>'
    )
    draft = drafted(text, tmp_path)
    assert any("shape of size 0 removed from link pelvis" in note for note in draft.notes)


def test_placeholder_inertias_give_way_to_those_of_the_shapes(tmp_path: Path):
    """1 kg m^2 on every link; the shapes are boxes, whose inertias the builder had written."""
    honest = drafted(Biped(), tmp_path).robot
    text = changed('i(xx|yy|zz)="[^"]*"', r'i\1="1"', count=0)
    draft = drafted(text, tmp_path)
    assert any("radius of gyration" in note and SHIN in note for note in draft.notes)
    assert draft.robot.mass == pytest.approx(honest.mass)
    for name in ("left_knee_pitch", "right_hip_pitch"):
        j = honest.model.getJointId(name)
        found, right = draft.robot.model.inertias[j], honest.model.inertias[j]
        np.testing.assert_allclose(found.inertia, right.inertia, rtol=1e-6, atol=1e-12)
        np.testing.assert_allclose(found.lever, right.lever)


def test_honest_inertias_are_left_alone(tmp_path: Path):
    assert not any("radius of gyration" in note for note in drafted(Biped(), tmp_path).notes)


def test_a_fixed_world_link_is_removed(tmp_path: Path):
    weld = '<link name="world"/><joint name="weld" type="fixed"><parent link="world"/><child link="pelvis"/>{}</joint>'  # noqa: E501
    plain = drafted(Biped(), tmp_path).robot
    for origin in ("", '<origin xyz="1 2 3"/>', '<origin xyz="1 2 3" rpy="0 0 1"/>'):
        draft = drafted(Biped(extra=[weld.format(origin)]), tmp_path)
        assert draft.robot.spec.base_link == "pelvis"
        assert "world" not in draft.urdf
        assert any("world" in note and "removed" in note for note in draft.notes)
        np.testing.assert_allclose(draft.robot.standing_q, plain.standing_q, atol=1e-9)


def test_limits_of_a_continuous_joint_hold(tmp_path: Path):
    text = in_joint("left_hip_pitch", 'type="revolute"', 'type="continuous"')
    draft = drafted(text, tmp_path)
    j = draft.robot.joint_names.index("left_hip_pitch")
    assert (draft.robot.lower[j], draft.robot.upper[j]) == (-1.6, 1.6)
    assert any("left_hip_pitch is continuous, but has limits" in note for note in draft.notes)


def test_leftover_macros_and_simulator_blocks_are_ignored_and_noted(tmp_path: Path):
    extra = [
        '<x:imu_sensor xmlns:x="http://www.ros.org/wiki/xacro" name="imu"/>',
        "<gazebo><plugin/></gazebo>",
        '<transmission><joint name="left_knee_pitch"/></transmission>',
    ]
    draft = drafted(Biped(extra=extra), tmp_path)
    (note,) = [note for note in draft.notes if "ignored" in note]
    assert "1 <imu_sensor>" in note and "1 <gazebo>" in note and "1 <transmission>" in note


@pytest.mark.parametrize("span", [(0.0, 0.002), (-0.01, 0.01)])
def test_a_joint_with_hardly_any_range_is_fixed_and_named(
    tmp_path: Path, span: tuple[float, float]
):
    limits = f'lower="{span[0]}" upper="{span[1]}"'
    text = in_joint("waist_yaw", 'lower="[^"]*" upper="[^"]*"', limits)
    draft = drafted(text, tmp_path)
    assert "waist_yaw" not in draft.robot.joint_names
    assert any("joint waist_yaw fixed: its range" in note for note in draft.notes)
    run_stages(draft.robot, load_gait("generic/walk"))


def test_a_locked_angle_is_read_back_exactly(tmp_path: Path):
    """The range of a finger begins at a number of 17 digits."""
    low = 0.04852015320544236
    fingers = [
        f'<link name="{name}"/><joint name="{name}_pitch" type="revolute">'
        f'<parent link="left_elbow_pitch_link"/><child link="{name}"/><axis xyz="0 1 0"/>'
        f'<limit lower="{low!r}" upper="1.0" effort="1" velocity="1"/></joint>'
        for name in ("finger", "thumb")
    ]
    draft = drafted(Biped(extra=fingers), tmp_path)
    write_robot(draft, tmp_path / "mine")
    assert load_robot(tmp_path / "mine").spec.locked["thumb_pitch"] == low


def test_meshes_and_robots_in_millimetres_are_recognised(tmp_path: Path):
    mesh = tmp_path / "shin.stl"
    triangle = np.array([[0, 0, 0], [80, 0, 0], [0, 0, 300], [0, 60, 0]])
    facets = [triangle[[0, 1, 2]], triangle[[0, 2, 3]], triangle[[0, 3, 1]], triangle[[1, 3, 2]]]
    mesh.write_text(
        "solid shin\n" + "".join(
            "facet normal 0 0 0\nouter loop\n"
            + "".join(f"vertex {x} {y} {z}\n" for x, y, z in facet) + "endloop\nendfacet\n"
            for facet in facets
        ) + "endsolid shin\n"
    )  # fmt: skip
    assert coal.MeshLoader(coal.BV_OBBRSS).load(str(mesh), np.ones(3)).num_vertices
    text = in_link(SHIN, '<box size="[^"]*"/>', '<mesh filename="shin.stl"/>')
    with pytest.raises(ConfigError, match=f"link {SHIN} reach .* is its mesh in millimetres"):
        drafted(text, tmp_path)
    scaled = text.replace('filename="shin.stl"', 'filename="shin.stl" scale="0.001 0.001 0.001"')
    drafted(scaled, tmp_path)
    with pytest.raises(ConfigError, match="are these millimetres"):
        drafted(Biped(size=700.0), tmp_path)


# --- facing and stance ----------------------------------------------------------------------------


@pytest.mark.parametrize("span", [(-1.05, 1.10), (-1.10, 1.05), (-1.1, 1.1)])
def test_knees_that_bend_both_ways_leave_the_direction_to_other_signs(
    tmp_path: Path, span: tuple[float, float]
):
    text = Biped(ahead=0.04).urdf()
    for side in Side:
        text = in_joint(
            f"{side.label}_knee_pitch", 'lower="[^"]*" upper="[^"]*"',
            f'lower="{span[0]}" upper="{span[1]}"', text,
        )  # fmt: skip
    draft = drafted(text, tmp_path)
    assert draft.robot.spec.base_link == "pelvis"  # no root link that turns the robot
    assert not any("contradict" in note for note in draft.notes)


def test_contradicting_signs_are_told(tmp_path: Path):
    """Heels longer than toes, on a robot whose knees and names say the opposite."""
    draft = drafted(Biped(ahead=-0.05), tmp_path)
    assert draft.robot.spec.base_link == "pelvis"
    (note,) = [note for note in draft.notes if "contradict" in note]
    assert "length of the toes for the opposite one" in note


def test_a_wide_zero_posture_gives_a_stance_that_walks(tmp_path: Path):
    text = Biped(size=0.5).urdf()
    for side, sign in (("left", 1), ("right", -1)):
        text = in_joint(f"{side}_hip_yaw", 'xyz="[^"]*"', f'xyz="0 {0.16 * sign} 0"', text)
    robot = drafted(text, tmp_path).robot
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.standing_q)
    left, right = (data.oMf[frame].translation for frame in robot.sole_frames)
    assert 0.13 < left[1] - right[1] < 0.2  # the soles are 0.1 m wide, the hips 0.32 m apart
    run_stages(robot, load_gait("generic/walk"))


# --- strength -------------------------------------------------------------------------------------


def test_joints_that_cannot_hold_the_robot_are_named(tmp_path: Path):
    weak = drafted(Biped(effort=1.4), tmp_path).robot  # the motor's side of a gear
    (finding,) = [f for f in check_robot(weak) if f.name == "strength"]
    assert not finding.ok and "left_knee_pitch needs" in finding.figure
    assert "before its gear" in finding.remedy
    strong = drafted(Biped(), tmp_path).robot
    (finding,) = [f for f in check_robot(strong) if f.name == "strength"]
    assert finding.ok


def test_torques_on_one_leg_agree_with_virtual_work(melson: Robot):
    """Moving a leg joint lifts the body above the sole: tau = - d(m g z) / dq, sole at rest."""
    data = melson.model.createData()
    pin.framesForwardKinematics(melson.model, data, melson.standing_q)
    torques = one_legged_torques(melson, data, Side.LEFT)
    frame = melson.sole_frames[Side.LEFT]

    def com_above_sole(q: np.ndarray) -> float:
        pin.framesForwardKinematics(melson.model, data, q)
        com = pin.centerOfMass(melson.model, data, q, False)
        return float(com[2] - data.oMf[frame].translation[2])

    for name in ("left_hip_pitch", "left_knee_pitch", "left_ankle_pitch"):
        j, step = melson.joint_names.index(name), 1e-6
        above, below = melson.standing_q.copy(), melson.standing_q.copy()
        above[7 + j] += step
        below[7 + j] -= step
        slope = (com_above_sole(above) - com_above_sole(below)) / (2 * step)
        # base upright: the wrench has no moment, as in the code; the potential gives the same
        assert torques[j] == pytest.approx(melson.mass * 9.81 * slope, rel=1e-3, abs=1e-6)
