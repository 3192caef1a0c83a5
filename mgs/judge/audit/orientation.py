"""In which order a file gives the quaternion of the base: that in which the robot stands.

Two popular layouts have the same shape and different orders. In the wrong order the base is turned
about another axis, often by half a turn, so that soles tilt, leave the floor or slide. How far the
sole that is lower does so is compared for all orders.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Side
from mgs.core.scene import Box, ground_below
from mgs.judge.audit.finding import Finding
from mgs.judge.audit.given import GivenMotion
from mgs.judge.audit.tree import frame_poses, joint_poses
from mgs.robot import Robot

# A score is 1 where the lower sole tilts by 0.1 rad, slides at 0.1 m/s or goes up and down by 2 cm
TILT, SPEED, HEIGHT = 0.1, 0.1, 0.02
UNLIKELY = 0.5  # score above which an order may be wrong
BETTER = 4.0  # times smaller has the score of another order to be
MOST_SAMPLES = 400  # that are looked at
# of the columns in the file: the order in which they are x, y, z, w
ORDERS = {"xyzw": (0, 1, 2, 3), "wxyz": (1, 2, 3, 0)}
# read as xyzw: what the numbers may have been, by how many places they have to be rolled
ROLLS = {"wxyz read as xyzw": -1, "xyzw read as wxyz": 1}


def standing_score(robot: Robot, q: Array, dt: float, boxes: tuple[Box, ...] = ()) -> float:
    """How unlike standing and walking on soles the motion q (T, 7 + n) is; about 0: not at all.

    Heights are those above the boxes, such as stairs, that the centres of the soles are on.
    """
    stride = max(1, len(q) // MOST_SAMPLES)
    pairs = np.unique(np.minimum([np.arange(0, len(q), stride), np.arange(0, len(q), stride) + 1],
                                 len(q) - 1))  # fmt: skip
    poses = joint_poses(robot, q[pairs])
    placed = [frame_poses(robot, poses, robot.sole_frames[side]) for side in Side]
    height = np.stack([p[:, 2] - _ground(boxes, p) for _, p in placed], axis=1)
    low = height.argmin(axis=1)
    k = np.arange(len(pairs))
    R = np.stack([R for R, _ in placed], axis=1)[k, low]
    p = np.stack([p for _, p in placed], axis=1)
    tilt = np.arccos(np.clip(R[:, 2, 2], -1.0, 1.0))
    next_to = np.diff(pairs) == 1
    same = next_to & (low[1:] == low[:-1])
    moved = np.linalg.norm((p[k[1:], low[:-1]] - p[k[:-1], low[:-1]])[:, :2], axis=1) / dt
    speed = moved[same].mean() if same.any() else 0.0
    lowest = height.min(axis=1)
    parts = (tilt.mean() / TILT, float(speed) / SPEED, float(np.std(lowest)) / HEIGHT)
    return float(sum(parts))


def _ground(boxes: tuple[Box, ...], points: Array) -> Array:
    """Heights (T,) of the ground below points (T, 3)."""
    around = 1e-3 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return ground_below(boxes, points[:, None, :2] + around)


def order_findings(given: GivenMotion) -> list[Finding]:
    """A finding if the robot stands in another order of its quaternions and not in this one."""
    if given.n_samples < 3:
        return []
    as_read = standing_score(given.robot, given.q, given.dt, given.scene.boxes)
    if as_read < UNLIKELY:
        return []
    for name, places in ROLLS.items():
        q = given.q.copy()
        q[:, 3:7] = np.roll(q[:, 3:7], places, axis=1)
        score = standing_score(given.robot, q, given.dt, given.scene.boxes)
        if score * BETTER < as_read:
            end = given.dt * (given.n_samples - 1)
            return [Finding("quaternion_order", 0.0, end, 0.0, as_read, UNLIKELY, "", name)]
    return []
