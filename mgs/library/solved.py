"""Points of a sweep over velocities, turned into points over the steps that have them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.errors import ConfigError
from mgs.core.short_text import shown
from mgs.gait import Gait, WalkGait
from mgs.library.velocity import STEPS, VELOCITIES, has_velocity, steps_of

TIMES = ("walk.single_support", "walk.double_support")
Point = tuple[Any, ...]


def solved(
    source: Path, gait: Gait, keys: tuple[str, ...], points: list[Point]
) -> tuple[tuple[str, ...], list[Point]]:
    """Keys and points without velocities; a velocity that is no key is 0.

    Args:
        source: the sweep file, for messages.
        gait: the base gait.
        keys: varied keys, some of them `VELOCITIES`.
        points: a value for each of the keys.

    Raises:
        ConfigError: the base gait is no walk of equal steps, its steps are varied too, or a value
            is no number.
    """
    if not has_velocity(gait):
        raise ConfigError(
            source,
            f"axes.{next(k for k in VELOCITIES if k in keys)}: velocities need a base gait of "
            "equal steps with given sizes: motion walk with n_steps and without sizes",
        )
    fixed = (*STEPS, "walk.steps", "walk.footsteps", "walk.goal", "walk.sizes")
    if clash := [key for key in keys if key in fixed]:
        raise ConfigError(source, f"axes.{clash[0]}: the velocity decides on it; leave one out")
    assert isinstance(gait, WalkGait)
    kept = [k for k, key in enumerate(keys) if key not in VELOCITIES]
    times = {key: getattr(gait.walk, key.partition(".")[2]) for key in TIMES}
    found = []
    for point in points:
        values = times | dict(zip(keys, point, strict=True))
        period = sum(_number(source, key, values[key]) for key in TIMES)
        velocity = [_number(source, key, values.get(key, 0.0)) for key in VELOCITIES]
        steps = steps_of(np.array(velocity), period)
        found.append((*(point[k] for k in kept), *steps))
    return (*(keys[k] for k in kept), *STEPS), found


def _number(source: Path, key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ConfigError(source, f"axes.{key}: {shown(value)} is not a number")
    return float(value)
