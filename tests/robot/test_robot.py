"""Tests of the robot Melson against published values and its README, and of faulty folders."""

from __future__ import annotations

import itertools
import math
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest
import yaml
from numpy.testing import assert_allclose

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.shipped import shipped_folder
from mgs.ik_solver.tree.support_tree import build_support_tree
from mgs.robot import Robot, build_robot, list_robots, load_robot, midpoint_width

FOLDER = shipped_folder("robots") / "melson"
YAML = (FOLDER / "robot.yaml").read_text()
URDF = (FOLDER / "robot.urdf").read_text()
README = (FOLDER / "README.md").read_text()
MIRROR = np.diag([1.0, -1.0, 1.0])
STRETCHED = np.zeros(19)


def standing_still(robot: Robot, joints: np.ndarray) -> tuple[pin.Data, pin.SE3]:
    """Kinematics at joint angles (n,), and the pose of the ground below the left sole."""
    q = np.concatenate([pin.neutral(robot.model)[:FLOATING_BASE_NQ], joints])
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    pin.centerOfMass(robot.model, data, q, False)
    return data, data.oMf[robot.sole_frames[Side.LEFT]]


def vertices_in_base(robot: Robot, joints: np.ndarray) -> np.ndarray:
    """Corners (m, 3) of all collision boxes, from the URDF by its own parser."""
    data, _ = standing_still(robot, joints)
    corners = []
    for link in ElementTree.fromstring(URDF).iter("link"):
        T_base_link = data.oMf[robot.model.getBodyId(link.get("name"))]
        for shape in link.iter("collision"):
            centre = np.fromstring(shape.find("origin").get("xyz"), sep=" ")
            size = np.fromstring(shape.find("geometry/box").get("size"), sep=" ")
            for signs in itertools.product((-0.5, 0.5), repeat=3):
                corners.append(T_base_link.act(centre + np.array(signs) * size))
    return np.array(corners)


# --- published figures ------------------------------------------------------------------------


def test_melson_has_the_published_mass_height_and_joints(melson: Robot):
    assert melson.mass == pytest.approx(2.6, rel=0.005)
    heights = vertices_in_base(melson, STRETCHED)[:, 2]
    assert np.ptp(heights) == pytest.approx(0.5, abs=0.005)
    assert melson.n == 19
    assert {group: len(names) for group, names in melson.spec.groups.items()} == {
        "left_leg": 6,
        "right_leg": 6,
        "left_arm": 3,
        "right_arm": 3,
        "waist": 1,
    }


def test_the_servos_of_melson_have_their_published_values(melson: Robot):
    for i, name in enumerate(melson.joint_names):
        in_leg = name in melson.spec.groups["left_leg"] + melson.spec.groups["right_leg"]
        torque, seconds_per_60_deg = (2.8, 0.167) if in_leg else (1.5, 0.169)
        assert melson.torque_limit[i] == torque
        # the data sheet gives three digits
        assert melson.no_load_speed[i] == pytest.approx(math.pi / 3 / seconds_per_60_deg, rel=2e-3)
        assert melson.speed_limit[i] <= melson.no_load_speed[i]
        assert melson.upper[i] - melson.lower[i] < math.radians(300)  # the mechanism's range


def test_melson_is_symmetric(melson: Robot):
    """Mirrored joint angles give the mirrored robot: CoM, inertia and frame of every body."""
    rng = np.random.default_rng(0)
    for _ in range(5):
        joints = rng.uniform(melson.lower, melson.upper)
        mirrored = np.empty(melson.n)
        for i, name in enumerate(melson.joint_names):
            twin = melson.joint_names.index(swap_sides(name))
            mirrored[twin] = joints[i] if name.endswith("pitch") else -joints[i]
        assert np.all(mirrored >= melson.lower - 1e-9) and np.all(mirrored <= melson.upper + 1e-9)
        (here, _), (there, _) = standing_still(melson, joints), standing_still(melson, mirrored)
        for joint in range(1, melson.model.njoints):
            twin = melson.model.getJointId(swap_sides(melson.model.names[joint]))
            a = here.oMi[joint].act(melson.model.inertias[joint])
            b = there.oMi[twin].act(melson.model.inertias[twin])
            assert a.mass == b.mass
            assert_allclose(MIRROR @ a.lever, b.lever, atol=1e-12)
            assert_allclose(MIRROR @ a.inertia @ MIRROR, b.inertia, atol=1e-12)
        for frames in (melson.sole_frames, melson.hand_frames):
            a, b = here.oMf[frames[0]], there.oMf[frames[1]]
            assert_allclose(MIRROR @ a.translation, b.translation, atol=1e-12)
            assert_allclose(MIRROR @ a.rotation @ MIRROR, b.rotation, atol=1e-12)


def swap_sides(name: str) -> str:
    return re.sub("left|right", lambda m: {"left": "right", "right": "left"}[m[0]], name)


def test_every_inertia_is_physically_possible(melson: Robot):
    """Masses are positive, and a body of positive density can have these inertias."""
    for inertia in melson.model.inertias[1:]:
        assert inertia.mass > 0.0
        spread = 0.5 * np.trace(inertia.inertia) * np.eye(3) - inertia.inertia
        assert np.linalg.eigvalsh(spread).min() > 0.0


def test_every_inertia_fits_a_body_inside_its_boxes(melson: Robot):
    for link in ElementTree.fromstring(URDF).iter("link"):
        inertial = link.find("inertial")
        lever = np.fromstring(inertial.find("origin").get("xyz"), sep=" ")
        mass = float(inertial.find("mass").get("value"))
        ixx, iyy, izz = (float(inertial.find("inertia").get(key)) for key in ("ixx", "iyy", "izz"))
        boxes = [
            (
                np.fromstring(shape.find("origin").get("xyz"), sep=" "),
                np.fromstring(shape.find("geometry/box").get("size"), sep=" "),
            )
            for shape in link.iter("collision")
        ]
        low = np.min([centre - size / 2 for centre, size in boxes], axis=0)
        high = np.max([centre + size / 2 for centre, size in boxes], axis=0)
        assert np.all((low < lever) & (lever < high)), link.get("name")
        reach = np.maximum(high - lever, lever - low)
        spread = 0.5 * np.array([iyy + izz - ixx, izz + ixx - iyy, ixx + iyy - izz]) / mass
        assert np.all(spread < reach**2), link.get("name")


# --- posture ----------------------------------------------------------------------------------


def test_the_posture_lies_within_the_limits_with_room(melson: Robot):
    room = np.minimum(melson.posture - melson.lower, melson.upper - melson.posture)
    assert room.min() > math.radians(5.0)


def test_in_the_posture_both_soles_are_flat_on_the_ground(any_robot: Robot):
    """With random leg angles at least the left sole is flat and the origin is midway."""
    data = any_robot.model.createData()
    pin.framesForwardKinematics(any_robot.model, data, any_robot.standing_q)
    left, right = (data.oMf[frame] for frame in any_robot.sole_frames)
    assert_allclose(left.translation + right.translation, 0.0, atol=1e-12)
    assert_allclose(left.rotation, np.eye(3), atol=1e-12)
    if any_robot.spec.name == "melson":
        assert_allclose(right.rotation, np.eye(3), atol=1e-12)
        assert_allclose([left.translation[2], right.translation[2]], 0.0, atol=1e-12)


def test_the_soles_are_the_lowest_faces_of_the_feet(melson: Robot):
    """Frame and rectangle of robot.yaml coincide with the underside of the lowest box."""
    data, _ = standing_still(melson, STRETCHED)
    corners = vertices_in_base(melson, STRETCHED)
    ground = corners[np.isclose(corners[:, 2], corners[:, 2].min(), atol=1e-9)]
    for side in Side:
        sole, frame = melson.sole_spec(side), data.oMf[melson.sole_frames[side]].translation
        own = ground[np.sign(ground[:, 1]) == side.sign]
        assert_allclose(own.mean(axis=0), frame, atol=1e-9)
        assert_allclose(np.ptp(own, axis=0), [sole.length, sole.width, 0.0], atol=1e-9)


def test_no_shapes_touch_at_zero_in_the_posture_and_at_mid_range(melson: Robot):
    geometry = melson.geometry
    for joints in (STRETCHED, melson.posture, 0.5 * (melson.lower + melson.upper)):
        q = np.concatenate([pin.neutral(melson.model)[:7], joints])
        data = geometry.createData()
        touching = pin.computeCollisions(
            melson.model, melson.model.createData(), geometry, data, q, True
        )
        assert not touching


def test_collisions_are_checked_between_all_links_that_no_joint_connects(melson: Robot):
    frames = melson.model.frames
    watched = set()
    for pair in melson.geometry.collisionPairs:
        links = [
            frames[melson.geometry.geometryObjects[i].parentFrame].name
            for i in (pair.first, pair.second)
        ]
        watched.add(frozenset(links))
    tree = ElementTree.fromstring(URDF)
    links = {link.get("name") for link in tree.iter("link")}
    jointed = {
        frozenset((joint.find("parent").get("link"), joint.find("child").get("link")))
        for joint in tree.iter("joint")
    }
    assert watched == {frozenset(pair) for pair in itertools.combinations(links, 2)} - jointed


# --- README -----------------------------------------------------------------------------------


def row(label: str, section: str = "") -> list[float]:
    """Numbers in the cells of the README's first table row that begins with `label`."""
    lines = README[README.index(section) :].splitlines()
    line = next(line for line in lines if line.startswith(f"| {label} |"))
    return [float(x) for x in re.findall(r"-?\d+\.?\d*", line.split("|", 2)[2])]


def test_lengths_in_the_readme_are_those_of_the_model(melson: Robot):
    data, ground = standing_still(melson, STRETCHED)

    def joint(name: str) -> np.ndarray:
        return data.oMi[melson.model.getJointId(name)].translation

    hip, knee, ankle = joint("left_hip_pitch"), joint("left_knee_pitch"), joint("left_ankle_roll")
    shoulder, elbow = joint("left_shoulder_roll"), joint("left_elbow_pitch")
    hand = data.oMf[melson.hand_frames[Side.LEFT]].translation
    level = ground.translation[2]
    assert_allclose(joint("left_ankle_pitch"), ankle, atol=1e-12)
    for label, found in {
        "body height": np.ptp(vertices_in_base(melson, STRETCHED)[:, 2]),
        "shoulder height": shoulder[2] - level,
        "thigh": hip[2] - knee[2],
        "shank": knee[2] - ankle[2],
        "hip to hip": 2.0 * hip[1],
        "upper arm": shoulder[2] - elbow[2],
        "ankle height": ankle[2] - level,
        "hip to shoulder, vertical": shoulder[2] - hip[2],
        "between shoulder centres": 2.0 * shoulder[1],
    }.items():
        # the last figure but for the number of a remark: fractions, scaled, the length built
        built = [x for x in row(label) if x not in (1.0, 2.0, 3.0)][-1]
        assert built == pytest.approx(found), label
    assert row("forearm")[2] + 0.5 * row("hand")[2] == pytest.approx(elbow[2] - hand[2])
    assert row("knee, hip height")[-3:-1] == pytest.approx([knee[2] - level, hip[2] - level])


def test_masses_in_the_readme_are_those_of_the_urdf():
    for link in ElementTree.fromstring(URDF).iter("link"):
        label = re.sub("^(left|right)_", "", link.get("name"))
        grams = 1e3 * float(link.find("inertial/mass").get("value"))
        assert row(label, "## Masses")[-1] == pytest.approx(grams), label


def test_limits_in_the_readme_are_those_of_the_urdf(melson: Robot):
    for i, name in enumerate(melson.joint_names):
        if name.startswith("right"):
            continue
        low, high, middle = row(name.removeprefix("left_"))[:3]
        found = np.degrees([melson.lower[i], melson.upper[i]])
        assert_allclose(found, [low, high], atol=0.01)  # five digits in the URDF
        assert middle == pytest.approx(0.5 * (low + high))


def test_standing_figures_in_the_readme_are_those_of_the_model(melson: Robot):
    for column, joints in enumerate((STRETCHED, melson.posture)):
        data, ground = standing_still(melson, joints)
        hip = ground.actInv(data.oMi[melson.model.getJointId("left_hip_pitch")].translation)
        com = ground.actInv(data.com[0])
        assert row("hip height")[column] == pytest.approx(hip[2], abs=5e-5)  # four decimals
        assert row("centre of mass above the ground")[column] == pytest.approx(com[2], abs=5e-5)
        in_front = row("centre of mass in front of the sole centres")[column]
        assert in_front == pytest.approx(com[0], abs=1e-4)  # "within 0.1 mm"


def test_the_step_width_is_the_distance_of_the_soles_in_the_posture(melson: Robot):
    assert midpoint_width(melson) == pytest.approx(row("hip to hip")[1])  # legs hang straight


# --- folders gone wrong -----------------------------------------------------------------------


def refusal(yaml_text: str, urdf: str = URDF) -> str:
    with pytest.raises(ConfigError) as caught:
        build_robot(yaml_text, urdf, "robot.yaml")
    assert str(caught.value).startswith("robot.yaml: ")
    return str(caught.value)


def changed(old: str, new: str, text: str = YAML) -> str:
    assert old in text
    return text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("mgs: 1", "mgs: 2", "mgs: input should be 1, found 2"),
        ("name: melson", "", "name: missing"),
        ("name: melson", "nmae: melson\nname: melson", "nmae: unknown key; did you mean 'name'?"),
        ("base_link: pelvis", "base_link: hips", "base_link: robot.urdf has no link 'hips'"),
        ("base_link: pelvis", "base_link: torso", "'torso' is not the root link"),
        (
            "torso: {link: torso,",
            "torso: {link: chest,",
            "torso.link: robot.urdf has no link 'chest'",
        ),
        ("link: left_foot", "link: lfoot", "soles.left.link: robot.urdf has no link 'lfoot'"),
        ("link: right_forearm", "link: hand", "hands.right.link: robot.urdf has no link 'hand'"),
        (
            "length: 0.106",
            "length: 0.0",
            "soles.left.length: input should be greater than or equal to 0.001 [m]",
        ),
        ("width: 0.06", "width: .nan", "soles.left.width: input should be a finite number"),
        ("position: [0.002, 0.0, -0.036]", "position: [0.002, 0.0]", "soles.left.position: "),
        (
            "left_knee_pitch: 0.87",
            "left_knee_pitch: 2.9",
            "posture.left_knee_pitch: 2.9000 rad is outside",
        ),
        (
            "left_knee_pitch: 0.87",
            "left_knee: 0.87",
            "posture: robot.urdf has no joint 'left_knee'",
        ),
        ("left_knee_pitch: 0.87", "left_knee_pitch: bent", "posture.left_knee_pitch: "),
        ("stall_torque: 2.8", "stall_torque: -2.8", "servos.RX-28.stall_torque: "),
        ("stall_torque: 2.8, ", "", "servos.RX-28.stall_torque: missing"),
        ("punch: 0.1752", "stiffness: 0.0", "servos.RX-28.stiffness: "),
        ("punch: 0.1752", "stiffness: .inf", "servos.RX-28.stiffness: "),
        ("punch: 0.1752", "stiffness: 17.0", "give stiffness or compliance_slope, not both"),
        ("punch: 0.1752", "punch: -0.1", "servos.RX-28.punch: "),
        (
            "compliance_slope: 16, deadband: 0.00511, punch: 0.1752",
            "compliance_slope: 33",
            "servos.RX-28.compliance_slope: ",
        ),
        ("resolution: 0.00511, armature: 0.005", "armature: 0.005", "give resolution too"),
        ("latency: 0.004, friction: 0.05}\n  AX", "latency: 4.0}\n  AX", "servos.RX-28.latency: "),
        ("waist_yaw: AX-12", "waist_yaw: AX-18", "joints.waist_yaw: servo 'AX-18' is not listed"),
        ("  waist_yaw: AX-12\n", "", "joints: no servo given for joint 'waist_yaw'"),
        (
            "waist_yaw: AX-12",
            "waist_yaw: AX-12\n  neck: AX-12",
            "joints: robot.urdf has no joint 'neck'",
        ),
        ("waist: [waist_yaw]", "waist: [waist]", "groups.waist: robot.urdf has no joint 'waist'"),
        ("ignore_collisions: []", "ignore_collisions: [[torso]]", "ignore_collisions.0: "),
        ("ignore_collisions: []", "ignore_collisions: [[torso, tail]]", "has no link 'tail'"),
    ],
)
def test_a_bad_robot_file_is_refused_by_the_name_of_the_key(old: str, new: str, message: str):
    assert message in refusal(changed(old, new))


def test_all_problems_of_a_robot_file_are_reported_at_once():
    text = changed("link: left_foot", "link: lfoot", changed("waist_yaw: AX-12", "waist_yaw: X"))
    message = refusal(text)
    assert "soles.left.link" in message
    assert "joints.waist_yaw" in message


WAIST = 'name="waist_yaw" type="revolute"'
WAIST_LIMITS = 'lower="-1.0472" upper="1.0472" effort="1.5" velocity="6.2"'


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (WAIST, WAIST.replace("revolute", "prismatic"), "joint waist_yaw is not a revolute joint"),
        (WAIST, WAIST.replace("revolute", "continuous"), "joint waist_yaw is not a revolute joint"),
        (WAIST, WAIST.replace("revolute", "floating"), "joint waist_yaw is not a revolute joint"),
        (WAIST, WAIST.replace("revolute", "fixed"), "robot.urdf has no joint 'waist_yaw'"),
        (WAIST, WAIST.replace("waist_yaw", "root_joint"), "joint root_joint: a name taken"),
        (WAIST_LIMITS, 'lower="1" upper="-1" effort="1" velocity="1"', "joint waist_yaw: limits"),
        (
            WAIST_LIMITS,
            'lower="-1" upper="1" effort="1" velocity="0"',
            "waist_yaw: limit velocity = 0",
        ),
        (WAIST_LIMITS, 'lower="-1" upper="1"', "cannot read it as a URDF"),
        (
            '<mass value="0.942"/>',
            '<mass value="-0.942"/>',
            "mass value = '-0.942' has to be 0 kg or more",
        ),
        ('<link name="torso">', '<link name="pelvis">', "cannot read it as a URDF"),
        ("</robot>", "", "cannot read it as a URDF"),
    ],
)
def test_a_bad_urdf_is_refused_by_the_name_of_the_joint(old: str, new: str, message: str):
    assert message in refusal(YAML, changed(old, new, URDF))


@pytest.mark.parametrize(
    "urdf", ["", "no XML", "<a/>", "<robot name='x'/>", URDF[:9000], "\x00\x01"]
)
def test_a_text_that_is_not_a_urdf_is_refused(urdf: str):
    assert "cannot read it as a URDF" in refusal(YAML, urdf)


def test_a_robot_without_masses_is_refused():
    assert "no link has a mass" in refusal(
        YAML, re.sub("<inertial>.*?</inertial>", "", URDF, flags=re.S)
    )


def test_a_missing_mesh_is_refused():
    box = '<box size="0.0506 0.0356 0.0355"/></geometry></collision>'
    urdf = changed(box, '<mesh filename="package://a/b.stl"/></geometry></collision>', URDF)
    with pytest.raises(ConfigError, match=r"b\.stl"):
        build_robot(YAML, urdf, "robot.yaml").geometry  # noqa: B018


def test_a_link_may_have_the_name_of_a_joint(melson: Robot):
    """A URDF keeps both names apart; Pinocchio has one list of frames."""
    texts = [text.replace("waist_yaw", "pelvis") for text in (YAML, URDF)]
    robot = build_robot(*texts, "robot.yaml")
    assert robot.mass == pytest.approx(melson.mass)
    assert_allclose(robot.standing_q[:7], melson.standing_q[:7], atol=1e-12)
    assert build_support_tree(robot, Side.LEFT).model.njoints == 1 + robot.n


# --- locked joints ----------------------------------------------------------------------------


def spec_of(robot: Robot, **locked: float) -> str:
    """robot.yaml with locked joints, which are removed from all other keys."""
    tree = yaml.safe_load(robot.yaml) | {"locked": locked}
    for key in ("joints", "posture"):
        tree[key] = {name: x for name, x in tree[key].items() if name not in locked}
    tree["groups"] = {
        group: [name for name in names if name not in locked]
        for group, names in tree.get("groups", {}).items()
    }
    return yaml.safe_dump(tree)


def test_a_locked_joint_is_locked_as_pinocchio_does_it(any_robot: Robot):
    """Oracle: buildReducedModel, which does not use the URDF; with oblique axes and origins."""
    rng = np.random.default_rng(4)
    names = [any_robot.joint_names[i] for i in rng.choice(any_robot.n, 5, replace=False)]
    ids = [any_robot.model.getJointId(name) for name in names]
    q = pin.neutral(any_robot.model)
    q[7:] = rng.uniform(any_robot.lower, any_robot.upper)
    angles = {
        name: float(q[any_robot.model.joints[i].idx_q]) for name, i in zip(names, ids, strict=True)
    }
    robot = build_robot(spec_of(any_robot, **angles), any_robot.urdf, "robot.yaml")
    model = pin.buildReducedModel(any_robot.model, ids, q)
    assert list(robot.joint_names) == list(model.names[2:])
    assert robot.n == any_robot.n - 5
    mine, theirs = robot.model.createData(), model.createData()
    for _ in range(3):
        q = pin.randomConfiguration(model, -np.ones(model.nq), np.ones(model.nq))
        assert_allclose(
            np.triu(pin.crba(robot.model, mine, q)), np.triu(pin.crba(model, theirs, q)), atol=1e-12
        )
        for frames, others in (
            (robot.sole_frames, any_robot.sole_frames),
            (robot.hand_frames, any_robot.hand_frames),
        ):
            pin.framesForwardKinematics(robot.model, mine, q)
            pin.framesForwardKinematics(model, theirs, q)
            for frame, other in zip(frames, others, strict=True):
                same = model.getFrameId(any_robot.model.frames[other].name)
                assert_allclose(mine.oMf[frame].homogeneous, theirs.oMf[same].homogeneous)


def test_locking_twice_changes_nothing(melson: Robot):
    """Motion files hold robot.yaml and the changed URDF, from which the robot is built again."""
    robot = build_robot(spec_of(melson, waist_yaw=0.4), URDF, "robot.yaml")
    again = build_robot(robot.yaml, robot.urdf, "robot.yaml")
    assert again.urdf == robot.urdf != URDF
    assert again.model == robot.model
    assert robot.mass == pytest.approx(melson.mass)


def test_without_locked_joints_the_urdf_stays_as_it_was(melson: Robot):
    assert build_robot(spec_of(melson), URDF, "robot.yaml").urdf == URDF


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("", "waist: 0.1", "locked.waist: robot.urdf has no joint 'waist'; did you mean 'waist_y"),
        ("", "zzz: 0.1", "locked.zzz: robot.urdf has no joint 'zzz'\n"),
        (
            "",
            "waist_yaw: 1.05",
            "locked.waist_yaw: 1.0500 rad is outside its range [-1.0472, 1.0472]",
        ),
        ("", "waist_yaw: .nan", "locked.waist_yaw: input should be a finite number"),
        ("", "waist_yaw: 101", "locked.waist_yaw: input should be less than or equal to 100 [rad]"),
        ("", "waist_yaw: far", "locked.waist_yaw: "),
        (WAIST, WAIST.replace("revolute", "prismatic"), "locked.waist_yaw: a prismatic joint in"),
        (
            'upper="1.0472"',
            'upper="x"',
            "locked.waist_yaw: 0.1000 rad is outside its range [-1.0472, nan]",
        ),
        ('xyz="0 0 0.0705"', 'rpy="0 0"', "locked.waist_yaw: axis or origin is malformed"),
        ("</robot>", "", "robot.urdf: cannot read it as a URDF: not valid XML: no element found"),
        (
            "</robot>",
            "<a>" * 9000 + "</a>" * 9000 + "</robot>",
            "robot.urdf: cannot read it as a URDF: nested too deeply, more than 50 levels",
        ),
    ],
)
def test_a_joint_that_cannot_be_locked_is_refused(melson: Robot, old: str, new: str, message: str):
    text = spec_of(melson, waist_yaw=0.1)
    urdf = changed(old, new, URDF) if old else URDF
    message_found = refusal(text if old else changed("waist_yaw: 0.1", new, text), urdf) + "\n"
    assert message in message_found


@pytest.mark.parametrize("axis", ["0 0 0", "0 1", "x y z"])
def test_a_joint_without_a_direction_cannot_be_locked(melson: Robot, axis: str):
    urdf = re.sub('(<joint name="waist_yaw".*?<axis xyz=")[^"]*', rf"\g<1>{axis}", URDF, flags=re.S)
    assert "axis or origin is malformed" in refusal(spec_of(melson, waist_yaw=0.1), urdf)


@pytest.mark.parametrize(
    ("key", "content"),
    [
        ("joints", {"waist_yaw": "AX-12"}),
        ("posture", {"waist_yaw": 0.1}),
        ("groups.waist", ["waist_yaw"]),
    ],
)
def test_a_locked_joint_is_not_a_joint_of_the_robot(melson: Robot, key: str, content: object):
    tree = yaml.safe_load(spec_of(melson, waist_yaw=0.1))
    if isinstance(content, dict):
        tree[key] |= content
    else:
        tree["groups"]["waist"] = content
    message = refusal(yaml.safe_dump(tree))
    assert message == f"robot.yaml: {key}: joint 'waist_yaw' is locked, leave it out here"


# --- narrowed ranges ---------------------------------------------------------------------------


def with_limits(robot: Robot, **limits: object) -> str:
    return yaml.safe_dump(yaml.safe_load(robot.yaml) | {"limits": limits})


def test_limits_narrow_the_ranges_of_the_urdf_and_change_nothing_else(any_robot: Robot):
    name = any_robot.joint_names[4]
    low, high = any_robot.lower[4], any_robot.upper[4]
    middle = any_robot.posture[4]
    inner = [0.5 * (float(low) + float(middle)), 0.5 * (float(middle) + float(high))]
    narrow = build_robot(with_limits(any_robot, **{name: inner}), any_robot.urdf, "robot.yaml")
    assert [narrow.lower[4], narrow.upper[4]] == inner
    others = np.arange(any_robot.n) != 4
    assert np.array_equal(narrow.lower[others], any_robot.lower[others])
    assert np.array_equal(narrow.upper[others], any_robot.upper[others])
    assert narrow.urdf == any_robot.urdf
    for figure in ("speed_limit", "torque_limit", "posture"):
        assert np.array_equal(getattr(narrow, figure), getattr(any_robot, figure))


def test_the_ranges_of_the_urdf_themselves_and_one_of_their_ends_are_allowed(melson: Robot):
    j = melson.joint_names.index("left_knee_pitch")
    low, high = float(melson.lower[j]), float(melson.upper[j])
    for limits in ([low, high], [low, 1.0], [0.5, high]):
        text = with_limits(melson, left_knee_pitch=limits)
        robot = build_robot(text, URDF, "robot.yaml")
        assert [robot.lower[j], robot.upper[j]] == limits


@pytest.mark.parametrize(
    ("name", "limits", "message"),
    [
        ("left_knee_pitch", [-0.2, 1.0], "limits.left_knee_pitch: [-0.2, 1] rad is not a range"),
        ("left_knee_pitch", [0.0, 3.5], "limits.left_knee_pitch: [0, 3.5] rad is not a range"),
        ("left_knee_pitch", [1.0, 0.5], "limits.left_knee_pitch: [1, 0.5] rad is not a range"),
        ("left_knee_pitch", [0.9, 0.9], "limits.left_knee_pitch: [0.9, 0.9] rad is not a range"),
        ("left_knee_pitch", [1.0, 2.0], "posture.left_knee_pitch: 0.8700 rad is outside the joint"),
        ("left_knee_pitch", [0.5], "limits.left_knee_pitch: list should have at least 2 items"),
        ("left_knee_pitch", [0.5, math.nan], "limits.left_knee_pitch.1: input should be a finite"),
        (
            "left_knee_pitch",
            [0.5, 101.0],
            "limits.left_knee_pitch.1: input should be less than or equal to 100 [rad]",
        ),
        ("left_knee_pitch", 0.5, "limits.left_knee_pitch: input should be a valid list"),
        ("left_knee", [0.5, 1.0], "limits: robot.urdf has no joint 'left_knee'"),
    ],
)
def test_an_invalid_range_is_refused_by_name(
    melson: Robot, name: str, limits: object, message: str
):
    assert f"robot.yaml: {message}" in refusal(with_limits(melson, **{name: limits}))


def test_limits_of_a_locked_joint_are_refused(melson: Robot):
    tree = yaml.safe_load(spec_of(melson, waist_yaw=0.1)) | {"limits": {"waist_yaw": [-0.1, 0.1]}}
    message = refusal(yaml.safe_dump(tree))
    assert message == "robot.yaml: limits: joint 'waist_yaw' is locked, leave it out here"


def test_a_robot_with_narrowed_limits_is_built_again_from_its_texts(melson: Robot):
    robot = build_robot(with_limits(melson, left_knee_pitch=[0.1, 1.5]), URDF, "robot.yaml")
    again = build_robot(robot.yaml, robot.urdf, "a motion file")
    assert np.array_equal(again.lower, robot.lower) and np.array_equal(again.upper, robot.upper)


# --- folders ----------------------------------------------------------------------------------


def test_robots_are_found_by_name_by_folder_and_by_file(tmp_path: Path):
    assert "melson" in list_robots()
    for path in ("melson", FOLDER, FOLDER / "robot.yaml"):
        assert load_robot(path).spec.name == "melson"
    with pytest.raises(ConfigError, match=r"shipped: .*melson"):
        load_robot(tmp_path)
    with pytest.raises(ConfigError, match=r"shipped: .*melson"):
        load_robot("a" * 5000)


@pytest.mark.parametrize("urdf", ["missing.urdf", "", "a\0b", "."])
def test_a_missing_urdf_is_refused(tmp_path: Path, urdf: str):
    tree = yaml.safe_load(YAML) | {"urdf": urdf}
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(tree))
    with pytest.raises(ConfigError):
        load_robot(tmp_path)


def test_a_robot_keeps_the_texts_from_which_it_was_built(melson: Robot):
    assert (melson.urdf, melson.yaml) == (URDF, YAML)
