"""bitbots: animation of the Bit-Bots (bitbots_animation_server).

JSON with `name`, `author`, `description`, `version`, `last_edited` and `keyframes`: `name`,
`duration` [s] of the way to the keyframe, `pause` [s] there, `goals` {joint: angle [deg]}, `torque`
and `stabilization_functions` (both empty). The first keyframe is reached after the approach
(--approach, 2 s unless it is given), from the measured posture. The server goes from keyframe to
keyframe along polynomials of the fifth degree that are at rest at both ends, so every frame becomes
a keyframe; by how much the joints then stray from the plan in between is reported. Angles read back
within 1e-12 rad.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mgs.core.curves import at_rest, evaluate
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.plain.csv_table import rate_of
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.motion_file.formats.robots.flow_text import entries, number, read_flow, text
from mgs.motion_file.formats.robots.play_motion2 import motion_key
from mgs.robot import Robot

BETWEEN = np.linspace(0.0, 1.0, 21)  # instants of an interval at which the player is compared
EMPTY = '"pause": 0.0, "torque": {}, "stabilization_functions": {}'


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the animation."""
    names, index = chosen_joints(sampled.robot, options, None)
    degrees = np.degrees(sampled.joints[:, index])
    durations = np.full(len(degrees), sampled.interval)
    durations[0] = options.approach
    frames = (
        f'{{"name": "frame {k}", "duration": {number(duration)}, {EMPTY}, "goals": {{'
        + ", ".join(f"{text(name)}: {number(x)}" for name, x in zip(names, row, strict=True))
        + "}}"
        for k, (duration, row) in enumerate(zip(durations, degrees, strict=True))
    )
    key = motion_key(sampled.motion.gait_name)
    about = "; ".join([sampled.motion.gait_name, *options.remarks])
    path.write_text(
        f'{{"name": {text(key)}, "author": "mgs", "description": {text(about)}, "version": 0, '
        f'"last_edited": "",\n"keyframes": {entries(frames)}}}\n',
        encoding="utf-8",
    )
    worst, joint = straying(sampled, index)
    note = (
        f"between frames the player strays by at most {worst:.2g} rad ({names[joint]}); "
        "a higher --fps makes it less"
    )
    return Written(names, notes=(note,))


def straying(sampled: SampledMotion, index: np.ndarray) -> tuple[float, int]:
    """Largest distance [rad] of the player from the plan between frames, and which joint's.

    Between two frames the plan is the cubic with its angles and velocities.
    """
    s, h = BETWEEN[:, None, None], sampled.interval
    q, v = sampled.joints[:, index], sampled.joint_velocity[:, index]
    if len(q) < 2:
        return 0.0, 0
    rise, r = np.diff(q, axis=0), 1.0 - s
    plan = s * rise + s * r * (r * (h * v[:-1] - rise) + s * (rise - h * v[1:]))
    player = evaluate(at_rest([0.0, 1.0], [[0.0], [1.0]]), BETWEEN)[:, :, None] * rise
    worst = np.abs(player - plan).max(axis=(0, 1))
    return float(worst.max()), int(np.argmax(worst))


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the animation, if all keyframes but the first take the same time."""
    del robot  # the file names its joints
    reading, content = Reading(path), read_flow(path, "an animation")
    frames = content.get("keyframes") if isinstance(content, dict) else None
    if not isinstance(frames, list) or not all(isinstance(frame, dict) for frame in frames):
        raise reading.error("it should have keyframes")
    goals = [frame.get("goals") for frame in frames]
    if not goals or not all(isinstance(goal, dict) for goal in goals):
        raise reading.error("a keyframe should have goals")
    names = reading.names("goals", list(goals[0]))
    if any(set(goal) != set(names) for goal in goals):
        raise reading.error("every keyframe should have goals for the same joints")
    takes = [frame.get("duration", 1) for frame in frames]
    pauses = [frame.get("pause", 0) for frame in frames]
    times = np.cumsum(reading.array("duration", takes, None))
    if reading.array("pause", pauses, None).any():
        raise reading.error("keyframes with pauses are not at equal intervals")
    angles = reading.array("goals", [[g[n] for n in names] for g in goals], None, len(names))
    return RecordedMotion(
        layout="bitbots",
        fps=rate_of(reading, times),
        joint_names=names,
        order=None,
        joints=np.radians(angles),
    )
