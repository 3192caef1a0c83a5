"""nubots: script of the NUbots (NUgus and robots with the same servos).

A list of frames, in YAML that is JSON too: `duration` [ms] of the way to the frame, a whole number,
and `targets`, one for each servo: `id`, `position` [rad], `gain` and `torque`. The id is the name
of the servo, such as R_HIP_YAW, which follows from its number on the bus: 1 is R_SHOULDER_PITCH, 20
is HEAD_PITCH, right before left, as in ROBOTIS OP2 and OP3. The numbers are those of `motors` in
robot.yaml, or of --motors FILE; directions and zeros are settings of the robot (HardwareIO.yaml),
not of the script. The first frame is reached after the approach (--approach, 2 s unless it is
given). Angles read back exactly, times in whole milliseconds. `gain` and `torque` are 30 and 100:
set them to what the scripts of the robot have. The file belongs into scripts/PLATFORM/.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.errors import ConfigError
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.plain.csv_table import rate_of
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.motion_file.formats.robots.flow_text import entries, number, read_flow, remarks
from mgs.motion_file.formats.robots.milliseconds import MILLISECOND, whole_milliseconds
from mgs.robot import Robot

GAIN, TORQUE = 30.0, 100.0
PAIRS = (
    *("SHOULDER_PITCH", "SHOULDER_ROLL", "ELBOW", "HIP_YAW", "HIP_ROLL", "HIP_PITCH", "KNEE"),
    *("ANKLE_PITCH", "ANKLE_ROLL"),
)
SERVOS = (*(f"{side}_{name}" for name in PAIRS for side in "RL"), "HEAD_YAW", "HEAD_PITCH")


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the script."""
    names, index = chosen_joints(sampled.robot, options, None)
    motors = options.motors_of(sampled.robot, names)
    source = options.motors_source(sampled.robot)
    if other := [i for i in motors.ids if not 1 <= i <= len(SERVOS)]:
        raise ConfigError(source, f"motors: id {other[0]}: NUgus has 1 to {len(SERVOS)}")
    ends = whole_milliseconds(options.approach + sampled.times, sampled.interval)
    durations = np.diff(ends, prepend=0)
    heads = [f'{{"id": "{SERVOS[i - 1]}", "position": ' for i in motors.ids]
    tail = f', "gain": {number(GAIN)}, "torque": {number(TORQUE)}}}'
    frames = (
        f'{{"duration": {duration}, "targets": ['
        + ", ".join(head + number(x) + tail for head, x in zip(heads, row, strict=True))
        + "]}"
        for duration, row in zip(durations, sampled.joints[:, index], strict=True)
    )
    path.write_text(remarks(options.remarks) + entries(frames, "") + "\n", encoding="utf-8")
    return Written(names, notes=(f"the first frame is reached after {options.approach:g} s",))


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the script; joints are named if the robot has motors with these ids."""
    reading, frames = Reading(path), read_flow(path, "a script")
    if not isinstance(frames, list) or not all(isinstance(frame, dict) for frame in frames):
        raise reading.error("it should be a list of frames")
    targets = [_targets(reading, frame.get("targets")) for frame in frames]
    servos = reading.names("targets", list(targets[0]) if targets else [])
    if any(set(found) != set(servos) for found in targets):
        raise reading.error("every frame should have targets for the same servos")
    times = MILLISECOND * np.cumsum(
        reading.array("duration", [frame.get("duration") for frame in frames], None)
    )
    rows = [[found[name] for name in servos] for found in targets]
    return RecordedMotion(
        layout="nubots",
        fps=rate_of(reading, times),
        joint_names=_joint_names(servos, robot),
        order=None,
        joints=reading.array("position", rows, None, len(servos)),
        extra={"servos": list(servos)},
    )


def _targets(reading: Reading, found: object) -> dict[str, object]:
    if not isinstance(found, list) or not all(isinstance(target, dict) for target in found):
        raise reading.error("targets should be a list of mappings")
    return {str(target.get("id")): target.get("position") for target in found}


def _joint_names(servos: tuple[str, ...], robot: Robot | None) -> tuple[str, ...] | None:
    """Joints that the servos turn; None if that is not known."""
    if robot is None:
        return None
    turned = {
        SERVOS[spec.id - 1]: joint
        for joint, spec in robot.spec.motors.items()
        if 1 <= spec.id <= len(SERVOS)
    }
    return tuple(turned[s] for s in servos) if set(servos) <= turned.keys() else None
