"""A search whose walks are judged by a formula instead of plans and replays."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mgs.gait import load_gait
from mgs.robot import load_robot
from mgs.search.tune.evaluate import STAGES, Found, TuneTask
from mgs.search.tune.objective import ObjectiveName
from mgs.search.tune.setup import make_task
from mgs.search.tune.space import Value

MELSON = load_robot("melson")
BEST = {"walk.step_height": 0.8, "walk.landing": 0.15}  # places between the bounds
PINS = tuple(
    f"{key}=0.01" for key in ("walk.zmp_travel", "walk.arm_swing", "com.margin", "com.weight_jerk")
)


def easy_task(objective: ObjectiveName = "robust", margin: float = 0.0, seed: int = 0) -> TuneTask:
    return make_task(
        MELSON, load_gait("melson/walk_practical"), objective, engines=("mujoco",),
        margin=margin, pins=PINS, n_draws=2, seed=seed,
    )  # fmt: skip


def by_formula(
    task: TuneTask, values: Mapping[str, Value], best: float = 0.0, _promising: float = 0.0
) -> Found:
    """Walks pass where the sole rises by more than a tenth of its bounds.

    The score falls with the distance from an optimum, which for two keys is far from the start gait
    and matters most.
    """
    start, square = task.space.start(), 0.0
    for p in task.space.parameters:
        if p.choices:
            continue
        place = p.place(float(values[p.key]))
        if p.key == "walk.step_height" and place < 0.1:
            return Found(-3.5, STAGES[1], "joint_speed")
        aim = BEST.get(p.key, p.place(float(start[p.key])))
        square += (1.0 if p.key in BEST else 0.02) * (place - aim) ** 2
    return Found(max(0.01, 1.0 - np.sqrt(square)), STAGES[-1], "", False, {"speed": 0.06})
