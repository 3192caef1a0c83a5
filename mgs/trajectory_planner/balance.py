"""Balancing: what CoM, torso and hands shall do at every sample while both soles stay.

A channel displaces one coordinate from its value at rest; channels of the same coordinate add up.
All of them are eased in and out by the same minimum-jerk factor. The torso's angles are yaw-pitch-
roll (z-y-x), each about the axes that the ones before it have turned.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.errors import InfeasibleGaitError
from mgs.core.geometry import quat_multiply, quat_xyzw_from_rpy, quat_xyzw_from_yaw, quintic
from mgs.gait import AnyChannel, ConstantChannel, FigureEightChannel, RampChannel, SineChannel
from mgs.motion_planner import MotionPlan
from mgs.motion_planner.motion_plan import BodyPlan
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


def plan_balance_trajectories(plan: MotionPlan, body: BodyPlan) -> TaskTrajectory:
    """Trajectories of a balance motion; see `plan_trajectories` for the errors."""
    n, dt = plan.n_samples, plan.dt
    moved = displacements(body.channels, dt * np.arange(n, dtype=np.float64))
    moved[:, 2] += body.com_height - body.com[2]
    moved *= ease(body, n)[:, None]
    com = body.com + moved[:, :3]
    feet = np.array([[f.x, f.y, f.yaw] for f in plan.footsteps])
    poses = np.concatenate([feet[:, :2], np.zeros((2, 1)), quat_xyzw_from_yaw(feet[:, 2])], axis=1)
    return TaskTrajectory(
        dt=dt,
        support=np.full(n, Support.DOUBLE, np.int8),
        root=np.full(n, Side.LEFT, np.int8),
        zmp_ref=com[:, :2].copy(),
        load_left=load_left(com, feet),
        soles=np.broadcast_to(poses, (n, 2, 7)).copy(),
        hands=body.hands + moved[:, 6:].reshape(n, 2, 3) - com[:, None],
        com_height=com[:, 2].copy(),
        torso=quat_multiply(quat_xyzw_from_rpy(moved[:, 3:6]), plan.torso),
        torso_asked=any(c.task.startswith("torso") for c in body.channels),
        com=com,
    )


def ease(body: BodyPlan, n_samples: int) -> Array:
    """Factor (N,) of all channels: 0 at rest, 1 in between."""
    k = np.arange(n_samples)
    inward = np.minimum(k - body.start, body.end - k) / body.ease
    return quintic(inward)


def displacements(channels: tuple[AnyChannel, ...], times: Array) -> Array:
    """Sum (N, 12) of the channels at times (N,) [s], in the order of COORDINATES."""
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
    """One channel (N,)."""
    if isinstance(channel, ConstantChannel):
        return np.full(len(times), channel.value)
    if isinstance(channel, SineChannel):
        turn = 2.0 * np.pi * channel.frequency * times + channel.phase
        return np.asarray(channel.amplitude * np.sin(turn))
    return channel.value * quintic((times - channel.start) / (channel.end - channel.start))


def load_left(com: Array, feet: Array) -> Array:
    """Share (N,) of the left sole: where the CoM stands between the two."""
    across = feet[Side.LEFT, :2] - feet[Side.RIGHT, :2]
    share = (com[:, :2] - feet[Side.RIGHT, :2]) @ across / (across @ across)
    worst = float(np.abs(share - 0.5).max())
    if worst > 1.0:
        raise InfeasibleGaitError(
            f"the CoM is asked to go {worst * np.hypot(*across):.3f} m sideways, beyond both feet; "
            "use a smaller com_y"
        )
    return np.asarray(np.clip(share, 0.0, 1.0))
