"""Trajectories from key to key: CoM, torso, hands and joint angles, minimum jerk in between.

Points move along straight lines and orientations turn about one axis, all by the same blend. In a
key everything is at rest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.geometry import quintic, slerp
from mgs.motion_planner import KeyframePlan, PosturePlan
from mgs.motion_planner.motion_plan import KeyTimes, Payload
from mgs.trajectory_planner.standing import load_left, standing_soles
from mgs.trajectory_planner.task_trajectory import (
    PostureTrajectory,
    PreferredPosture,
    TaskTrajectory,
)


def plan_key_trajectories(plan: KeyframePlan) -> TaskTrajectory:
    """Trajectories of a motion from key to key; see `plan_trajectories` for the errors."""
    n = plan.n_samples
    before, part = _blend(plan.times, n)
    com, hands = _between(plan.com, before, part), _between(plan.hands, before, part)
    loaded = com if plan.payload is None else _loaded_com(com, hands, plan.payload)
    return TaskTrajectory(
        dt=plan.dt,
        support=np.full(n, Support.DOUBLE, np.int8),
        root=np.full(n, Side.LEFT, np.int8),
        zmp_ref=loaded[:, :2].copy(),
        load_left=load_left(loaded, plan.footsteps),
        soles=standing_soles(plan.footsteps, n),
        hands=hands - com[:, None],
        com_height=com[:, 2].copy(),
        torso=slerp(plan.torso[before], plan.torso[_following(before, plan.torso)], part),
        torso_asked=True,
        com=com,
        posture=PreferredPosture(_between(plan.posture, before, part), plan.held),
        payload=None if plan.payload is None else plan.payload.masses,
    )


def plan_posture_trajectory(plan: PosturePlan) -> PostureTrajectory:
    """Joint angles from key to key, while the base turns steadily to where it is upright."""
    n = plan.n_samples
    return PostureTrajectory(
        dt=plan.dt,
        angles=_between(plan.posture, *_blend(plan.times, n)),
        base=slerp(plan.base[0], plan.base[1], quintic(np.arange(n) / (n - 1))),
    )


def _blend(times: KeyTimes, n_samples: int) -> tuple[NDArray[np.intp], Array]:
    """Last key (N,) at every sample, and the part (N,) of the way to the key after it."""
    k = np.arange(n_samples)
    before = np.maximum(np.searchsorted(times.arrivals, k, side="right") - 1, 0)
    leaves, arrives = times.departures[before], times.arrivals[_following(before, times.arrivals)]
    return before, quintic((k - leaves) / np.maximum(arrives - leaves, 1))


def _following(before: NDArray[np.intp], keys: NDArray[np.generic]) -> NDArray[np.intp]:
    """Indices (N,) of the keys after the last ones (N,); the last key of all follows itself."""
    return np.minimum(before + 1, len(keys) - 1)


def _between(values: Array, before: NDArray[np.intp], part: Array) -> Array:
    """Values (N, ...) at every sample on straight lines between those of the keys (K, ...)."""
    part = part.reshape(-1, *[1] * (values.ndim - 1))
    start = values[before]
    return np.asarray(start + part * (values[_following(before, values)] - start))


def _loaded_com(com: Array, hands: Array, payload: Payload) -> Array:
    """Common CoM (N, 3) of the robot, whose own is at `com`, and the payload in its hands [m]."""
    masses, robot = payload.masses, payload.robot_mass
    moment = robot * com + np.einsum("ns,nsi->ni", masses, np.nan_to_num(hands))
    return np.asarray(moment / (robot + masses.sum(axis=1, keepdims=True)))
