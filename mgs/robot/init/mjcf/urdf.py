"""The compiled model of MuJoCo, written as the links and joints of a URDF.

A body of MuJoCo turns about its joints one after another, each about a point and an axis that are
fixed in the body. With the points a_1 ... a_k of its joints it becomes k links in a row. The frame
of link i is parallel to the body's and has its origin at a_i:

    T_parent_link1(q) = T_parent_body T(a_1) R_1(q_1 - ref_1)
    T_link(i-1)_link(i)(q) = T(a_i - a_(i-1)) R_i(q_i - ref_i)         T_link(k)_body = T(-a_k)

All links but the last have neither mass nor shapes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.robot.init.mjcf.text import ModelText
from mgs.robot.urdf_text import add_inertial, add_origin, numbers

BALL, SLIDE, HINGE = 1, 2, 3  # types of joints in MuJoCo
SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH = 2, 3, 4, 5, 6, 7  # types of shapes
FIRST_HIDDEN_GROUP = 3  # shapes of this group and higher ones are there for contacts, by custom
ELLIPSOID_POINTS = 9  # along each angle
MESH_NAME = "mjcf:"  # begins the names of meshes that are no files


@dataclass(eq=False)
class Tree:
    """Links and joints of the robot in a compiled model."""

    root: ElementTree.Element  # <robot>
    links: dict[int, str]  # name of the link of each body
    joints: dict[int, str]  # name of each joint that became one, by its id in MuJoCo
    meshes: dict[str, Array] = field(default_factory=dict)  # points (N, 3) by name
    problems: list[str] = field(default_factory=list)


def tree_of(model: Any, base: int, name: str, text: ModelText) -> Tree:
    """Links and joints of the bodies from `base` on outward; the joints of `base` are left out.

    `text` tells which shapes have lost their meshes, and which of them touch others.
    """
    bodies = [body for body in range(model.nbody) if base in _ancestry(model, body)]
    links = _unique([model.body(body).name or f"body_{body}" for body in bodies])
    tree = Tree(ElementTree.Element("robot", name=name), dict(zip(bodies, links, strict=True)), {})
    own = [j for body in bodies if body != base for j in _joints_of(model, body)]
    named = _unique([model.joint(j).name or f"joint_{j}" for j in own])
    tree.joints.update(zip(own, named, strict=True))
    for body in bodies:
        anchor = _add_joints(tree, model, body) if body != base else np.zeros(3)
        link = _add_body(tree, model, body, anchor)
        _add_shapes(tree, link, model, body, pin.SE3(np.eye(3), -anchor), text)
    _add_upright(tree, model, base)
    return tree


def _ancestry(model: Any, body: int) -> set[int]:
    found = {body}
    while body:
        body = int(model.body_parentid[body])
        found.add(body)
    return found


def _joints_of(model: Any, body: int) -> list[int]:
    first = int(model.body_jntadr[body])
    return list(range(first, first + int(model.body_jntnum[body])))


def _unique(names: list[str]) -> list[str]:
    taken: set[str] = set()
    for i, name in enumerate(names):
        while name in taken:
            name += "_"
        taken.add(name)
        names[i] = name
    return names


def _last_anchor(model: Any, body: int, base: int) -> Array:
    joints = _joints_of(model, body) if body != base else []
    return np.array(model.jnt_pos[joints[-1]]) if joints else np.zeros(3)


def _add_joints(tree: Tree, model: Any, body: int) -> Array:
    """Append the joints above a body; the last of their points (3,) in the body's frame."""
    parent = int(model.body_parentid[body])
    base = min(tree.links)
    above = tree.links[parent]
    placement = pin.SE3(np.eye(3), -_last_anchor(model, parent, base)) * pin.SE3(
        _rotation(model.body_quat[body]), np.array(model.body_pos[body])
    )
    joints, anchor = _joints_of(model, body), np.zeros(3)
    if not joints:
        _add_joint(tree, f"{tree.links[body]}_fixed", (above, tree.links[body]), placement, None)
    for i, joint in enumerate(joints):
        name, here = tree.joints[joint], np.array(model.jnt_pos[joint])
        is_last = joint == joints[-1]
        below = tree.links[body] if is_last else f"{tree.links[body]}_{name}"
        step = pin.SE3(np.eye(3), here - anchor)
        placement, anchor = placement * step if i == 0 else step, here
        if not is_last:
            ElementTree.SubElement(tree.root, "link", name=below)
        placement = placement * _unturned(model, joint)
        _add_joint(tree, name, (above, below), placement, _figures(tree, model, joint))
        above = below
    return anchor


def _unturned(model: Any, joint: int) -> pin.SE3:
    """Motion of a joint from its reference to position 0, which a URDF starts from."""
    at = int(model.jnt_qposadr[joint])
    kind, back = int(model.jnt_type[joint]), -float(model.qpos0[at])
    axis = np.array(model.jnt_axis[joint])
    if kind == HINGE:
        return pin.SE3(pin.exp3(back * axis), np.zeros(3))
    return pin.SE3(np.eye(3), back * axis) if kind == SLIDE else pin.SE3.Identity()


def _figures(tree: Tree, model: Any, joint: int) -> tuple[str, Array, dict[str, float]] | None:
    """Type, axis and limits of a joint of a URDF; velocities are unknown in an MJCF."""
    kind = int(model.jnt_type[joint])
    if kind not in (HINGE, SLIDE):
        tree.problems.append(
            f"joint {tree.joints[joint]} is a ball joint; replace it by three hinges, whose angles "
            "motors can control"
        )
        return None
    lower, upper = model.jnt_range[joint] if model.jnt_limited[joint] else (0.0, 0.0)
    limit = {"lower": lower, "upper": upper, "effort": _effort(model, joint), "velocity": 0.0}
    free = "continuous" if kind == HINGE else "prismatic"
    named = ("revolute" if model.jnt_limited[joint] else free) if kind == HINGE else "prismatic"
    return named, np.array(model.jnt_axis[joint]), limit


def _effort(model: Any, joint: int) -> float:
    """Largest torque of the actuators of a joint [N m]; 0 if one of them has no limit."""
    total, limits = 0.0, []
    for i in range(model.nu):
        if int(model.actuator_trntype[i]) > 1 or int(model.actuator_trnid[i, 0]) != joint:
            continue
        gear = abs(float(model.actuator_gear[i, 0]))
        if model.actuator_forcelimited[i]:
            limits.append(gear * float(np.abs(model.actuator_forcerange[i]).max()))
        elif model.actuator_ctrllimited[i] and not model.actuator_biastype[i]:
            gain = abs(float(model.actuator_gainprm[i, 0]))
            limits.append(gear * gain * float(np.abs(model.actuator_ctrlrange[i]).max()))
        else:
            limits.append(np.inf)
    total = float(sum(limits)) if limits else np.inf
    if model.jnt_actfrclimited[joint]:
        total = min(total, float(np.abs(model.jnt_actfrcrange[joint]).max()))
    return total if np.isfinite(total) else 0.0


def _add_joint(
    tree: Tree,
    name: str,
    ends: tuple[str, str],
    placement: pin.SE3,
    figures: tuple[str, Array, dict[str, float]] | None,
) -> None:
    kind = "fixed" if figures is None else figures[0]
    element = ElementTree.SubElement(tree.root, "joint", name=name, type=kind)
    ElementTree.SubElement(element, "parent", link=ends[0])
    ElementTree.SubElement(element, "child", link=ends[1])
    add_origin(element, placement)
    if figures is not None:
        _, axis, limit = figures
        ElementTree.SubElement(element, "axis", xyz=numbers(axis))
        given = {key: repr(float(value)) for key, value in limit.items()}
        if kind == "continuous":
            del given["lower"], given["upper"]
        ElementTree.SubElement(element, "limit", given)


def _add_body(tree: Tree, model: Any, body: int, anchor: Array) -> ElementTree.Element:
    """Append the link of a body, whose frame is at `anchor` (3,) in the body's frame."""
    link = ElementTree.SubElement(tree.root, "link", name=tree.links[body])
    if model.body_mass[body] > 0.0:
        R = _rotation(model.body_iquat[body])
        moments = R @ np.diag(model.body_inertia[body]) @ R.T
        lever = np.array(model.body_ipos[body]) - anchor
        add_inertial(link, pin.Inertia(float(model.body_mass[body]), lever, moments))
    return link


def _add_shapes(
    tree: Tree,
    link: ElementTree.Element,
    model: Any,
    body: int,
    to_link: pin.SE3,
    text: ModelText,
) -> None:
    """Append the shapes of a body; those that touch nothing are there to be looked at."""
    first = int(model.body_geomadr[body])
    for geom in range(first, first + int(model.body_geomnum[body])):
        is_mesh = int(model.geom_type[geom]) == MESH
        if is_mesh and model.mesh(int(model.geom_dataid[geom])).name in text.missing:
            continue
        touches = bool(model.geom_conaffinity[geom] or model.geom_contype[geom])
        hidden = int(model.geom_group[geom]) >= FIRST_HIDDEN_GROUP
        named = model.geom(geom).name in text.paired
        tag = "collision" if touches or hidden or named else "visual"
        _add_shape(tree, link, tag, model, geom, to_link)


def _add_shape(
    tree: Tree, link: ElementTree.Element, tag: str, model: Any, geom: int, to_link: pin.SE3
) -> None:
    kind, size = int(model.geom_type[geom]), model.geom_size[geom]
    pose = pin.SE3(_rotation(model.geom_quat[geom]), np.array(model.geom_pos[geom]))
    shape: tuple[str, dict[str, str]]
    if kind == SPHERE:
        shape = "sphere", {"radius": repr(float(size[0]))}
    elif kind in (CAPSULE, CYLINDER):
        length = {"radius": repr(float(size[0])), "length": repr(2.0 * float(size[1]))}
        shape = "capsule" if kind == CAPSULE else "cylinder", length
    elif kind == BOX:
        shape = "box", {"size": numbers(2.0 * size)}
    elif kind in (ELLIPSOID, MESH):
        name = f"{MESH_NAME}{geom}"
        tree.meshes[name] = _mesh(model, geom) if kind == MESH else _ellipsoid(size)
        shape = "mesh", {"filename": name}
    else:
        return  # planes and height fields are no parts of a robot
    element = ElementTree.SubElement(link, tag)
    add_origin(element, to_link * pose)
    ElementTree.SubElement(ElementTree.SubElement(element, "geometry"), *shape)


def _mesh(model: Any, geom: int) -> Array:
    mesh = int(model.geom_dataid[geom])
    first = int(model.mesh_vertadr[mesh])
    return np.array(model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])], dtype=float)


def _ellipsoid(radii: Array) -> Array:
    polar = np.linspace(0.0, np.pi, ELLIPSOID_POINTS)
    around = np.arange(2 * ELLIPSOID_POINTS - 2) * np.pi / (ELLIPSOID_POINTS - 1)
    t, p = (x.ravel() for x in np.meshgrid(polar, around))
    return radii * np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=1)


def _add_upright(tree: Tree, model: Any, base: int) -> None:
    """Append a root link that stands upright above a base that does not."""
    R = _rotation(model.body_quat[base])
    if R[2, 2] > 1.0 - 1e-9:
        return
    name = f"{tree.links[base]}_upright"
    ElementTree.SubElement(tree.root, "link", name=name)
    ends = name, tree.links[base]
    _add_joint(tree, f"{name}_joint", ends, pin.SE3(R, np.zeros(3)), None)


def _rotation(quat_wxyz: Array) -> Array:
    w, x, y, z = (float(value) for value in quat_wxyz)
    quat = pin.Quaternion(w, x, y, z)
    quat.normalize()
    return np.asarray(quat.matrix())
