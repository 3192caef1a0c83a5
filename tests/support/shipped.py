"""Every gait that ships, generated once a test run."""

from __future__ import annotations

import functools
from dataclasses import dataclass

from mgs.gait import Gait, load_gait
from mgs.motion_planner import for_robot
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot, load_robot


@dataclass(frozen=True)
class Generated:
    """A gait, the robot that walks it, and what the pipeline makes of it."""

    robot: Robot
    gait: Gait
    stages: Stages


@functools.cache
def generated(name: str) -> Generated:
    gait = load_gait(name)
    robot = load_robot(gait.robot or "melson")
    gait = for_robot(gait, robot)
    return Generated(robot, gait, run_stages(robot, gait, name))
