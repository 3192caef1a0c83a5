"""Trajectories of a balance motion: CoM, torso and hands move while both soles stay.

A channel displaces one coordinate from its value at rest; channels of the same coordinate add up.
One minimum-jerk factor fades all of them in and out. The angles of the torso are yaw, pitch and
roll (z-y-x), each about an axis that the angles before it have turned.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.geometry import quat_multiply, quat_xyzw_from_rpy, quintic
from mgs.gait import AnyChannel, ConstantChannel, FigureEightChannel, RampChannel, SineChannel
from mgs.motion_planner import BalancePlan
from mgs.trajectory_planner.standing import load_left, standing_soles
from mgs.trajectory_planner.task_trajectory import TaskTrajectory

COORDINATES = [
    f"{task}_{axis}"
    for task, axes in {
        "com": ("x", "y", "z"),
        "torso": ("roll", "pitch", "yaw"),
        "left_hand": ("x", "y", "z"),
        "right_hand": ("x", "y", "z"),
    }.items()
    for axis in axes
]


def plan_balance_trajectories(plan: BalancePlan) -> TaskTrajectory:
    """Trajectories of a balance motion; see `plan_trajectories` for the errors."""
    n = plan.n_samples
    moved = displacements(plan.channels, plan.dt * np.arange(n, dtype=np.float64))
    moved[:, 2] += plan.com_height - plan.com[2]
    moved *= fading(plan)[:, None]
    com = plan.com + moved[:, :3]
    return TaskTrajectory(
        dt=plan.dt,
        support=np.full(n, Support.DOUBLE, np.int8),
        root=np.full(n, Side.LEFT, np.int8),
        zmp_ref=com[:, :2].copy(),
        load_left=load_left(com, plan.footsteps),
        soles=standing_soles(plan.footsteps, n),
        hands=plan.hands + moved[:, 6:].reshape(n, 2, 3) - com[:, None],
        com_height=com[:, 2].copy(),
        torso=quat_multiply(quat_xyzw_from_rpy(moved[:, 3:6]), plan.torso),
        torso_asked=any(channel.task.startswith("torso") for channel in plan.channels),
        com=com,
    )


def fading(plan: BalancePlan) -> Array:
    """Factor (N,) of all channels: 0 at rest at both ends, 1 in between."""
    k = np.arange(plan.n_samples)
    return quintic(np.minimum(k - plan.start, plan.end - k) / plan.ease)


def displacements(channels: tuple[AnyChannel, ...], times: Array) -> Array:
    """Sum (N, 12) of all channels at times (N,) [s], in the order of COORDINATES [m], [rad]."""
    out = np.zeros((len(times), len(COORDINATES)))
    for channel in channels:
        if isinstance(channel, FigureEightChannel):
            turn = 2.0 * np.pi * channel.frequency * times
            first, second = (COORDINATES.index(f"{channel.task}_{a}") for a in channel.plane)
            out[:, first] += 0.5 * channel.width * np.sin(turn)
            out[:, second] += 0.5 * channel.height * np.sin(2.0 * turn)
        else:
            out[:, COORDINATES.index(channel.task)] += _wave(channel, times)
    return out


def _wave(channel: ConstantChannel | SineChannel | RampChannel, times: Array) -> Array:
    """Displacement (N,) of one channel at times (N,) [s]."""
    if isinstance(channel, ConstantChannel):
        return np.full(len(times), channel.value)
    if isinstance(channel, SineChannel):
        turn = 2.0 * np.pi * channel.frequency * times + channel.phase
        return np.asarray(channel.amplitude * np.sin(turn))
    return channel.value * quintic((times - channel.start) / (channel.end - channel.start))
