"""How a replay is simulated: engines, steps, servo gains; docs/simulation.md says why so."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Literal

from mgs.core.engines import ENGINES, EngineName

__all__ = ["DEFAULTS", "ENGINES", "SERVOS", "EngineName", "ServoName", "Settings"]

ServoName = Literal["ideal", "model", "pd"]
SERVOS: tuple[ServoName, ...] = ("ideal", "model", "pd")
# Servos that an engine simulates by itself; all others are evaluated outside, once a step.
OUTSIDE: ServoName = "model"  # what an engine is told of servos that are evaluated outside
OWN_SERVOS: dict[EngineName, tuple[ServoName, ...]] = {
    "pybullet": ("ideal",),
    "mujoco": ("ideal", "pd"),
}

# Longest physics step [s] with friction that depends on the load: without rotors, feet in contact
# jitter in PyBullet, and jitter loosens what dry friction holds.
LOAD_FRICTION_STEP: dict[EngineName, float] = {"pybullet": 0.00025, "mujoco": 0.0005}

# Shortest physics step [s] of replays under random conditions, and the servos that bear it. One
# replay does not decide there, and the rate of survival is that of half the step.
DRAW_STEP = 0.001
BEAR_DRAW_STEP: dict[EngineName, tuple[ServoName, ...]] = {
    "pybullet": SERVOS,
    "mujoco": OWN_SERVOS["mujoco"],
}


@dataclass(frozen=True, kw_only=True)
class Settings:
    """How a replay is simulated.

    The ideal servo is a spring and a damper, clipped at its stall torque:
    torque = stall_torque * stiffness * ((q_plan - q) + damping * (v_plan - v)).

    The PD servo has no speed target and is limited by the line from stall torque to no-load speed:
    torque = stall_torque / sag * ((q_plan - q) - damping_time * v).
    """

    dt: float  # longest step [s]; a replay uses the next one that divides the sampling period
    iterations: int  # of the contact solver: of PyBullet exactly, of MuJoCo at most
    stiffness: float  # stall torques per angle [1/rad]; 300: all of it at 0.2 deg
    damping: float  # time in which the spring goes slack against its damper [s]
    friction: float = 1.0  # effective Coulomb coefficient of the pair sole and ground
    settle: float = 0.5  # first posture held before the motion [s]
    tail: float = 1.0  # last posture held after the motion [s]
    sag: float = math.radians(1.0)  # error of a PD servo at stall torque [rad]
    damping_time: float = 0.01  # damping of a PD servo, relative to its stiffness [s]


DEFAULTS: dict[EngineName, Settings] = {
    # PyBullet's rigid motors bear a slow damper only, a quick one hunts against the robot's own
    # inertia. They yield to lasting loads alone, such as two feet that press on each other. With
    # steps of 1 ms soles creep and turn, docs/simulation.md#steps-of-pybullet.
    "pybullet": Settings(dt=0.0005, iterations=50, stiffness=1000.0, damping=0.3),
    "mujoco": Settings(dt=0.0005, iterations=50, stiffness=300.0, damping=0.02),
}


def settings_of_draws(engine: EngineName, servo: ServoName, settings: Settings) -> Settings:
    """Settings of replays under random conditions; every draw has them, however it is replayed."""
    if servo not in BEAR_DRAW_STEP[engine]:
        return settings
    return dataclasses.replace(settings, dt=max(settings.dt, DRAW_STEP))
