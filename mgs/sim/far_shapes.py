"""Shapes of a robot in MuJoCo that are too far from the ground to touch it soon.

A walking robot stands on its soles, and its other shapes only take time: MuJoCo looks for their
contacts in every step, which takes a sixth of it. While they are far from the ground they are left
out. What is simulated stays the same to the last bit, since no contact is left out that is one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mgs.core.arrays import Array

FASTEST = 10.0  # [m/s] that a shape of a robot falls, with plenty to spare


class FarShapes:
    """The shapes of one robot other than its soles."""

    def __init__(self, model: Any, data: Any, side_of_geom: Array) -> None:
        """Take the shapes of a compiled model; side_of_geom (g,) is -1 for all but the soles."""
        self._model, self._data = model, data
        has_balls = model.nbody > 1 and (model.geom_conaffinity * model.geom_contype).any()
        is_robot = (model.geom_bodyid > 0) & (side_of_geom < 0) & ~has_balls
        self._shapes = np.flatnonzero(is_robot)
        self._bodies = model.geom_bodyid[self._shapes]
        self._radius = model.geom_rbound[self._shapes]
        grounds = np.flatnonzero(model.geom_bodyid == 0)
        height = model.geom_pos[grounds, 2] + model.geom_rbound[grounds]
        self._top = float(height.max(initial=0.0))
        self._near = np.ones(len(self._shapes), dtype=np.bool_)

    def leave_out(self, duration: float) -> None:
        """Leave out of contacts what cannot touch the ground within a duration [s]."""
        lowest = self._data.geom_xpos[self._shapes, 2] - self._radius
        near = lowest < self._top + FASTEST * duration
        if near.tobytes() == self._near.tobytes():
            return
        self._near = near
        self._model.geom_contype[self._shapes] = near
        self._model.body_contype[self._bodies] = 0
        np.maximum.at(self._model.body_contype, self._bodies, near)
