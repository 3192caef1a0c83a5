"""The static posture in which a robot on both soles brings its hands to given points.

Over joint angles x, the left sole on the ground, with c the CoM of robot and payload:

    min  w_posture |(x - posture) / range|^2 + w_torque |tau / stall|^2 + w_com |(c - middle) / d|^2
    s.t. right sole in its place,  hands at their goals,  c inside the soles by a margin,
         no two bodies touch,  lower + room <= x <= upper - room

tau are the torques that hold the robot still; c and middle are horizontal, and d is the distance
from the middle of the support polygon to its nearest edge. The problem is solved by sequential
quadratic programming (D. Kraft, "A software package for sequential quadratic programming", report
DFVLR-FB 88-28, DLR, 1988, as in SciPy) for a series of goals from the present places of the hands
to the final ones: a crouch is far from standing, and on the way there knees and elbows keep the
directions in which they bend. Bodies are kept apart once they have been found to touch.
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
ROOM = 0.08  # distance from joint limits [rad]; a stretched limb cannot move in all directions
COM_MARGIN = 0.4  # of the distance from the middle of the support polygon to its nearest edge
GAP = 0.005  # least distance of bodies that would touch [m]
LENGTH_UNIT = 0.01  # error that counts as one [m], [rad]
N_GOALS = 3  # number of goals on the way, the final one included
MAX_ITERATIONS = 100
MAX_CONTACTS = 6  # largest number of searches that keep touching bodies apart
DIFFERENCE = 1e-6  # step of the one-sided differences [rad]
TOLERANCE = 1e-5  # largest error of soles and hands [m], [rad]; the IK removes it


@dataclass(frozen=True, eq=False)
class StaticPose:
    """A posture, with the places of its CoM, torso and hands in the world frame."""

    joints: Array  # (n,) [rad]
    com: Array  # (3,) of the robot alone [m]
    torso: Array  # (4,) quaternion xyzw
    hands: Array  # (2, 3) [m]


def find_pose(robot: Robot, goals: Array, payload: Array, start: Array) -> StaticPose:
    """Posture with the hands at their goals.

    Args:
        robot: the robot.
        goals: positions (2, 3) of left and right hand; world frame, origin midway between the
            soles [m]; NaN: this hand is free.
        payload: masses (2,) in the hands [kg].
        start: joint angles (n,) that the search starts from [rad].

    Raises:
        InfeasibleGaitError: there is no such posture; the message says how far off the hands stay.
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
    """Search for postures of one robot and payload; `asked` (2,) tells which hands have goals."""

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
        """Joint angles (n,) with the hands at their goals, or as near as they come [rad]."""
        joints = self._minimise(start, goals, hands_hard=True)
        if np.abs(self._errors(joints, goals)).max() > TOLERANCE:
            joints = self._minimise(start, goals, hands_hard=False)
        return joints

    def _minimise(self, start: Array, goals: Array, hands_hard: bool) -> Array:
        """Joint angles (n,) of least cost [rad]; the goals are constraints, or part of the cost."""
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
        joints = np.asarray(np.clip(result.x, self.low, self.high))
        if self.model.robot.coupling is not None:
            self.model.robot.coupling.complete(joints)
        return joints

    def _parts(self, joints: Array, goals: Array, hands_hard: bool) -> tuple[Array, Array, Array]:
        """Residuals to minimise in sum of squares, to make zero, and to keep positive."""
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
        if robot.coupling is not None:
            vanishing.append(robot.coupling.misses(joints))
        if hands_hard:
            vanishing.append(hands)
        else:
            least = [1e-2 * np.concatenate(least), hands]
        inside = self.inward @ com - self.offset - COM_MARGIN * self.depth
        positive = np.concatenate([inside, standing.gaps - GAP]) / LENGTH_UNIT
        return np.concatenate(least), np.concatenate(vanishing), positive

    def _errors(self, joints: Array, goals: Array) -> Array:
        """Errors of the right sole (6,) and of the hands with goals [m], [rad]."""
        standing = self.model.stand(joints)
        return np.concatenate([standing.right_sole, (standing.hands - goals)[self.asked].ravel()])

    def refuse(self, joints: Array, goals: Array, touching: list[int]) -> None:
        """Raise InfeasibleGaitError where a posture misses its goals or two bodies touch."""
        standing = self.model.stand(joints)
        gaps = np.where(self.asked, np.linalg.norm(standing.hands - goals, axis=1), 0.0)
        worst = int(np.argmax(gaps))
        side = ("left", "right")[worst]
        if not np.abs(self._errors(joints, goals)).max() <= TOLERANCE:
            raise InfeasibleGaitError(
                f"the {side} hand cannot reach {_point(goals[worst])}: in balance, within joint "
                f"limits and without self-collision {self.model.robot.spec.name} reaches "
                f"{_point(standing.hands[worst])}, {1e3 * gaps[worst]:.0f} mm away; move "
                "pick_up.object there or nearer to the feet"
            )
        if touching:
            raise InfeasibleGaitError(
                f"with the {side} hand at {_point(goals[worst])} "
                f"{self.model.names_of(touching[0])} touch; "
                "move pick_up.object sideways or away from the feet"
            )


def _point(position: Array) -> str:
    """Coordinates (3,) as text [m]."""
    return "(" + ", ".join(f"{x:.3f}" for x in position) + ") m"


class _Parts:
    """A function with three parts: its values and Jacobians, kept for the last point."""

    def __init__(self, function: Callable[[Array], tuple[Array, Array, Array]]) -> None:
        self.function = function
        self.at = np.empty(0)
        self.values: tuple[Array, Array, Array] | None = None
        self.slopes: tuple[Array, ...] | None = None

    def value(self, x: Array, part: int) -> Array:
        """Value (m,) of one part at x (n,)."""
        if self.values is None or not np.array_equal(x, self.at):
            self.at, self.values, self.slopes = x.copy(), self.function(x), None
        return self.values[part]

    def slope(self, x: Array, part: int) -> Array:
        """Jacobian (m, n) of one part at x (n,), by one-sided differences."""
        self.value(x, part)
        assert self.values is not None
        if self.slopes is None:
            moved = [self.function(x + step) for step in DIFFERENCE * np.eye(len(x))]
            self.slopes = tuple(
                np.stack([(m[i] - self.values[i]) / DIFFERENCE for m in moved], axis=1)
                for i in range(3)
            )
        return self.slopes[part]
