"""Everything that a page shows of a motion, as plain data for its script.

A long motion is thinned out to `MOST_SAMPLES` samples. Of what is judged by its worst value, each
sample that is kept has the worst value of the stretch that it stands for, so that no peak is lost.

The contact force is that of Newton's law, m (a_com + g); of a motion without balance, of whose
contacts nothing is known, neither forces nor torques are shown.
"""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV, GRAVITY
from mgs.core.contact import Support
from mgs.judge.motion_checks import zmp_margins
from mgs.motion import Motion
from mgs.motion.dynamics import lowest_points
from mgs.motion.energy import energy_of, positive_power
from mgs.motion_file.transforms import link_tree
from mgs.report.page.arrays import packed, packed_codes
from mgs.robot import Robot
from mgs.robot.support_polygon import support_polygon, support_spans

MOST_SAMPLES = 16_000


def kept_samples(n_samples: int, most: int = MOST_SAMPLES) -> NDArray[np.intp]:
    """Samples to show: every k-th one, and the last one."""
    stride = max(1, math.ceil((n_samples - 1) / max(most - 1, 1)))
    return np.unique(np.append(np.arange(0, n_samples, stride), n_samples - 1))


def motion_arrays(motion: Motion, kept: NDArray[np.intp]) -> dict[str, Any]:
    """Arrays over time at the kept samples (m,)."""
    arrays = {
        "t": packed(motion.times[kept], "f4"),
        "base": packed(motion.q[kept, :3], "f4"),
        "turn": packed(motion.q[kept, 3:FLOATING_BASE_NQ]),
        "q": packed(motion.q[kept, FLOATING_BASE_NQ:]),
        "v": packed(_peaks(motion.v[:, FLOATING_BASE_NV:], kept)),
        "com": packed(motion.com[kept], "f4"),
        "support": packed_codes(motion.support[kept], "u1"),
    }
    if motion.gait.is_balanced:
        margins = zmp_margins(motion, motion.zmp)
        margins = np.where(np.isfinite(margins), margins, np.nan)
        power = positive_power(motion)
        arrays |= {
            "torque": packed(_peaks(motion.torque, kept)),
            "power": packed(_peaks(power[:, None], kept)),
            "energy": packed((np.cumsum(power) * motion.dt)[kept], "f4"),
            "zmp": packed(motion.zmp[kept], "f4"),
            "zmp_ref": packed(motion.zmp_ref[kept], "f4"),
            "margin": packed(np.fmin.reduceat(margins, kept), "f4"),
            "force": packed(contact_force(motion)[kept]),
        }
    return arrays


def contact_force(motion: Motion) -> Array:
    """Force (N, 3) that the ground has to exert [N]; at rest before the motion and after it."""
    steps = np.zeros((motion.n_samples + 1, 3))
    steps[1:-1] = np.diff(motion.com, axis=0) / motion.dt
    acceleration = np.diff(steps, axis=0) / motion.dt
    return np.asarray(motion.robot.mass * (acceleration + np.array([0.0, 0.0, GRAVITY])))


def _peaks(values: Array, kept: NDArray[np.intp]) -> Array:
    """Values (m, c) of largest magnitude in the stretches that begin at the kept samples."""
    high = np.maximum.reduceat(values, kept, axis=0)
    low = np.minimum.reduceat(values, kept, axis=0)
    return np.where(high >= -low, high, low)


def robot_tree(robot: Robot) -> dict[str, Any]:
    """Links as `mgs.motion_file.transforms.LinkTree` has them, with the limits of the joints."""
    tree = link_tree(robot)
    groups = {name: group for group, names in robot.spec.groups.items() for name in names}
    moving = [
        {
            "parent": parent,
            "link": child,
            "joint": int(tree.index[i]) - FLOATING_BASE_NQ,
            "position": tree.position[i].tolist(),
            "quat": tree.quat[i].tolist(),
            "turn": tree.turn[i].tolist(),
        }
        for i, (parent, child) in enumerate(tree.moving)
    ]
    fixed = [
        {"parent": parent, "link": child, "pose": pose.tolist()}
        for (parent, child), pose in zip(tree.fixed, tree.fixed_poses, strict=True)
    ]
    joints = [
        {
            "name": name,
            "group": groups.get(name, "other"),
            "lower": float(robot.lower[i]),
            "upper": float(robot.upper[i]),
            "speed": float(robot.speed_limit[i]),
            "torque": float(robot.torque_limit[i]),
        }
        for i, name in enumerate(robot.joint_names)
    ]
    return {"root": tree.root, "moving": moving, "fixed": fixed, "joints": joints}


def ground_data(motion: Motion) -> dict[str, Any]:
    """Footsteps, support polygons, boxes and balls."""
    soles = [motion.robot.sole_spec(side) for side in Support.DOUBLE.sides]
    return {
        "soles": [[sole.length, sole.width] for sole in soles],
        "footsteps": [
            [int(step.side), *_rounded([step.x, step.y, step.z, step.yaw])]
            for step in motion.footsteps
        ],
        "polygons": _polygons(motion) if motion.gait.is_balanced else [],
        "boxes": [
            _rounded([box.x, box.y, box.yaw, box.length, box.width, box.height])
            for box in motion.scene.boxes
        ],
        "balls": [
            _rounded([ball.x, ball.y, ball.radius, ball.time]) for ball in motion.scene.balls
        ],
    }


def _polygons(motion: Motion) -> list[dict[str, Any]]:
    """Each support polygon: its start [s], its height and its corners [m]."""
    found = []
    for span in support_spans(motion.robot, motion.soles, motion.support):
        soles, sides = motion.soles[span.start], list(span.support.sides)
        corners = support_polygon(motion.robot, soles, span.support, span.bears)
        height = float(lowest_points(motion.robot, soles[None])[0, sides].mean())
        entry = {"t": span.start * motion.dt, "z": round(height, 5), "points": _rounded(corners)}
        found.append(entry)
    return found


def _rounded(values: Any) -> Any:
    """Lengths as lists of numbers with a resolution of 10 micrometres."""
    return np.round(np.asarray(values, dtype=np.float64), 5).tolist()


def facts(motion: Motion) -> list[list[str]]:
    """Label and text of what matters most about a motion."""
    robot, made = motion.robot, motion.provenance
    energy = energy_of(motion)
    travel = motion.soles[-1, :, :2].mean(axis=0) - motion.soles[0, :, :2].mean(axis=0)
    distance = float(np.hypot(*travel)) if motion.gait.is_balanced else 0.0
    rows = [
        ["Gait", f"{motion.gait_name} ({motion.gait.motion})"],
        ["Robot", f"{robot.spec.name}, {robot.n} joints, {robot.mass:.2f} kg"],
        ["Solver", made.solver.name],
        ["Duration", f"{motion.duration:.2f} s, {motion.n_samples} samples of {motion.dt:g} s"],
    ]
    if made.com_generator is not None:
        rows.insert(3, ["CoM generator", made.com_generator.name])
    if len(motion.footsteps) > 2:
        rows.append(["Steps", str(len(motion.footsteps) - 2)])
    if distance > 1e-3:
        speed = distance / motion.duration
        rows.append(["Distance", f"{distance:.3f} m, mean speed {speed:.3f} m/s"])
    if energy is not None:
        told = f"{energy.positive_work:.3g} J given by the joints"
        if energy.cost_of_transport is not None:
            told += f", cost of transport {energy.cost_of_transport:.3g}"
        rows.append(["Energy", told])
    return rows


def provenance_text(motion: Motion) -> str:
    """How the motion was made, as indented JSON."""
    return json.dumps(motion.provenance.to_dict(), indent=2, default=str, allow_nan=False)
