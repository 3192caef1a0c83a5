"""What can be said of a motion without simulating it.

Everything is computed anew from the joint angles and the base pose, so that a file is judged by
what its joints do, not by what it says of itself; only in double support are torques taken as
stored, since there they rest on the planned share of the load. Nothing is averaged away: each
check reports its worst value, when and where.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import (
    CONTACT_TOLERANCE,
    FLOATING_BASE_NQ,
    FLOATING_BASE_NV,
    FRICTION,
    GRAVITY,
    POSITION_TOLERANCE,
    ROTATION_TOLERANCE,
)
from mgs.core.contact import Side, Support
from mgs.core.geometry import polygon_margins, rotation_angles
from mgs.core.progress import Progress
from mgs.core.scene import ground_below
from mgs.core.spans import spans
from mgs.judge.wrench_feasibility import missing_wrenches
from mgs.judge.yaw_friction import yaw_moments
from mgs.motion import Motion
from mgs.motion.collisions import first_contact
from mgs.motion.dynamics import WholeBodyMotion, analyse, lowest_points
from mgs.motion.joint_load import available_torque, step_speeds
from mgs.robot.support_polygon import (
    corners_of_soles,
    in_support,
    on_ground,
    support_polygon,
    support_spans,
)

REST_SPEED = 0.05  # [rad/s] of a joint at the first and last sample
ANGLE_ROUNDING = 1e-9  # [rad]
# checks of how well soles, hands, torso and CoM follow their plan
TRACKING = ("sole_position", "sole_rotation", "hand_position", "torso_rotation", "com_position")
FORCE_TOLERANCE = 1e-6  # of the weight, that contact forces may miss


@dataclass(frozen=True)
class Check:
    """One figure of a motion against its limit."""

    name: str
    ok: bool
    value: float
    limit: float
    unit: str
    time: float | None  # [s] of the worst sample
    where: str  # joint, link or task

    def to_dict(self) -> dict[str, object]:
        """The check as plain data."""
        return asdict(self)


def check_motion(
    motion: Motion, progress: Progress | None = None, collision_step: int = 1
) -> list[Check]:
    """Every static check of a motion, worst value each.

    Args:
        motion: the motion.
        progress: called with samples done and samples in all.
        collision_step: collisions are looked for at every sample of this number; larger than 1 for
            a quick look at a long motion.
    """
    load_left = np.choose(motion.support, [0.5, 1.0, 0.0])  # by Support
    body = analyse(motion.robot, motion.q, motion.dt, load_left, motion.payload)
    double = motion.support[:, None] == Support.DOUBLE
    torque = np.where(double, motion.torque, body.torque)
    speed = step_speeds(motion)
    if not motion.gait.is_balanced:  # nothing is known of what bears the robot on the way
        return [
            joint_position(motion),
            _joint_speed(motion, speed),
            _self_collision(motion, progress, collision_step),
            _rest(motion, speed),
        ]
    corners, bears = corners_of_soles(motion.robot, body.soles), _bearing_corners(motion)
    checks = [
        joint_position(motion),
        _joint_speed(motion, speed),
        _joint_torque(motion, body, torque),
        _joint_torque_rms(motion, torque),
        _zmp_margin(motion, body),
        *contact_forces(motion, body),
        *yaw_friction(motion, body),
        _self_collision(motion, progress, collision_step),
        _sole_still(motion, corners, bears),
        _sole_ground(motion, corners),
        _sole_contact(motion, corners, bears),
        _sole_position(motion, body),
        _sole_rotation(motion, body),
        _hand_position(motion, body),
        _torso_rotation(motion, body),
        _com_position(motion, body),
        _rest(motion, speed),
    ]
    return [check for check in checks if check.name not in checks_left_out(motion)]


def checks_left_out(motion: Motion) -> tuple[str, ...]:
    """Checks that are not made, since nobody has planned what this motion should do."""
    return () if motion.gait.has_references else TRACKING


def zmp_margins(motion: Motion, zmp: Array, soles: Array | None = None) -> Array:
    """Signed distance (N,) of points (N, 2) to the edge of the support polygon [m].

    Infinite where both soles carry at unequal heights: there is no such polygon.

    `soles` (N, 2, 7) are those that the polygon is made of; None: as the motion states them.
    """
    soles = motion.soles if soles is None else soles
    margins = np.full(motion.n_samples, np.inf)
    uneven = is_uneven(motion)
    for span in support_spans(motion.robot, motion.soles_ref, motion.support):
        if uneven[span.start]:
            continue
        polygon = support_polygon(motion.robot, soles[span.start], span.support, span.bears)
        margins[span.start : span.end] = polygon_margins(zmp[span.start : span.end], polygon)
    return margins


def is_uneven(motion: Motion) -> NDArray[np.bool_]:
    """Whether both soles are in support (N,) and bear at unequal heights."""
    rise = np.diff(lowest_points(motion.robot, motion.soles_ref))[:, 0]
    return np.asarray((motion.support == Support.DOUBLE) & (np.abs(rise) > CONTACT_TOLERANCE))


def joint_position(motion: Motion) -> Check:
    """Least distance of a joint from its limits."""
    robot, angles = motion.robot, motion.q[:, FLOATING_BASE_NQ:]
    margin = np.minimum(angles - robot.lower, robot.upper - angles)
    k, j = np.unravel_index(np.argmin(margin), margin.shape)
    worst = float(margin[k, j])
    return Check(
        "joint_position",
        worst >= -ANGLE_ROUNDING,
        worst,
        0.0,
        "rad to the limit",
        float(k * motion.dt),
        robot.joint_names[j],
    )


def _joint_speed(motion: Motion, speed: Array) -> Check:
    """Speed (N - 1, n) from sample to sample, which is what a servo is asked for."""
    robot = motion.robot
    return _worst_joint(
        motion, "joint_speed", speed, np.broadcast_to(robot.speed_limit, speed.shape), "rad/s"
    )


def _joint_torque(motion: Motion, body: WholeBodyMotion, torque: Array) -> Check:
    """Torque against the speed-torque line; a servo that brakes has its stall torque."""
    robot, speed = motion.robot, body.v[:, FLOATING_BASE_NV:]
    available = available_torque(robot, torque, speed)
    return _worst_joint(motion, "joint_torque", np.abs(torque), available, "N m")


def _joint_torque_rms(motion: Motion, torque: Array) -> Check:
    robot = motion.robot
    rms = np.sqrt(np.mean(torque**2, axis=0))
    allowed = robot.lasting_torque
    j = int(np.argmax(rms / allowed))
    return Check(
        "joint_torque_rms",
        bool(rms[j] <= allowed[j]),
        float(rms[j]),
        float(allowed[j]),
        "N m",
        None,
        robot.joint_names[j],
    )


def _worst_joint(motion: Motion, name: str, value: Array, limit: Array, unit: str) -> Check:
    k, j = np.unravel_index(np.argmax(value / limit), value.shape)
    worst, allowed = float(value[k, j]), float(limit[k, j])
    where = motion.robot.joint_names[j]
    return Check(name, worst <= allowed, worst, allowed, unit, float(k * motion.dt), where)


def _zmp_margin(motion: Motion, body: WholeBodyMotion) -> Check:
    margins = zmp_margins(motion, body.zmp, body.soles)
    k = int(np.argmin(margins))
    where = f"{Support(motion.support[k]).label} support"
    worst = float(margins[k])
    return Check("zmp_margin", worst >= 0.0, worst, 0.0, "m", k * motion.dt, where)


def contact_forces(motion: Motion, body: WholeBodyMotion) -> list[Check]:
    """Whether both soles can bear the robot where they are at unequal heights; nothing elsewhere.

    What is missing is told in parts of the weight.
    """
    samples = np.flatnonzero(is_uneven(motion))
    if not len(samples):
        return []
    corners = corners_of_soles(motion.robot, body.soles)[samples].reshape(len(samples), 8, 3)
    missing = missing_wrenches(corners, body.wrench[samples]) / (GRAVITY * motion.robot.mass)
    i = int(np.argmax(missing))
    worst = float(missing[i])
    time = float(samples[i] * motion.dt)
    where = "both soles, at unequal heights"
    return [
        Check("contact_forces", worst <= FORCE_TOLERANCE, worst, FORCE_TOLERANCE, "", time, where)
    ]


def yaw_friction(motion: Motion, body: WholeBodyMotion) -> list[Check]:
    """Moment about the vertical against what friction under the only sole in support can give.

    The worst sample is the one of the largest ratio. Nothing for motions without single support:
    two soles hold each other from turning.
    """
    needed, available = yaw_moments(motion, body)
    samples = np.flatnonzero(np.isfinite(needed))
    if not len(samples):
        return []
    value, limit = np.abs(needed[samples]), available[samples]
    ratio = np.divide(value, limit, out=np.full(len(samples), np.inf), where=limit > 0.0)
    i = int(np.argmax(ratio))
    k = samples[i]
    where = f"{Support(motion.support[k]).label} support, friction {FRICTION:g}"
    worst, allowed = float(value[i]), float(limit[i])
    time = float(k * motion.dt)
    return [Check("yaw_friction", worst <= allowed, worst, allowed, "N m", time, where)]


def _self_collision(motion: Motion, progress: Progress | None, step: int) -> Check:
    """First of every `step`-th sample at which two bodies touch that may not."""
    found = first_contact(motion.robot, motion.q, step, progress)
    if found is None:
        return Check("self_collision", True, 0.0, 0.0, "contacts", None, "")
    return Check("self_collision", False, 1.0, 0.0, "contacts", found[0] * motion.dt, found[1])


def _bearing_corners(motion: Motion) -> NDArray[np.bool_]:
    """Whether each corner of each sole (N, 2, 4) bears by the plan."""
    planned = corners_of_soles(motion.robot, motion.soles_ref)
    return on_ground(planned) & in_support(motion.support)[..., None]


def _sole_still(motion: Motion, corners: Array, bears: NDArray[np.bool_]) -> Check:
    """Farthest that a corner of a sole moves while it bears."""
    travel = np.zeros((motion.n_samples, 2))
    for side in Side:
        for corner in range(4):
            path = corners[:, side, corner]
            for start, end in spans(bears[:, side, corner]):
                if bears[start, side, corner]:
                    moved = np.linalg.norm(path[start:end] - path[start], axis=-1)
                    travel[start:end, side] = np.maximum(travel[start:end, side], moved)
    return _worst_side(motion, "sole_still", travel, CONTACT_TOLERANCE, "m")


def _sole_ground(motion: Motion, corners: Array) -> Check:
    ground = ground_below(motion.scene.boxes, corners[..., :2])
    depth = np.maximum(ground - corners[..., 2].min(axis=-1), 0.0)
    return _worst_side(motion, "sole_ground", depth, CONTACT_TOLERANCE, "m below ground")


def _sole_contact(motion: Motion, corners: Array, bears: NDArray[np.bool_]) -> Check:
    """Highest corner, of those that bear by the plan, of a sole in support."""
    above = corners[..., 2] - ground_below(motion.scene.boxes, corners[..., :2])[..., None]
    height = np.where(bears, np.maximum(above, 0.0), 0.0).max(axis=-1)
    return _worst_side(motion, "sole_contact", height, CONTACT_TOLERANCE, "m above ground")


def _sole_position(motion: Motion, body: WholeBodyMotion) -> Check:
    gap = np.linalg.norm(body.soles[..., :3] - motion.soles_ref[..., :3], axis=-1)
    return _worst_side(motion, "sole_position", gap, POSITION_TOLERANCE, "m")


def _sole_rotation(motion: Motion, body: WholeBodyMotion) -> Check:
    angle = rotation_angles(body.soles[..., 3:], motion.soles_ref[..., 3:])
    return _worst_side(motion, "sole_rotation", angle, ROTATION_TOLERANCE, "rad")


def _hand_position(motion: Motion, body: WholeBodyMotion) -> Check:
    gap = np.linalg.norm(body.hands[..., :3] - motion.hands_ref, axis=-1)
    return _worst_side(motion, "hand_position", gap, POSITION_TOLERANCE, "m")


def _torso_rotation(motion: Motion, body: WholeBodyMotion) -> Check:
    angle = rotation_angles(body.torso[:, 3:], motion.torso_ref)
    k, limit = int(np.argmax(angle)), ROTATION_TOLERANCE
    worst = float(angle[k])
    return Check("torso_rotation", worst <= limit, worst, limit, "rad", k * motion.dt, "")


def _com_position(motion: Motion, body: WholeBodyMotion) -> Check:
    gap = np.linalg.norm(body.com - motion.com_ref, axis=-1)
    k = int(np.argmax(gap))
    limit = motion.gait.com_tolerance
    return Check(
        "com_position", bool(gap[k] <= limit), float(gap[k]), limit, "m", k * motion.dt, ""
    )


def _rest(motion: Motion, speed: Array) -> Check:
    """Fastest joint of speed (N - 1, n) at the two ends, where the robot is to be at rest."""
    ends = speed[[0, -1]]
    k, j = np.unravel_index(np.argmax(ends), ends.shape)
    worst = float(ends[k, j])
    time = float(k) * motion.duration
    return Check(
        "rest", worst <= REST_SPEED, worst, REST_SPEED, "rad/s", time, motion.robot.joint_names[j]
    )


def _worst_side(motion: Motion, name: str, value: Array, limit: float, unit: str) -> Check:
    k, side = np.unravel_index(np.argmax(value), value.shape)
    worst = float(value[k, side])
    return Check(
        name, worst <= limit, worst, limit, unit, float(k * motion.dt), Side(int(side)).label
    )
