"""From any gait to its motion, without any file."""

from __future__ import annotations

from dataclasses import dataclass

from mgs.core.progress import Progress
from mgs.core.short_repr import short_repr
from mgs.gait import Gait, SequenceGait, WalkGait
from mgs.motion import Motion
from mgs.pipeline.fit import Fit, fit_walk
from mgs.pipeline.stages import run_stages
from mgs.robot import Robot


@dataclass(frozen=True, eq=False)
class Generated:
    """A motion, the wall time of each stage [s], and what was tried to fit it to the robot."""

    motion: Motion
    seconds: dict[str, float]
    fit: Fit | None = None  # None: the gait states its sizes

    __repr__ = short_repr


def generate(
    robot: Robot, gait: Gait, name: str = "gait", progress: Progress | None = None
) -> Generated:
    """The motion of any gait: of the four stages, or of those of each part of a sequence.

    Sizes that a walk leaves to the robot are chosen so that its joints have reserve
    (`mgs.pipeline.fit`); those in the parts of a sequence are as derived from the leg length.

    Args:
        robot: the robot.
        gait: what it shall do.
        name: name of the gait, for the motion file.
        progress: called with work done and work in all.

    Raises:
        ConfigError: values of the gait that do not fit each other or this robot.
        InfeasibleGaitError: the robot cannot do it; for a sequence the message names the part.
        SeamError: a part does not begin as the one before it ends.
    """
    if isinstance(gait, SequenceGait):
        from mgs.pipeline.sequence import generate_sequence  # one gait needs no seams

        return Generated(*generate_sequence(robot, gait, name, progress))
    if isinstance(gait, WalkGait) and gait.walk.sizes != "given":
        stages, fit = fit_walk(robot, gait, name, progress)
        return Generated(stages.motion, stages.seconds, fit)
    stages = run_stages(robot, gait, name, progress)
    return Generated(stages.motion, stages.seconds)
