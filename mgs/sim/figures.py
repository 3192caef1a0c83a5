"""What a recorded replay shows: mgs.sim.replay says what the figures mean."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, GRAVITY
from mgs.core.geometry import wrap_angle
from mgs.core.short_repr import short_repr
from mgs.motion import Motion
from mgs.sim.measure import angle_between, largest_slip, travel
from mgs.sim.playback import Recording
from mgs.sim.poses import fallen
from mgs.sim.strike import measure_strike

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
    contacts: Array  # (M, 2, 5) of the soles: force x, y, z [N], first moments x, y [N m], or NaN
    balls: Array  # (M, b, 6) positions and velocities of the balls of the scene
    tilt: Array  # (M,) of the torso against the plan [rad]

    __repr__ = short_repr


def figures_of(motion: Motion, recording: Recording) -> dict[str, Any]:
    """Figures of a recorded replay by their names in `mgs.sim.replay.Replay`."""
    q, q_plan = recording.q, motion.q[recording.plan]
    soles, up, up_plan = recording.soles, recording.up, recording.up_plan
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
        **_slip_figures(motion, soles[:fall], recording.plan[:fall]),
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


def _slip_figures(motion: Motion, soles: Array, plan: NDArray[np.intp]) -> dict[str, Any]:
    slip = largest_slip(soles, motion.soles_ref[plan], motion.support[plan], motion.dt)
    return {
        "sole_slip_max": slip.distance,
        "sole_slip_side": None if slip.side is None else slip.side.label,
        "sole_slip_time": None if slip.sample is None else slip.sample * motion.dt,
    }
