"""The plan of keyframes: what the body does at given times over feet that stay."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.geometry import quat_multiply, quat_xyzw_from_rpy
from mgs.gait import Keyframe, KeyframesGait
from mgs.motion_planner.joint_angles import refuse_joints
from mgs.motion_planner.motion_plan import KeyframePlan, KeyTimes, PosturePlan
from mgs.motion_planner.standing import StandingFigures, feet_abreast, standing_figures
from mgs.robot import Robot, arm_mask, leg_length, leg_mask

MIN_SAMPLES = 5  # from key to key; with fewer the quintic blend is no longer sampled
LYING_PITCH = {"front": 0.5 * np.pi, "back": -0.5 * np.pi, None: 0.0}  # of the base [rad]


def plan_keyframes(robot: Robot, gait: KeyframesGait) -> KeyframePlan:
    """Keys of the body in a motion that keeps its balance; see `plan_motion` for the errors."""
    rest = standing_figures(robot)
    led = _led_hands(robot, gait, rest)
    held = ~leg_mask(robot)
    refuse_joints(robot, gait, held, led)
    for side in Side:
        if led[side]:
            held &= ~arm_mask(robot, side)
    states = _states(robot, gait)
    times, n_samples = _key_times(gait)
    one_per_cent = 0.01 * leg_length(robot) * np.array([0.0, 0.0, 1.0])
    return KeyframePlan(
        dt=gait.dt,
        n_samples=n_samples,
        footsteps=feet_abreast(robot),
        times=times,
        com=np.array([rest.com + state.com - state.crouch * one_per_cent for state in states]),
        torso=quat_multiply(quat_xyzw_from_rpy([s.turns for s in states]), rest.torso),
        hands=np.where(led[:, None], [rest.hands + s.hands for s in states], np.nan),
        posture=np.array([state.joints for state in states]),
        held=held,
    )


def plan_postures(robot: Robot, gait: KeyframesGait) -> PosturePlan:
    """Joint angles of a motion without balance; see `plan_motion` for the errors."""
    refuse_joints(robot, gait, np.ones(robot.n, np.bool_), np.zeros(2, np.bool_))
    times, n_samples = _key_times(gait)
    upright = robot.standing_q[3:FLOATING_BASE_NQ]
    pitch = LYING_PITCH[gait.keyframes.lying]
    return PosturePlan(
        dt=gait.dt,
        n_samples=n_samples,
        footsteps=feet_abreast(robot),
        times=times,
        posture=np.array([state.joints for state in _states(robot, gait)]),
        base=np.stack([quat_multiply(quat_xyzw_from_rpy([0.0, pitch, 0.0]), upright), upright]),
    )


@dataclass(frozen=True, eq=False)
class _State:
    """Displacements of the body from rest in one key, and its joint angles."""

    com: Array  # (3,) [m]
    crouch: float  # lowering of the CoM in per cent of the leg length
    turns: Array  # (3,) roll, pitch, yaw of the torso [rad]
    hands: Array  # (2, 3) [m]
    joints: Array  # (n,) joint angles [rad]


def _states(robot: Robot, gait: KeyframesGait) -> list[_State]:
    """The body at the start and in every key."""
    frames = gait.keyframes
    still = _State(np.zeros(3), 0.0, np.zeros(3), np.zeros((2, 3)), robot.posture)
    states = [_after(robot, Keyframe(time=1.0, posture=frames.begin), still)]
    for key in frames.keys:
        states.append(_after(robot, key, still if key.rest else states[-1]))
    return states


def _after(robot: Robot, key: Keyframe, before: _State) -> _State:
    """The body in a key; what the key does not name stays as in the state before."""
    hands, joints = before.hands.copy(), before.joints.copy()
    for side, moved in zip(Side, (key.left_hand, key.right_hand), strict=True):
        if moved is not None:
            hands[side] = moved
    for name, angle in key.posture.items():
        joints[robot.joint_names.index(name)] = angle
    return _State(
        com=before.com if key.com is None else np.array(key.com),
        crouch=before.crouch if key.crouch is None else key.crouch,
        turns=before.turns if key.torso is None else np.array(key.torso),
        hands=hands,
        joints=joints,
    )


def _led_hands(robot: Robot, gait: KeyframesGait, rest: StandingFigures) -> NDArray[np.bool_]:
    """Mask (2,) of the hands that any key names."""
    keys = gait.keyframes.keys
    led = np.array([any(getattr(k, f"{s.label}_hand") is not None for k in keys) for s in Side])
    for side in Side:
        if led[side] and np.isnan(rest.hands[side]).any():
            raise ConfigError(
                "keyframes.keys",
                f"{side.label}_hand: {robot.spec.name} cannot move it relative to its torso; "
                "leave it out",
            )
    return led


def _key_times(gait: KeyframesGait) -> tuple[KeyTimes, int]:
    """Samples at which the body rests in the keys, the start first, and the number of samples."""
    frames, dt = gait.keyframes, gait.dt
    leaves, arrivals, departures = frames.rest, [0], [round(frames.rest / dt)]
    for i, key in enumerate(frames.keys):
        arrivals.append(round(key.time / dt))
        if arrivals[-1] - departures[-1] < MIN_SAMPLES:
            raise ConfigError(
                f"keyframes.keys.{i}.time",
                f"{key.time:g} s is fewer than {MIN_SAMPLES} samples of dt = {dt:g} s after "
                f"{leaves:g} s, when the key before it ends; use a later time or a smaller dt",
            )
        leaves = key.time + key.hold
        departures.append(round(leaves / dt))
    n_samples = round(frames.duration / dt) + 1
    departures[-1] = n_samples - 1  # the last key lasts until the end
    return KeyTimes(np.array(arrivals, np.intp), np.array(departures, np.intp)), n_samples
