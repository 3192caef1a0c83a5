"""jtc: trajectory for the joint_trajectory_controller of ros2_control.

Fields of trajectory_msgs/JointTrajectory, in YAML that is JSON too: `joint_names`, and `points`
with `positions` [rad], `velocities` [rad/s], `accelerations` [rad/s^2] and `time_from_start` {sec,
nanosec}. Numbers read back exactly. The first and the last point are at rest, since the controller
refuses a trajectory whose last point moves; a cycle, which never rests, is refused. Its stamp is
left out, which is 0: the controller starts at once. It interpolates by quintic polynomials where
points have accelerations. Send it as the goal of follow_joint_trajectory, after the robot has been
brought to the first point:

    ros2 topic pub --once --yaml-file walk.yaml /joint_trajectory_controller/joint_trajectory \
        trajectory_msgs/msg/JointTrajectory
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.plain.csv_table import rate_of
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.motion_file.formats.robots.flow_text import (
    entries,
    numbers,
    read_flow,
    remarks,
    texts,
)
from mgs.motion_file.formats.robots.rest import refuse_cycle
from mgs.robot import Robot


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the trajectory."""
    refuse_cycle(sampled, "jtc", "the controller refuses a trajectory that does not end at rest")
    names, index = chosen_joints(sampled.robot, options, None)
    position, velocity, acceleration = (
        values[:, index].copy()
        for values in (sampled.joints, sampled.joint_velocity, sampled.joint_acceleration)
    )
    velocity[[0, -1]] = 0.0  # planned ones are; those of commands that lead the plan need not be
    stamps = np.rint(sampled.times * 1e9).astype(np.int64)
    points = (
        f'{{"positions": {numbers(q)}, "velocities": {numbers(v)}, '
        f'"accelerations": {numbers(a)}, '
        f'"time_from_start": {{"sec": {t // 10**9}, "nanosec": {t % 10**9}}}}}'
        for q, v, a, t in zip(position, velocity, acceleration, stamps, strict=True)
    )
    body = f'{{"joint_names": {texts(names)},\n"points": {entries(points)}}}\n'
    path.write_text(remarks(options.remarks) + body, encoding="utf-8")
    return Written(names)


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the trajectory, which may also be below a key `trajectory`."""
    del robot  # the file names its joints
    reading, content = Reading(path), read_flow(path, "a trajectory")
    if isinstance(content, dict) and isinstance(content.get("trajectory"), dict):
        content = content["trajectory"]
    if not isinstance(content, dict) or not isinstance(content.get("points"), list):
        raise reading.error("a trajectory should have the keys joint_names and points")
    names = reading.names("joint_names", content.get("joint_names"))
    points = content["points"]
    if not all(isinstance(point, dict) for point in points):
        raise reading.error("points should be mappings")
    times = reading.array("time_from_start", [_time(point) for point in points], None)
    speeds = [point.get("velocities") for point in points]
    joints = reading.array("positions", [p.get("positions") for p in points], None, len(names))
    return RecordedMotion(
        layout="jtc",
        fps=rate_of(reading, times),
        joint_names=names,
        order=None,
        joints=joints,
        joint_velocity=(
            reading.array("velocities", speeds, None, len(names)) if all(speeds) else None
        ),
    )


def _time(point: dict[str, Any]) -> float | None:
    found = point.get("time_from_start")
    if not isinstance(found, dict):
        return None
    sec, nanosec = (found.get(key, 0) for key in ("sec", "nanosec"))
    if not all(isinstance(part, int | float) for part in (sec, nanosec)):
        return None
    return float(sec) + 1e-9 * float(nanosec)
