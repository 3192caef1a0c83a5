"""What a file of another program says of a motion, before it is anybody's `Motion`.

A reader takes what is there and adds nothing: a rate, names or velocities that the file does not
state are None. Quaternions are turned into the order x, y, z, w and units into SI; which frame a
velocity is given in is stated beside it.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from mgs.core.arrays import Array
from mgs.core.errors import MgsError, MotionFileError
from mgs.core.foreign import described
from mgs.core.limits import MAX_CHANNELS, MAX_SAMPLES, MAX_VALUE
from mgs.core.short_repr import short_repr
from mgs.robot.orders import Order

UNIT = 1e-2  # that the length of a quaternion may differ by from 1


@dataclass(frozen=True, eq=False)
class RecordedLinks:
    """What B links do in T frames; world frame."""

    names: tuple[str, ...] | None  # None: the file names none
    position: Array  # (T, B, 3) of the origins [m]
    quat_xyzw: Array  # (T, B, 4)
    velocity: Array | None  # (T, B, 3) [m/s]
    velocity_of: Literal["origin", "com"] | None  # which point of a link that is the velocity of
    angular_velocity: Array | None  # (T, B, 3) [rad/s]

    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class RecordedMotion:
    """A motion as a file has it; world frame, SI units, first axis time."""

    layout: str  # name of the format
    fps: float | None  # [Hz]
    joint_names: tuple[str, ...] | None
    order: Order | None  # in which joints and links without names stand; None: it is not stated
    joints: Array  # (T, J) [rad]
    joint_velocity: Array | None = None  # (T, J) [rad/s]
    base_position: Array | None = None  # (T, 3) [m]; None: the file has joints only
    base_quat_xyzw: Array | None = None  # (T, 4)
    base_linear_velocity: Array | None = None  # (T, 3) of the base's origin in the world [m/s]
    base_angular_velocity: Array | None = None  # (T, 3) in the world [rad/s]
    links: RecordedLinks | None = None
    contacts: Array | None = None  # (T, 2) of left and right foot; 1: on the ground
    displacement: Array | None = None  # (3,) of a cycle that repeats: x, y [m], yaw [rad]
    notes: tuple[str, ...] = ()
    extra: dict[str, Any] = field(default_factory=dict)  # facts that only this format has

    __repr__ = short_repr

    @property
    def n_frames(self) -> int:
        """Number of frames T."""
        return len(self.joints)


class Reading:
    """The arrays of one file, checked as they are taken from it; every message names the file."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def error(self, problem: str) -> MotionFileError:
        """Error that names the file."""
        return MotionFileError(self.path, problem)

    def array(self, name: str, value: object, *shape: int | None) -> Array:
        """Array of finite numbers.

        Args:
            name: what it is, for messages.
            value: what the file has.
            shape: its lengths; None: any length, of the second axis at most `MAX_CHANNELS`.

        Raises:
            MotionFileError: it is missing, no array of numbers, of another shape or not finite.
        """
        if value is None:
            raise self.error(f"{name} is missing")
        found = numbers(value)
        if found is None:
            raise self.error(f"{name} should be an array of numbers")
        fits = found.ndim == len(shape) and all(
            have == want for have, want in zip(found.shape, shape, strict=True) if want is not None
        )
        if not fits:
            wanted = ", ".join("any" if n is None else str(n) for n in shape)
            raise self.error(f"{name} has the shape {found.shape}; it should be ({wanted})")
        if found.ndim and not 0 < len(found) <= MAX_SAMPLES:
            raise self.error(f"{name} has {len(found)} frames; 1 to {MAX_SAMPLES} are read")
        if found.ndim > 1 and found.shape[1] > MAX_CHANNELS:
            raise self.error(f"{name} has {found.shape[1]} columns; up to {MAX_CHANNELS} are read")
        bad = np.argwhere(~(np.abs(found) <= MAX_VALUE))
        if len(bad):
            where = f" in frame {bad[0][0]}" if found.ndim else ""
            value = found[tuple(bad[0])]
            raise self.error(
                f"{name} has the value {value:g}{where}; up to +-{MAX_VALUE:g} is read"
            )
        return found

    def quat_xyzw(
        self, name: str, value: object, *shape: int | None, scalar_first: bool = False
    ) -> Array:
        """Unit quaternions, the last axis of the shape, in the order x, y, z, w.

        Raises:
            MotionFileError: as `array`, or their length is not 1.
        """
        found = self.array(name, value, *shape)
        length = np.linalg.norm(found, axis=-1, keepdims=True)
        worst = float(np.abs(length - 1.0).max())
        if worst > UNIT:
            raise self.error(f"{name} should be unit quaternions; a length differs by {worst:.3g}")
        found = found / length
        return np.roll(found, -1, axis=-1) if scalar_first else found

    def fps(self, value: object, key: str = "fps", unit: str = "Hz") -> float:
        """Frames per second, or the period of a frame; `key` and `unit` name it in the message.

        Raises:
            MotionFileError: it is no positive number.
        """
        found = numbers(value)
        if found is None or found.size != 1 or not 0.0 < float(found.reshape(-1)[0]) < np.inf:
            raise self.error(f"{key} should be one positive number [{unit}]")
        return float(found.reshape(-1)[0])

    def names(self, name: str, value: object) -> tuple[str, ...]:
        """List of names; raises MotionFileError if it is none, or names something twice."""
        found = value.tolist() if isinstance(value, np.ndarray) else value
        if not isinstance(found, list | tuple) or not all(isinstance(n, str) for n in found):
            raise self.error(f"{name} should be a list of names")
        if not 0 < len(found) <= MAX_CHANNELS:
            raise self.error(f"{name} has {len(found)} names; 1 to {MAX_CHANNELS} are read")
        if len(set(found)) < len(found):
            raise self.error(f"{name} has the same name twice")
        return tuple(found)


@contextlib.contextmanager
def decoding(path: Path, kind: str) -> Iterator[None]:
    """Turn what goes wrong while the content of a file is decoded into an error that names it.

    The content is in memory, so an error of the system or lack of memory comes from what the
    content claims, not from the machine.

    Args:
        path: the file.
        kind: what it should be, such as "a NumPy npz file".
    """
    try:
        yield
    except MgsError:
        raise
    except Exception as error:
        raise MotionFileError(path, f"not {kind}: {described(error)}") from error


def numbers(value: object) -> Array | None:
    """Values as an array; None if they are no array of real numbers."""
    try:
        found = np.asarray(value)
    except (TypeError, ValueError):  # lists of unequal length
        return None
    if found.dtype.kind not in "fiub":
        return None
    with np.errstate(invalid="ignore"):  # a signalling NaN is told of as any other
        return found.astype(np.float64)


def as_float32(array: ArrayLike) -> np.ndarray[Any, np.dtype[np.float32]]:
    """Array in the precision of training frameworks, contiguous."""
    return np.ascontiguousarray(array, dtype=np.float32)
