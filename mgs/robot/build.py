"""Construction of a robot from the texts of robot.yaml and URDF."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin

from mgs.core.constants import FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.robot.consistency import checked_ranges, require_known_names
from mgs.robot.coupled_limits import couple_limits, couple_posture, followers_in
from mgs.robot.coupling import coupling_of
from mgs.robot.pinocchio_urdf import parse_urdf
from mgs.robot.robot import Robot
from mgs.robot.spec import FrameSpec, RobotSpec, parse_spec
from mgs.robot.urdf_lock import lock_joints


def build_robot(
    yaml_text: str, urdf_text: str, source: str | Path, spec: RobotSpec | None = None
) -> Robot:
    """Build a robot from the texts of its two files; messages name robot.yaml by `source`.

    Locked joints are fixed joints in `Robot.urdf`, so that this text gives the same robot again.

    Args:
        yaml_text: text of robot.yaml.
        urdf_text: text of the URDF.
        source: path or name of robot.yaml, for messages.
        spec: content of `yaml_text` if it has been parsed before; None: it is parsed here.

    Raises:
        ConfigError: a file is malformed, or the two contradict each other.
    """
    spec = parse_spec(yaml_text, source) if spec is None else spec
    followers = followers_in(urdf_text, spec, source)
    urdf_text = lock_joints(urdf_text, spec.locked, str(source), spec.urdf)
    model = parse_urdf(urdf_text, f"{source}: {spec.urdf}")
    names = tuple(model.names[2:])
    require_known_names(spec, model, names, source, followers)
    movers = [followers[name].leader if name in followers else name for name in names]
    servos = [spec.servos[spec.joints[name]] for name in movers]
    is_motor = np.array([name not in followers for name in names], dtype=np.bool_)
    no_load_speed = np.array([servo.no_load_speed for servo in servos])
    speed_limit = np.minimum(model.velocityLimit[FLOATING_BASE_NV:], no_load_speed)
    posture = np.array([spec.posture.get(name, 0.0) for name in names])
    lower, upper = checked_ranges(spec, model, names, speed_limit, posture, source)
    coupling = coupling_of(names, followers)
    if coupling is not None:
        couple_limits(coupling, lower, upper, speed_limit, no_load_speed)
        couple_posture(coupling, names, spec, posture, (lower, upper), source)
    left = _add_frame(model, f"sole_{Side.LEFT.label}", spec.soles.left)
    right = _add_frame(model, f"sole_{Side.RIGHT.label}", spec.soles.right)
    torso = _add_frame(model, "torso_frame", spec.torso)
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
        armature=np.where(is_motor, [servo.armature for servo in servos], 0.0),
        posture=posture,
        sole_frames=(left, right),
        hand_frames=_add_hands(model, spec) or (torso, torso),
        torso_frame=torso,
        followers=followers,
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
