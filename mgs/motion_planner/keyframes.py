"""Keyframes: what the body does at named times over feet that stay."""

from __future__ import annotations

import difflib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.core.geometry import quat_multiply, quat_xyzw_from_rpy
from mgs.gait import Keyframe, KeyframesGait
from mgs.motion_planner.motion_plan import KeyPlan, MotionPlan
from mgs.motion_planner.standing import StandingFigures, standing_figures, standing_plan
from mgs.robot import Robot, arm_mask, leg_length, leg_mask

MIN_SAMPLES = 5  # of a way from key to key; below this a quintic is no longer sampled


def plan_keyframes(robot: Robot, gait: KeyframesGait) -> MotionPlan:
    """One phase on both feet and the keys of the body in it; see `plan_motion` for the errors."""
    frames, rest = gait.keyframes, standing_figures(robot)
    led = _led_hands(robot, gait, rest)
    upper = ~leg_mask(robot) if gait.is_balanced else np.ones(robot.n, dtype=np.bool_)
    _refuse_joints(robot, gait, upper, led)
    still = _State(np.zeros(3), 0.0, np.zeros(3), np.zeros((2, 3)), robot.posture)
    states = [_after(robot, Keyframe(time=1.0, posture=frames.begin), still)]
    for key in frames.keys:
        states.append(_after(robot, key, still if key.rest else states[-1]))
    lower = 0.01 * leg_length(robot) * np.array([0.0, 0.0, 1.0])
    arrivals = _samples(gait)
    departures = [round(frames.rest / gait.dt)]
    departures += [round((key.time + key.hold) / gait.dt) for key in frames.keys]
    n_samples = round(frames.duration / gait.dt) + 1
    departures[-1] = n_samples - 1
    held = upper.copy()
    for side in Side:
        if led[side]:
            held &= ~arm_mask(robot, side)
    return standing_plan(
        robot,
        gait.dt,
        n_samples,
        rest,
        KeyPlan(
            arrivals=arrivals,
            departures=np.array(departures, np.intp),
            com=np.array([rest.com + state.com - state.crouch * lower for state in states]),
            torso=quat_multiply(quat_xyzw_from_rpy([s.turns for s in states]), rest.torso),
            hands=np.where(led[:, None], [rest.hands + s.hands for s in states], np.nan),
            posture=np.array([state.joints for state in states]),
            held=held,
            base=None if gait.is_balanced else lying_base(robot, frames.lying),
        ),
    )


def lying_base(robot: Robot, lying: str | None) -> Array:
    """Orientation (4,) of the base at the start, quaternion xyzw."""
    pitch = {"front": 0.5 * np.pi, "back": -0.5 * np.pi, None: 0.0}[lying]
    upright = robot.standing_q[3:7]
    return quat_multiply(quat_xyzw_from_rpy([0.0, pitch, 0.0]), upright)


@dataclass(frozen=True, eq=False)
class _State:
    """The body in one key, displaced from rest."""

    com: Array  # (3,) [m]
    crouch: float  # per cent of the leg length
    turns: Array  # (3,) roll, pitch, yaw of the torso [rad]
    hands: Array  # (2, 3) [m]
    joints: Array  # (n,) angles, not displaced [rad]


def _after(robot: Robot, key: Keyframe, before: _State) -> _State:
    """The body in a key, where what the key does not name is as before."""
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
    """Mask (2,) of the hands that some key names."""
    keys = gait.keyframes.keys
    led = np.array([any(getattr(k, f"{s.label}_hand") is not None for k in keys) for s in Side])
    for side in Side:
        if led[side] and np.isnan(rest.hands[side]).any():
            raise ConfigError(
                "keyframes.keys",
                f"{side.label}_hand: {robot.spec.name} cannot move it against its torso; "
                "leave it out",
            )
    return led


def _refuse_joints(
    robot: Robot, gait: KeyframesGait, upper: NDArray[np.bool_], led: NDArray[np.bool_]
) -> None:
    """Raise ConfigError for joints that `posture` cannot have."""
    problems = []
    arms = [arm_mask(robot, side) for side in Side]
    frames = gait.keyframes
    postures = {"begin": frames.begin}
    postures |= {f"keys.{i}.posture": key.posture for i, key in enumerate(frames.keys)}
    for where, posture in postures.items():
        for name, angle in posture.items():
            place = f"{where}.{name}"
            if name not in robot.joint_names:
                close = difflib.get_close_matches(name, robot.joint_names, n=1)
                hint = f"; did you mean {close[0]!r}?" if close else ""
                problems.append(f"{place}: {robot.spec.name} has no such joint{hint}")
                continue
            j = robot.joint_names.index(name)
            if not upper[j]:
                problems.append(
                    f"{place}: a joint of the legs, which keep soles and balance; use com, crouch "
                    "or torso"
                )
            elif any(led[side] and arms[side][j] for side in Side):
                problems.append(f"{place}: this arm follows its hand, which some key names")
            elif not robot.lower[j] <= angle <= robot.upper[j]:
                problems.append(
                    f"{place}: {angle:g} rad is outside the joint's range "
                    f"[{robot.lower[j]:.4f}, {robot.upper[j]:.4f}]"
                )
    if problems:
        raise ConfigError("keyframes", problems)


def _samples(gait: KeyframesGait) -> NDArray[np.intp]:
    """Samples (K,) at which the keys are reached, the start first."""
    frames, dt = gait.keyframes, gait.dt
    leaves = frames.rest
    arrivals = [0]
    for i, key in enumerate(frames.keys):
        if round(key.time / dt) - round(leaves / dt) < MIN_SAMPLES:
            raise ConfigError(
                f"keyframes.keys.{i}.time",
                f"{key.time:g} s is fewer than {MIN_SAMPLES} samples of dt = {dt:g} s after "
                f"{leaves:g} s, when the key before it ends; use a later time or a smaller dt",
            )
        arrivals.append(round(key.time / dt))
        leaves = key.time + key.hold
    return np.array(arrivals, np.intp)
