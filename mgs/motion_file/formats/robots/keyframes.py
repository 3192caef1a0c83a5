"""Few keyframes for many frames: straight lines between them stay near the motion."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array


def keyframes(joints: Array, tolerance: float, least: int, most: int) -> list[int]:
    """Frames that become keyframes, the first and the last among them.

    From each keyframe the next one is as far as the straight line to it stays within the tolerance
    of every frame in between. Where that is nearer than `least`, it is `least` frames away.

    Args:
        joints: angles (T, n) of the frames [rad].
        tolerance: largest distance of a joint from the line [rad].
        least: smallest number of frames between two keyframes, but for the last two if T is small.
        most: largest number of frames between two keyframes, at least twice `least`.
    """
    last = len(joints) - 1
    found = [0]
    while found[-1] < last:
        i = found[-1]
        end = min(i + least, last)
        while end < min(i + most, last) and _off_line(joints[i : end + 2]) <= tolerance:
            end += 1
        if last - least < end < last:  # what is left would be too short for a step of its own
            end = last if last - i <= most else last - least
        found.append(end)
    return found


def _off_line(joints: Array) -> float:
    """Largest distance [rad] of frames (m, n) from the line between the first and the last."""
    s = np.linspace(0.0, 1.0, len(joints))[:, None]
    return float(np.abs(joints - (1.0 - s) * joints[0] - s * joints[-1]).max())
