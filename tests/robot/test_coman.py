"""Tests of COMAN and its legs against published values, their README and Pinocchio."""

from __future__ import annotations

import itertools
import re
import shutil
from contextlib import closing
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.shipped import shipped_folder
from mgs.robot import Robot, build_robot, load_robot, midpoint_width
from mgs.robot.soundness import check_robot
from mgs.sim import DEFAULTS, ENGINES, replay
from mgs.sim.audit import audit
from mgs.sim.engine import make_engine
from tests.support.motions import standing

FOLDER = shipped_folder("robots") / "coman"
URDF = (FOLDER / "robot.urdf").read_text()
README = (FOLDER / "README.md").read_text()
MIRROR = np.diag([1.0, -1.0, 1.0])
# Figures of the package coman_urdf of ADVRHumanoids/iit-coman-ros-pkg, those of the left side.
# Joint: axis, lower and upper limit [rad]; roll and yaw limits are mirrored on the right.
JOINTS = {
    "HipSag": ("y", -1.9199, 0.7854),
    "HipLat": ("x", -0.4363, 1.0472),
    "HipYaw": ("z", -0.8727, 0.8727),
    "KneeSag": ("y", -0.1745, 1.9199),
    "AnkLat": ("x", -0.6109, 0.6109),
    "AnkSag": ("y", -1.2217, 1.2217),
    "WaistLat": ("tilted", -0.5236, 0.5235),
    "WaistSag": ("y", -0.3491, 0.8727),
    "WaistYaw": ("z", -1.3963, 1.3962),
    "ShSag": ("y", -3.4034, 1.6581),
    "ShLat": ("x", -0.31415, 2.094),
    "ShYaw": ("z", -1.5708, 1.5708),
    "Elbj": ("y", -2.3562, 0.0),
    "ForearmPlate": ("z", -1.5708, 1.5708),
    "Wrj1": ("y", -0.524, 0.524),
    "Wrj2": ("x", -0.785375, 1.395),
}
LEG, WAIST, ARM = list(JOINTS)[:6], list(JOINTS)[6:9], list(JOINTS)[9:]
NAMES = [*("L" + x for x in LEG), *("R" + x for x in LEG), *WAIST]
NAMES += [*("L" + x for x in ARM), *("R" + x for x in ARM)]
AXES = {
    "x": (1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "tilted": (0.93969262078, 0.0, 0.34202014332),
}
MASSES = {  # [kg]
    "Waist": 1.8008695,
    "imu_link": 0.01,
    "HipMot": 0.89258227,
    "ThighUpLeg": 1.0246101,
    "ThighLowLeg": 1.7001134,
    "LowLeg": 1.4098179,
    "Footmot": 0.72992131,
    "Foot": 0.66646684,
    "DWL": 0.54588774,
    "DWS": 0.75398402,
    "DWYTorso": 6.3617175,
    "Shp": 0.56782202,
    "Shr": 0.77683752,
    "Shy": 1.0462304,
    "Elb": 0.63306933,
    "Forearm": 0.93351655,
    "WrMot2": 0.26070556,
    "WrMot3": 0.054007518,
}
TOTAL_MASS = 30.863860196
MICROMETRE = 1e-6  # the published derived lengths are rounded to it
POSES = {  # CoM and centre line of the left ankle's ground point, in the pelvis frame [m]
    "zero": ((-0.000723, -0.000123, 0.023171), (0.0, 0.0726, -0.5168)),
    "half-sitting": ((0.013677, -0.000123, 0.041895), (0.010787, 0.0726, -0.474311)),
}


@pytest.fixture(scope="module")
def coman() -> Robot:
    return load_robot("coman")


@pytest.fixture(scope="module")
def legs() -> Robot:
    return load_robot("coman_legs")


@pytest.fixture(params=["coman", "coman_legs"])
def either(request: pytest.FixtureRequest) -> Robot:
    robot: Robot = request.getfixturevalue(request.param.removeprefix("coman_"))
    return robot


def at(robot: Robot, joints: np.ndarray) -> pin.Data:
    """Frames and CoM at joint angles (n,), with the base in the origin."""
    q = np.concatenate([pin.neutral(robot.model)[:FLOATING_BASE_NQ], joints])
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    pin.centerOfMass(robot.model, data, q, False)
    return data


def joint_place(robot: Robot, data: pin.Data, name: str) -> np.ndarray:
    return data.oMi[robot.model.getJointId(name)].translation


def without_side(name: str) -> str:
    return name if name in WAIST or name in MASSES else name[1:]


# --- published figures ------------------------------------------------------------------------


def test_coman_has_the_published_joints_in_depth_first_order(coman: Robot):
    assert list(coman.joint_names) == NAMES
    assert {group: len(names) for group, names in coman.spec.groups.items()} == {
        "left_leg": 6,
        "right_leg": 6,
        "left_arm": 7,
        "right_arm": 7,
        "waist": 3,
    }


def test_axes_and_limits_have_their_published_values(coman: Robot):
    elements = {joint.get("name"): joint for joint in ElementTree.fromstring(URDF).iter("joint")}
    for i, name in enumerate(coman.joint_names):
        axis, low, high = JOINTS[without_side(name)]
        if name[0] == "R" and axis != "y":
            low, high = -high, -low
        assert (coman.lower[i], coman.upper[i]) == (low, high), name
        found = np.fromstring(elements[name].find("axis").get("xyz"), sep=" ")
        assert_allclose(found, AXES[axis], atol=0)


def test_masses_have_their_published_values(coman: Robot):
    links = {
        link.get("name"): float(link.find("inertial/mass").get("value"))
        for link in ElementTree.fromstring(URDF).iter("link")
    }
    assert len(links) == 31
    for name, mass in links.items():
        assert mass == MASSES[without_side(name)], name
    assert coman.mass == pytest.approx(TOTAL_MASS, abs=1e-9)


def half_sitting(coman: Robot) -> np.ndarray:
    """Published half-sitting joint angles (n,), with the arms spread by 0.5 instead of 0.6 rad."""
    joints = coman.posture.copy()
    for name, angle in (("LShLat", 0.5), ("RShLat", -0.5)):
        j = coman.joint_names.index(name)
        assert abs(joints[j]) == 0.6
        joints[j] = angle
    return joints


@pytest.mark.parametrize("pose", POSES)
def test_com_and_soles_have_their_published_positions(coman: Robot, pose: str):
    com, ankle_ground = POSES[pose]
    joints = np.zeros(coman.n) if pose == "zero" else half_sitting(coman)
    data = at(coman, joints)
    assert_allclose(data.com[0], com, atol=MICROMETRE)
    for side in Side:
        T_base_sole = data.oMf[coman.sole_frames[side]]
        centre = np.array(ankle_ground) * [1.0, side.sign, 1.0] + [0.03, 0.0, 0.0]
        assert_allclose(T_base_sole.translation, centre, atol=MICROMETRE)
        assert_allclose(T_base_sole.rotation, np.eye(3), atol=1e-12)


def test_lengths_agree_with_publication_and_readme(coman: Robot):
    data = at(coman, np.zeros(coman.n))

    def place(name: str) -> np.ndarray:
        return joint_place(coman, data, name)

    hip, knee, ankle = place("LHipLat"), place("LKneeSag"), place("LAnkSag")
    shoulder, elbow, wrist = place("LShLat"), place("LElbj"), place("LWrj2")
    sole = data.oMf[coman.sole_frames[Side.LEFT]].translation
    assert_allclose(hip, [0.0, 0.0726, 0.0], atol=1e-12)
    assert_allclose(place("LAnkLat"), ankle, atol=1e-12)
    assert_allclose(shoulder, [0.005305, 0.1558, 0.324329], atol=MICROMETRE)
    assert_allclose(elbow - shoulder, [0.015, 0.0, -0.18], atol=MICROMETRE)
    assert_allclose(wrist, [0.005305, 0.1558, -0.050351], atol=MICROMETRE)
    for label, published, found in (
        ("hip to hip", 0.1452, 2.0 * hip[1]),
        ("hip to knee", 0.2258, hip[2] - knee[2]),
        ("knee to ankle", 0.201, knee[2] - ankle[2]),
        ("ankle to sole", 0.09, ankle[2] - sole[2]),
        ("shoulder to shoulder", 0.3116, 2.0 * shoulder[1]),
        ("shoulder to elbow, vertical", 0.18, shoulder[2] - elbow[2]),
        ("elbow to wrist, vertical", 0.19468, elbow[2] - wrist[2]),
    ):
        assert found == pytest.approx(published, abs=MICROMETRE), label
        assert row(label)[0] == published
    assert midpoint_width(coman) == pytest.approx(0.1452, abs=MICROMETRE)


def test_torso_and_hands_are_the_published_frames(coman: Robot):
    data = at(coman, np.zeros(coman.n))
    shoulders = [joint_place(coman, data, name) for name in ("LShSag", "RShSag")]
    torso = data.oMf[coman.torso_frame].translation
    assert_allclose(torso, np.mean(shoulders, axis=0), atol=MICROMETRE)
    for side, wrist in zip(Side, ("LWrj2", "RWrj2"), strict=True):
        hand = data.oMf[coman.hand_frames[side]].translation
        assert_allclose(hand - joint_place(coman, data, wrist), [0.0, 0.0, -0.07], atol=1e-12)


def test_the_sole_is_the_underside_of_the_published_foot_box(coman: Robot):
    for side, link in zip(Side, ("LFoot", "RFoot"), strict=True):
        foot = ElementTree.fromstring(URDF).find(f"link[@name='{link}']/collision")
        centre = np.fromstring(foot.find("origin").get("xyz"), sep=" ")
        size = np.fromstring(foot.find("geometry/box").get("size"), sep=" ")
        sole = coman.sole_spec(side)
        assert (sole.length, sole.width) == tuple(size[:2])
        assert_allclose(sole.position, centre - [0.0, 0.0, size[2] / 2], atol=1e-12)
        assert sole.position[0] + sole.length / 2 == pytest.approx(0.13)


def test_every_inertia_is_physically_possible(either: Robot):
    for inertia in either.model.inertias[1:]:
        assert inertia.mass > 0.0
        spread = 0.5 * np.trace(inertia.inertia) * np.eye(3) - inertia.inertia
        assert np.linalg.eigvalsh(spread).min() > 0.0


def test_left_and_right_are_mirror_symmetric(coman: Robot):
    """Mirrored joint angles give mirrored limbs; the published trunk is asymmetric."""
    joints = np.random.default_rng(0).uniform(coman.lower, coman.upper)
    joints[[coman.joint_names.index(name) for name in WAIST]] = 0.0
    mirrored = joints.copy()
    for i, name in enumerate(coman.joint_names):
        if name not in WAIST:
            twin = coman.joint_names.index({"L": "R", "R": "L"}[name[0]] + name[1:])
            mirrored[twin] = joints[i] if JOINTS[name[1:]][0] == "y" else -joints[i]
    here, there = at(coman, joints), at(coman, mirrored)
    for name in coman.joint_names:
        if name[0] == "L":
            left, right = (coman.model.getJointId(side + name[1:]) for side in "LR")
            a = here.oMi[left].act(coman.model.inertias[left])
            b = there.oMi[right].act(coman.model.inertias[right])
            assert a.mass == b.mass
            assert_allclose(MIRROR @ a.lever, b.lever, atol=1e-8)  # RLowLeg's CoM has 8 decimals
            assert_allclose(MIRROR @ a.inertia @ MIRROR, b.inertia, atol=1e-9)


# --- drives -----------------------------------------------------------------------------------


def test_no_limit_is_a_placeholder_of_the_source(coman: Robot):
    """50 N m and joint damping are placeholders; the speed limit is from Faraji and Ijspeert."""
    assert set(coman.speed_limit) == {4.0}
    assert set(coman.torque_limit) == {37.0, 5.0}
    assert_allclose(coman.no_load_speed, 7300.0 * np.pi / 30.0 / 100.0, rtol=1e-3)  # 3 digits
    assert "dynamics" not in URDF
    armature = (8.47e-6 + 5.4e-6) * 100.0**2
    for i, name in enumerate(coman.joint_names):
        small = without_side(name) in ("ForearmPlate", "Wrj1", "Wrj2")
        assert coman.armature[i] == (0.004 if small else pytest.approx(armature))
    efforts = [limit.get("effort") for limit in ElementTree.fromstring(URDF).iter("limit")]
    assert [float(effort) for effort in efforts] == list(coman.torque_limit)


def test_one_leg_can_hold_the_robot(coman: Robot):
    """Static knee torque: the whole weight minus shank and foot acts on the left sole."""
    q = coman.standing_q
    data = coman.model.createData()
    gravity = pin.computeGeneralizedGravity(coman.model, data, q)
    J = pin.computeFrameJacobian(
        coman.model, data, q, coman.sole_frames[Side.LEFT], pin.LOCAL_WORLD_ALIGNED
    )
    torque = (gravity - J.T @ np.linalg.solve(J[:, :6].T, gravity[:6]))[6:]
    knee, roll = (abs(torque[coman.joint_names.index(name)]) for name in ("LKneeSag", "LHipLat"))
    assert (knee, roll) == (pytest.approx(23.8, abs=0.05), pytest.approx(20.1, abs=0.05))  # README
    assert np.all(np.abs(torque) < coman.torque_limit)


# --- README -----------------------------------------------------------------------------------


def row(label: str) -> list[float]:
    """Numbers in the cells of the README's first table row that begins with `label`."""
    line = next(line for line in README.splitlines() if line.startswith(f"| {label} |"))
    return [float(x) for x in re.findall(r"-?\d+\.?\d*", line.split("|", 2)[2])]


def test_the_readme_has_the_limits_masses_and_drives_of_the_model(coman: Robot):
    for name, (axis, low, high) in JOINTS.items():
        assert row(name) == [*([20.0] if axis == "tilted" else []), low, high]
    for name, mass in MASSES.items():
        assert row(name)[0] == mass
    servos = coman.spec.servos
    for label, key in (
        ("stall torque", "stall_torque"),
        ("no-load speed [rad/s]", "no_load_speed"),
        ("armature [kg m^2]", "armature"),
    ):
        assert row(label)[:2] == [getattr(servos[name], key) for name in ("CSD-17-100", "forearm")]


def test_the_readme_has_the_standing_figures_of_the_model(coman: Robot):
    for column, joints in enumerate((np.zeros(coman.n), coman.posture)):
        data = at(coman, joints)
        com = data.oMf[coman.sole_frames[Side.LEFT]].actInv(data.com[0])
        hip = -data.oMf[coman.sole_frames[Side.LEFT]].translation[2]
        assert row("hip height")[column] == pytest.approx(hip, abs=5e-5)  # four decimals
        assert row("centre of mass above the ground")[column] == pytest.approx(com[2], abs=5e-5)
        in_front = row("centre of mass in front of the sole centres")[column]
        assert in_front == pytest.approx(com[0], abs=5e-5)


# --- collisions -------------------------------------------------------------------------------


def test_ignored_pairs_are_neighbours_across_one_or_two_links(coman: Robot):
    """No pair that would show a collision of limbs is ignored."""
    tree = ElementTree.fromstring(URDF)
    near: dict[str, set[str]] = {}
    for joint in tree.iter("joint"):
        a, b = joint.find("parent").get("link"), joint.find("child").get("link")
        near.setdefault(a, set()).add(b)
        near.setdefault(b, set()).add(a)
    for a, b in coman.spec.ignore_collisions:
        reached = {a}
        for _ in range(4):
            reached |= set(itertools.chain.from_iterable(near[link] for link in reached))
        assert b in reached
        assert {a[0], b[0]} != {"L", "R"}
        if {a[1:], b[1:]} != {"LowLeg", "Foot"}:  # the published ankle range says that they pass
            assert not {a[1:], b[1:]} & {"LowLeg", "Foot", "Footmot", "Elb", "WrMot2"}


def test_both_pass_every_check_of_a_robot(either: Robot):
    assert [finding.name for finding in check_robot(either) if not finding.ok] == []


# --- legs alone -------------------------------------------------------------------------------


def reduced(coman: Robot, legs: Robot) -> pin.Model:
    """Model of COMAN with the same joints locked by Pinocchio."""
    q = pin.neutral(coman.model)
    for name, angle in legs.spec.locked.items():
        q[coman.model.joints[coman.model.getJointId(name)].idx_q] = angle
    ids = [coman.model.getJointId(name) for name in legs.spec.locked]
    return pin.buildReducedModel(coman.model, ids, q)


def test_the_legs_are_coman_with_locked_waist_and_arms_and_limited_knees(coman: Robot, legs: Robot):
    assert list(legs.joint_names) == NAMES[:12]
    assert legs.model.nv == 18
    assert list(legs.spec.locked) == NAMES[12:]
    posture = dict(zip(coman.joint_names, half_sitting(coman), strict=True))
    assert legs.spec.locked == {name: posture[name] for name in NAMES[12:]}
    assert list(legs.posture) == [posture[name] for name in NAMES[:12]]
    assert (legs.spec.soles, legs.spec.hands, legs.spec.torso) == (
        coman.spec.soles,
        coman.spec.hands,
        coman.spec.torso,
    )
    for figure in ("upper", "torque_limit", "speed_limit", "no_load_speed", "armature"):
        assert_allclose(getattr(legs, figure), getattr(coman, figure)[:12], atol=0)
    knees = [name.endswith("KneeSag") for name in legs.joint_names]
    assert_allclose(legs.lower, np.where(knees, 0.0, coman.lower[:12]), atol=0)


def test_the_legs_have_the_mass_matrix_of_pinocchios_reduced_model(coman: Robot, legs: Robot):
    """Oracle: buildReducedModel, which does not use the changed URDF."""
    model = reduced(coman, legs)
    assert list(model.names[2:]) == list(legs.joint_names)
    assert legs.mass == pytest.approx(TOTAL_MASS, abs=1e-9)
    mine, theirs = legs.model.createData(), model.createData()
    rng = np.random.default_rng(1)
    for _ in range(5):
        q = pin.neutral(model)
        q[7:] = rng.uniform(legs.lower, legs.upper)
        q[3:7] = pin.Quaternion(pin.exp3(rng.normal(size=3))).coeffs()
        com = pin.centerOfMass(legs.model, mine, q)
        assert_allclose(com, pin.centerOfMass(model, theirs, q), atol=1e-12)
        M = pin.crba(legs.model, mine, q)
        assert_allclose(np.triu(M), np.triu(pin.crba(model, theirs, q)), atol=1e-12)


def test_in_the_posture_the_legs_equal_coman(coman: Robot, legs: Robot):
    whole, part = at(coman, half_sitting(coman)), at(legs, legs.posture)
    assert_allclose(part.com[0], whole.com[0], atol=1e-12)
    for attribute in ("sole_frames", "hand_frames"):
        frames = zip(getattr(legs, attribute), getattr(coman, attribute), strict=True)
        for mine, theirs in frames:
            assert_allclose(part.oMf[mine].homogeneous, whole.oMf[theirs].homogeneous, atol=1e-12)
    torso = part.oMf[legs.torso_frame].homogeneous
    assert_allclose(torso, whole.oMf[coman.torso_frame].homogeneous, atol=1e-12)
    assert_allclose(legs.standing_q[:7], coman.standing_q[:7], atol=1e-12)  # arms have no part


def test_the_legs_are_built_again_from_their_texts(legs: Robot):
    again = build_robot(legs.yaml, legs.urdf, "a motion file")
    assert again.urdf == legs.urdf
    assert again.model == legs.model


def test_the_legs_find_comans_urdf_beside_them(
    tmp_path: Path, legs: Robot, monkeypatch: pytest.MonkeyPatch
):
    """The whole folder of shipped robots is in another place, as in a wheel."""
    robots = tmp_path / "data" / "robots"
    shutil.copytree(FOLDER.parent, robots)
    with pytest.raises(ConfigError, match="not in the robot folder"):
        load_robot(robots / "coman_legs")  # a folder of the user reads no file outside itself
    monkeypatch.setattr("mgs.robot.load.shipped_folder", lambda _: robots)
    assert load_robot("coman_legs").urdf == legs.urdf


# --- engines ----------------------------------------------------------------------------------


@pytest.mark.parametrize("engine", ENGINES)
def test_engines_load_the_robot_and_it_stands(either: Robot, engine):
    pytest.importorskip(engine)
    with closing(make_engine(engine, either, DEFAULTS[engine])) as simulator:
        audit(simulator, either, engine)
    result = replay(standing(either, 1.0), engine)
    assert not result.fell
    assert result.max_tilt_deg < 0.5
    assert result.torque_saturation == 0.0
    assert result.sole_slip_max < 1e-3
