"""hulks: motion of the HULKs for the robot NAO (crates/motionfile).

JSON with `interpolation_mode` ("linear"), `initial_positions`, and `motion` with one entry, whose
`keyframes` have a `duration` [s] and `positions` [rad], nested by limb and joint: head {yaw,
pitch}, left_arm and right_arm {shoulder_pitch, shoulder_roll, elbow_yaw, elbow_roll, wrist_yaw,
hand}, left_leg and right_leg {hip_yaw_pitch, hip_roll, hip_pitch, knee_pitch, ankle_pitch,
ankle_roll}. The robot starts from `initial_positions`, the first frame; each further frame is a
keyframe. Joints of the robot are found by NAO's names, such as LHipYawPitch, or by
left_hip_yaw_pitch; both legs have to be there, what is missing of head and arms is 0. The player
computes in single precision; in the file angles read back exactly. `about` is ignored by the robot.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.errors import ConfigError
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.plain.csv_table import rate_of
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.motion_file.formats.robots.flow_text import entries, number, read_flow, text
from mgs.robot import Robot

HEAD = ("yaw", "pitch")
ARM = ("shoulder_pitch", "shoulder_roll", "elbow_yaw", "elbow_roll", "wrist_yaw", "hand")
LEG = ("hip_yaw_pitch", "hip_roll", "hip_pitch", "knee_pitch", "ankle_pitch", "ankle_roll")
LIMBS = {"head": HEAD, "left_arm": ARM, "right_arm": ARM, "left_leg": LEG, "right_leg": LEG}
FIELDS = tuple((limb, joint) for limb, joints in LIMBS.items() for joint in joints)
SIDES = {"L": "left_", "R": "right_"}


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the motion."""
    names, index = chosen_joints(sampled.robot, options, None)
    fields = [field_of(name) for name in names]
    if unknown := [name for name, field in zip(names, fields, strict=True) if field is None]:
        raise ConfigError("joints", f"{unknown[0]!r} is no joint of NAO, for which format hulks is")
    if missing := [f for f in FIELDS if f not in fields and f[0].endswith("leg")]:
        raise ConfigError("joints", f"no joint is {missing[0][0]} {missing[0][1]} of NAO")
    rows = sampled.joints[:, index]
    postures = [
        _posture(dict(zip(fields, row, strict=True)))  # type: ignore[arg-type]  # none is None
        for row in rows.tolist()
    ]
    frames = (
        f'{{"duration": {number(sampled.interval)}, "positions": {posture}}}'
        for posture in postures[1:]
    )
    about = "; ".join([sampled.motion.gait_name, *options.remarks])
    path.write_text(
        f'{{"about": {text(about)},\n"interpolation_mode": "linear",\n'
        f'"initial_positions": {postures[0]},\n"motion": [{{"keyframes": {entries(frames)}}}]}}\n',
        encoding="utf-8",
    )
    zeros = [f"{limb} {joint}" for limb, joint in FIELDS if (limb, joint) not in fields]
    return Written(names, notes=(f"0 for {', '.join(zeros)}",) if zeros else ())


def field_of(joint: str) -> tuple[str, str] | None:
    """Limb and joint of a name such as LHipYawPitch or left_hip_roll; None: no joint of NAO."""
    if joint[:1] in SIDES and joint[1:2].isupper():
        joint = SIDES[joint[0]] + joint[1:]
    snake = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", joint).lower()
    side, _, rest = snake.partition("_")
    found = {
        "head": ("head", rest),
        "left": (f"left_{'arm' if rest in ARM else 'leg'}", rest),
        "right": (f"right_{'arm' if rest in ARM else 'leg'}", rest),
    }.get(side)
    return found if found in FIELDS else None


def _posture(angles: dict[tuple[str, str], float]) -> str:
    limbs = (
        f'"{limb}": {{'
        + ", ".join(f'"{joint}": {number(angles.get((limb, joint), 0.0))}' for joint in joints)
        + "}"
        for limb, joints in LIMBS.items()
    )
    return f"{{{', '.join(limbs)}}}"


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the file; joints are named as the robot names them, else as NAO does."""
    reading, content = Reading(path), read_flow(path, "a motion")
    if not isinstance(content, dict) or not isinstance(content.get("motion"), list):
        raise reading.error("it should have the keys initial_positions and motion")
    frames = [f for part in content["motion"] for f in _keyframes(reading, part)]
    postures = [content.get("initial_positions"), *(f.get("positions") for f in frames)]
    durations = reading.array("duration", [0.0, *(f.get("duration") for f in frames)], None)
    known = {field_of(name): name for name in (robot.joint_names if robot else ())}
    fields = [field for field in FIELDS if field in known] if robot else list(FIELDS)
    rows = [[_angle(posture, *field) for field in fields] for posture in postures]
    return RecordedMotion(
        layout="hulks",
        fps=rate_of(reading, np.cumsum(durations)),
        joint_names=tuple(known[f] if robot else _name(*f) for f in fields),
        order=None,
        joints=reading.array("positions", rows, None, len(fields)),
    )


def _keyframes(reading: Reading, part: object) -> list[dict[str, Any]]:
    found = part.get("keyframes") if isinstance(part, dict) else None
    if not isinstance(found, list) or not all(isinstance(frame, dict) for frame in found):
        raise reading.error("every part of motion should have keyframes")
    return found


def _angle(posture: object, limb: str, joint: str) -> object:
    joints = posture.get(limb) if isinstance(posture, dict) else None
    return joints.get(joint) if isinstance(joints, dict) else None


def _name(limb: str, joint: str) -> str:
    """Name of a joint of NAO, such as LHipYawPitch."""
    side = {"left": "L", "right": "R"}.get(limb.partition("_")[0], "Head")
    return side + "".join(word.capitalize() for word in joint.split("_"))
