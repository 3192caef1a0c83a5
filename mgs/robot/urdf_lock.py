"""Locking of joints: revolute joints of a URDF are replaced by fixed joints in its text.

The text is changed before it is parsed, so that Pinocchio, physics engines, motion files and
viewers use the same robot. The new origin includes the rotation by the locked angle:

    R_parent_child = R_origin exp(angle axis)
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.errors import ConfigError
from mgs.robot.urdf_bounds import parse_bounded


def lock_joints(urdf: str, angles: Mapping[str, float], source: str, urdf_name: str) -> str:
    """URDF text with the joints of `angles` [rad] fixed; joints that are fixed stay as they are.

    `source` names robot.yaml and `urdf_name` the URDF in messages.

    Raises:
        ConfigError: the text is not XML, or a joint is missing, not revolute or out of range.
    """
    if not angles:
        return urdf
    root = parse_bounded(urdf, f"{source}: {urdf_name}")
    joints = {joint.get("name", ""): joint for joint in root.findall("joint")}
    problems: list[str] = []
    changed = False
    for name, angle in angles.items():
        problem = _problem(joints, name, angle, urdf_name)
        if problem:
            problems.append(f"locked.{name}: {problem}")
        elif joints[name].get("type") != "fixed":
            fix_joint(joints[name], angle)
            changed = True
    if problems:
        raise ConfigError(source, problems)
    return ElementTree.tostring(root, encoding="unicode") if changed else urdf


def _problem(
    joints: Mapping[str, ElementTree.Element], name: str, angle: float, urdf_name: str
) -> str:
    """Reason why a joint cannot be locked at an angle [rad]; empty if it can be."""
    if name not in joints:
        close = difflib.get_close_matches(name[:40], joints, n=1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        return f"{urdf_name} has no joint {name!r}{hint}"
    joint, kind = joints[name], joints[name].get("type")
    if kind == "fixed":
        return ""
    if kind not in ("revolute", "continuous"):
        return f"a {kind} joint in {urdf_name}; only revolute joints can be locked"
    if not np.isfinite(_placed(joint, angle)).all():
        return f"axis or origin is malformed in {urdf_name}"
    low, high = (_numbers(joint, "limit", key, "nan")[0] for key in ("lower", "upper"))
    if kind == "revolute" and not low <= angle <= high:
        return f"{angle:.4f} rad is outside its range [{low:.4f}, {high:.4f}] rad in {urdf_name}"
    return ""


def _placed(joint: ElementTree.Element, angle: float) -> NDArray[np.float64]:
    """Roll, pitch, yaw [rad] of the origin of a joint, rotated by an angle about its axis."""
    axis = np.array(_numbers(joint, "axis", "xyz", "1 0 0"))
    R_origin = pin.rpy.rpyToMatrix(*_numbers(joint, "origin", "rpy", "0 0 0"))
    norm = float(np.linalg.norm(axis)) or np.nan  # an axis of length 0 gives NaN
    return np.asarray(pin.rpy.matrixToRpy(R_origin @ pin.exp3(angle / norm * axis)))


def fix_joint(joint: ElementTree.Element, angle: float) -> None:
    """Change a joint into a fixed joint, rotated by an angle [rad] about its axis."""
    rpy = _placed(joint, angle)
    origin = joint.find("origin")
    if origin is None:
        origin = ElementTree.SubElement(joint, "origin")
    origin.set("rpy", " ".join(repr(float(x)) for x in rpy))
    joint.set("type", "fixed")
    for child in list(joint):
        if child.tag not in ("parent", "child", "origin"):
            joint.remove(child)


def _numbers(joint: ElementTree.Element, tag: str, key: str, default: str) -> list[float]:
    """Numbers in an attribute of a child element of a joint; NaN for each if it is malformed."""
    element = joint.find(tag)
    text = default if element is None else element.get(key, default)
    count = len(default.split())
    try:
        numbers = [float(word) for word in text.split()]
    except ValueError:
        numbers = []
    return numbers if len(numbers) == count else [np.nan] * count
