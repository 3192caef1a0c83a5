"""Melson as the robots for which some formats are: with motors on a bus, or with NAO's names."""

from __future__ import annotations

import dataclasses
import functools
import re

from mgs.motion import Motion
from mgs.motion_file.formats import FORMATS
from mgs.robot import MotorSpec, Robot, build_robot
from mgs.robot.motor_models import MotorName

MOTORS: dict[str, MotorName] = {"feetech": "STS3215", "feetech-sync": "STS3215"}
TURNED_BACK = ("left_hip_pitch", "right_knee_pitch", "waist_yaw")  # joints with sign -1
NAO = {
    "Hip_Yaw": "HipYawPitch",
    "Elbow_Pitch": "ElbowRoll",
}
OF_NAO = ("hulks",)


def motors_of_melson(robot: Robot, model: MotorName = "MX-28") -> dict[str, MotorSpec]:
    """A motor for each joint; some turn back, and zeros are apart by hundredths of a radian."""
    return {
        name: MotorSpec(
            id=k + 1,
            model=model,
            sign=-1 if name in TURNED_BACK else 1,
            zero_offset=0.01 * (k % 5) - 0.02,
        )
        for k, name in enumerate(robot.joint_names)
    }


def with_motors(robot: Robot, model: MotorName = "MX-28") -> Robot:
    """The robot with a motor for each joint."""
    spec = robot.spec.model_copy(update={"motors": motors_of_melson(robot, model)})
    return dataclasses.replace(robot, spec=spec)


@functools.cache
def _as_nao(yaml: str, urdf: str) -> Robot:
    for text in ("yaml", "urdf"):
        del text
    names = sorted(set(re.findall(r"\b(?:left|right)_\w+_(?:yaw|roll|pitch)\b", yaml)))
    for name in names:
        side, _, joint = name.partition("_")
        words = joint.title()
        new = side[0].upper() + NAO.get(words, words.replace("_", ""))
        yaml = re.sub(rf"\b{name}\b", new, yaml)
        urdf = re.sub(rf"\b{name}\b", new, urdf)
    yaml, urdf = (re.sub(r"\bwaist_yaw\b", "HeadYaw", text) for text in (yaml, urdf))
    return build_robot(yaml, urdf, "as_nao/robot.yaml")


def as_nao(robot: Robot) -> Robot:
    """Melson with the joint names of NAO; its waist has the name of NAO's neck."""
    return _as_nao(robot.yaml, robot.urdf)


def motion_for(fmt: str, motion: Motion) -> Motion:
    """The motion, of the robot that a format is for."""
    assert fmt in FORMATS
    robot = motion.robot
    found = as_nao(robot) if fmt in OF_NAO else with_motors(robot, MOTORS.get(fmt, "MX-28"))
    return dataclasses.replace(motion, robot=found)
