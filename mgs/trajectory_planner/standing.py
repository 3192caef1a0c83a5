"""References that are the same for every motion on two feet that stay where they are."""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.contact import Footstep
from mgs.core.errors import ComOutsideFeetError
from mgs.core.geometry import quat_xyzw_from_yaw


def standing_soles(footsteps: tuple[Footstep, ...], n_samples: int) -> Array:
    """Poses (N, 2, 7) of the soles on the initial footsteps: x, y, z [m], quaternion xyzw."""
    poses = [
        np.concatenate([[foot.x, foot.y, foot.z], quat_xyzw_from_yaw(foot.yaw)])
        for foot in footsteps[:2]
    ]
    return np.tile(poses, (n_samples, 1, 1))


def load_left(com: Array, footsteps: tuple[Footstep, ...]) -> Array:
    """Share (N,) of the weight on the left sole for a CoM (N, 3) between the two.

    Raises:
        ComOutsideFeetError: the CoM goes sideways beyond both feet.
    """
    left, right = (np.array([foot.x, foot.y]) for foot in footsteps[:2])
    across = left - right
    share = (com[:, :2] - right) @ across / (across @ across)
    worst = float(np.abs(share - 0.5).max())
    if worst > 1.0:
        raise ComOutsideFeetError(float(worst * np.hypot(*across)))
    return np.asarray(np.clip(share, 0.0, 1.0))
