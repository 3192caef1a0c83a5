"""A robot: URDF and robot.yaml joined into one Pinocchio model with soles, hands and limits."""

from __future__ import annotations

import functools
import math
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from pydantic import Field, model_validator

from mgs.config import FormatVersion, Model, build, is_file, parse_yaml, read_text
from mgs.contact import Side
from mgs.errors import ConfigError
from mgs.gait import shipped_folder
from mgs.urdf_lock import lock_joints

Array = NDArray[np.float64]
FLOATING_BASE_NQ, FLOATING_BASE_NV = 7, 6
UNIT_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])  # of a box
MAX_LENGTH, MAX_MASS, MAX_ANGLE = 10.0, 1e4, 100.0  # [m], [kg], [rad]; beyond: a slip of the unit
Coordinate = Annotated[float, Field(ge=-MAX_LENGTH, le=MAX_LENGTH)]
Vector3 = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]
Angle = Annotated[float, Field(ge=-MAX_ANGLE, le=MAX_ANGLE)]
Rotation = Annotated[list[Angle], Field(min_length=3, max_length=3)]
Range = Annotated[list[Angle], Field(min_length=2, max_length=2)]


class FrameSpec(Model):
    """A frame in a link."""

    link: str
    position: Vector3 = Field([0.0, 0.0, 0.0], description="Origin in the link frame [m].")
    rpy: Rotation = Field(
        [0.0, 0.0, 0.0],
        description="Roll, pitch and yaw of its axes in the link frame [rad]; 0: parallel.",
    )


class SoleSpec(FrameSpec):
    """Contact rectangle: frame at its centre, x forward, z up."""

    length: float = Field(ge=1e-3, le=1.0, description="Along x [m].")
    width: float = Field(ge=1e-3, le=1.0, description="Along y [m].")


class ServoSpec(Model):
    """Figures of one servo model; mgs.servos says what a servo does with those of its loop."""

    stall_torque: float = Field(gt=0.0, le=1e4, description="[N m]")
    no_load_speed: float = Field(gt=0.0, le=100.0, description="[rad/s]")
    resolution: float = Field(0.0, ge=0.0, le=0.1, description="One tick of the encoder [rad].")
    armature: float = Field(
        0.0, ge=0.0, le=10.0, description="Rotor inertia seen at the joint [kg m^2]."
    )
    stiffness: float | None = Field(
        None, gt=0.0, le=1e6, description="Torque per error of the position loop [N m/rad]."
    )
    compliance_slope: Literal[2, 4, 8, 16, 32, 64, 128] | None = Field(
        None,
        description="In place of stiffness: ticks of error over which the torque grows to stall "
        "torque, a register of Dynamixel's AX and RX servos; 32 when shipped.",
    )
    damping: float | None = Field(
        None,
        ge=0.0,
        le=1e5,
        description="Of the motor, by its back-EMF, and of the loop [N m s/rad]; "
        "None: stall torque / no-load speed.",
    )
    latency: float = Field(0.0, ge=0.0, le=0.5, description="From command to torque [s].")
    deadband: float = Field(
        0.0, ge=0.0, le=0.2, description="Error up to which there is no torque [rad]."
    )
    punch: float = Field(
        0.0, ge=0.0, le=1e4, description="Torque with which it sets in beyond the deadband [N m]."
    )
    friction: float = Field(0.0, ge=0.0, le=1e4, description="Of the gear, Coulomb's [N m].")
    viscous_friction: float = Field(
        0.0, ge=0.0, le=1e5, description="Of the gear, per speed [N m s/rad]."
    )

    @model_validator(mode="after")
    def _has_one_stiffness(self) -> ServoSpec:
        if self.compliance_slope is not None:
            if self.stiffness is not None:
                raise ValueError("give stiffness or compliance_slope, not both")
            if not self.resolution:
                raise ValueError("compliance_slope counts ticks: give resolution too")
        return self

    @property
    def spring(self) -> float | None:
        """Stiffness of the position loop [N m/rad]; None where the file has none."""
        if self.compliance_slope is None:
            return self.stiffness
        return self.stall_torque / (self.compliance_slope * self.resolution)


class PairOf(Model):
    """One frame a side."""

    left: FrameSpec
    right: FrameSpec


class SolePair(Model):
    """One sole a side."""

    left: SoleSpec
    right: SoleSpec


class RobotSpec(Model):
    """A robot.yaml."""

    mgs: FormatVersion = Field(description="Version of this format.")
    name: str = Field(min_length=1, max_length=100)
    urdf: str = Field("robot.urdf", description="URDF file, relative to the folder of robot.yaml.")
    base_link: str = Field(description="Link that carries the floating base.")
    torso: FrameSpec
    soles: SolePair
    hands: PairOf | None = Field(
        None, description="Of a robot with arms; without, nothing is ever asked of hands."
    )
    posture: dict[str, float] = Field(
        description="Half-sitting posture [rad]; joints not named stand at 0."
    )
    servos: dict[str, ServoSpec] = Field(description="Servo models by name.")
    joints: dict[str, str] = Field(description="Servo model of every joint.")
    locked: dict[str, Angle] = Field(
        {}, description="Joints of the URDF held at an angle [rad]; they are none of the robot's."
    )
    limits: dict[str, Range] = Field(
        {}, description="Ranges [rad] narrower than the URDF's, by joint."
    )
    groups: dict[str, list[str]] = Field({}, description="Names for sets of joints.")
    ignore_collisions: list[Annotated[list[str], Field(min_length=2, max_length=2)]] = Field(
        [], description="Pairs of links that may touch, besides adjacent ones."
    )


@dataclass(frozen=True, eq=False)
class Robot:
    """A humanoid: Pinocchio model with a floating base, operational frames and servo limits.

    Joint arrays have shape (n,) and follow `joint_names`; q is (7 + n,): base position, base
    quaternion xyzw, joints; v is (6 + n,): base twist in the base frame, joints.
    """

    spec: RobotSpec
    source: str
    urdf: str
    yaml: str
    model: pin.Model
    joint_names: tuple[str, ...]
    lower: Array  # [rad]
    upper: Array  # [rad]
    speed_limit: Array  # of the URDF, at most the servo's no-load speed [rad/s]
    no_load_speed: Array  # of the servo [rad/s]
    torque_limit: Array  # stall torque of the servo [N m]
    armature: Array  # [kg m^2]
    posture: Array  # half-sitting joint angles [rad]
    sole_frames: tuple[int, int]  # ids in `model`, left and right
    hand_frames: tuple[int, int]  # of a robot without hands both are the torso's
    torso_frame: int

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    @functools.cached_property
    def mass(self) -> float:
        """Total mass [kg]."""
        return float(pin.computeTotalMass(self.model))

    def sole_spec(self, side: Side) -> SoleSpec:
        """Contact rectangle of one sole."""
        return self.spec.soles.left if side is Side.LEFT else self.spec.soles.right

    @functools.cached_property
    def standing_q(self) -> Array:
        """Half-sitting posture (7 + n,), soles on the ground, the origin midway between them."""
        q = pin.neutral(self.model)
        q[FLOATING_BASE_NQ:] = self.posture
        data = self.model.createData()
        pin.framesForwardKinematics(self.model, data, q)
        left, right = (data.oMf[frame] for frame in self.sole_frames)
        middle = pin.SE3(left.rotation, 0.5 * (left.translation + right.translation))
        base = middle.inverse()  # the base frame is the world at neutral
        q[:FLOATING_BASE_NQ] = pin.SE3ToXYZQUAT(base)
        return q

    @functools.cached_property
    def geometry(self) -> pin.GeometryModel:
        """Collision shapes with every pair that is neither adjacent nor ignored."""
        return _collision_pairs(self)


def shape_corners(robot: Robot) -> Array:
    """Corners (b, 8, 3) of the box around every collision shape, in the shape's frame [m]."""
    corners = []
    for item in robot.geometry.geometryObjects:
        item.geometry.computeLocalAABB()
        box = item.geometry.aabb_local
        low, high = np.ravel(box.min_), np.ravel(box.max_)
        corners.append(low + UNIT_CORNERS * (high - low))
    return np.array(corners)


def load_robot(name_or_dir: str | Path) -> Robot:
    """Read a robot folder, or a shipped robot by name.

    Raises:
        ConfigError: a file is missing or malformed, or robot.yaml and URDF contradict each other.
    """
    folder = find_robot(name_or_dir)
    path = folder / "robot.yaml"
    text = read_text(path)
    spec = build(RobotSpec, parse_yaml(text, path), path)
    return build_robot(text, read_text(folder / spec.urdf), path)


def find_robot(name_or_dir: str | Path) -> Path:
    """Folder of a robot given by path or shipped name; raises ConfigError listing what ships."""
    path = Path(name_or_dir)
    path = path.parent if path.name == "robot.yaml" else path
    shipped = shipped_folder("robots")
    for folder in (path, shipped / name_or_dir):
        if is_file(folder / "robot.yaml"):
            return folder
    raise ConfigError(
        name_or_dir,
        f"no robot.yaml there and no robot of that name; shipped: {', '.join(list_robots())}",
    )


def list_robots() -> list[str]:
    """Names of the shipped robots."""
    return sorted(path.parent.name for path in shipped_folder("robots").glob("*/robot.yaml"))


def build_robot(yaml_text: str, urdf_text: str, source: str | Path) -> Robot:
    """Robot from the texts of its two files; `source` names robot.yaml in messages.

    Locked joints are fixed in `Robot.urdf`, from which the same robot can be built again.
    """
    spec = build(RobotSpec, parse_yaml(yaml_text, source), source)
    urdf_text = lock_joints(urdf_text, spec.locked, str(source), spec.urdf)
    model = _parse_urdf(urdf_text, f"{source}: {spec.urdf}")
    problems: list[str] = []
    names = tuple(model.names[2:])
    _check_names(spec, model, names, problems)
    if problems:
        raise ConfigError(source, problems)
    servos = [spec.servos[spec.joints[name]] for name in names]
    lower, upper = model.lowerPositionLimit[7:].copy(), model.upperPositionLimit[7:].copy()
    _narrow(spec, names, lower, upper, problems)
    no_load_speed = np.array([servo.no_load_speed for servo in servos])
    speed_limit = np.minimum(model.velocityLimit[6:], no_load_speed)
    posture = np.array([spec.posture.get(name, 0.0) for name in names])
    _check_bodies(spec, model, problems)
    for name, low, high, speed, angle in zip(
        names, lower, upper, speed_limit, posture, strict=True
    ):
        _check_joint(spec, name, (low, high, speed, angle), problems)
    if problems:
        raise ConfigError(source, problems)
    soles = tuple(
        _add_frame(model, f"sole_{side.label}", frame)
        for side, frame in zip(Side, (spec.soles.left, spec.soles.right), strict=True)
    )
    torso = _add_frame(model, "torso_frame", spec.torso)
    hands = _add_hands(model, spec) or (torso, torso)
    return Robot(
        spec=spec,
        source=str(source),
        urdf=urdf_text,
        yaml=yaml_text,
        model=model,
        joint_names=names,
        lower=lower,
        upper=upper,
        speed_limit=speed_limit,
        no_load_speed=no_load_speed,
        torque_limit=np.array([servo.stall_torque for servo in servos]),
        armature=np.array([servo.armature for servo in servos]),
        posture=posture,
        sole_frames=(soles[0], soles[1]),
        hand_frames=hands,
        torso_frame=torso,
    )


def _parse_urdf(text: str, source: str) -> pin.Model:
    return _call_parser(lambda: pin.buildModelFromXML(text, pin.JointModelFreeFlyer()), source)


def _call_parser(parse: Callable[[], pin.Model], source: str) -> pin.Model:
    try:
        return parse()
    except (RuntimeError, ValueError, ArithmeticError) as error:
        reason = " ".join(str(error).split())
        raise ConfigError(source, f"Pinocchio cannot read it as a URDF: {reason}") from error


def _check_names(
    spec: RobotSpec, model: pin.Model, names: tuple[str, ...], problems: list[str]
) -> None:
    def check_link(key: str, link: str) -> None:
        if not model.existBodyName(link):
            problems.append(f"{key}: {spec.urdf} has no link {link!r}")

    for joint, name in enumerate(names, start=2):
        kind = model.joints[joint]
        if kind.nq != 1 or not kind.shortname().startswith("JointModelR"):
            problems.append(f"{spec.urdf}: joint {name} is not a revolute joint with limits")
        if name in model.names[:2]:  # its link would be welded to the floating base
            problems.append(f"{spec.urdf}: joint {name}: a name taken by Pinocchio; rename it")
    frames: dict[str, FrameSpec] = {
        "torso": spec.torso,
        "soles.left": spec.soles.left,
        "soles.right": spec.soles.right,
    }
    if spec.hands is not None:
        frames |= {"hands.left": spec.hands.left, "hands.right": spec.hands.right}
    for key, frame in frames.items():
        check_link(f"{key}.link", frame.link)
    check_link("base_link", spec.base_link)
    if not problems and model.frames[model.getBodyId(spec.base_link)].parentJoint != 1:
        problems.append(f"base_link: {spec.base_link!r} is not the root link of {spec.urdf}")
    for pair in spec.ignore_collisions:
        for link in pair:
            check_link("ignore_collisions", link)
    for name in names:
        if name not in spec.joints:
            problems.append(f"joints: no servo given for joint {name!r} of {spec.urdf}")
        elif spec.joints[name] not in spec.servos:
            problems.append(
                f"joints.{name}: servo {spec.joints[name]!r} is not listed under servos"
            )
    named: dict[str, Iterable[str]] = {
        "joints": spec.joints,
        "posture": spec.posture,
        "limits": spec.limits,
    }
    named |= {f"groups.{group}": members for group, members in spec.groups.items()}
    for key, members in named.items():
        for name in members:
            if name in spec.locked:
                problems.append(f"{key}: joint {name!r} is locked, leave it out here")
            elif name not in names:
                problems.append(f"{key}: {spec.urdf} has no joint {name!r}")


def _narrow(
    spec: RobotSpec, names: tuple[str, ...], lower: Array, upper: Array, problems: list[str]
) -> None:
    """Replace limits (n,) of the URDF by those of robot.yaml where it has some."""
    for name, (low, high) in spec.limits.items():
        j = names.index(name)
        if lower[j] <= low < high <= upper[j]:
            lower[j], upper[j] = low, high
        else:
            problems.append(
                f"limits.{name}: [{low:g}, {high:g}] is not a range within "
                f"[{lower[j]:.4f}, {upper[j]:.4f}], that of {spec.urdf}"
            )


def _check_bodies(spec: RobotSpec, model: pin.Model, problems: list[str]) -> None:
    for inertia, joint in zip(model.inertias[1:], model.names[1:], strict=True):
        if not 0.0 <= inertia.mass <= MAX_MASS:
            problems.append(f"{spec.urdf}: the links moved by {joint} weigh {inertia.mass:g} kg")
    for placement, joint in zip(model.jointPlacements[1:], model.names[1:], strict=True):
        if not np.abs(placement.translation).max() <= MAX_LENGTH:
            problems.append(
                f"{spec.urdf}: joint {joint} is more than {MAX_LENGTH:g} m from its parent"
            )
    if not problems and not pin.computeTotalMass(model) > 0.0:
        problems.append(f"{spec.urdf}: no link has a mass")


def _check_joint(
    spec: RobotSpec, name: str, figures: tuple[float, float, float, float], problems: list[str]
) -> None:
    low, high, speed, angle = figures
    if not speed > 0.0:
        problems.append(f"{spec.urdf}: joint {name}: limit velocity = {speed:g} rad/s")
    if not low < high:
        problems.append(f"{spec.urdf}: joint {name}: limits [{low}, {high}] are empty")
    elif max(-low, high) > MAX_ANGLE:
        problems.append(f"{spec.urdf}: joint {name}: limits beyond +-{MAX_ANGLE:g} rad")
    elif not low <= angle <= high:
        problems.append(
            f"posture.{name}: {angle:.4f} rad is outside the joint's range "
            f"[{low:.4f}, {high:.4f}] in {spec.urdf}"
        )


def _add_frame(model: pin.Model, name: str, spec: FrameSpec) -> int:
    body = model.frames[model.getBodyId(spec.link)]
    inside = pin.SE3(pin.rpy.rpyToMatrix(*spec.rpy), np.array(spec.position))
    placement = body.placement * inside
    frame = pin.Frame(name, body.parentJoint, model.getBodyId(spec.link), placement, pin.OP_FRAME)
    return int(model.addFrame(frame))


def _add_hands(model: pin.Model, spec: RobotSpec) -> tuple[int, int] | None:
    if spec.hands is None:
        return None
    left = _add_frame(model, "hand_left", spec.hands.left)
    return left, _add_frame(model, "hand_right", spec.hands.right)


def _collision_pairs(robot: Robot) -> pin.GeometryModel:
    with tempfile.TemporaryDirectory() as folder:  # Pinocchio reads geometry from files only
        path = Path(folder) / "robot.urdf"
        path.write_text(robot.urdf, encoding="utf-8")
        geometry = _call_parser(
            lambda: pin.buildGeomFromUrdf(robot.model, str(path), pin.GeometryType.COLLISION),
            f"{robot.source}: {robot.spec.urdf}",
        )
    bodies = [robot.model.frames[g.parentFrame] for g in geometry.geometryObjects]
    ignored = {frozenset(pair) for pair in robot.spec.ignore_collisions}
    parents = robot.model.parents
    for i in range(geometry.ngeoms):
        for j in range(i):
            a, b = bodies[i], bodies[j]
            joint_a, joint_b = a.parentJoint, b.parentJoint
            adjacent = (
                joint_a == joint_b or joint_a in (parents[joint_b],) or joint_b == parents[joint_a]
            )
            if not adjacent and frozenset((a.name, b.name)) not in ignored:
                geometry.addCollisionPair(pin.CollisionPair(j, i))
    return geometry


def midpoint_width(robot: Robot) -> float:
    """Distance of the sole centres in the half-sitting posture [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.standing_q)
    left, right = (data.oMf[frame].translation for frame in robot.sole_frames)
    return float(math.hypot(*(left - right)[:2]))


def leg_joints(robot: Robot, side: Side) -> list[int]:
    """Pinocchio's joints of a leg, from the first that the other leg does not share to the sole."""
    own, other = (
        [int(joint) for joint in robot.model.supports[robot.model.frames[frame].parentJoint]]
        for frame in (robot.sole_frames[side], robot.sole_frames[side.other])
    )
    return [joint for joint in own if joint not in other]


def leg_length(robot: Robot) -> float:
    """Length of the left leg stretched [m]: along its joints, from the first one to the sole."""
    frame = robot.model.frames[robot.sole_frames[Side.LEFT]]
    steps = [robot.model.jointPlacements[j].translation for j in leg_joints(robot, Side.LEFT)[1:]]
    steps.append(frame.placement.translation)
    return float(sum(np.linalg.norm(step) for step in reversed(steps)))
