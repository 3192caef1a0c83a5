"""Sequences: gaits one after the other as one motion.

Each part is generated in its own frame, its inverse kinematics beginning with the joint angles that
the part before ended with. It is then moved to where that one ended: by the planar displacement
that brings the middle of its first soles, with their mean heading, onto the middle of the last
ones. The last sample of a part is the first one of the next; there a part has to agree with the
one before in soles, CoM, hands and joints, and in the speed of every joint.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mgs.contact import Footstep, Side
from mgs.dynamics import align_quaternion_signs
from mgs.errors import ConfigError, InfeasibleGaitError, SeamError
from mgs.gait import MAX_SAMPLES, Gait, SequenceGait, SingleGait
from mgs.geometry import (
    compose_planar,
    planar_inverse,
    quat_multiply,
    quat_xyzw_from_yaw,
    rotate_planar,
    rotation_angles,
    wrap_angle,
    yaw_from_quat_xyzw,
)
from mgs.motion import Motion
from mgs.pipeline import generate
from mgs.robot import FLOATING_BASE_NQ, FLOATING_BASE_NV, Robot

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]

SOLE_TOLERANCE, COM_TOLERANCE, HAND_TOLERANCE = 2e-4, 4e-4, 1e-3  # [m]
TURN_TOLERANCE = 5e-4  # [rad] of a sole
JOINT_TOLERANCE = 1e-3  # [rad]
SPEED_TOLERANCE = 0.05  # [rad/s], of a joint that counts as at rest
PER_PART = 1000  # steps of progress


@dataclasses.dataclass(frozen=True, eq=False)
class Made:
    """A motion and the wall time of each stage [s]."""

    motion: Motion
    seconds: dict[str, float]


def generate_motion(
    robot: Robot, gait: Gait, name: str = "gait", progress: Progress | None = None
) -> Made:
    """The motion of any gait: of the four stages, or of those of each part of a sequence.

    Args:
        robot: the robot.
        gait: what it shall do.
        name: name of the gait, for the motion file.
        progress: called with work done and work in all.

    Raises:
        ConfigError: values of the gait that do not fit each other or this robot.
        InfeasibleGaitError: the robot cannot do it; of a sequence it names the part.
        SeamError: a part does not begin as the one before it ends.
    """
    if not isinstance(gait, SequenceGait):
        stages = generate(robot, gait, name, progress)
        return Made(stages.motion, stages.seconds)
    return _generate_parts(robot, gait, name, progress)


def _generate_parts(robot: Robot, gait: SequenceGait, name: str, progress: Progress | None) -> Made:
    parts = list(labelled_parts(gait))
    motions: list[Motion] = []
    seconds: dict[str, float] = {}
    for i, (label, part) in enumerate(parts):
        start = motions[-1].q[-1, FLOATING_BASE_NQ:] if motions else None
        try:
            stages = generate(robot, part, label, _share(progress, i, len(parts)), start)
        except ConfigError as error:
            problems = [f"{error.source}: {problem}" for problem in error.problems]
            raise ConfigError(label, problems) from error
        except InfeasibleGaitError as error:
            raise InfeasibleGaitError(f"{label}: {error}") from error
        for stage, t in stages.seconds.items():
            seconds[stage] = seconds.get(stage, 0.0) + t
        motion = stages.motion
        if motions:
            motion = moved(motion, displacement(motions[-1], motion))
            refuse_jump(motions[-1], motion, label)
        motions.append(motion)
        if (n := sum(m.n_samples for m in motions)) > MAX_SAMPLES:
            raise ConfigError(label, f"sample {n} of the sequence; {MAX_SAMPLES} allowed in all")
    return Made(dataclasses.replace(join(motions), gait=gait, gait_name=name), seconds)


def labelled_parts(gait: SequenceGait) -> Iterator[tuple[str, SingleGait]]:
    """Every part as often as it is repeated, with what messages call it."""
    for i, part in enumerate(gait.sequence.parts):
        for repetition in range(part.repeat):
            label = f"sequence.parts.{i} ({part.label})"
            if part.repeat > 1:
                label += f", time {repetition + 1} of {part.repeat}"
            yield label, part.gait


def _share(progress: Progress | None, part: int, n_parts: int) -> Progress | None:
    """Progress of one part as one of the whole."""
    if progress is None:
        return None
    tell = progress
    return lambda done, total: tell(PER_PART * part + PER_PART * done // total, PER_PART * n_parts)


def middle_of_soles(soles: Array) -> Array:
    """Planar pose (3,) midway between two soles (2, 7): mean place, mean heading."""
    left, right = yaw_from_quat_xyzw(soles[:, 3:])
    yaw = left + 0.5 * float(wrap_angle(right - left))
    return np.array([*soles[:, :2].mean(axis=0), yaw])


def displacement(before: Motion, after: Motion) -> Array:
    """Planar pose (3,) of the frame of `after`, for it to begin where `before` ends."""
    end, begin = middle_of_soles(before.soles_ref[-1]), middle_of_soles(after.soles_ref[0])
    return compose_planar(end, planar_inverse(begin))


def moved(motion: Motion, pose: Array) -> Motion:
    """The motion seen from a frame in which its own has the planar pose (3,)."""
    turn = quat_xyzw_from_yaw(pose[2])

    def place(points: Array) -> Array:  # (..., 2) or (..., 3)
        out = points.copy()
        out[..., :2] = rotate_planar(points[..., :2], pose[2]) + pose[:2]
        return out

    def pose_of(poses: Array) -> Array:  # (..., 7)
        return np.concatenate([place(poses[..., :3]), quat_multiply(turn, poses[..., 3:])], axis=-1)

    q = motion.q.copy()
    q[:, :FLOATING_BASE_NQ] = pose_of(motion.q[:, :FLOATING_BASE_NQ])
    return dataclasses.replace(
        motion,
        footsteps=tuple(_moved_footstep(step, pose) for step in motion.footsteps),
        q=q,
        com=place(motion.com),
        com_ref=place(motion.com_ref),
        zmp=place(motion.zmp),
        zmp_ref=place(motion.zmp_ref),
        soles=pose_of(motion.soles),
        soles_ref=pose_of(motion.soles_ref),
        hands=pose_of(motion.hands),
        hands_ref=place(motion.hands_ref),
        torso=pose_of(motion.torso),
        torso_ref=quat_multiply(turn, motion.torso_ref),
    )


def _moved_footstep(step: Footstep, pose: Array) -> Footstep:
    x, y, yaw = compose_planar(pose, [step.x, step.y, step.yaw])
    return Footstep(step.side, float(x), float(y), float(yaw))


def refuse_jump(before: Motion, after: Motion, part: str) -> None:
    """Raise SeamError where the first sample of `after` is not the last one of `before`."""
    sole, next_sole = before.soles_ref[-1], after.soles_ref[0]
    joint = np.abs(after.q[0] - before.q[-1])[FLOATING_BASE_NQ:]
    # one-sided speeds are twice the central differences at an end
    speed = 2.0 * np.abs(after.v[0] - before.v[-1])[FLOATING_BASE_NV:]
    names = before.robot.joint_names
    sides = [side.label for side in Side]
    soles, hands = [f"{side} sole" for side in sides], [f"{side} hand" for side in sides]
    hand_gap = after.hands_ref[0] - before.hands_ref[-1]
    for gap, where, tolerance, unit in (
        (_lengths(next_sole[:, :3] - sole[:, :3]), soles, SOLE_TOLERANCE, "m"),
        (rotation_angles(next_sole[:, 3:], sole[:, 3:]), soles, TURN_TOLERANCE, "rad"),
        (_lengths(after.com_ref[:1] - before.com_ref[-1]), ["CoM"], COM_TOLERANCE, "m"),
        (_lengths(hand_gap), hands, HAND_TOLERANCE, "m"),
        (joint, [f"joint {name}" for name in names], JOINT_TOLERANCE, "rad"),
        (speed, [f"the speed of joint {name}" for name in names], SPEED_TOLERANCE, "rad/s"),
    ):
        worst = int(np.argmax(gap))
        if not gap[worst] <= tolerance:  # NaN is refused too
            raise SeamError(part, where[worst], float(gap[worst]), tolerance, unit)


def _lengths(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=-1))


def join(motions: list[Motion]) -> Motion:
    """One motion of several that begin where the one before ends; the first gives the gait.

    At a seam the end of the one before is kept, with the velocity across it: the central difference
    there is the sum of the two at ends, each of which takes the robot for at rest beyond.
    """
    first = motions[0]
    arrays: dict[str, Any] = {
        field.name: np.concatenate(
            [getattr(first, field.name), *(getattr(m, field.name)[1:] for m in motions[1:])]
        )
        for field in dataclasses.fields(Motion)
        if isinstance(getattr(first, field.name), np.ndarray)
    }
    seams = np.cumsum([m.n_samples - 1 for m in motions])[:-1]
    for seam, motion in zip(seams, motions[1:], strict=True):
        arrays["v"][seam] += motion.v[0]
    align_quaternion_signs(arrays["q"][:, 3:7])
    footsteps = (*first.footsteps, *(step for m in motions[1:] for step in m.footsteps[2:]))
    solvers = list(dict.fromkeys(str(m.solver["solver"]) for m in motions))
    solver: dict[str, object] = {"solver": ", ".join(solvers), "parts": [m.solver for m in motions]}
    return dataclasses.replace(first, footsteps=footsteps, solver=solver, **arrays)
