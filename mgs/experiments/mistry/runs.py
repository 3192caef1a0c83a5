"""Runs of the experiments of Mistry et al., and measurements on them; see the package."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Side, Support
from mgs.core.geometry import rotation_angles
from mgs.core.progress import Progress
from mgs.core.spans import span_starts
from mgs.experiments.variant import BASE, Variant
from mgs.gait import load_gait
from mgs.ik_solver.floating.constraints import base_velocity
from mgs.ik_solver.floating.parts import SOLES
from mgs.ik_solver.floating.tasks import BodyTasks
from mgs.ik_solver.prioritized import Phase, PrioritizedReport
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot, load_robot

SWAY, EIGHT, WALK = "coman/sway", "coman/hand_eight", "melson/walk_5cm"
VELOCITY, ACCELERATION = "prioritized", "prioritized-acceleration"
TRACKING, PROJECTED = "tracking", "projected"
NO_FEEDBACK = 1e-9  # practically zero feedback of task errors
FINE_DT = 0.001  # [s]
WORLD_ALIGNED = pin.LOCAL_WORLD_ALIGNED


@dataclass(frozen=True)
class Key:
    """Identification of one run."""

    gait: str
    solver: str = VELOCITY
    null_space: str = TRACKING
    variant: str = ""  # one of VARIANTS


VARIANTS: dict[str, tuple[str, ...]] = {
    "": (),
    "fine": (f"dt={FINE_DT}",),
    "no feedback": (f"ik.prioritized.feedback={NO_FEEDBACK}",),
    "no handover": ("ik.prioritized.handover=0",),
}


@dataclass(frozen=True, eq=False)
class Study:
    """All runs of the experiment."""

    robot: Robot  # COMAN
    runs: dict[Key, Stages]

    def __getitem__(self, key: Key) -> Stages:
        """Run with this key."""
        return self.runs[key]


def all_keys() -> list[Key]:
    """Keys of all runs."""
    forms = [(s, n) for s in (VELOCITY, ACCELERATION) for n in (TRACKING, PROJECTED)]
    keys = [Key(gait, solver, null) for gait in (SWAY, EIGHT) for solver, null in forms]
    keys += [Key(SWAY, VELOCITY, TRACKING, "no feedback")]
    keys += [Key(SWAY, solver, TRACKING, "fine") for solver in (VELOCITY, ACCELERATION)]
    keys += [Key(WALK, VELOCITY, n, v) for n in (TRACKING, PROJECTED) for v in ("", "no handover")]
    keys += [Key(WALK, ACCELERATION)]
    return keys


def solve(progress: Progress | None = None, variant: Variant | None = None) -> Study:
    """Generate all runs; missed tasks are recorded instead of refused."""
    variant = variant or BASE
    robots = {name: variant.robot(load_robot(name)) for name in ("coman", "melson")}
    runs: dict[Key, Stages] = {}
    keys = all_keys()
    for i, key in enumerate(keys):
        settings = (
            f"ik.solver={key.solver}",
            f"ik.prioritized.null_space={key.null_space}",
            "ik.on_limit=record",
            *VARIANTS[key.variant],
            *variant.settings,
        )
        robot = robots[key.gait.split("/")[0]]
        runs[key] = run_stages(robot, load_gait(key.gait, settings), key.gait)
        if progress is not None:
            progress(i + 1, len(keys))
    return Study(robots["coman"], runs)


def horizontal_com_error(stages: Stages) -> float:
    """Largest horizontal distance of the CoM from its reference [m]."""
    motion = stages.motion
    return float(np.linalg.norm((motion.com - motion.com_ref)[:, :2], axis=1).max())


def sole_error(stages: Stages) -> float:
    """Largest distance [m] or rotation [rad] of a sole from its reference."""
    motion = stages.motion
    gap = np.linalg.norm((motion.soles - motion.soles_ref)[..., :3], axis=-1).max()
    return float(max(gap, rotation_angles(motion.soles[..., 3:], motion.soles_ref[..., 3:]).max()))


def hand_errors(stages: Stages) -> Array:
    """Distance (N,) of the right hand from its reference [m]."""
    motion = stages.motion
    gap = motion.hands[:, Side.RIGHT, :3] - motion.hands_ref[:, Side.RIGHT]
    return np.asarray(np.linalg.norm(gap, axis=1))


def base_velocity_gap(robot: Robot, stages: Stages) -> float:
    """Largest error of the base velocity by eq. (10) along a motion [m/s] or [rad/s].

    Both velocities are central differences of the motion, so that the error falls with dt^2.
    """
    motion = stages.motion
    tasks = BodyTasks(robot, SOLES)
    worst = 0.0
    for q, v in zip(motion.q[1:-1:10], motion.v[1:-1:10], strict=True):
        tasks.update(q)
        found = base_velocity(tasks.J, v[FLOATING_BASE_NV:])
        worst = max(worst, float(np.abs(found - v[:FLOATING_BASE_NV]).max()))
    return worst


def angle_gap(a: Stages, b: Stages) -> float:
    """Largest difference between the joint angles of two runs [rad]."""
    return float(np.abs(a.joints.angles - b.joints.angles).max())


def switch_accelerations(stages: Stages) -> tuple[float, float]:
    """Largest joint acceleration [rad/s^2] at support switches, and at all other samples."""
    tasks, dt = stages.tasks, stages.tasks.dt
    acceleration = np.abs(np.diff(stages.joints.angles, 2, axis=0)).max(axis=1) / dt**2
    near = np.zeros(len(acceleration), bool)
    for switch in span_starts(tasks.support)[1:]:
        near[switch - 2 : switch + 1] = True
    return float(acceleration[near].max()), float(acceleration[~near].max())


def edge_rows(robot: Robot, side: Side, points: list[tuple[float, float]]) -> list[Array]:
    """Velocity rows (3, 6 + n) of points (x, y) of a sole in the standing posture."""
    model, data = robot.model, robot.model.createData()
    pin.computeJointJacobians(model, data, robot.standing_q)
    frame = robot.sole_frames[side]
    placement = pin.updateFramePlacement(model, data, frame)
    J = pin.getFrameJacobian(model, data, frame, WORLD_ALIGNED)
    return [J[:3] - pin.skew(placement.rotation @ np.array([x, y, 0.0])) @ J[3:] for x, y in points]


def straight_legs(robot: Robot) -> Array:
    """Configuration (7 + n,) with the joints of both legs at zero."""
    q = robot.standing_q.copy()
    for group in ("left_leg", "right_leg"):
        for name in robot.spec.groups[group]:
            q[FLOATING_BASE_NQ + robot.joint_names.index(name)] = 0.0
    return q


def phases_of(stages: Stages) -> tuple[Phase, ...]:
    """Reported constraints of a run, once for each kind of phase."""
    return stages.joints.report_of(PrioritizedReport).phases


def swing_switches(stages: Stages) -> int:
    """Number of support switches."""
    return len(span_starts(stages.tasks.support != Support.DOUBLE)) - 1
