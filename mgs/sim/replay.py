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

from mgs.core.errors import SimulationError
from mgs.core.foreign import told_as
from mgs.core.progress import Progress
from mgs.motion import Motion
from mgs.motion_file import read_motion
from mgs.robot import servo_sources
from mgs.sim.choice import choose_engines
from mgs.sim.conditions import Conditions, disturbed
from mgs.sim.engine import make_engine
from mgs.sim.figures import Trace, figures_of
from mgs.sim.one_robot import OneRobot
from mgs.sim.playback import play
from mgs.sim.prepare import Prepared, prepare
from mgs.sim.servo import servo_figures
from mgs.sim.settings import OUTSIDE, OWN_SERVOS, EngineName, ServoName, Settings
from mgs.sim.strike import Strike


@dataclass(frozen=True, eq=False)
class Replay:
    """One open-loop execution, measured; times are motion times."""

    engine: EngineName
    version: str
    settings: Settings  # as used: dt divides the sampling period
    servo: ServoName
    feed_forward: bool  # whether servos were told more than the planned joint angles
    assumed_stiffness: float  # of the feed-forward, relative to that of the servos
    unit: str | None  # physical robot whose errors the simulated one had; None: none
    corrected: bool  # whether the commands were corrected for them
    servo_sources: dict[str, str]  # of modelled servos: where their figures come from, by name
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
    one_robot: OneRobot | None = None,
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
        one_robot: physical robot whose errors the simulated one has; None: none.

    Raises:
        SimulationError: the engine is missing, has loaded another robot or diverged.
        ConfigError: robot.yaml gives a servo no stiffness.
        MotionFileError: the motion file is missing or damaged.
        TypeError: `motion` is of another type.
    """
    motion = read_motion(motion)
    engine = engine or choose_engines(None)[0]
    prepared = prepare(motion, engine, settings, servo, feed_forward, assumed_stiffness, one_robot)
    return replay_prepared(prepared, conditions, progress)


def replay_prepared(
    prepared: Prepared,
    conditions: Conditions | None = None,
    progress: Progress | None = None,
    with_contacts: bool = True,
) -> Replay:
    """Execute a prepared motion under conditions; for many replays of the same motion.

    Args:
        prepared: the motion, its engine and its servos.
        conditions: how robot, servos and floor differ from the plan's; None: not at all.
        progress: called with samples done and samples in all.
        with_contacts: whether the forces on the soles are read; without them the trace has NaN in
            their place, and so has `end_load`.

    Raises:
        SimulationError: the engine has loaded another robot or diverged.
    """
    started = time.perf_counter()
    motion, robot, settings = prepared.motion, prepared.motion.robot, prepared.settings
    engine, servo, one_robot = prepared.engine, prepared.servo, prepared.one_robot
    if conditions is not None:
        robot, settings = disturbed(robot, conditions), _disturbed_settings(settings, conditions)
    servos = None
    driven = servo  # by the engine, unless servos are evaluated outside of it
    if servo not in OWN_SERVOS[engine] or (one_robot is not None and servo == "pd"):
        gain = 1.0 if conditions is None else conditions.gain
        servos, driven = servo_figures(robot, servo, settings, gain), OUTSIDE
        servos = servos if one_robot is None else one_robot.with_errors(servos)
    simulator = make_engine(engine, robot, settings, driven, conditions, motion.scene)
    try:
        version = simulator.version
        with told_as(lambda what: SimulationError(f"{engine} has failed: {what}")):
            recording = play(prepared, simulator, servos, conditions, progress, with_contacts)
    finally:
        simulator.close()
    figures = figures_of(motion, recording)
    return Replay(
        engine=engine,
        version=version,
        settings=settings,
        servo=servo,
        feed_forward=prepared.feed_forward,
        assumed_stiffness=prepared.assumed_stiffness,
        unit=None if one_robot is None else one_robot.unit.name,
        corrected=one_robot is not None and one_robot.corrected,
        servo_sources=servo_sources(motion.robot) if servo == "model" else {},
        wall_seconds=time.perf_counter() - started,
        **_clip_figures(prepared),
        **figures,
    )


def _clip_figures(prepared: Prepared) -> dict[str, Any]:
    clipped, names = prepared.clipped, prepared.motion.robot.joint_names
    worst = int(clipped.argmax())
    return {
        "command_clipped_deg": float(np.degrees(clipped[worst])),
        "command_clipped_joint": names[worst] if clipped[worst] else None,
    }


def _disturbed_settings(settings: Settings, conditions: Conditions) -> Settings:
    sag = conditions.sag * settings.sag
    return dataclasses.replace(settings, friction=conditions.friction, sag=sag)
