"""robot.yaml and README.md of a robot that was read from somebody else's URDF."""

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

UPRIGHT = 0.35  # [rad] that waist and head may turn either way
PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_./-]*\Z")
WORDS_OF_YAML = {"y", "n", "yes", "no", "on", "off", "true", "false", "null"}


@dataclass(frozen=True, eq=False)
class Draft:
    """Everything that robot.yaml says."""

    name: str
    skeleton: Skeleton
    links: list[str]  # of every body
    anatomy: Anatomy
    soles: tuple[Sole, Sole]
    hands: tuple[Array, Array] | None  # (3,) in their bodies [m]
    q: Array  # half-sitting
    figures: dict[int, ServoFigures]
    ignored: list[tuple[str, str]]


def robot_yaml(draft: Draft) -> str:
    """Text of robot.yaml; a line that holds a guess says so."""
    return "\n".join([*_head(draft), *_posture(draft), *_servos(draft), *_tail(draft)]) + "\n"


def _head(draft: Draft) -> list[str]:
    anatomy = draft.anatomy
    base, torso = (word(draft.links[body]) for body in (BASE, anatomy.torso))
    carries = "body that carries the arms" if anatomy.arms else "body above the waist"
    lines = [
        f"# {draft.name}: first draft by `mgs robot init`; lines marked `guess` want a look.",
        "# Units m, rad, N m, rad/s, kg m^2; README.md says where the figures come from.",
        "mgs: 1",
        f"name: {word(draft.name)}",
        "urdf: robot.urdf",
        f"base_link: {base}  # guess: root link",
        f"torso: {{link: {torso}, position: [0.0, 0.0, 0.0]}}  # guess: {carries}",
        "soles:  # guess: rectangle about the lowest plane of each foot's surface",
    ]
    for side in Side:
        sole, link = draft.soles[side], word(draft.links[anatomy.feet[side]])
        size = f"length: {sole.length:.4f}, width: {sole.width:.4f}"
        lines.append(f"  {side.label}: {{link: {link}, {_pose(sole.placement)}, {size}}}")
    if anatomy.arms is not None and draft.hands is not None:
        lines.append("hands:  # guess: middle of the surface of each arm's last link")
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
        angle = float(draft.q[draft.skeleton.model.idx_qs[joint]])
        if abs(angle) > 1e-9:
            lines.append(f"  {word(draft.skeleton.name(joint))}: {angle:.9f}")
    return lines if len(lines) > 1 else ["posture: {}"]


def _servos(draft: Draft) -> list[str]:
    moving = _moving(draft)
    lines = ["servos:  # effort and velocity of the URDF; the latter is taken for no-load speed"]
    seen: dict[str, ServoFigures] = {}
    for joint in moving:
        seen.setdefault(_servo(draft.figures[joint]), draft.figures[joint])
    for name, figures in seen.items():
        guess = f"  # guess: {' and '.join(figures.guessed)}" if figures.guessed else ""
        torque, speed = f"stall_torque: {figures.effort:g}", f"no_load_speed: {figures.velocity:g}"
        lines.append(f"  {name}: {{{torque}, {speed}}}{guess}")
    lines.append("joints:")
    lines += [f"  {word(draft.skeleton.name(j))}: {_servo(draft.figures[j])}" for j in moving]
    lines += _limits(draft)
    if draft.anatomy.locked:
        lines.append("locked:  # guess: joints that no motion of the whole body needs [rad]")
        for joint, why in sorted(draft.anatomy.locked.items()):
            angle = float(draft.q[draft.skeleton.model.idx_qs[joint]])
            lines.append(f"  {word(draft.skeleton.name(joint))}: {angle:.9g}  # {why}")
    return lines


def _limits(draft: Draft) -> list[str]:
    """Waist and head near upright: their ranges in the URDF are wide and seldom symmetric."""
    model, lines = draft.skeleton.model, []
    for joint in [*draft.anatomy.waist, *draft.anatomy.head]:
        at = int(model.idx_qs[joint])
        angle = float(draft.q[at])
        low = max(float(model.lowerPositionLimit[at]), angle - UPRIGHT)
        high = min(float(model.upperPositionLimit[at]), angle + UPRIGHT)
        lines.append(f"  {word(draft.skeleton.name(joint))}: [{low!r}, {high!r}]")
    heading = "limits:  # guess: a trunk near upright; widen for motions that bend it"
    return [heading, *lines] if lines else []


def _servo(figures: ServoFigures) -> str:
    guess = "-guess" if figures.guessed else ""
    return f"{figures.effort:g}Nm-{figures.velocity:g}rad{guess}"


def _tail(draft: Draft) -> list[str]:
    lines = ["groups:  # guess"]
    for group, joints in groups(draft.anatomy).items():
        names = ", ".join(word(draft.skeleton.name(joint)) for joint in joints)
        lines.append(f"  {group}: [{names}]")
    if not draft.ignored:
        return [*lines, "ignore_collisions: []"]
    lines.append("ignore_collisions:  # guess: their shapes touch in or near the posture")
    return [*lines, *(f"  - [{word(a)}, {word(b)}]" for a, b in draft.ignored)]


def groups(anatomy: Anatomy) -> dict[str, list[int]]:
    """Joints by limb; limbs that the robot has."""
    limbs = {f"{side.label}_leg": anatomy.legs[side] for side in Side}
    if anatomy.arms is not None:
        limbs |= {f"{side.label}_arm": anatomy.arms[side] for side in Side}
    limbs |= {"waist": anatomy.waist, "head": anatomy.head}
    return {name: joints for name, joints in limbs.items() if joints}


def _moving(draft: Draft) -> list[int]:
    return [j for j in range(2, draft.skeleton.model.njoints) if j not in draft.anatomy.locked]


def readme(draft: Draft, source: str, notes: Iterable[str]) -> str:
    """Text of README.md: what was read, what was changed, what to do next."""
    limbs = [
        f"- {name.replace('_', ' ')}: {', '.join(draft.skeleton.name(j) for j in joints)}"
        for name, joints in groups(draft.anatomy).items()
    ]
    changes = [f"- {note}" for note in notes] or ["- nothing"]
    return "\n".join(
        [
            f"# {draft.name}",
            "",
            f"First draft by `mgs robot init`, from `{source}`.",
            "",
            "`robot.urdf` is a cleaned copy: one link for each moving body, with the inertia of "
            "all that is fixed to it; feet and meshes as boxes, other shapes as they were. Lines "
            "of `robot.yaml` marked `guess` want a look; `mgs robot check` says what is unsound.",
            "",
            "Joints by limb:",
            "",
            *limbs,
            "",
            "Changed or left out:",
            "",
            *changes,
            "",
        ]
    )


def word(text: str) -> str:
    """A string as YAML: plain where that is safe, else quoted."""
    plain = PLAIN.match(text) and text.lower() not in WORDS_OF_YAML
    return text if plain else json.dumps(text)


def _list(values: Array, digits: int = 6) -> str:
    return "[" + ", ".join(repr(round(float(value), digits) + 0.0) for value in values) + "]"
