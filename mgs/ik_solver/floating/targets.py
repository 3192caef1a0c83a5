"""References of a task vector of a floating-base robot at every sample."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mgs.com_generator import ComTrajectory
from mgs.core.arrays import Array
from mgs.core.geometry import rotations_from_quat_xyzw
from mgs.ik_solver.floating.parts import Part
from mgs.ik_solver.rotations import turns_between
from mgs.trajectory_planner import TaskTrajectory


@dataclass(frozen=True, eq=False)
class BodyTargets:
    """References of a task vector of m rows at every sample."""

    x: Array  # (N, m) positions; rows of rotations are 0
    rotations: Array  # (N, r, 3, 3) of the parts that have one, in their order
    steps: Array  # (N, m) x[k] - x[k-1], rotation vectors in the rows of rotations; 0 at k = 0


def body_targets(parts: Sequence[Part], tasks: TaskTrajectory, com: ComTrajectory) -> BodyTargets:
    """References for parts, in their order."""
    x, rotations, steps = [], [np.empty((tasks.n_samples, 0, 3, 3))], []
    for part in parts:
        reference = part.reference(tasks, com.position)
        position, step = np.zeros((2, tasks.n_samples, part.size))
        position[:, : part.n_axes] = reference[:, part.axes]
        step[1:] = np.diff(position, axis=0)
        if part.turns:
            R = rotations_from_quat_xyzw(reference[:, 3:])
            rotations.append(R[:, None])
            step[:, part.n_axes :] = turns_between(R)
        x.append(position)
        steps.append(step)
    return BodyTargets(
        x=np.concatenate(x, axis=1),
        rotations=np.concatenate(rotations, axis=1),
        steps=np.concatenate(steps, axis=1),
    )
