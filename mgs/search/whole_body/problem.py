"""The optimal-control problem of a whole motion: what it minimises, and what has to hold.

    min over q, w, tau   h sum_k [ torque / 2 |tau_k|^2 / (m g L)^2
                                   + work sum_j max(tau_kj v_kj, 0) / (m g sqrt(g L))
                                   + distance / 2 |q_k - q_k of the plan|^2, joints alone
                                   + upright / 2 |turn of the torso from the plan|^2
                                   + hands / 2 |hands from the plan|^2 / L^2 ]
    s.t.  M a_k + h(q_k, v_k) + rotors = S^T tau_k + sum_i J_i^T w_ki     whole-body dynamics
          both soles at their places of the plan, at every sample
          w_ki in the wrench cone of sole i if it bears, else 0
          vertical forces on both soles together of half of the weight at least
          ranges and speeds of the joints, speed-torque line of the servos
          links that may not touch keep a distance
          the first and the last sample are those of the plan, at rest

Velocities and accelerations are those of the semi-implicit Euler method:

    v_k = (q_k - q_k-1) / h,    a_k = (v_k+1 - v_k) / h

where differences are those of the configuration space, v_0 = 0 and v_T = 0. h is the period of the
samples, m the mass, L the length of a leg.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV, FRICTION, GRAVITY
from mgs.core.contact import Side, Support
from mgs.ik_solver.tree.wrench_cones import cone_of_rectangle
from mgs.robot import Robot, leg_length
from mgs.search.whole_body.clearance import Clearance

RESERVE = 0.95  # part of the limits of speed and torque that may be used
LEAST_LOAD = 0.5  # of the weight, on both soles together: with less, little moves the ZMP far
RANGE_RESERVE = 2e-3  # [rad]
FIRST_SPEED = 0.03  # [rad/s] of a joint in the first and in the last period
GENTLE = 3.0  # [rad/s^2] with which joints begin and end to move
LEAST_RECTANGLE = 0.1  # part of a sole that a margin leaves


@dataclass(frozen=True)
class Weights:
    """Weights of the terms of the objective; all terms are free of units."""

    torque: float = 1.0
    work: float = 0.0
    distance: float = 0.01
    upright: float = 1.0
    hands: float = 0.0


@dataclass(frozen=True, eq=False)
class Problem:
    """A motion that is to be improved."""

    robot: Robot
    h: float  # period of the samples [s]
    plan: Array  # (T, 7 + n)
    soles: Array  # (T, 2, 7) places of the soles
    bears: NDArray[np.bool_]  # (T, 2) soles that bear the robot
    weights: Weights
    margin: float  # [m] of the centre of pressure from the edge of a sole
    friction: float = FRICTION

    @property
    def n_samples(self) -> int:
        """Number of samples T."""
        return len(self.plan)

    @property
    def nv(self) -> int:
        """Degrees of freedom, with those of the base."""
        return FLOATING_BASE_NV + self.robot.n

    @functools.cached_property
    def leg(self) -> float:
        """Length of a leg [m]."""
        return leg_length(self.robot)

    @functools.cached_property
    def weight_torque(self) -> float:
        """Weight of |tau|^2 / 2."""
        return self.weights.torque / (self.robot.mass * GRAVITY * self.leg) ** 2

    @functools.cached_property
    def weight_work(self) -> float:
        """Weight of the positive power."""
        return self.weights.work / (self.robot.mass * GRAVITY * np.sqrt(GRAVITY * self.leg))

    @functools.cached_property
    def angles(self) -> tuple[Array, Array]:
        """Least and largest joint angles (T, n): the ranges less `RANGE_RESERVE`, or the plan's."""
        q = self.plan[:, FLOATING_BASE_NQ:]
        lower = np.minimum(self.robot.lower + RANGE_RESERVE, q)
        upper = np.maximum(self.robot.upper - RANGE_RESERVE, q)
        return lower, upper

    @functools.cached_property
    def speed_limit(self) -> Array:
        """Largest speeds (T - 1, n) of the joints between samples [rad/s].

        The motion begins and ends gently, if the plan does.
        """
        q = self.plan[:, FLOATING_BASE_NQ:]
        steps = np.arange(self.n_samples - 1)
        from_ends = self.h * np.minimum(steps, steps[::-1])
        gentle = FIRST_SPEED + GENTLE * from_ends[:, None]
        gentle = np.maximum(gentle, np.abs(np.diff(q, axis=0)) / self.h)
        return np.minimum(RESERVE * self.robot.speed_limit, gentle)

    @functools.cached_property
    def cones(self) -> tuple[Array, Array]:
        """Rows U (16, 6) with U w <= 0 for wrenches w in the frame of the left and right sole."""
        return self._cone(Side.LEFT, self.margin), self._cone(Side.RIGHT, self.margin)

    @functools.cached_property
    def whole_cones(self) -> tuple[Array, Array]:
        """The cones of the whole soles, without the margin."""
        return self._cone(Side.LEFT, 0.0), self._cone(Side.RIGHT, 0.0)

    def _cone(self, side: Side, margin: float) -> Array:
        spec = self.robot.sole_spec(side)
        x, y = (
            np.array([max(0.5 * size - margin, 0.5 * LEAST_RECTANGLE * size)])
            for size in (spec.length, spec.width)
        )
        return cone_of_rectangle(x, y, self.friction)[0]

    @functools.cached_property
    def clearance(self) -> Clearance:
        """The distances that links keep from each other."""
        return Clearance(self.robot, self.plan, self.leg)

    @functools.cached_property
    def places(self) -> list[tuple[pin.SE3, pin.SE3]]:
        """Places of the soles at each sample."""
        return [(pin.XYZQUATToSE3(a), pin.XYZQUATToSE3(b)) for a, b in self.soles]

    @functools.cached_property
    def references(self) -> tuple[list[pin.SE3], list[tuple[Array, Array]]]:
        """Placements of the torso and places of the hands in the plan."""
        model, data = self.robot.model, self.robot.model.createData()
        torsos, hands = [], []
        for q in self.plan:
            pin.framesForwardKinematics(model, data, q)
            torsos.append(data.oMf[self.robot.torso_frame].copy())
            left, right = (data.oMf[f].translation.copy() for f in self.robot.hand_frames)
            hands.append((left, right))
        return torsos, hands


def bearing(support: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Which soles (T, 2) bear, from the support phases (T,)."""
    return np.stack([support != Support.RIGHT, support != Support.LEFT], axis=1)
