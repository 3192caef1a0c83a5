"""Time of one step of inverse kinematics (IK), and the share of Pinocchio in it.

The solver is not changed. One step is the time from one update of the task Jacobian to the next,
recorded by a subclass of `TreeTasks`. Recording takes 0.1 to 0.2 us per step; therefore the mean
over a run without recording is given as well.
"""

from __future__ import annotations

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
from mgs.core.spans import spans
from mgs.gait import load_gait
from mgs.ik_solver import clik, solve_ik
from mgs.ik_solver.gains import gravity_gain_profile, rest_profile
from mgs.ik_solver.tree.tasks import WORLD_ALIGNED, TreeTasks
from mgs.pipeline import Stages, run_stages
from mgs.robot import load_robot


class StampedTasks(TreeTasks):
    """TreeTasks that record the start time of each update."""

    stamps: ClassVar[list[int]] = []  # [ns]

    def update(self, q: Array) -> None:
        """Record the time and update J, f and R."""
        self.stamps.append(time.perf_counter_ns())
        super().update(q)


@dataclass(frozen=True)
class IkFigures:
    """Times per sample [s] of one walk with one set of gains."""

    per_run: Spread  # time of a run divided by its samples, over several runs
    step: Spread  # single steps of all runs
    gravity_step: Spread | None  # single steps in which the gravity task is active
    kinematics: Spread  # Pinocchio calls of every single step
    gravity: Spread  # additional Pinocchio calls of the gravity task

    def to_dict(self) -> dict[str, Any]:
        """Convert to plain data."""
        return asdict(self)


class _Runs:
    """Measurements of one variant of a gait over several rounds."""

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
    """Solve variants of a Melson gait alternately, so that noise affects all of them equally."""
    runs = {name: _Runs(gait_name, assignments) for name, assignments in variants.items()}
    for _ in range(repeats):
        for run in runs.values():
            run.add()
    return {name: run.figures() for name, run in runs.items()}


def mean_step(stages: Stages) -> float:
    """Mean CPU time of an IK step in one run [s], with the set-up and the checks of the run.

    In contrast to elapsed time it does not contain the time of other work on the machine.
    """
    motion = stages.motion
    start = time.process_time()
    solve_ik(motion.robot, stages.tasks, stages.com, stages.gait.ik)
    return (time.process_time() - start) / motion.n_samples


def _single_steps(stages: Stages) -> Array:
    """Times (N,) of the steps of one run [s]."""
    StampedTasks.stamps.clear()
    with mock.patch.object(clik, "TreeTasks", StampedTasks):
        motion = stages.motion
        joints = solve_ik(motion.robot, stages.tasks, stages.com, stages.gait.ik)
    if joints.report_of(clik.ClosedLoopReport).newton_updates:
        raise RuntimeError("this gait needs Newton updates, so that an update is not a step")
    root = stages.tasks.root
    steps, end = np.empty(len(root)), len(StampedTasks.stamps)
    for first, last in reversed(spans(root)):
        # a span of m samples has m + 1 updates; the remaining updates belong to the start
        stamps = np.array(StampedTasks.stamps[end - (last - first) - 1 : end])
        steps[first:last] = np.diff(stamps) * 1e-9
        end -= len(stamps)
    return steps


def _gravity_at_work(stages: Stages) -> NDArray[np.bool_]:
    """Mask (N,) of the samples at which the solver evaluates the gravity task."""
    gait, tasks = stages.gait, stages.tasks
    ramp = gait.ik.gamma_grav_ramp
    factor = rest_profile(tasks.n_samples, tasks.dt, ramp)
    if gait.ik.double_support == "off":
        factor = factor * gravity_gain_profile(tasks.support, tasks.dt, ramp)
    return factor * gait.ik.gamma_grav > 0.0


def _pinocchio(stages: Stages) -> tuple[Array, Array]:
    """Times (N,) of Pinocchio calls alone [s]: kinematics with Jacobians, gravity derivative."""
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
