"""Links of the cleaned URDF: one per moving body, with inertias that physics engines accept."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.robot.init.anatomy import Anatomy
from mgs.robot.init.looks import Look
from mgs.robot.init.points import bounding_box
from mgs.robot.init.skeleton import BASE, Skeleton
from mgs.robot.init.sole import Sole
from mgs.robot.urdf_text import Shape, add_link, add_revolute, joint_axis, numbers

LEAST_MASS = 1e-5  # least mass of a body, as part of the mass of the robot
# Mass of a body that only connects two joints, as part of the mass of the robot, and its principal
# inertias, as part of that mass times leg length squared: too small to change what the robot does.
BETWEEN_MASS, BETWEEN_INERTIA = 1e-11, 1e-12
# Range of plausible radii of gyration of a body, as parts of the reach of its shapes from its CoM.
LEAST_GYRATION, MOST_GYRATION = 0.03, 2.0
LEAST_INERTIA = 1e-7  # least principal inertia, as part of robot mass times leg length squared
CLEAR = 0.005  # [m] least height of shapes other than feet above the soles


def link_names(skeleton: Skeleton, root: ElementTree.Element) -> list[str]:
    """Name of the link of each body: the child link of its joint, or the root link."""
    children = {j.get("name", ""): _child(j) for j in root.findall("joint")}
    ends = {_child(j) for j in root.findall("joint")}
    base = next(n for n in (link.get("name", "") for link in root.findall("link")) if n not in ends)
    moved = [children[skeleton.name(body)] for body in range(2, skeleton.model.njoints)]
    return ["", base, *moved]


def _child(joint: ElementTree.Element) -> str:
    child = joint.find("child")
    return "" if child is None else child.get("link", "")


def cleaned_urdf(
    name: str,
    skeleton: Skeleton,
    links: list[str],
    shapes: list[list[Shape]],
    looks: list[list[Look]],
    inertias: list[pin.Inertia],
    figures: dict[int, tuple[float, float]],
) -> str:
    """URDF text of a skeleton.

    Args:
        name: name of the robot.
        skeleton: bodies of the robot.
        links: name of the link of each body.
        shapes: collision shapes of each body.
        looks: visual meshes of each body.
        inertias: inertia of each body.
        figures: torque limit [N m] and speed limit [rad/s] of each joint.
    """
    model, root = skeleton.model, ElementTree.Element("robot", name=name)
    for body in range(BASE, model.njoints):
        link = add_link(root, links[body], inertias[body], shapes[body])
        for look in looks[body]:
            look.add_to(link)
    for body in range(BASE + 1, model.njoints):
        at = int(model.idx_qs[body])
        limits = (
            float(model.lowerPositionLimit[at]), float(model.upperPositionLimit[at]), *figures[body]
        )  # fmt: skip
        ends = links[int(model.parents[body])], links[body]
        placement, axis = model.jointPlacements[body], joint_axis(model, body)
        element = add_revolute(root, skeleton.name(body), ends, placement, axis, limits)
        if body in skeleton.followers:
            _, follower = skeleton.followers[body]
            mimic = ElementTree.SubElement(element, "mimic", joint=follower.leader)
            mimic.set("multiplier", repr(float(follower.multiplier)))
            mimic.set("offset", repr(float(follower.offset)))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def mended_inertias(
    skeleton: Skeleton, leg_length: float, links: list[str], notes: list[str]
) -> list[pin.Inertia]:
    """Inertias of the bodies, with a note for each one that is changed.

    A radius of gyration far beyond the body's shapes, or far inside them, is a placeholder: the
    body then gets the inertia of a box around its shapes, of the same mass. Impossible principal
    inertias are raised to the nearest possible ones.
    """
    mass = float(pin.computeTotalMass(skeleton.model))
    floor = LEAST_INERTIA * mass * leg_length**2
    inertias = [skeleton.model.inertias[0]]
    for body in range(BASE, skeleton.model.njoints):
        if _only_connects(skeleton, body):
            moment = BETWEEN_INERTIA * mass * leg_length**2 * np.eye(3)
            inertias.append(pin.Inertia(BETWEEN_MASS * mass, np.zeros(3), moment))
            continue
        inertia = _plausible(skeleton, body, links[body], notes)
        moments, axes = np.linalg.eigh(inertia.inertia)
        new_mass = max(float(inertia.mass), LEAST_MASS * mass)
        new = np.maximum(moments, floor)
        new[:2] += 0.5 * max(0.0, new[2] * (1.0 + 1e-6) - new[0] - new[1])
        if new_mass > inertia.mass:
            notes.append(
                f"mass of link {links[body]} raised from {inertia.mass:g} kg to {new_mass:.2g} kg"
            )
        if np.abs(new - moments).max() > 1e-9 * new[2]:
            was, now = (", ".join(f"{m:.3g}" for m in values) for values in (moments, new))
            notes.append(
                f"link {links[body]}: physically impossible principal inertias {was} kg m^2 set to "
                f"{now} kg m^2"
            )
            inertia = pin.Inertia(new_mass, inertia.lever, axes @ np.diag(new) @ axes.T)
        elif new_mass > inertia.mass:
            inertia = pin.Inertia(new_mass, inertia.lever, inertia.inertia)
        inertias.append(inertia)
    return inertias


def _only_connects(skeleton: Skeleton, body: int) -> bool:
    """Whether a body is there to connect two joints: it has neither inertia nor shape."""
    inertia = skeleton.model.inertias[body]
    is_bare = not inertia.mass and not inertia.inertia.any() and not skeleton.surfaces[body]
    return body != BASE and is_bare and bool(skeleton.children(body))


def _plausible(skeleton: Skeleton, body: int, link: str, notes: list[str]) -> pin.Inertia:
    """Inertia of a body, or that of a box around its shapes where it does not fit their size."""
    inertia = skeleton.model.inertias[body]
    points = skeleton.points(body)
    if not inertia.mass > 0.0 or len(points) < 2:
        return inertia
    reach = float(np.linalg.norm(points - inertia.lever, axis=1).max())
    radius = float(np.sqrt(np.linalg.eigvalsh(inertia.inertia)[-1] / inertia.mass))
    if LEAST_GYRATION * reach <= radius <= MOST_GYRATION * reach:
        return inertia
    placement, size = bounding_box(points)
    box = pin.Inertia.FromBox(float(inertia.mass), *size)
    R = placement.rotation
    notes.append(
        f"link {link}: its inertia has a radius of gyration of {radius:.2g} m, but its shapes "
        f"reach {reach:.2g} m from its centre of mass; replaced by the inertia of a box around them"
    )
    return pin.Inertia(float(inertia.mass), inertia.lever, R @ box.inertia @ R.T)


def clean_shapes(
    skeleton: Skeleton, anatomy: Anatomy, soles: tuple[Sole, Sole], q: Array, notes: list[str]
) -> list[list[Shape]]:
    """Collision shapes of the bodies: feet and meshes are replaced by boxes.

    Shapes other than feet that reach down to the soles in the posture q are left out: they are
    corners of boxes around ankles and would carry the robot.
    """
    model, data = skeleton.model, skeleton.model.createData()
    pin.forwardKinematics(model, data, q)
    ground = min(
        float((data.oMi[foot] * sole.placement).translation[2])
        for foot, sole in zip(anatomy.feet, soles, strict=True)
    )
    shapes: list[list[Shape]] = [[] for _ in range(model.njoints)]
    for body in range(BASE, model.njoints):
        if body in anatomy.feet:
            sole = soles[anatomy.feet.index(body)]
            shapes[body].append(_foot_box(skeleton.points(body), sole))
            continue
        for link, pose, surface in skeleton.surfaces[body]:
            placement, kind, size = surface.shape()
            placement = pose * placement
            low = (data.oMi[body] * placement).act(np.zeros(3))[2] - _half_height(
                data.oMi[body].rotation @ placement.rotation, kind, size
            )
            if low < ground + CLEAR:
                notes.append(f"{kind} of link {link} left out: it reaches down to the ground")
                continue
            shapes[body].append((placement, kind, size))
    return shapes


def _foot_box(points: Array, sole: Sole) -> Shape:
    local = (points - sole.placement.translation) @ sole.placement.rotation
    low, high = local.min(axis=0), local.max(axis=0)
    low[2], high[2] = 0.0, max(high[2], 1e-3)
    centre = sole.placement * pin.SE3(np.eye(3), 0.5 * (low + high))
    return centre, "box", {"size": numbers(high - low)}


def _half_height(R: Array, kind: str, size: dict[str, str]) -> float:
    """Half of the vertical extent of a primitive [m]."""
    if kind == "sphere":
        return float(size["radius"])
    if kind == "box":
        half = 0.5 * np.array([float(word) for word in size["size"].split()])
        return float(np.abs(R[2]) @ half)
    z = abs(float(R[2, 2]))
    across = float(np.sqrt(max(0.0, 1.0 - z * z)))
    return 0.5 * float(size["length"]) * z + float(size["radius"]) * across
