"""Open-loop replay of a motion in physics, measured against the plan.

Distances are displacements of the midpoint between the soles, from the settled start to the end of
the tail; yaw errors likewise, of the mean heading of the soles. Tilt is the angle between the
vertical as the simulated torso sees it and as the planned torso sees it at the same time: a turn
about the vertical is no tilt. A robot has fallen where that angle exceeds 45 deg or its base is
below 60 % of its planned height; in a motion without balance it has fallen unless it stands at the
end of the tail, the torso within 10 deg of upright and a fifth of the weight on each sole. Slip is
the horizontal displacement of a sole within one of its support phases in the plan. The limit of an
ideal servo is its stall torque, that of any other the line from stall torque to no-load speed.
"""

from __future__ import annotations

import dataclasses
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, GRAVITY
from mgs.core.errors import SimulationError
from mgs.core.geometry import wrap_angle
from mgs.core.progress import Progress
from mgs.core.short_repr import short_repr
from mgs.motion import Motion
from mgs.motion.servo_commands import Commands, servo_commands
from mgs.motion_file import read_motion
from mgs.sim.choice import choose_engines
from mgs.sim.conditions import Conditions, disturbed
from mgs.sim.engine import make_engine, require
from mgs.sim.measure import angle_between, largest_slip, travel
from mgs.sim.playback import Recording, fallen, play, poses_along
from mgs.sim.servo import servo_figures
from mgs.sim.settings import DEFAULTS, OWN_SERVOS, SERVOS, EngineName, ServoName, Settings
from mgs.sim.strike import Strike, measure_strike

STANDING_TIME = 0.3  # [s] at the end of a motion without balance
STANDING_TILT_DEG = 10.0
STANDING_LOAD = 0.2  # of the weight, on each sole


@dataclass(frozen=True, eq=False)
class Trace:
    """What happened at the M samples of the motion and its tail, from the settled start on.

    World frame, SI units. M is smaller than planned if the robot fell.
    """

    t: Array  # (M,) motion time
    plan: NDArray[np.intp]  # (M,) sample of the motion; the last one stays during the tail
    q: Array  # (M, 7 + n) base position, base quaternion xyzw, joint angles
    torque: Array  # (M, n) of the servos, mean over the sampling period before
    soles: Array  # (M, 2, 7) x, y, z, quaternion xyzw
    contacts: Array  # (M, 2, 5) of the soles: force x, y, z [N], first moments x, y [N m]
    balls: Array  # (M, b, 6) positions and velocities of the balls of the scene
    tilt: Array  # (M,) of the torso against the plan [rad]

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class Replay:
    """One open-loop execution, measured; times are motion times."""

    engine: EngineName
    version: str
    settings: Settings  # as used: dt divides the sampling period
    servo: ServoName
    feed_forward: bool  # whether servos were told more than the planned joint angles
    assumed_stiffness: float  # of the feed-forward, relative to that of the servos
    command_clipped_deg: float  # by how much a joint limit cuts a command at most
    command_clipped_joint: str | None
    is_balanced: bool  # whether the motion claims to stand all the way
    fell: bool
    fall_time: float | None  # [s]
    distance: tuple[float, float]  # x, y [m]
    planned_distance: tuple[float, float]  # x, y [m]
    position_error: float  # of the two distances [m]
    yaw_error_deg: float
    settled_tilt_deg: float  # at the settled start, before the motion
    max_tilt_deg: float
    max_tilt_time: float  # [s]
    end_tilt_deg: float  # over the last `STANDING_TIME`, at most
    end_load: float  # of the less loaded sole, over the same time, as a part of the weight
    min_base_height: float  # [m]
    joint_error_rms_deg: float  # over all samples and joints
    joint_error_max_deg: float
    torque_saturation: float  # longest time in a row that any servo is at its limit [s]
    torque_saturation_joint: str | None
    torque_saturation_time: float | None  # when that time was over [s]
    torque_rms: dict[str, float]  # by joint [N m]
    torque_peak: dict[str, float]  # by joint [N m]
    sole_slip_max: float  # [m]
    sole_slip_side: str | None
    sole_slip_time: float | None  # [s]
    strikes: tuple[Strike, ...]  # of the balls of the scene
    wall_seconds: float
    trace: Trace

    def __repr__(self) -> str:
        fate = f"fell at {self.fall_time:.2f} s" if self.fell else "stays up"
        apart = f"{1e3 * self.position_error:.1f} mm and {self.yaw_error_deg:.2f} deg"
        return f"<Replay in {self.engine}, servos {self.servo}: {fate}, ends {apart} off its plan>"

    def to_json(self) -> dict[str, object]:
        """Plain dict of all figures, without the trace."""
        fields = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        del fields["trace"]
        fields["settings"] = dataclasses.asdict(self.settings)
        fields["strikes"] = [dataclasses.asdict(strike) for strike in self.strikes]
        return {key: list(v) if isinstance(v, tuple) else v for key, v in fields.items()}


def replay(
    motion: Motion | str | Path,
    engine: EngineName | None = None,
    settings: Settings | None = None,
    progress: Progress | None = None,
    *,
    servo: ServoName = "ideal",
    feed_forward: bool | None = None,
    assumed_stiffness: float = 1.0,
    conditions: Conditions | None = None,
) -> Replay:
    """Execute a motion open loop in a physics engine.

    Args:
        motion: what the servos are told: a motion or the path of a motion file.
        engine: "pybullet" or "mujoco"; None: the first of them that is installed.
        settings: None for the engine's defaults.
        progress: called with samples done and samples in all.
        servo: "ideal", "pd" for the PD servos of the settings, or "model" for the servos that
            robot.yaml describes.
        feed_forward: whether servos are told the commands of `mgs.motion.servo_commands`
            rather than the planned joint angles; None: modelled ones are.
        assumed_stiffness: stiffness that the feed-forward commands are computed for, relative to
            that of the servos.
        conditions: how robot, servos and floor differ from the plan's; None: not at all.

    Raises:
        SimulationError: the engine is missing, has loaded another robot or diverged.
        ConfigError: robot.yaml gives a servo no stiffness.
        MotionFileError: the motion file is missing or damaged.
        TypeError: `motion` is of another type.
    """
    motion = read_motion(motion)
    started = time.perf_counter()
    engine = engine or choose_engines(None)[0]
    require(engine)
    if servo not in SERVOS:
        raise SimulationError(f"no servo {servo!r}; there are: {', '.join(SERVOS)}")
    settings = _divide(settings or DEFAULTS[engine], motion.dt)
    feed_forward = servo == "model" if feed_forward is None else feed_forward
    commands = None
    if feed_forward:
        assumed = servo_figures(motion.robot, servo, settings, assumed_stiffness)
        commands = servo_commands(motion, servos=assumed)
    robot = motion.robot
    if conditions is not None:
        robot, settings = disturbed(robot, conditions), _disturbed_settings(settings, conditions)
    servos = None
    if servo not in OWN_SERVOS[engine]:
        gain = 1.0 if conditions is None else conditions.gain
        servos = servo_figures(robot, servo, settings, gain)
    simulator = make_engine(engine, robot, settings, servo, conditions, motion.scene)
    try:
        version = simulator.version
        recording = play(motion, simulator, settings, progress, servos, commands, conditions)
    finally:
        simulator.close()
    figures = _figures(motion, recording)
    wall_seconds = time.perf_counter() - started
    return Replay(
        engine=engine,
        version=version,
        settings=settings,
        servo=servo,
        feed_forward=feed_forward,
        assumed_stiffness=assumed_stiffness,
        wall_seconds=wall_seconds,
        **_clip_figures(motion, commands),
        **figures,
    )


def _clip_figures(motion: Motion, commands: Commands | None) -> dict[str, Any]:
    clipped = np.zeros(motion.robot.n) if commands is None else commands.clipped
    worst = int(clipped.argmax())
    return {
        "command_clipped_deg": float(np.degrees(clipped[worst])),
        "command_clipped_joint": motion.robot.joint_names[worst] if clipped[worst] else None,
    }


def _disturbed_settings(settings: Settings, conditions: Conditions) -> Settings:
    sag = conditions.sag * settings.sag
    return dataclasses.replace(settings, friction=conditions.friction, sag=sag)


def _divide(settings: Settings, period: float) -> Settings:
    """Settings with the longest step that is no longer and divides the sampling period [s]."""
    n_steps = max(1, int(np.ceil(period / settings.dt - 1e-9)))
    return dataclasses.replace(settings, dt=period / n_steps)


def _figures(motion: Motion, recording: Recording) -> dict[str, Any]:
    q, q_plan = recording.q, motion.q[recording.plan]
    soles, up = poses_along(motion.robot, q)
    _, up_plan = poses_along(motion.robot, q_plan)
    tilt = angle_between(up, up_plan)
    last = slice(-max(1, round(STANDING_TIME / motion.dt)), None)
    end_tilt = float(np.degrees(tilt[last].max()))
    weight = GRAVITY * motion.robot.mass
    end_load = float((recording.contacts[last, :, 2].mean(axis=0) / weight).min())
    if motion.gait.is_balanced:
        down = np.flatnonzero(fallen(up, up_plan, q[:, 2], q_plan[:, 2]))
        fall = int(down[0]) if len(down) else None
    else:
        stands = end_tilt <= STANDING_TILT_DEG and end_load >= STANDING_LOAD
        fall = None if stands else len(q) - 1
    t = np.arange(len(q), dtype=np.float64) * motion.dt
    return {
        "is_balanced": motion.gait.is_balanced,
        "end_tilt_deg": end_tilt,
        "end_load": end_load,
        "fell": fall is not None,
        "fall_time": None if fall is None else float(t[fall]),
        "settled_tilt_deg": float(np.degrees(tilt[0])),
        "max_tilt_deg": float(np.degrees(tilt.max())),
        "max_tilt_time": float(t[tilt.argmax()]),
        "min_base_height": float(q[:, 2].min()),
        "trace": Trace(
            t,
            recording.plan,
            q,
            recording.torque,
            soles,
            recording.contacts,
            recording.balls,
            tilt,
        ),
        "strikes": tuple(
            measure_strike(ball, recording.balls[:, i], soles, motion.dt)
            for i, ball in enumerate(motion.scene.balls)
        ),
        **_travel_figures(motion, soles),
        **_joint_figures(q - q_plan),
        **_effort_figures(motion, recording),
        **_slip_figures(soles[:fall], motion.support[recording.plan[:fall]], motion.dt),
    }


def _travel_figures(motion: Motion, soles: Array) -> dict[str, Any]:
    """Displacements over the whole plan, even if the replay ended early."""
    done, planned = travel(soles), travel(motion.soles)
    return {
        "distance": (float(done[0]), float(done[1])),
        "planned_distance": (float(planned[0]), float(planned[1])),
        "position_error": float(np.linalg.norm(done[:2] - planned[:2])),
        "yaw_error_deg": float(np.degrees(wrap_angle(done[2] - planned[2]))),
    }


def _joint_figures(difference: Array) -> dict[str, Any]:
    errors_deg = np.degrees(difference[:, FLOATING_BASE_NQ:])
    return {
        "joint_error_rms_deg": float(np.sqrt(np.square(errors_deg).mean())),
        "joint_error_max_deg": float(np.abs(errors_deg).max()),
    }


def _effort_figures(motion: Motion, recording: Recording) -> dict[str, Any]:
    names, effort = motion.robot.joint_names, recording.effort
    worst = int(effort.saturation.argmax())
    saturation = float(effort.saturation[worst])
    return {
        "torque_saturation": saturation,
        "torque_saturation_joint": names[worst] if saturation > 0.0 else None,
        "torque_saturation_time": float(effort.saturation_end[worst]) if saturation > 0.0 else None,
        "torque_rms": dict(zip(names, effort.rms.tolist(), strict=True)),
        "torque_peak": dict(zip(names, effort.peak.tolist(), strict=True)),
    }


def _slip_figures(soles: Array, support: NDArray[np.int8], dt: float) -> dict[str, Any]:
    slip = largest_slip(soles, support, dt)
    return {
        "sole_slip_max": slip.distance,
        "sole_slip_side": None if slip.side is None else slip.side.label,
        "sole_slip_time": None if slip.sample is None else slip.sample * dt,
    }
