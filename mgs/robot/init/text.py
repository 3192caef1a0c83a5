"""Text of robot.yaml and README.md for a robot that was read from a third-party URDF."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.robot.init.anatomy import Anatomy
from mgs.robot.init.figures import ServoFigures
from mgs.robot.init.skeleton import BASE, Skeleton
from mgs.robot.init.sole import Sole

UPRIGHT = 0.35  # [rad] largest angle of waist and head joints to either side of the posture
PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_./-]*\Z")
WORDS_OF_YAML = {"y", "n", "yes", "no", "on", "off", "true", "false", "null"}


@dataclass(frozen=True, eq=False)
class Draft:
    """Contents of robot.yaml."""

    name: str
    skeleton: Skeleton
    links: list[str]  # name of the link of each body
    anatomy: Anatomy
    soles: tuple[Sole, Sole]
    hands: tuple[Array, Array] | None  # positions (3,) in the frames of their bodies [m]
    q: Array  # half-sitting configuration
    figures: dict[int, ServoFigures]
    ignored: list[tuple[str, str]]


def robot_yaml(draft: Draft) -> str:
    """Text of robot.yaml; every line with a guessed value is marked."""
    parts = [_head(draft), _posture(draft), _servos(draft), _tail(draft), _guesses(draft)]
    return "\n".join(line for lines in parts for line in lines) + "\n"


def _head(draft: Draft) -> list[str]:
    anatomy = draft.anatomy
    base, torso = (word(draft.links[body]) for body in (BASE, anatomy.torso))
    carries = "body that carries the arms" if anatomy.arms else "body above the waist"
    lines = [
        f"# {draft.name}: first version by `mgs robot init`. Review the lines marked `guess`.",
        "# Units: m, rad, N m, rad/s, kg m^2. README.md states the origin of the values.",
        "mgs: 1",
        f"name: {word(draft.name)}",
        "urdf: robot.urdf",
        f"base_link: {base}  # guess: root link",
        f"torso: {{link: {torso}, position: [0.0, 0.0, 0.0]}}  # guess: {carries}",
        "soles:  # guess: bounding rectangle of the lowest plane of each foot",
    ]
    for side in Side:
        sole, link = draft.soles[side], word(draft.links[anatomy.feet[side]])
        size = f"length: {sole.length:.4f}, width: {sole.width:.4f}"
        lines.append(f"  {side.label}: {{link: {link}, {_pose(sole.placement)}, {size}}}")
    if anatomy.arms is not None and draft.hands is not None:
        lines.append("hands:  # guess: middle of the surface of the last link of each arm")
        for side in Side:
            link = word(draft.links[anatomy.arms[side][-1]])
            position = _list(draft.hands[side])
            lines.append(f"  {side.label}: {{link: {link}, position: {position}}}")
    return lines


def _pose(placement: pin.SE3) -> str:
    rpy = pin.rpy.matrixToRpy(placement.rotation)
    text = f"position: {_list(placement.translation)}"
    return text if np.abs(rpy).max() < 1e-9 else f"{text}, rpy: {_list(rpy, 9)}"


def _posture(draft: Draft) -> list[str]:
    lines = ["posture:  # guess: knees bent, soles level, CoM above them"]
    for joint in _moving(draft):
        if joint in draft.skeleton.followers:
            continue
        angle = float(draft.q[draft.skeleton.model.idx_qs[joint]])
        if abs(angle) > 1e-9:
            lines.append(f"  {word(draft.skeleton.name(joint))}: {angle:.9f}")
    return lines if len(lines) > 1 else ["posture: {}"]


def _servos(draft: Draft) -> list[str]:
    moving = [j for j in _moving(draft) if j not in draft.skeleton.followers]
    lines = ["servos:  # effort and velocity limits of the URDF; velocity taken as no-load speed"]
    names = _servo_names(draft.figures[joint] for joint in moving)
    for figures, name in names.items():
        guess = f"  # guess: {' and '.join(figures.guessed)}" if figures.guessed else ""
        values = {
            "stall_torque": figures.effort,
            "no_load_speed": figures.velocity,
            "armature": figures.armature,
            "viscous_friction": figures.viscous_friction,
            "friction": figures.friction,
        }
        given = ", ".join(f"{key}: {value:g}" for key, value in values.items() if value)
        lines.append(f"  {name}: {{{given}}}{guess}")
    lines.append("joints:")
    lines += [f"  {word(draft.skeleton.name(j))}: {names[draft.figures[j]]}" for j in moving]
    lines += _limits(draft)
    if draft.anatomy.locked:
        lines.append("locked:  # guess: joints that whole-body motions do not need [rad]")
        for joint, why in sorted(draft.anatomy.locked.items()):
            angle = float(draft.q[draft.skeleton.model.idx_qs[joint]])
            lines.append(f"  {word(draft.skeleton.name(joint))}: {angle!r}  # {why}")
    return lines


def _limits(draft: Draft) -> list[str]:
    """Ranges of waist and head near upright; those in the URDF are wide and seldom symmetric."""
    model, lines = draft.skeleton.model, []
    for joint in [*draft.anatomy.waist, *draft.anatomy.head]:
        at = int(model.idx_qs[joint])
        angle = float(draft.q[at])
        low = max(float(model.lowerPositionLimit[at]), angle - UPRIGHT)
        high = min(float(model.upperPositionLimit[at]), angle + UPRIGHT)
        lines.append(f"  {word(draft.skeleton.name(joint))}: [{low!r}, {high!r}]")
    heading = "limits:  # guess: trunk near upright; widen them for motions that bend the trunk"
    return [heading, *lines] if lines else []


def _servo_names(figures: Iterable[ServoFigures]) -> dict[ServoFigures, str]:
    """Name of each different servo: its torque and speed, and a number where that is not enough."""
    names: dict[ServoFigures, str] = {}
    for servo in figures:
        if servo not in names:
            guess = "-guess" if servo.guessed else ""
            name = first = f"{servo.effort:g}Nm-{servo.velocity:g}rad{guess}"
            number = 1
            while name in names.values():
                number += 1
                name = f"{first}-{number}"
            names[servo] = name
    return names


def _tail(draft: Draft) -> list[str]:
    lines = ["groups:  # guess"]
    for group, joints in groups(draft.anatomy).items():
        names = ", ".join(word(draft.skeleton.name(joint)) for joint in joints)
        lines.append(f"  {group}: [{names}]")
    if not draft.ignored:
        return [*lines, "ignore_collisions: []"]
    lines.append("ignore_collisions:  # guess: the shapes touch in or near the posture")
    return [*lines, *(f"  - [{word(a)}, {word(b)}]" for a, b in draft.ignored)]


def _guesses(draft: Draft) -> list[str]:
    """Keys of guessed values on which verdicts rest."""
    motors = [j for j in _moving(draft) if j not in draft.skeleton.followers]
    names = _servo_names(draft.figures[joint] for joint in motors)
    keys = ["torso", "soles", *(["hands"] if draft.hands is not None else []), "posture"]
    keys += [f"servos.{name}.{key}" for servo, name in names.items() for key in servo.guessed]
    keys += ["limits"] if _limits(draft) else []
    keys += ["locked"] if draft.anatomy.locked else []
    keys += ["ignore_collisions"] if draft.ignored else []
    return [
        "guesses:  # named by verdicts; remove a key once its value is confirmed",
        *(f"  - {key}" for key in keys),
    ]


def groups(anatomy: Anatomy) -> dict[str, list[int]]:
    """Joints of each limb that the robot has."""
    limbs = {f"{side.label}_leg": anatomy.legs[side] for side in Side}
    if anatomy.arms is not None:
        limbs |= {f"{side.label}_arm": anatomy.arms[side] for side in Side}
    limbs |= {"waist": anatomy.waist, "head": anatomy.head}
    return {name: joints for name, joints in limbs.items() if joints}


def _moving(draft: Draft) -> list[int]:
    return [j for j in range(2, draft.skeleton.model.njoints) if j not in draft.anatomy.locked]


def readme(draft: Draft, source: str, notes: Iterable[str]) -> str:
    """Text of README.md: source, joints by limb, and all changes of the URDF."""
    limbs = [
        f"- {name.replace('_', ' ')}: {', '.join(draft.skeleton.name(j) for j in joints)}"
        for name, joints in groups(draft.anatomy).items()
    ]
    changes = [f"- {note}" for note in notes] or ["- no changes"]
    return "\n".join(
        [
            f"# {draft.name}",
            "",
            f"First version by `mgs robot init`, made from `{source}`.",
            "",
            "`robot.urdf` is a cleaned copy of the source. It has one link for each moving body, "
            "with the inertia of all links that are fixed to it. Feet and meshes are replaced by "
            "boxes; other shapes are unchanged. Visual meshes are named for pages and viewers, and "
            "their files are not needed. Review the lines of `robot.yaml` that are marked "
            "`guess`. `mgs robot check` finds errors in this folder.",
            "",
            "Joints by limb:",
            "",
            *limbs,
            "",
            "Changes and omissions:",
            "",
            *changes,
            "",
        ]
    )


def word(text: str) -> str:
    """String as YAML: plain if that is safe, else quoted."""
    plain = PLAIN.match(text) and text.lower() not in WORDS_OF_YAML
    return text if plain else json.dumps(text)


def _list(values: Array, digits: int = 6) -> str:
    return "[" + ", ".join(repr(round(float(value), digits) + 0.0) for value in values) + "]"
