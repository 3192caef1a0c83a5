"""What formats for motion tracking have in common: joints, and links with their velocities."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from mgs.core.arrays import Array
from mgs.motion.link_motion import LinkMotion, link_motion
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, chosen_joints
from mgs.motion_file.formats.recorded import Reading, RecordedLinks, as_float32
from mgs.robot.orders import Order

VelocityOf = Literal["origin", "com"]
SCALAR_FIRST = [3, 0, 1, 2]  # from x, y, z, w to w, x, y, z
LINK_KEYS = ("body_pos_w", "body_quat_w", "body_lin_vel_w", "body_ang_vel_w")


@dataclass(frozen=True, eq=False)
class Tracked:
    """Joints and links of a motion, in the order of a format."""

    joint_names: tuple[str, ...]
    joints: Array  # (T, J) [rad]
    joint_velocity: Array  # (T, J) [rad/s]
    links: LinkMotion


def tracked(sampled: SampledMotion, options: Options, order: Order) -> Tracked:
    """Joints and links of a motion as the user wants them, or in the order of the format."""
    names, index = chosen_joints(sampled.robot, options, order)
    return Tracked(
        joint_names=names,
        joints=sampled.joints[:, index],
        joint_velocity=sampled.joint_velocity[:, index],
        links=link_motion(sampled, options.order or order, options.links),
    )


def whole_fps(fps: float) -> Any:
    """Rate as an integer where it is one: readers print it, or compare it with their own."""
    return np.array([round(fps) if abs(fps - round(fps)) < 1e-9 else fps])


def link_arrays(links: LinkMotion, velocity_of: VelocityOf) -> dict[str, Any]:
    """The four arrays of links that trackers read; quaternions w, x, y, z."""
    velocity = links.com_velocity if velocity_of == "com" else links.velocity
    quat = links.quat_xyzw[..., SCALAR_FIRST]
    arrays = (links.position, quat, velocity, links.angular_velocity)
    return {key: as_float32(array) for key, array in zip(LINK_KEYS, arrays, strict=True)}


def read_links(
    reading: Reading,
    arrays: Mapping[str, Any],
    frames: int,
    names: tuple[str, ...] | None,
    velocity_of: VelocityOf,
    keys: tuple[str, str, str, str] = LINK_KEYS,
) -> RecordedLinks:
    """Links of the four arrays of a file.

    Args:
        reading: of the file.
        arrays: its arrays by name.
        frames: number of frames T that its joints have.
        names: of the links; None: the file names none.
        velocity_of: point of a link whose velocity the file has.
        keys: names of the arrays.
    """
    n = None if names is None else len(names)
    position = reading.array(keys[0], arrays.get(keys[0]), frames, n, 3)
    shape = position.shape
    return RecordedLinks(
        names=names,
        position=position,
        quat_xyzw=reading.quat_xyzw(keys[1], arrays.get(keys[1]), *shape[:2], 4, scalar_first=True),
        velocity=reading.array(keys[2], arrays.get(keys[2]), *shape),
        velocity_of=velocity_of,
        angular_velocity=reading.array(keys[3], arrays.get(keys[3]), *shape),
    )


def optional_names(reading: Reading, arrays: Mapping[str, Any], key: str) -> tuple[str, ...] | None:
    """Names that a file may have."""
    return reading.names(key, arrays[key]) if key in arrays else None
