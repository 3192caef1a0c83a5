"""How stiff plain PD servos have to be for a motion, on floors more and less slippery.

A motion is replayed with PD servos of many sags, told the planned angles or feed-forward commands
for another stiffness than theirs, and with several coefficients of friction. It passes where the
tolerances of `mgs.judge.verdict` are met.
"""

from __future__ import annotations

import dataclasses
import math
from contextlib import closing
from dataclasses import dataclass

from mgs.core.errors import DivergenceError
from mgs.core.progress import Progress
from mgs.judge.processes import in_order
from mgs.judge.servo_cases import CASES, Case, Outcome, ServoSweep
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.sim import DEFAULTS, EngineName, Settings
from mgs.sim.prepare import prepare
from mgs.sim.replay import replay_prepared


@dataclass(frozen=True, eq=False)
class _Task:
    motion: Motion
    engine: EngineName
    settings: Settings
    cases: tuple[Case, ...]


def sweep_servos(
    motion: Motion,
    engine: EngineName,
    settings: Settings | None = None,
    *,
    cases: tuple[Case, ...] = CASES,
    workers: int = 1,
    progress: Progress | None = None,
) -> ServoSweep:
    """Replay a motion with plain PD servos of many kinds.

    Args:
        motion: the plan.
        engine: "pybullet" or "mujoco".
        settings: None for the engine's defaults; sag and friction are those of the cases.
        cases: servos and floors.
        workers: number of processes.
        progress: called with replays done and replays in all.

    Raises:
        SimulationError: the engine is missing. A replay that diverges has failed.
    """
    task, done = _Task(motion, engine, settings or DEFAULTS[engine], cases), []
    with closing(in_order(_replay, task, len(cases), workers)) as outcomes:
        for outcome in outcomes:
            done.append(outcome)
            if progress is not None:
                progress(len(done), len(cases))
    return ServoSweep(engine, tuple(done))


def _replay(task: _Task, number: int) -> Outcome:
    case = task.cases[number]
    settings = dataclasses.replace(
        task.settings, friction=case.friction, sag=math.radians(case.sag_deg)
    )
    try:
        prepared = prepare(
            task.motion,
            task.engine,
            settings,
            "pd",
            case.assumed_stiffness is not None,
            case.assumed_stiffness or 1.0,
        )
        # forces on the soles matter to motions without balance alone
        result = replay_prepared(prepared, with_contacts=not task.motion.gait.is_balanced)
    except DivergenceError:
        return Outcome(case, True, ("diverged",))
    checks = replay_checks(result, "pd")
    failed = [check.name.removeprefix("pd_") for check in checks if not check.ok]
    return Outcome(case, result.fell, tuple(failed))
