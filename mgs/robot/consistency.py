"""Checks that robot.yaml and URDF agree, and the joint ranges that follow from both."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from pathlib import Path

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.errors import ConfigError
from mgs.robot.motors import repeated_ids
from mgs.robot.spec import MAX_ANGLE, MAX_LENGTH, MAX_MASS, FrameSpec, RobotSpec


def require_known_names(
    spec: RobotSpec,
    model: pin.Model,
    names: tuple[str, ...],
    source: str | Path,
    followers: Collection[str] = (),
) -> None:
    """Check all links, joints and servos that robot.yaml names; followers have no servo.

    Raises:
        ConfigError: a name is missing or unknown, or a joint has no revolute axis with limits.
    """
    problems: list[str] = []
    _check_kinds(spec, model, names, problems)
    _check_links(spec, model, problems)
    _check_servos(spec, [name for name in names if name not in followers], problems)
    problems += [
        f"joints: {name} follows another joint and has no servo of its own; leave it out"
        for name in followers
        if name in spec.joints
    ]
    _check_joint_names(spec, names, problems)
    problems += repeated_ids(spec.motors)
    if problems:
        raise ConfigError(source, problems)


def checked_ranges(
    spec: RobotSpec,
    model: pin.Model,
    names: tuple[str, ...],
    speed_limit: Array,
    posture: Array,
    source: str | Path,
) -> tuple[Array, Array]:
    """Lower and upper joint limits (n,) [rad]: of robot.yaml if given, else of the URDF.

    `speed_limit` (n,) [rad/s] and `posture` (n,) [rad] are checked as well.

    Raises:
        ConfigError: a limit, a mass, a length or an angle of the posture is out of range.
    """
    problems: list[str] = []
    lower, upper = (
        limit[FLOATING_BASE_NQ:].copy()
        for limit in (model.lowerPositionLimit, model.upperPositionLimit)
    )
    _narrow(spec, names, lower, upper, problems)
    _check_bodies(spec, model, problems)
    for name, low, high, speed, angle in zip(
        names, lower, upper, speed_limit, posture, strict=True
    ):
        _check_joint(spec, name, (low, high, speed, angle), problems)
    if problems:
        raise ConfigError(source, problems)
    return lower, upper


def _check_kinds(
    spec: RobotSpec, model: pin.Model, names: tuple[str, ...], problems: list[str]
) -> None:
    for joint, name in enumerate(names, start=2):
        kind = model.joints[joint]
        if kind.nq != 1 or not kind.shortname().startswith("JointModelR"):
            problems.append(f"{spec.urdf}: joint {name} is not a revolute joint with limits")
        if name in model.names[:2]:  # Pinocchio would attach the link to the floating base
            problems.append(f"{spec.urdf}: joint {name}: a name taken by Pinocchio; rename it")


def _check_links(spec: RobotSpec, model: pin.Model, problems: list[str]) -> None:
    frames: dict[str, FrameSpec] = {
        "torso": spec.torso,
        "soles.left": spec.soles.left,
        "soles.right": spec.soles.right,
    }
    if spec.hands is not None:
        frames |= {"hands.left": spec.hands.left, "hands.right": spec.hands.right}
    links = [(f"{key}.link", frame.link) for key, frame in frames.items()]
    links.append(("base_link", spec.base_link))
    for key, link in links:
        if not model.existBodyName(link):
            problems.append(f"{key}: {spec.urdf} has no link {link!r}")
    if not problems and model.frames[model.getBodyId(spec.base_link)].parentJoint != 1:
        problems.append(f"base_link: {spec.base_link!r} is not the root link of {spec.urdf}")
    for link in (link for pair in spec.ignore_collisions for link in pair):
        if not model.existBodyName(link):
            problems.append(f"ignore_collisions: {spec.urdf} has no link {link!r}")


def _check_servos(spec: RobotSpec, names: Iterable[str], problems: list[str]) -> None:
    for name in names:
        if name not in spec.joints:
            problems.append(f"joints: no servo given for joint {name!r} of {spec.urdf}")
        elif spec.joints[name] not in spec.servos:
            problems.append(
                f"joints.{name}: servo {spec.joints[name]!r} is not listed under servos"
            )


def _check_joint_names(spec: RobotSpec, names: tuple[str, ...], problems: list[str]) -> None:
    named: dict[str, Iterable[str]] = {
        "joints": spec.joints,
        "posture": spec.posture,
        "limits": spec.limits,
        "motors": spec.motors,
        "roles": spec.roles.values(),
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
