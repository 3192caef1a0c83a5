"""The posture in which a robot on both soles brings its hands somewhere, found before it moves.

Over joint angles x, the left sole on the ground, with c the CoM of robot and payload:

    min  w_posture |(x - posture) / range|^2 + w_torque |tau / stall|^2 + w_com |(c - middle) / d|^2
    s.t. right sole in its place,  hands at their goals,  c inside the soles by a margin,
         no two bodies touch,  lower + room <= x <= upper - room

tau holds the robot still; c and middle are horizontal, d is the distance from the middle of the
support polygon to its nearest edge. Solved by sequential quadratic programming (Kraft, DFVLR-FB
88-28, 1988, as in SciPy), along a path of goals that begins where the hands are at first: a crouch
is far from standing, and the way there keeps to the same bends of knees and elbows. Bodies are kept
apart once they have been found to touch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.core.errors import InfeasibleGaitError
from mgs.motion_planner.standing_model import StandingModel
from mgs.robot import Robot

WEIGHT_POSTURE, WEIGHT_TORQUE, WEIGHT_COM = 1.0, 1.0, 0.3
ROOM = 0.08  # [rad] kept to joint limits; from a stretched elbow or knee no direction is free
COM_MARGIN = 0.4  # of the distance from the middle of the support polygon to its nearest edge
GAP = 0.005  # [m] between bodies that would touch
LENGTH_UNIT = 0.01  # [m] and [rad] that count as one in errors
N_GOALS = 3  # on the way
MAX_ITERATIONS = 100
MAX_CONTACTS = 6  # times that bodies are found to touch
DIFFERENCE = 1e-6  # [rad] of the one-sided differences
TOLERANCE = 1e-5  # [m] and [rad] of soles and hands; the IK meets them exactly


@dataclass(frozen=True, eq=False)
class StaticPose:
    """A posture and what the plan needs of it; world frame."""

    joints: Array  # (n,) [rad]
    com: Array  # (3,) of the robot alone [m]
    torso: Array  # (4,) quaternion xyzw
    hands: Array  # (2, 3) [m]


def find_pose(robot: Robot, goals: Array, payload: Array, start: Array) -> StaticPose:
    """Posture with the hands at their goals.

    Args:
        robot: the robot.
        goals: positions (2, 3) of left and right hand, world, origin midway between the soles [m];
            NaN: this hand is free.
        payload: masses (2,) in the hands [kg].
        start: joint angles (n,) to set out from.

    Raises:
        InfeasibleGaitError: no such posture; says how far off the hands stay.
    """
    search = _Search(StandingModel(robot, payload), ~np.isnan(goals[:, 0]))
    began = search.model.stand(start).hands
    joints = start
    for part in np.arange(1, N_GOALS + 1) / N_GOALS:
        joints = search.solve(joints, began + part * (goals - began))
    touching = search.model.collisions(joints)
    for _ in range(MAX_CONTACTS):
        if not touching:
            break
        search.model.pairs = sorted({*search.model.pairs, *touching})
        joints = search.solve(joints, goals)
        touching = search.model.collisions(joints)
    search.refuse(joints, goals, touching)
    found = search.model.stand(joints)
    return StaticPose(joints, found.com, search.model.torso(joints), found.hands)


class _Search:
    """The problem of one robot and payload; `asked` (2,) says which hands have goals."""

    def __init__(self, model: StandingModel, asked: NDArray[np.bool_]) -> None:
        self.model, self.asked = model, asked
        robot = model.robot
        self.range = robot.upper - robot.lower
        room = np.minimum(ROOM, 0.25 * self.range)
        self.low = np.minimum(robot.lower + room, robot.posture)
        self.high = np.maximum(robot.upper - room, robot.posture)
        polygon = model.polygon()
        edges = np.roll(polygon, -1, axis=0) - polygon
        inward = np.stack([-edges[:, 1], edges[:, 0]], axis=1)
        self.inward = inward / np.linalg.norm(edges, axis=1)[:, None]
        self.offset = np.sum(self.inward * polygon, axis=1)
        self.middle = polygon.mean(axis=0)
        self.depth = float((self.inward @ self.middle - self.offset).min())

    def solve(self, start: Array, goals: Array) -> Array:
        """Joint angles (n,) with the hands at their goals as far as they can be."""
        joints = self._minimise(start, goals, hands_hard=True)
        if np.abs(self._errors(joints, goals)).max() > TOLERANCE:
            joints = self._minimise(start, goals, hands_hard=False)
        return joints

    def _minimise(self, start: Array, goals: Array, hands_hard: bool) -> Array:
        from scipy.optimize import minimize  # slow to import, needed by few motions

        parts = _Parts(lambda x: self._parts(x, goals, hands_hard))
        result = minimize(
            lambda x: float(np.sum(parts.value(x, 0) ** 2)),
            np.clip(start, self.low, self.high),
            jac=lambda x: 2.0 * parts.value(x, 0) @ parts.slope(x, 0),
            method="SLSQP",
            bounds=np.stack([self.low, self.high], axis=1),
            constraints=[
                {
                    "type": kind,
                    "fun": lambda x, i=i: parts.value(x, i),
                    "jac": lambda x, i=i: parts.slope(x, i),
                }
                for kind, i in (("eq", 1), ("ineq", 2))
            ],
            options={"maxiter": MAX_ITERATIONS, "ftol": 1e-6},
        )
        return np.asarray(np.clip(result.x, self.low, self.high))

    def _parts(self, joints: Array, goals: Array, hands_hard: bool) -> tuple[Array, Array, Array]:
        """Residuals whose squares are least, those that vanish, and those that are positive."""
        robot = self.model.robot
        standing = self.model.stand(joints)
        com = standing.loaded_com[:2]
        hands = (standing.hands - goals)[self.asked].ravel() / LENGTH_UNIT
        least = [
            np.sqrt(WEIGHT_POSTURE) * (joints - robot.posture) / self.range,
            np.sqrt(WEIGHT_TORQUE) * standing.torque / robot.torque_limit,
            np.sqrt(WEIGHT_COM) * (com - self.middle) / self.depth,
        ]
        vanishing = [standing.right_sole / LENGTH_UNIT]
        if hands_hard:
            vanishing.append(hands)
        else:
            least = [1e-2 * np.concatenate(least), hands]
        inside = self.inward @ com - self.offset - COM_MARGIN * self.depth
        positive = np.concatenate([inside, standing.gaps - GAP]) / LENGTH_UNIT
        return np.concatenate(least), np.concatenate(vanishing), positive

    def _errors(self, joints: Array, goals: Array) -> Array:
        """Of sole and hands [m] and [rad]."""
        standing = self.model.stand(joints)
        return np.concatenate([standing.right_sole, (standing.hands - goals)[self.asked].ravel()])

    def refuse(self, joints: Array, goals: Array, touching: list[int]) -> None:
        """Raise InfeasibleGaitError where a pose does not do what it shall."""
        standing = self.model.stand(joints)
        gaps = np.where(self.asked, np.linalg.norm(standing.hands - goals, axis=1), 0.0)
        worst = int(np.argmax(gaps))
        side = ("left", "right")[worst]
        if not np.abs(self._errors(joints, goals)).max() <= TOLERANCE:
            raise InfeasibleGaitError(
                f"the {side} hand cannot reach {_point(goals[worst])}: in balance, inside the "
                f"joint limits and without touching itself {self.model.robot.spec.name} comes to "
                f"{_point(standing.hands[worst])}, {1e3 * gaps[worst]:.0f} mm away; move the "
                "object there or nearer to the feet"
            )
        if touching:
            raise InfeasibleGaitError(
                f"with the {side} hand at {_point(goals[worst])} "
                f"{self.model.names_of(touching[0])} touch; "
                "move the object sideways or away from the feet"
            )


def _point(position: Array) -> str:
    return "(" + ", ".join(f"{x:.3f}" for x in position) + ") m"


class _Parts:
    """Values and one-sided differences of a function of three parts, kept for one point."""

    def __init__(self, function: Callable[[Array], tuple[Array, Array, Array]]) -> None:
        self.function = function
        self.at = np.empty(0)
        self.values: tuple[Array, Array, Array] | None = None
        self.slopes: tuple[Array, ...] | None = None

    def value(self, x: Array, part: int) -> Array:
        """One part (m,) at x (n,)."""
        if self.values is None or not np.array_equal(x, self.at):
            self.at, self.values, self.slopes = x.copy(), self.function(x), None
        return self.values[part]

    def slope(self, x: Array, part: int) -> Array:
        """Jacobian (m, n) of one part."""
        self.value(x, part)
        assert self.values is not None
        if self.slopes is None:
            moved = [self.function(x + step) for step in DIFFERENCE * np.eye(len(x))]
            self.slopes = tuple(
                np.stack([(m[i] - self.values[i]) / DIFFERENCE for m in moved], axis=1)
                for i in range(3)
            )
        return self.slopes[part]
