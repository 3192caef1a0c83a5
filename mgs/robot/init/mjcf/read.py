"""An MJCF model as a URDF, with what a URDF cannot say beside it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError
from mgs.robot.init.mjcf.compiled import compiled
from mgs.robot.init.mjcf.sources import NOT_READ, with_includes
from mgs.robot.init.mjcf.text import robot_text
from mgs.robot.init.mjcf.urdf import HINGE, Tree, tree_of

CONNECT, WELD, JOINT = 0, 1, 2  # types of equality constraints in MuJoCo
LINEAR, HIGHEST = 2, 5  # coefficients of a polynomial up to the linear one, and all of them


@dataclass(frozen=True)
class Drive:
    """What an MJCF tells about the motor of a joint, besides its torque."""

    armature: float  # [kg m^2]
    damping: float  # [N m s/rad]
    friction: float  # [N m]


@dataclass(frozen=True, eq=False)
class Mjcf:
    """Content of an MJCF model."""

    root: ElementTree.Element  # the robot as a URDF
    meshes: dict[str, Array]  # points (N, 3) [m] by the names of meshes in `root`
    missing: list[str]  # names of mesh files that were not found
    posture: dict[str, float]  # angles of a keyframe that shows how to stand [rad]
    drives: dict[str, Drive]  # by the name of the joint
    apart: list[tuple[str, str]]  # pairs of links that the model excludes from collisions
    notes: list[str] = field(default_factory=list)


def read_mjcf(root: ElementTree.Element, path: Path, folders: tuple[Path, ...]) -> Mjcf:
    """The robot in an MJCF model.

    Args:
        root: root element of the model, which is changed.
        path: path of the model.
        folders: folders besides that of the model in which meshes and included files may lie.

    Raises:
        ConfigError: MuJoCo refuses the model, or there is no robot that mgs supports in it.
    """
    root = with_includes(root, path, folders)
    text = robot_text(root, path, folders)
    model = compiled(text, path)
    base = _base(model, path, text.notes)
    tree = tree_of(model, base, root.get("model") or path.stem, text)
    problems = [*tree.problems, *_couple(model, tree, text.notes)]
    if problems:
        raise ConfigError(path, problems)
    ElementTree.indent(tree.root)
    return Mjcf(
        root=tree.root,
        meshes=tree.meshes,
        missing=list(text.missing.values()),
        posture=_posture(model, tree, text.notes),
        drives={tree.joints[joint]: _drive(model, joint) for joint in tree.joints},
        apart=_apart(model, tree),
        notes=text.notes,
    )


def _base(model: Any, path: Path, notes: list[str]) -> int:
    """The body on the world with the most mass above it; what else there is, is left out."""
    bodies = [b for b in range(1, model.nbody) if int(model.body_parentid[b]) == 0]
    if not bodies:
        raise ConfigError(path, f"{NOT_READ}: it has no body")
    base = max(bodies, key=lambda body: float(model.body_subtreemass[body]))
    others = [model.body(body).name or f"body {body}" for body in bodies if body != base]
    if others:
        notes.append(f"bodies that are no part of the robot left out: {', '.join(others[:5])}")
    n = int(model.body_jntnum[base])
    if n:
        notes.append(
            f"{n} joint{'s' if n > 1 else ''} between the world and body {model.body(base).name} "
            "removed: mgs adds a floating base"
        )
    return base


def _couple(model: Any, tree: Tree, notes: list[str]) -> list[str]:
    """Write equality constraints between joints as mimic joints; the problems that there are."""
    problems, found = [], {j.get("name", ""): j for j in tree.root.findall("joint")}
    for i in range(model.neq):
        if not model.eq_active0[i]:
            continue
        kind = int(model.eq_type[i])
        one, two = int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
        if kind in (CONNECT, WELD):
            if int(model.eq_objtype[i]) == 1 and one in tree.links and two in tree.links:
                problems.append(
                    f"closed loop: the bodies {tree.links[one]} and {tree.links[two]} are "
                    "connected by an equality constraint; mgs supports only trees of joints"
                )
            continue
        if kind != JOINT or one not in tree.joints or two not in (-1, *tree.joints):
            continue
        data = np.array(model.eq_data[i, :HIGHEST])
        start = float(model.qpos0[model.jnt_qposadr[one]])
        element, name = found[tree.joints[one]], tree.joints[one]
        if two < 0:
            _hold(element, start + float(data[0]))
            notes.append(f"joint {name} is held at {start + float(data[0]):g} rad by a constraint")
            continue
        leader = tree.joints[two]
        if np.any(data[LINEAR:]):
            problems.append(
                f"joint {name} follows joint {leader} by a polynomial of higher order "
                f"{', '.join(f'{c:g}' for c in data)}; only linear couplings are supported"
            )
            continue
        offset = start + data[0] - data[1] * float(model.qpos0[model.jnt_qposadr[two]])
        ElementTree.SubElement(
            element,
            "mimic",
            joint=leader,
            multiplier=repr(float(data[1])),
            offset=repr(float(offset)),
        )
    return problems


def _hold(joint: ElementTree.Element, angle: float) -> None:
    """Leave a joint no range around an angle [rad], so that it is fixed there."""
    limit = joint.find("limit")
    assert limit is not None
    if joint.get("type") == "continuous":
        joint.set("type", "revolute")
    limit.set("lower", repr(angle))
    limit.set("upper", repr(angle))


def _posture(model: Any, tree: Tree, notes: list[str]) -> dict[str, float]:
    """Angles in the keyframe, if there is one."""
    if not model.nkey:
        return {}
    notes.append(f"posture taken from keyframe {model.key(0).name} where it suits a walk")
    return {
        name: float(model.key_qpos[0, model.jnt_qposadr[joint]])
        for joint, name in tree.joints.items()
        if int(model.jnt_type[joint]) == HINGE
    }


def _drive(model: Any, joint: int) -> Drive:
    dof = int(model.jnt_dofadr[joint])
    return Drive(
        armature=float(model.dof_armature[dof]),
        damping=float(np.asarray(model.dof_damping[dof]).flat[0]),
        friction=float(model.dof_frictionloss[dof]),
    )


def _apart(model: Any, tree: Tree) -> list[tuple[str, str]]:
    """Pairs of links that the model excludes from collisions."""
    pairs = []
    for signature in np.array(model.exclude_signature, dtype=np.int64):
        one, two = int(signature) >> 16, int(signature) & 0xFFFF
        if one in tree.links and two in tree.links:
            pairs.append((tree.links[one], tree.links[two]))
    return pairs
