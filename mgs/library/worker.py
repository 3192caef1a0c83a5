"""The work of a worker: from the values of the varied keys to a motion file and its figures.

`make_gait` does the work, without Dask. `GaitWorker` brings to every worker once what all gaits
have in common, and `work` calls `make_gait` there.
"""

from __future__ import annotations

import contextlib
import faulthandler
import functools
import hashlib
import json
import math
import os
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from distributed import Worker, WorkerPlugin, get_worker

import mgs
from mgs.core.contact import Support
from mgs.core.errors import ConfigError, DivergenceError, InfeasibleGaitError, MgsError
from mgs.core.geometry import yaw_from_quat_xyzw
from mgs.gait import Gait, RecordedGait, SequenceGait, parse_gait
from mgs.judge.motion_checks import Check, check_motion
from mgs.judge.verdict import judge
from mgs.library.kernel import processor_kernel
from mgs.library.manifest import LOST, Value
from mgs.motion import Motion
from mgs.motion.energy import energy_of
from mgs.motion_file import motion_bytes
from mgs.pipeline import generate
from mgs.robot import Robot, build_robot
from mgs.sim import EngineName, Replay, ServoName, replay

TIMEOUT = 600.0  # [s], default


@dataclass(frozen=True)
class Recipe:
    """Everything that all gaits of a library have in common, so that workers need no files."""

    base: str  # path of the base gait, for messages
    base_text: str
    name: str  # name of the gait in its motion files
    robots: dict[str, tuple[str, str]]  # texts of robot.yaml and URDF by the name of the robot
    engines: tuple[EngineName, ...] = ()
    servo: ServoName = "ideal"
    timeout: float = TIMEOUT  # [s] after which a gait is given up


@dataclass(frozen=True, eq=False)
class Outcome:
    """Result of one gait: columns of the manifest, and the motion file if there is one."""

    row: dict[str, Value] = field(default_factory=dict)
    content: bytes | None = None


def make_gait(recipe: Recipe, assignments: tuple[str, ...]) -> Outcome:
    """Plan, check and, if engines are named, replay one gait.

    Errors are outcomes too. The verdict is `infeasible` if the gait is malformed or the robot
    cannot execute it, and `lost` if the computation broke down, such as for lack of memory.
    """
    started = time.perf_counter()
    try:
        outcome = _made(recipe, assignments)
    except (ConfigError, InfeasibleGaitError) as error:
        outcome = failure("infeasible", error)
    except Exception as error:
        outcome = failure(LOST, error)
    outcome.row["seconds"] = time.perf_counter() - started
    outcome.row["kernel"] = processor_kernel()
    return outcome


def failure(verdict: str, error: Exception) -> Outcome:
    """Outcome of a gait that ended in an error."""
    message = str(error)[:2000]
    return Outcome({"verdict": verdict, "reason": type(error).__name__, "message": message})


def _made(recipe: Recipe, assignments: tuple[str, ...]) -> Outcome:
    gait = parse_gait(recipe.base_text, recipe.base, assignments)
    if gait.robot not in recipe.robots:
        raise ConfigError(recipe.base, f"robot {gait.robot!r} is not a robot of the sweep")
    robot = _robot(*recipe.robots[gait.robot], gait.robot)
    motion = generate(robot, gait, recipe.name).motion
    energy = energy_of(motion)
    content = motion_bytes(motion)
    checks = check_motion(motion)
    replays, diverged = _replays(recipe, motion)
    verdict = judge(recipe.name, checks, replays)
    failed = [check.name for check in verdict.checks if not check.ok] + diverged
    row: dict[str, Value] = {
        "verdict": "fail" if failed else "pass",
        "reason": ", ".join(failed) or None,
        "sha256": hashlib.sha256(content).hexdigest(),
        "bytes": len(content),
        "robot": gait.robot,
        "motion": gait.motion,
        "ik.solver": solver_of(gait),
        "dt": motion.dt,
        "samples": motion.n_samples,
        "duration": motion.duration,
        **travel_figures(motion),
        **_check_figures(checks),
        **({} if energy is None else energy.to_dict()),
        **_replay_figures(replays, diverged),
        "checks": json.dumps(
            [_finite(check.to_dict()) for check in verdict.checks], allow_nan=False
        ),
    }
    return Outcome({key: _number(value) for key, value in row.items()}, content)


def solver_of(gait: Gait) -> str | None:
    """Name of the IK solver; None for a sequence, whose parts have their own solvers."""
    return None if isinstance(gait, SequenceGait | RecordedGait) else gait.ik.solver


@functools.lru_cache(maxsize=64)
def _robot(yaml_text: str, urdf_text: str, name: str) -> Robot:
    """Build a robot, once in each worker."""
    return build_robot(yaml_text, urdf_text, name)


def _replays(recipe: Recipe, motion: Motion) -> tuple[list[Replay], list[str]]:
    """Replays, and the name of a failed check for each engine whose simulation diverged."""
    replays, diverged = [], []
    for engine in recipe.engines:
        try:
            replays.append(replay(motion, engine, servo=recipe.servo))
        except DivergenceError:
            diverged.append(f"{engine}_diverged")
    return replays, diverged


def travel_figures(motion: Motion) -> dict[str, Value]:
    """Distance and mean velocity of the point midway between the soles, as planned.

    vx, vy [m/s] and wz [rad/s] are means from the first lift-off to the last touch-down, along and
    across the mean heading of the soles at each time; a motion without a step has zeros.
    """
    middle = motion.soles[:, :, :2].mean(axis=1)  # (N, 2)
    yaw = np.unwrap(yaw_from_quat_xyzw(motion.soles[:, :, 3:]), axis=0).mean(axis=1)  # (N,)
    gone = middle[-1] - middle[0]
    stepping = np.flatnonzero(motion.support != Support.DOUBLE)
    vx = vy = wz = 0.0
    if len(stepping):
        span = slice(stepping[0] - 1, stepping[-1] + 2)  # from rest on both soles to rest on both
        step, heading = np.diff(middle[span], axis=0), yaw[span]
        between = (heading[1:] + heading[:-1]) / 2.0
        time = motion.dt * len(step)
        vx = float(np.sum(step[:, 0] * np.cos(between) + step[:, 1] * np.sin(between))) / time
        vy = float(np.sum(step[:, 1] * np.cos(between) - step[:, 0] * np.sin(between))) / time
        wz = float(heading[-1] - heading[0]) / time
    return {
        "distance": float(np.hypot(*gone)),
        "distance_x": float(gone[0]),
        "distance_y": float(gone[1]),
        "turn": float(yaw[-1] - yaw[0]),
        "speed": math.hypot(vx, vy),
        "vx": vx,
        "vy": vy,
        "wz": wz,
    }


def _check_figures(checks: list[Check]) -> dict[str, Value]:
    """Figures of the checks that were made; motions without balance have fewer checks."""
    found = {check.name: check for check in checks}
    columns = {"zmp_margin": "zmp_margin", "joint_margin": "joint_position"}
    figures: dict[str, Value] = {
        column: found[name].value for column, name in columns.items() if name in found
    }
    for column, name in (
        ("joint_speed_ratio", "joint_speed"),
        ("torque_ratio", "joint_torque"),
        ("torque_rms_ratio", "joint_torque_rms"),
    ):
        if name in found:
            figures[column] = found[name].value / found[name].limit
    return figures


def _replay_figures(replays: list[Replay], diverged: list[str]) -> dict[str, Value]:
    """Worst figures of all engines; empty without replays."""
    figures: dict[str, Value] = {}
    if replays or diverged:
        figures["survived"] = int(not diverged and not any(r.fell for r in replays))
    if replays:
        for name in ("max_tilt_deg", "position_error", "sole_slip_max"):
            figures[name] = max(getattr(r, name) for r in replays)
        figures["yaw_error_deg"] = max((r.yaw_error_deg for r in replays), key=abs)
    return figures


def _number(value: Value) -> Value:
    """Convert a value for the database: a number that is not finite becomes NULL."""
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value


def _finite(content: dict[str, Any]) -> dict[str, Any]:
    return {key: _number(value) for key, value in content.items()}


class GaitWorker(WorkerPlugin):  # type: ignore[misc]
    """Plugin that brings the recipe to every worker, also to those that join or return later."""

    def __init__(self, name: str, recipe: Recipe) -> None:
        self.name, self.recipe, self.version = name, recipe, mgs.__version__

    def setup(self, worker: Worker) -> None:
        """Refuse a worker with another version of mgs, since its files would differ."""
        if mgs.__version__ != self.version:
            raise MgsError(
                f"worker {worker.address} has mgs {mgs.__version__}, this is {self.version}; "
                "install the same version there"
            )


# Physics engines are not safe for threads, of which a worker may have several.
_one_at_a_time = threading.Lock()


def work(name: str, assignments: tuple[str, ...]) -> Outcome:
    """Make a gait on a worker that has the recipe of that name."""
    plugin = get_worker().plugins[name]
    assert isinstance(plugin, GaitWorker)
    with _one_at_a_time, _ended_after(plugin.recipe.timeout):
        return make_gait(plugin.recipe, assignments)


@contextlib.contextmanager
def _ended_after(seconds: float) -> Iterator[None]:
    """End this process after some time, even if it hangs in compiled code.

    Dask cannot stop a task, but it notices that a worker has ended, and starts another one.
    """
    with Path(os.devnull).open("w") as nowhere:
        faulthandler.dump_traceback_later(seconds, exit=True, file=nowhere)
        try:
            yield
        finally:
            faulthandler.cancel_dump_traceback_later()
