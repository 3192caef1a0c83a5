"""From key to key: CoM, torso, hands and postures at every sample, minimum jerk in between.

Points move on straight lines and the torso turns about one axis, all by the same blend; in a key
everything is at rest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.geometry import quat_xyzw_from_yaw, quintic, slerp
from mgs.motion_planner import MotionPlan
from mgs.motion_planner.motion_plan import KeyPlan
from mgs.trajectory_planner.balance import load_left
from mgs.trajectory_planner.task_trajectory import TaskTrajectory


def plan_key_trajectories(plan: MotionPlan, keys: KeyPlan) -> TaskTrajectory:
    """Trajectories of a motion from key to key; see `plan_trajectories` for the errors."""
    n = plan.n_samples
    before, part = _blend(keys, n)
    com, hands = _between(keys.com, before, part), _between(keys.hands, before, part)
    after = np.minimum(before + 1, len(keys.com) - 1)
    feet = np.array([[f.x, f.y, f.yaw] for f in plan.footsteps])
    poses = np.concatenate([feet[:, :2], np.zeros((2, 1)), quat_xyzw_from_yaw(feet[:, 2])], axis=1)
    loaded = _loaded_com(com, hands, keys)
    return TaskTrajectory(
        dt=plan.dt,
        support=np.full(n, Support.DOUBLE, np.int8),
        root=np.full(n, Side.LEFT, np.int8),
        zmp_ref=loaded[:, :2].copy(),
        load_left=load_left(loaded, feet),
        soles=np.broadcast_to(poses, (n, 2, 7)).copy(),
        hands=hands - com[:, None],
        com_height=com[:, 2].copy(),
        torso=slerp(keys.torso[before], keys.torso[after], part),
        torso_asked=True,
        com=com,
        posture=_between(keys.posture, before, part),
        held=keys.held,
        payload=keys.payload,
    )


def _blend(keys: KeyPlan, n_samples: int) -> tuple[NDArray[np.intp], Array]:
    """At every sample the key (N,) that was last, and the part (N,) of the way to the next one."""
    k = np.arange(n_samples)
    before = np.maximum(np.searchsorted(keys.arrivals, k, side="right") - 1, 0)
    after = np.minimum(before + 1, len(keys.arrivals) - 1)
    leaves, arrives = keys.departures[before], keys.arrivals[after]
    return before, quintic((k - leaves) / np.maximum(arrives - leaves, 1))


def _between(values: Array, before: NDArray[np.intp], part: Array) -> Array:
    """Values (K, ...) of the keys at every sample (N, ...)."""
    after = np.minimum(before + 1, len(values) - 1)
    part = part.reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray(values[before] + part * (values[after] - values[before]))


def _loaded_com(com: Array, hands: Array, keys: KeyPlan) -> Array:
    """CoM (N, 3) of robot and payload together."""
    if keys.payload is None:
        return com
    moment = keys.mass * com + np.einsum("ns,nsi->ni", keys.payload, np.nan_to_num(hands))
    return np.asarray(moment / (keys.mass + keys.payload.sum(axis=1, keepdims=True)))
