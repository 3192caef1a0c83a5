"""Construction of a robot from the texts of robot.yaml and URDF, with checks of consistency."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.config import build, parse_yaml
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.robot.pinocchio_urdf import parse_urdf
from mgs.robot.robot import Robot
from mgs.robot.spec import MAX_ANGLE, MAX_LENGTH, MAX_MASS, FrameSpec, RobotSpec
from mgs.robot.urdf_lock import lock_joints


def build_robot(yaml_text: str, urdf_text: str, source: str | Path) -> Robot:
    """Build a robot from the texts of its two files; messages name robot.yaml by `source`.

    Locked joints are fixed joints in `Robot.urdf`, so that this text gives the same robot again.
    """
    spec = build(RobotSpec, parse_yaml(yaml_text, source), source)
    urdf_text = lock_joints(urdf_text, spec.locked, str(source), spec.urdf)
    model = parse_urdf(urdf_text, f"{source}: {spec.urdf}")
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
        if name in model.names[:2]:  # Pinocchio would attach the link to the floating base
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
    """Replace limits (n,) of the URDF by the limits in robot.yaml, if given."""
    for name, (low, high) in spec.limits.items():
        j = names.index(name)
        if lower[j] <= low < high <= upper[j]:
            lower[j], upper[j] = low, high
        else:
            problems.append(
                f"limits.{name}: [{low:g}, {high:g}] rad is not a range within the range "
                f"[{lower[j]:.4f}, {upper[j]:.4f}] rad in {spec.urdf}"
            )


def _check_bodies(spec: RobotSpec, model: pin.Model, problems: list[str]) -> None:
    for inertia, joint in zip(model.inertias[1:], model.names[1:], strict=True):
        if not 0.0 <= inertia.mass <= MAX_MASS:
            problems.append(
                f"{spec.urdf}: the links moved by {joint} have a mass of {inertia.mass:g} kg, "
                f"outside [0, {MAX_MASS:g}] kg"
            )
    for placement, joint in zip(model.jointPlacements[1:], model.names[1:], strict=True):
        if not np.abs(placement.translation).max() <= MAX_LENGTH:
            problems.append(
                f"{spec.urdf}: joint {joint} is more than {MAX_LENGTH:g} m from its parent"
            )
    if not problems and not pin.computeTotalMass(model) > 0.0:
        problems.append(f"{spec.urdf}: no link has a mass; add inertial elements")


def _check_joint(
    spec: RobotSpec, name: str, figures: tuple[float, float, float, float], problems: list[str]
) -> None:
    low, high, speed, angle = figures
    if not speed > 0.0:
        problems.append(
            f"{spec.urdf}: joint {name}: limit velocity = {speed:g} rad/s, must be above 0 rad/s"
        )
    if not low < high:
        problems.append(f"{spec.urdf}: joint {name}: limits [{low}, {high}] are empty")
    elif max(-low, high) > MAX_ANGLE:
        problems.append(f"{spec.urdf}: joint {name}: limits exceed +-{MAX_ANGLE:g} rad")
    elif not low <= angle <= high:
        problems.append(
            f"posture.{name}: {angle:.4f} rad is outside the joint's range "
            f"[{low:.4f}, {high:.4f}] rad in {spec.urdf}"
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
