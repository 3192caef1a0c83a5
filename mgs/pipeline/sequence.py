"""The motion of a sequence.

Each part is generated in its own frame, its inverse kinematics beginning with the joint angles that
the part before ended with. It is then moved to where that one ended: by the planar displacement
that brings the middle of its first soles, with their mean heading, onto the middle of the last
ones. The last sample of a part is the first one of the next.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.errors import ConfigError, InfeasibleGaitError, SeamError
from mgs.core.limits import MAX_SAMPLES
from mgs.core.progress import Progress
from mgs.gait import SequenceGait, SingleGait
from mgs.motion import Motion
from mgs.pipeline.join import displacement, join, last_sample, moved
from mgs.pipeline.seam import (
    SOLE_TOLERANCE,
    refuse_moving_joints,
    refuse_other_posture,
    refuse_shifted_soles,
    transition,
)
from mgs.pipeline.stages import Stages, run_stages
from mgs.robot import Robot

PER_PART = 1000  # steps of progress


def generate_sequence(
    robot: Robot, gait: SequenceGait, name: str = "gait", progress: Progress | None = None
) -> tuple[Motion, dict[str, float]]:
    """The motion of a sequence, and the wall time of each stage over all parts [s].

    Raises:
        ConfigError: values of a part that do not fit each other or this robot.
        InfeasibleGaitError: the robot cannot do a part; the message names it.
        SeamError: a part does not begin as the one before it ends.
    """
    parts = list(labelled_parts(gait))
    motions: list[Motion] = []
    seconds: dict[str, float] = {}
    for i, (label, part) in enumerate(parts):
        start = motions[-1].q[-1, FLOATING_BASE_NQ:] if motions else None
        try:
            stages = run_stages(robot, part, label, _share(progress, i, len(parts)), start)
        except ConfigError as error:
            problems = [f"{error.source}: {problem}" for problem in error.problems]
            raise ConfigError(label, problems) from error
        except InfeasibleGaitError as error:
            raise InfeasibleGaitError(f"{label}: {error}") from error
        for stage, t in stages.seconds.items():
            seconds[stage] = seconds.get(stage, 0.0) + t
        if motions:
            motions += _continued(motions[-1], stages, label, gait.sequence.transition)
        else:
            motions.append(stages.motion)
        if (n := sum(m.n_samples for m in motions)) > MAX_SAMPLES:
            raise ConfigError(label, f"ends at sample {n} of the sequence; {MAX_SAMPLES} allowed")
    return dataclasses.replace(join(motions), gait=gait, gait_name=name), seconds


def _continued(before: Motion, stages: Stages, label: str, duration: float) -> list[Motion]:
    """The motion of a part where `before` ends, and before it a transition where one is wanted."""
    by = displacement(before, stages.motion)
    if stages.motion.scene.balls and abs(by.rise) > SOLE_TOLERANCE:
        raise InfeasibleGaitError(
            f"{label}: balls lie on the ground, and this part begins {by.rise:.3f} m above it"
        )
    end = moved(last_sample(before), by.inverse)
    refuse_shifted_soles(end, stages.motion, label)
    refuse_moving_joints(before, stages.motion, label)
    motions = [stages.motion]
    try:
        refuse_other_posture(end, stages.motion, label)
    except SeamError:
        if duration == 0.0:
            raise
        motions.insert(0, transition(end, stages, label, duration))
    return [moved(motion, by) for motion in motions]


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
