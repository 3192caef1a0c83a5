"""Time of one IK step, and how much of it Pinocchio takes.

The solver runs as it is. One step is the time from one update of the task Jacobian to the next,
stamped by a subclass of `TreeTasks`; the stamps cost 0.1 to 0.2 us each, so that the mean over a
run without stamps is given beside them.
"""

from __future__ import annotations

import itertools
import time
from dataclasses import asdict, dataclass
from typing import Any, ClassVar
from unittest import mock

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from spread import Spread, spread

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.gait import load_gait
from mgs.ik_solver import clik, solve_ik
from mgs.ik_solver.tree.tasks import WORLD_ALIGNED, TreeTasks
from mgs.pipeline import Stages, run_stages
from mgs.robot import load_robot


class StampedTasks(TreeTasks):
    """Writes down when each update begins."""

    stamps: ClassVar[list[int]] = []  # [ns]

    def update(self, q: Array) -> None:
        """Refill J, f and R."""
        self.stamps.append(time.perf_counter_ns())
        super().update(q)


@dataclass(frozen=True)
class IkFigures:
    """Times per sample [s] of one walk with one set of gains."""

    per_run: Spread  # mean over the samples of a run, over runs
    step: Spread  # single steps, of all runs together
    gravity_step: Spread | None  # those in which the gravity task is at work
    kinematics: Spread  # Pinocchio's share of every single step
    gravity: Spread  # Pinocchio's share of what the gravity task adds

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


class _Runs:
    """Measurements of one variant of a gait, to which every round adds."""

    def __init__(self, gait_name: str, assignments: tuple[str, ...]) -> None:
        self.stages = run_stages(load_robot("melson"), load_gait(gait_name, assignments))
        self.at_work = _gravity_at_work(self.stages)
        self.means: list[float] = []
        self.steps: list[Array] = []
        self.pinocchio: list[tuple[Array, Array]] = []

    def add(self) -> None:
        self.means.append(mean_step(self.stages))
        self.steps.append(_single_steps(self.stages))
        self.pinocchio.append(_pinocchio(self.stages))

    def figures(self) -> IkFigures:
        steps, pinocchio = np.array(self.steps), np.concatenate(self.pinocchio, axis=1)
        return IkFigures(
            per_run=spread(self.means),
            step=spread(steps.ravel()),
            gravity_step=spread(steps[:, self.at_work].ravel()) if self.at_work.any() else None,
            kinematics=spread(pinocchio[0]),
            gravity=spread(pinocchio[1]),
        )


def measure(
    gait_name: str, repeats: int, variants: dict[str, tuple[str, ...]]
) -> dict[str, IkFigures]:
    """Solve variants of a gait of Melson's in turn, so that noise meets all of them."""
    runs = {name: _Runs(gait_name, assignments) for name, assignments in variants.items()}
    for _ in range(repeats):
        for run in runs.values():
            run.add()
    return {name: run.figures() for name, run in runs.items()}


def mean_step(stages: Stages) -> float:
    """Mean time of an IK step in one run [s]."""
    motion = stages.motion
    start = time.perf_counter()
    solve_ik(motion.robot, stages.tasks, stages.com, stages.gait.ik)
    return (time.perf_counter() - start) / motion.n_samples


def _single_steps(stages: Stages) -> Array:
    """Times (N,) of the steps of one run [s]."""
    StampedTasks.stamps.clear()
    with mock.patch.object(clik, "TreeTasks", StampedTasks):
        motion = stages.motion
        joints = solve_ik(motion.robot, stages.tasks, stages.com, stages.gait.ik)
    if joints.report["newton_updates"]:
        raise RuntimeError("this gait takes Newton updates, so that updates are not steps")
    root = stages.tasks.root
    bounds = [0, *(np.flatnonzero(np.diff(root)) + 1), len(root)]
    steps, end = np.empty(len(root)), len(StampedTasks.stamps)
    for first, last in reversed(list(itertools.pairwise(bounds))):
        # a span of m samples makes m + 1 updates; those left over belong to the start
        stamps = np.array(StampedTasks.stamps[end - (last - first) - 1 : end])
        steps[first:last] = np.diff(stamps) * 1e-9
        end -= len(stamps)
    return steps


def _gravity_at_work(stages: Stages) -> NDArray[np.bool_]:
    """Samples (N,) at which the solver evaluates the gravity task."""
    gait, tasks = stages.gait, stages.tasks
    ramp = gait.ik.gamma_grav_ramp
    factor = clik.gravity_gain_profile(tasks.support, tasks.dt, ramp)
    factor *= clik.rest_profile(tasks.n_samples, tasks.dt, ramp)
    return factor * gait.ik.gamma_grav > 0.0


def _pinocchio(stages: Stages) -> tuple[Array, Array]:
    """Times (N,) of Pinocchio's calls alone [s]: kinematics with Jacobians, gravity derivative."""
    tasks = TreeTasks(stages.motion.robot, Side.LEFT)
    model, data, frames = tasks.model, tasks.data, (tasks.tree.swing_sole, *tasks.tree.hands)
    angles = np.ascontiguousarray(stages.joints.angles[:, tasks.order])
    stamps = np.empty((len(angles), 3), dtype=np.int64)
    for k, q in enumerate(angles):
        start = time.perf_counter_ns()
        pin.jacobianCenterOfMass(model, data, q, False)
        for frame in frames:
            placement = pin.updateFramePlacement(model, data, frame)
        for frame in frames:
            pin.getFrameJacobian(model, data, frame, WORLD_ALIGNED)
        pin.log3(placement.rotation)
        middle = time.perf_counter_ns()
        pin.computeGeneralizedGravityDerivatives(model, data, q)
        stamps[k] = start, middle, time.perf_counter_ns()
    kinematics, gravity = np.diff(stamps, axis=1).T * 1e-9
    return kinematics, gravity
