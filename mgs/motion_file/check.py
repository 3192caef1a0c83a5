"""Conditions that every motion in a file fulfils, checked before writing and after reading."""

from __future__ import annotations

import numpy as np

from mgs.core.contact import Side, Support
from mgs.core.limits import MAX_BALLS, MAX_BOXES, MAX_CROWD
from mgs.core.scene import PLACE, is_crowded
from mgs.motion import Motion
from mgs.motion_file.topics import field_shapes


def find_problem(motion: Motion) -> str | None:
    """Describe the first problem in the arrays of a motion; None if there is none."""
    n_samples = len(motion.q)
    if n_samples == 0:
        return "it has no samples"
    if motion.gait.is_balanced and len(motion.footsteps) < len(Side):
        return "it has no two footsteps that the robot stands on at the start"
    if len(motion.scene.boxes) > MAX_BOXES or len(motion.scene.balls) > MAX_BALLS:
        return f"it has more than {MAX_BOXES} boxes or {MAX_BALLS} balls on the floor"
    if is_crowded(motion.scene.boxes):
        return f"more than {MAX_CROWD} boxes touch one square of {PLACE:g} m x {PLACE:g} m"
    for name, shape in field_shapes(motion.robot.n).items():
        array = getattr(motion, name)
        if array.shape != (n_samples, *shape) or array.dtype != np.float64:
            return f"{name} is {array.dtype}{array.shape}, not float64{(n_samples, *shape)}"
        if not np.isfinite(array).all():
            k = int(np.argwhere(~np.isfinite(array))[0, 0])
            return f"{name} is not finite at t = {k * motion.dt:.3f} s"
    if motion.support.shape != (n_samples,) or not np.isin(motion.support, list(Support)).all():
        return "support is not double, left or right at every sample"
    return None
