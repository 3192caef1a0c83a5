"""Whether forces inside friction cones exist that hold the robot, on soles at any heights.

The condition that the ZMP inside the support polygon stands for on level ground: Caron, Pham,
Nakamura, "ZMP support areas for multicontact mobility under frictional constraints", IEEE Trans.
Robotics 33(1), 2017. A linear program for each sample, solved by HiGHS.
"""

from __future__ import annotations

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FRICTION

N_EDGES = 8  # of the pyramid inside each friction cone


def missing_wrenches(corners: Array, wrenches: Array) -> Array:
    """Least sum (m,) of what forces at points (m, c, 3) lack of wrenches (m, 6) [N] and [N m].

    Wrenches are forces and moments about the world origin that the ground has to exert. The forces
    stay inside pyramids within the friction cones of level ground.
    """
    # a motion that stands on level ground at all times needs neither, and they load for long
    import scipy.sparse as sp
    from scipy.optimize import linprog

    turn = 2.0 * np.pi * np.arange(N_EDGES) / N_EDGES
    edges = np.stack([FRICTION * np.cos(turn), FRICTION * np.sin(turn), np.ones(N_EDGES)], axis=1)
    m, c = corners.shape[:2]
    forces = np.broadcast_to(edges, (m, c, N_EDGES, 3))
    moments = np.cross(corners[:, :, None], forces)
    columns = np.concatenate([forces, moments], axis=-1).reshape(m, c * N_EDGES, 6)
    slack = sp.hstack([sp.eye(6), -sp.eye(6)])
    cost = np.concatenate([np.zeros(c * N_EDGES), np.ones(12)])
    missing = np.empty(m)
    for i in range(m):
        rows = sp.hstack([sp.csc_matrix(columns[i].T), slack], format="csc")
        missing[i] = linprog(cost, A_eq=rows, b_eq=wrenches[i], bounds=(0, None)).fun
    return missing
