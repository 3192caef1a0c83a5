"""A recorded motion on a robot: its joints by name or order, its base, its rate, its quaternions.

What is not in the file and cannot be found out is asked for; what was decided is told.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.errors import ConfigError
from mgs.core.limits import MAX_RATE
from mgs.core.short_repr import short_repr
from mgs.judge.audit.given import GivenMotion, StatedLinks
from mgs.judge.audit.orientation import BETTER, standing_score
from mgs.judge.recorded.base import with_base
from mgs.motion.dynamics import align_quaternion_signs
from mgs.motion_file.formats import RecordedLinks, RecordedMotion
from mgs.robot import Robot
from mgs.robot.orders import Order, robot_order

QuaternionOrder = Literal["xyzw", "wxyz"]
LEAST_FRAMES = 2
LEAST_RATE = 10.0  # [Hz]: a sampling period of 0.1 s is the longest that a motion file has
SAME_RATE = 1e-3  # relative
UPRIGHT = 0.9  # mean size of one of the four numbers that tells the scalar part
# layouts that give quaternions as w, x, y, z; all others have the scalar part last
TWO_ORDERS = ("unitree-csv",)  # tables of the same shape are written in both orders
SCALAR_FIRST = ("beyondmimic", "mjlab", "holosoma", "isaaclab-amp", "locomujoco", "sonic")


@dataclass(frozen=True)
class Choices:
    """What a user says of a file, where it is not to be found out."""

    fps: float | None = None  # [Hz]
    order: Order | None = None  # of joints without names
    quaternion: QuaternionOrder | None = None  # of the base
    degrees: bool = False  # angles and speeds of joints, in a table


@dataclass(frozen=True, eq=False)
class Placed:
    """A recorded motion on a robot."""

    given: GivenMotion
    base: Literal["file", "contacts"]
    notes: tuple[str, ...]  # what was decided
    score: float  # how unlike standing and walking it is, see `standing_score`

    __repr__ = short_repr


def place_recorded(recorded: RecordedMotion, robot: Robot, choices: Choices, source: str) -> Placed:
    """The motion of a file on a robot.

    Raises:
        ConfigError: joints, rate or quaternions are unknown or do not fit the robot, or there is
            one frame only.
    """
    if recorded.n_frames < LEAST_FRAMES:
        raise ConfigError(
            source, f"has {recorded.n_frames} frame; a motion has at least {LEAST_FRAMES}"
        )
    notes = list(recorded.notes)
    if choices.degrees:
        recorded = _in_radians(recorded, source)
        notes.append("joint angles taken in degrees, as asked for")
    fps = _rate(recorded, choices, source, notes)
    joints, velocity = _joints(recorded, robot, choices, source, notes)
    base: Literal["file", "contacts"] = "file"
    if recorded.base_position is None or recorded.base_quat_xyzw is None:
        base = "contacts"
        q = with_base(robot, joints)
        notes.append(
            "the base is not in the file; it was found from the contacts: the lower sole stands "
            "flat and still on the floor"
        )
    else:
        q = np.hstack([recorded.base_position, recorded.base_quat_xyzw, joints])
        q[:, 3:FLOATING_BASE_NQ] = _in_order(
            q, recorded.layout, robot, 1.0 / fps, choices, source, notes
        )
    align_quaternion_signs(q[:, 3:FLOATING_BASE_NQ])
    given = GivenMotion(
        robot=robot,
        dt=1.0 / fps,
        q=q,
        joint_velocity=velocity,
        base_linear=recorded.base_linear_velocity,
        base_angular=recorded.base_angular_velocity,
        angular_frame="world",
        links=_links(recorded, recorded.links, robot),
    )
    return Placed(given, base, tuple(notes), standing_score(robot, q, 1.0 / fps))


def _in_radians(recorded: RecordedMotion, source: str) -> RecordedMotion:
    """The motion of a table of degrees; no other file has them."""
    if not source.endswith(".csv"):
        raise ConfigError(
            "--degrees",
            f"{source} is no table (.csv); its layout has radians: leave the option out",
        )
    velocity = recorded.joint_velocity
    return dataclasses.replace(
        recorded,
        joints=np.radians(recorded.joints),
        joint_velocity=None if velocity is None else np.radians(velocity),
    )


def _rate(recorded: RecordedMotion, choices: Choices, source: str, notes: list[str]) -> float:
    fps = choices.fps if choices.fps is not None else recorded.fps
    if fps is None:
        raise ConfigError(
            source,
            "the file states no rate; give it with --fps (most programs take 30 for this layout, "
            "some 50)",
        )
    if not LEAST_RATE <= fps <= MAX_RATE:
        raise ConfigError(
            source, f"fps: {fps:g} Hz is out of range; use {LEAST_RATE:g} to {MAX_RATE:g}"
        )
    if recorded.fps is not None and abs(fps / recorded.fps - 1.0) > SAME_RATE:
        notes.append(f"{fps:g} Hz as asked for, not {recorded.fps:g} Hz as the file says")
    else:
        notes.append(f"{fps:g} Hz")
    return fps


def _joints(
    recorded: RecordedMotion, robot: Robot, choices: Choices, source: str, notes: list[str]
) -> tuple[Array, Array | None]:
    """Angles and, if the file has them, velocities (T, n) in the order of the robot's joints."""
    names = recorded.joint_names
    if names is None:
        if choices.order is None and recorded.order is None:
            raise ConfigError(
                source, "the file names no joints; give their order with --order depth-first or "
                "breadth-first"
            )  # fmt: skip
        raise ConfigError(
            source,
            f"the file has {recorded.joints.shape[1]} joints without names, robot "
            f"{robot.spec.name} has {robot.n}; use a robot folder with the same joints (`locked` "
            "in robot.yaml fixes those that the file lacks)",
        )
    known = [name for name in robot.joint_names if name in names]
    if not known:
        raise ConfigError(
            source,
            f"none of its joints ({', '.join(names[:3])}, ...) is a joint of robot "
            f"{robot.spec.name} ({', '.join(robot.joint_names[:3])}, ...)",
        )
    missing = [name for name in robot.joint_names if name not in names]
    ignored = [name for name in names if name not in robot.joint_names]
    if missing:
        notes.append(f"not in the file, kept in the half-sitting posture: {', '.join(missing)}")
    if ignored:
        notes.append(f"no joints of this robot, left out: {', '.join(ignored)}")
    to, at = [robot.joint_names.index(n) for n in known], [names.index(n) for n in known]
    joints = np.tile(robot.posture, (recorded.n_frames, 1))
    joints[:, to] = recorded.joints[:, at]
    _refuse_degrees(robot, joints, source)
    if recorded.joint_velocity is None:
        return joints, None
    velocity = np.zeros_like(joints)
    velocity[:, to] = recorded.joint_velocity[:, at]
    return joints, velocity


def _refuse_degrees(robot: Robot, joints: Array, source: str) -> None:
    """Refuse angles of which, in half of the frames, one is a turn beyond the range of its joint.

    No robot does so, while nearly every motion in degrees does. Joints that turn without end may.
    """
    beyond = np.maximum(joints - robot.upper, robot.lower - joints) > 2.0 * np.pi
    if 2 * np.count_nonzero(beyond.any(axis=1)) > len(joints):
        j = int(np.argmax(np.count_nonzero(beyond, axis=0)))
        k = int(np.argmax(beyond[:, j]))
        raise ConfigError(
            source,
            f"{robot.joint_names[j]} is at {joints[k, j]:.4g} rad in frame {k}, more than a turn "
            f"beyond its range ({robot.lower[j]:.4g} to {robot.upper[j]:.4g}); angles are read in "
            "radians: if the file has degrees, add --degrees",
        )


def _in_order(
    q: Array, layout: str, robot: Robot, dt: float, choices: Choices, source: str, notes: list[str]
) -> Array:
    """Quaternions (T, 4) of the base in the order x, y, z, w.

    The layout says in which order they stand in the file, and the reader has turned them; whether
    it was the right one shows in how the robot stands. Where both orders let it stand, as with a
    base that never turns, or neither does, the layout counts; of tables that are written in both
    orders, the one with a scalar part near 1 or -1.
    """
    said, other = ("wxyz", "xyzw") if layout in SCALAR_FIRST else ("xyzw", "wxyz")
    as_said, otherwise = q[:, 3:7], np.roll(q[:, 3:7], 1 if said == "wxyz" else -1, axis=1)
    if choices.quaternion is not None:
        notes.append(f"quaternions taken {choices.quaternion}, as asked for")
        return as_said if choices.quaternion == said else otherwise
    turned = q.copy()
    turned[:, 3:7] = otherwise
    score, other_score = standing_score(robot, q, dt), standing_score(robot, turned, dt)
    if score * BETTER < other_score:
        notes.append(f"quaternions {said}: so the robot stands")
        return as_said
    if other_score * BETTER < score:
        notes.append(f"quaternions {other}, not {said} as in the layout: only so the robot stands")
        return otherwise
    if layout not in TWO_ORDERS:
        notes.append(f"quaternions {said}, as the layout says; how the robot moves tells neither")
        return as_said
    for name, quat in ((said, as_said), (other, otherwise)):
        if np.abs(quat[:, 3]).mean() > UPRIGHT:
            notes.append(f"quaternions {name}: both orders let the robot stand, in this one w is 1")
            return quat
    raise ConfigError(
        source,
        "the order of its quaternions cannot be found out: the robot stands alike in both (unlike "
        f"standing: {said} {score:.2g}, {other} {other_score:.2g}); choose one with --quaternion "
        "xyzw or --quaternion wxyz",
    )


def _links(
    recorded: RecordedMotion, links: RecordedLinks | None, robot: Robot
) -> StatedLinks | None:
    """Velocities of those links that the robot has."""
    if links is None or links.velocity is None:
        return None
    names = links.names
    if names is None and recorded.order is not None:
        names = robot_order(robot, recorded.order).links
    if names is None or len(names) != links.position.shape[1]:
        return None
    has = [b for b, name in enumerate(names) if robot.model.existBodyName(name)]
    angular = links.angular_velocity
    return StatedLinks(
        names=tuple(names[b] for b in has),
        linear=links.velocity[:, has],
        angular=None if angular is None else angular[:, has],
        point=links.velocity_of or "origin",
    )


def without_velocities(given: GivenMotion) -> GivenMotion:
    """A motion of positions alone."""
    return dataclasses.replace(
        given, joint_velocity=None, base_linear=None, base_angular=None, links=None
    )
