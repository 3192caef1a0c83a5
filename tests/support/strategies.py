"""Hypothesis strategies for gaits, and a short way to write one down."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from mgs.gait import (
    BalanceGait,
    ComParameters,
    IkParameters,
    KeyframesGait,
    PickUpGait,
    WalkGait,
    WalkParameters,
)


def walk_gait(
    dt: float = 0.01,
    com: dict[str, Any] | None = None,
    ik: dict[str, Any] | None = None,
    **walk: Any,
) -> WalkGait:
    """A walk with the defaults of the gait file but for what is given."""
    return WalkGait(
        mgs=1,
        motion="walk",
        dt=dt,
        walk=WalkParameters(**{"n_steps": 2, **walk}),
        com=ComParameters(**(com or {})),
        ik=IkParameters(**(ik or {})),
    )


def balance_gait(
    *channels: dict[str, Any],
    dt: float = 0.01,
    ik: dict[str, Any] | None = None,
    **balance: Any,
) -> BalanceGait:
    """A balance motion of 4 s with the defaults of the gait file but for what is given."""
    tree = {"duration": 4.0, "channels": list(channels), **balance}
    return BalanceGait.model_validate(
        {"mgs": 1, "motion": "balance", "dt": dt, "balance": tree, "ik": ik or {}}
    )


def sine(task: str, amplitude: float, frequency: float = 0.5, **more: float) -> dict[str, Any]:
    return {"task": task, "wave": "sine", "amplitude": amplitude, "frequency": frequency, **more}


def constant(task: str, value: float) -> dict[str, Any]:
    return {"task": task, "wave": "constant", "value": value}


def ramp(task: str, value: float, start: float, end: float) -> dict[str, Any]:
    return {"task": task, "wave": "ramp", "value": value, "start": start, "end": end}


def figure_eight(
    task: str, plane: str, width: float, height: float, frequency: float = 0.5
) -> dict[str, Any]:
    return {
        "task": task,
        "wave": "figure_eight",
        "plane": plane,
        "width": width,
        "height": height,
        "frequency": frequency,
    }


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False, width=64)


@st.composite
def walks(draw: st.DrawFn, max_steps: int = 8) -> WalkGait:
    """Walks whose footsteps do not overlap on Melson (soles 106 mm x 60 mm).

    Some of them need more reach than it has: enough for the first three stages.
    """
    return walk_gait(
        dt=draw(st.sampled_from([0.005, 0.01, 0.02])),
        n_steps=draw(st.integers(2, max_steps)),
        step_length=draw(numbers(-0.06, 0.06)),
        lateral=draw(st.just(0.0) | numbers(-0.03, 0.03)),
        step_yaw=draw(st.just(0.0) | numbers(-0.15, 0.15)),
        step_width=draw(numbers(0.095, 0.12)),
        first_support=draw(st.sampled_from(["left", "right", None])),
        lead_in=draw(numbers(1.6, 2.2)),
        double_support=draw(numbers(0.15, 1.2)),
        single_support=draw(numbers(0.3, 2.4)),
        lead_out=draw(numbers(1.6, 2.2)),
        step_height=draw(numbers(0.005, 0.04)),
        landing=draw(st.just(0.0) | numbers(0.0, 0.5)),
        zmp_offset=[draw(numbers(-0.02, 0.02)), draw(numbers(-0.01, 0.01))],
    )


@st.composite
def legal_gaits(draw: st.DrawFn, max_steps: int = 300, longest: float = 20.0) -> WalkGait:
    """Gaits from all over what a gait file allows, whether any robot can walk them or not.

    No phase is longer than `longest` [s].
    """
    preview = draw(numbers(0.1, min(10.0, longest)))
    n_steps = draw(st.integers(1, max_steps))
    moving = numbers(-1.0, 1.0) if n_steps > 1 else st.just(0.0)
    return walk_gait(
        dt=draw(numbers(0.01, 0.1)),
        com={
            "generator": draw(st.sampled_from(["preview", "qp"])),
            "margin": draw(st.just(0.0) | numbers(0.0, 0.1)),
            "passes": draw(st.integers(0, 5)),
            "preview": preview,
            "weight_error": draw(numbers(1e-9, 1e12)),
            "weight_jerk": draw(numbers(1e-12, 1e6)),
        },
        ik={
            "gamma_joint": draw(numbers(0.0, 1e3)),
            "gamma_grav": draw(numbers(0.0, 1e3)),
            "gamma_grav_ramp": draw(numbers(1e-3, 10.0)),
            "gamma_momentum": draw(numbers(0.0, 1.0)),
            "double_support": draw(st.sampled_from(["off", "shared", "optimal"])),
            "iterations": draw(st.none() | st.integers(0, 50)),
            "on_limit": draw(st.sampled_from(["hold", "refuse", "record"])),
        },
        n_steps=n_steps,
        step_length=draw(moving),
        lateral=draw(moving),
        step_yaw=draw(moving),
        step_width=draw(st.none() | numbers(1e-3, 2.0)),
        first_support=draw(st.sampled_from(["left", "right", None])),
        lead_in=draw(numbers(preview, longest)),
        double_support=draw(numbers(1e-3, longest)),
        single_support=draw(numbers(1e-3, longest)),
        lead_out=draw(numbers(preview, longest)),
        step_height=draw(numbers(1e-6, 0.5)),
        landing=draw(st.just(0.0) | numbers(0.0, 0.5)),
        com_height=draw(st.none() | numbers(1e-3, 3.0)),
        zmp_offset=draw(st.just([0.0, 0.0]) | st.lists(numbers(-1.0, 1.0), min_size=2, max_size=2)),
    )


BODY_TASKS = [
    "com_x", "com_y", "com_z", "torso_roll", "torso_pitch", "torso_yaw",
    "left_hand_x", "left_hand_y", "left_hand_z", "right_hand_x", "right_hand_y", "right_hand_z",
]  # fmt: skip


@st.composite
def channels(draw: st.DrawFn) -> dict[str, Any]:
    """One channel of up to 2 cm or 0.02 rad; four of them stay between the feet."""
    size, frequency = numbers(-0.02, 0.02), draw(numbers(0.05, 3.0))
    task = draw(st.sampled_from(BODY_TASKS))
    start = draw(numbers(0.0, 3.0))
    return draw(
        st.one_of(
            st.builds(constant, st.just(task), size),
            st.builds(sine, st.just(task), size, st.just(frequency), phase=numbers(-6.0, 6.0)),
            st.builds(ramp, st.just(task), size, st.just(start), numbers(start + 0.1, 4.0)),
            st.builds(
                figure_eight,
                st.sampled_from(["com", "left_hand", "right_hand"]),
                st.sampled_from(["xy", "xz", "yx", "yz", "zx", "zy"]),
                size,
                size,
                st.just(frequency),
            ),
        )
    )


@st.composite
def balances(draw: st.DrawFn) -> BalanceGait:
    """Balance motions of up to four channels, whether a robot can do them or not."""
    rest, ease = draw(numbers(0.0, 0.8)), draw(numbers(0.05, 1.0))
    return balance_gait(
        *draw(st.lists(channels(), min_size=1, max_size=4)),
        dt=draw(st.sampled_from([0.005, 0.01, 0.02])),
        rest=rest,
        ease=ease,
        duration=draw(numbers(2.0 * (rest + ease) + 0.1, 5.0)),
        com_height=draw(st.none() | numbers(0.2, 0.28)),
    )


def keyframes_gait(
    *keys: dict[str, Any], dt: float = 0.01, ik: dict[str, Any] | None = None, **frames: Any
) -> KeyframesGait:
    """Keyframes with the defaults of the gait file but for what is given."""
    tree = {"keys": list(keys), **frames}
    return KeyframesGait.model_validate(
        {"mgs": 1, "motion": "keyframes", "dt": dt, "keyframes": tree, "ik": ik or {}}
    )


def pick_up_gait(dt: float = 0.01, ik: dict[str, Any] | None = None, **pick_up: Any) -> PickUpGait:
    """A pick-up with the defaults of the gait file but for what is given."""
    return PickUpGait.model_validate(
        {"mgs": 1, "motion": "pick_up", "dt": dt, "pick_up": pick_up, "ik": ik or {}}
    )


UPPER_JOINTS = ["waist_yaw", "left_shoulder_pitch", "left_elbow_pitch"]  # of Melson


@st.composite
def keyframes(draw: st.DrawFn) -> KeyframesGait:
    """Keyframes of Melson with small displacements; the right hand may be led, the left not."""
    small = st.lists(numbers(-0.015, 0.015), min_size=3, max_size=3)
    rest = draw(numbers(0.0, 0.6))
    t, keys = rest, []
    for _ in range(draw(st.integers(1, 4))):
        t += draw(numbers(0.3, 1.5))
        key: dict[str, Any] = {"time": t, "hold": draw(st.just(0.0) | numbers(0.0, 0.5))}
        for name in ("com", "torso", "right_hand"):
            if draw(st.booleans()):
                key[name] = draw(small)
        if draw(st.booleans()):
            key["crouch"] = draw(numbers(-2.0, 8.0))
        if draw(st.booleans()):
            key["posture"] = {draw(st.sampled_from(UPPER_JOINTS)): draw(numbers(-0.9, -0.1))}
        key["rest"] = draw(st.booleans())
        keys.append(key)
        t += key["hold"]
    return keyframes_gait(*keys, rest=rest, dt=draw(st.sampled_from([0.01, 0.02])))
