"""Trajectories of a walk, of stairs or of a kick: soles, hands, torso, ZMP and CoM height."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side, Support
from mgs.core.geometry import quat_multiply, quat_xyzw_from_yaw, quintic, rotate_planar
from mgs.motion_planner import Phase, WalkPlan
from mgs.trajectory_planner.com_height import height_within_reach, pendulum_above
from mgs.trajectory_planner.foot_roll import rolled_soles, sole_pitch
from mgs.trajectory_planner.swing import sole_paths
from mgs.trajectory_planner.task_trajectory import TaskTrajectory
from mgs.trajectory_planner.zmp import plan_zmp


def plan_walk_trajectories(plan: WalkPlan) -> TaskTrajectory:
    """Trajectories of a walk, of stairs or of a kick."""
    lengths = [phase.end - phase.start for phase in plan.phases]
    planar, height = sole_paths(plan)
    zmp, load_left, pressure = plan_zmp(plan)
    soles = _sole_poses(planar, height)
    root = np.repeat(np.array(_roots(plan.phases), np.int8), lengths)
    if plan.roll is not None:
        pitch = sole_pitch(plan)
        soles = rolled_soles(plan.roll, planar, height, pitch)
        rolling = pitch[np.arange(len(root)), root] != 0.0
        root = np.where(rolling, 1 - root, root).astype(np.int8)  # the other one is level then
    heading = planar[..., 2].mean(axis=1)
    return TaskTrajectory(
        dt=plan.dt,
        support=np.repeat(np.array([phase.support for phase in plan.phases], np.int8), lengths),
        root=root,
        zmp_ref=zmp,
        load_left=load_left,
        soles=soles,
        pressure=pressure if plan.roll is not None else None,
        hands=_hands(plan, planar, heading),
        com_height=_com_height(plan, zmp, soles, heading),
        torso=quat_multiply(quat_xyzw_from_yaw(heading), plan.torso),
    )


def _com_height(plan: WalkPlan, zmp: Array, soles: Array, heading: Array) -> Array:
    """Height (N,) of the CoM above the ground below it, as far as the legs reach [m]."""
    asked = plan.com_height + _level(plan)
    if plan.reach is None:
        return asked
    # over boxes the ZMP stands for the CoM, which asks for lower heights: with the pendulum
    # melson/obstacle falls on servos that give way by 2 deg (docs/robustness.md)
    com = zmp if plan.scene.boxes else pendulum_above(zmp, plan.com_height, plan.dt)
    return height_within_reach(asked, com, soles, heading, plan.reach, plan.dt)


def _level(plan: WalkPlan) -> Array:
    """Height (N,) of the ground below the CoM [m]: blends between mean heights of the soles."""
    heights = np.array([foot.z for foot in plan.footsteps])
    level, now = np.empty(plan.n_samples), float(heights[:2].mean())
    start = 0
    for phase in plan.phases:
        if phase.target is None:
            continue
        begin = phase.start if start == 0 else start  # before the first step nothing changes
        following = float(heights[[phase.target, phase.feet[phase.support - 1]]].mean())
        level[start:begin] = now
        span = np.arange(phase.end - begin) / (phase.end - begin)
        level[begin : phase.end] = now + (following - now) * quintic(span)
        start, now = phase.end, following
    level[start:] = now
    return level


def _roots(phases: tuple[Phase, ...]) -> list[Side]:
    """Sole of each phase that inverse kinematics starts from: that of this or the next step.

    After the last single support it is the sole of that one; without any it is the left sole.
    """
    singles = [phase.support.sides[0] for phase in phases if phase.support is not Support.DOUBLE]
    upcoming = singles[-1] if singles else Side.LEFT
    roots = []
    for phase in reversed(phases):
        if phase.support is not Support.DOUBLE:
            upcoming = phase.support.sides[0]
        roots.append(upcoming)
    return roots[::-1]


def _sole_poses(planar: Array, height: Array) -> Array:
    """Poses (N, 2, 7) of level soles from x, y, yaw (N, 2, 3) and z (N, 2)."""
    return np.concatenate(
        [planar[..., :2], height[..., None], quat_xyzw_from_yaw(planar[..., 2])], axis=-1
    )


def _hands(plan: WalkPlan, planar: Array, heading: Array) -> Array:
    """Hands (N, 2, 3) at constant offsets from the CoM that turn with the heading (N,) [m].

    With arm swing each hand moves forward and back with the opposite foot. NaN: hands are free.
    """
    hands = np.full((plan.n_samples, 2, 3), np.nan)
    if not plan.hands_held:
        return hands
    hands[..., 2] = plan.hand_offsets[:, 2]
    apart = planar[:, Side.LEFT, :2] - planar[:, Side.RIGHT, :2]
    ahead = rotate_planar(apart, -heading)[:, 0]  # way of the left foot past the right one
    for side in Side:
        offset = np.repeat(plan.hand_offsets[side, None, :2], plan.n_samples, axis=0)
        offset[:, 0] -= 0.5 * side.sign * plan.arm_swing * ahead
        hands[:, side, :2] = rotate_planar(offset, heading)
    return hands
