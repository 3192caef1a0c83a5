"""Computation of a half-sitting posture: knees bent, soles level on one plane, CoM above the soles.

The base stays upright. Each leg is solved separately by bounded least squares, with a level sole,
at the lateral distance of the sole with all joints at 0 or at a smaller one that suits a walk, and
at a height that bends the knee. The
soles are then moved below the CoM and the legs are solved again, until the position converges.
The arms hang forward with bent elbows. Where leg joints are coupled, the legs are solved together,
and the base may pitch (`coupled_posture`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mgs.core.arrays import Array
from mgs.robot.init.anatomy import Anatomy
from mgs.robot.init.coupled_posture import place_coupled_soles
from mgs.robot.init.skeleton import Skeleton
from mgs.robot.init.sole import Sole
from mgs.robot.limbs import stretched_length
from mgs.robot.urdf_text import joint_axis

CROUCHES = (0.95, 0.96, 0.97, 0.98)  # distance from hip to sole, as part of the stretched leg
MOST_LOAD = 0.3  # largest part of the torque of a pitch joint to carry the robot on one leg
LEG_ROOM = 0.25  # [rad] distance from the limits of leg joints that suffices for a step
HAND_REACH = 0.85  # distance from shoulder to hand, as part of the stretched arm
STRETCHED = 0.95  # distance from shoulder to hand from which on an arm counts as stretched
HANGING = 0.8  # least part of that distance that points down
HANDS = (0.2, 0.2)  # direction of a hand from its shoulder: forward and outward ...
HANDS_UP = -0.96  # ... and up
WIDEST_STANCE = 0.35  # largest distance of the soles from each other, as part of the stretched leg
LEAST_GAP = 0.3  # least gap between narrowed soles, as part of their width
REST_WEIGHT = 1e-3  # [m/rad] weight of the distance from the posture at rest
NEAR = 1e-6  # [m] and [rad] tolerance of the pose of a sole
ROOM, ARM_ROOM = 0.02, 0.35  # [rad] distance from the limits of legs and arms; less if narrow
BALANCE_ROUNDS = 20  # largest number of corrections of the soles


@dataclass(frozen=True, eq=False)
class Posture:
    """Half-sitting configuration and its errors."""

    q: Array  # (nq,), base at the origin
    sole_error: float  # largest error of both soles [m] or [rad]
    balance_error: float  # distance of the CoM in front of the middle of the soles [m]


def leg_length(skeleton: Skeleton, leg: list[int], sole: Sole) -> float:
    """Length of a stretched leg from its first joint to the sole [m]."""
    return stretched_length(skeleton.model, leg, sole.placement.translation)


def hand_point(skeleton: Skeleton, body: int) -> Array:
    """Middle (3,) of the surface of a hand, in its frame [m]; its CoM if it has no shape."""
    if not skeleton.surfaces[body]:
        return np.array(skeleton.model.inertias[body].lever)
    points = skeleton.points(body)
    return 0.5 * (points.min(axis=0) + points.max(axis=0))


def find_posture(
    skeleton: Skeleton,
    anatomy: Anatomy,
    soles: tuple[Sole, Sole],
    torque: dict[int, float],
    stand: Mapping[str, float],
    hands: tuple[float, float] | None = None,
) -> Posture:
    """Deepest posture with level soles, enough distance from joint limits and enough torque.

    If no posture meets all three conditions, they are ranked in this order. `torque` holds the
    torque limit of each joint [N m]. Where the arms hang bent in `stand`, angles of joints by name
    [rad], they stay like that, unless `hands` tells where the hands go (as `HANDS`); the search
    for the angles of the legs begins at `stand`.
    """
    q = skeleton.at_rest.copy()
    for leg in anatomy.legs if stand else ():
        _take(skeleton, leg, stand, q)
    for side, arm in enumerate(anatomy.arms or ()):
        if stand:
            _take(skeleton, arm, stand, q)
        if not stand or hands is not None or not _hangs(skeleton, arm, q):
            forward, outward = hands or HANDS
            _place_hand(skeleton, arm, (forward, (1.0 - 2.0 * side) * outward), q)
    found: list[tuple[tuple[float, float, float], Posture]] = []
    for crouch in CROUCHES:
        posture = _sit(skeleton, anatomy, soles, q.copy(), crouch, WIDEST_STANCE)
        if posture.sole_error > NEAR:  # legs that cannot roll their soles stand as at rest
            as_at_rest = _sit(skeleton, anatomy, soles, q.copy(), crouch, np.inf)
            posture = min(posture, as_at_rest, key=lambda found: found.sole_error)
        room = _room(skeleton, anatomy, posture.q)
        load = _load(skeleton, anatomy.legs[0], soles[0], posture.q, torque)
        score = -max(posture.sole_error, NEAR), min(room, LEG_ROOM), -max(load, MOST_LOAD)
        found.append((score, posture))
        if score == (-NEAR, LEG_ROOM, -MOST_LOAD):
            break
    return max(found, key=lambda item: item[0])[1]


def _take(skeleton: Skeleton, joints: list[int], stand: Mapping[str, float], q: Array) -> None:
    """Set the angles of joints in q to those of a known posture, within their ranges."""
    model, at = skeleton.model, _angles(skeleton, joints)
    angles = [stand.get(skeleton.name(joint), 0.0) for joint in joints]
    q[at] = np.clip(angles, model.lowerPositionLimit[at], model.upperPositionLimit[at])


def _hangs(skeleton: Skeleton, arm: list[int], q: Array) -> bool:
    """Whether an arm hangs down bent in q, so that its hand can keep its place while walking.

    The shoulder sways from side to side; an arm that points aside would fold and stretch with it.
    """
    data = skeleton.model.createData()
    pin.forwardKinematics(skeleton.model, data, q)
    hand = hand_point(skeleton, arm[-1])
    way = data.oMi[arm[-1]].act(hand) - data.oMi[arm[0]].translation
    distance = float(np.linalg.norm(way))
    is_bent = distance <= STRETCHED * stretched_length(skeleton.model, arm, hand)
    return is_bent and -float(way[2]) >= HANGING * distance


def _room(skeleton: Skeleton, anatomy: Anatomy, q: Array) -> float:
    """Least distance of a leg joint from its limits [rad]."""
    at = _angles(skeleton, [*anatomy.legs[0], *anatomy.legs[1]])
    model = skeleton.model
    room = np.minimum(q[at] - model.lowerPositionLimit[at], model.upperPositionLimit[at] - q[at])
    return float(room.min())


def _load(
    skeleton: Skeleton, leg: list[int], sole: Sole, q: Array, torque: dict[int, float]
) -> float:
    """Largest ratio of needed torque to torque limit of a pitch joint, standing on one leg."""
    model, data = skeleton.model, skeleton.model.createData()
    gravity = pin.computeGeneralizedGravity(model, data, q)
    pin.computeJointJacobians(model, data, q)
    at = data.oMi[leg[-1]].act(sole.placement.translation)
    weight = np.array([0.0, 0.0, gravity[2]])  # the base is upright: entry 2 is the weight
    wrench = np.concatenate([weight, np.cross(at, weight)])  # about the origin
    needed = gravity - pin.getJointJacobian(model, data, leg[-1], pin.WORLD).T @ wrench
    for joint, (leader, follower) in skeleton.followers.items():
        needed[model.idx_vs[leader]] += follower.multiplier * needed[model.idx_vs[joint]]
    pitch = [j for j in leg if _turns_in_pitch(skeleton, j) and j not in skeleton.followers]
    return max((abs(float(needed[model.idx_vs[j]])) / torque[j] for j in pitch), default=0.0)


def _turns_in_pitch(skeleton: Skeleton, joint: int) -> bool:
    axis = skeleton.placements[joint].rotation @ joint_axis(skeleton.model, joint)
    return bool(abs(axis[1]) > 0.7)


def _sit(
    skeleton: Skeleton,
    anatomy: Anatomy,
    soles: tuple[Sole, Sole],
    q: Array,
    crouch: float,
    widest: float,
) -> Posture:
    """Posture with the arms of q; `widest` is that of `stance_width`."""
    model, data = skeleton.model, skeleton.model.createData()
    pin.forwardKinematics(model, data, skeleton.at_rest)
    rest = [data.oMi[leg[-1]] * s.placement for leg, s in zip(anatomy.legs, soles, strict=True)]
    length = leg_length(skeleton, anatomy.legs[0], soles[0])
    half_width = 0.5 * stance_width(rest, soles, length, widest)
    middle = 0.5 * (rest[0].translation[1] + rest[1].translation[1])
    hips = [data.oMi[leg[0]].translation.copy() for leg in anatomy.legs]
    drop = min(hips[0][2] - rest[0].translation[2], length) * crouch
    x, error, offset = float(hips[0][0]), 0.0, 0.0
    for _ in range(BALANCE_ROUNDS):
        z = 0.5 * (hips[0] + hips[1])[2] - drop
        targets = [
            pin.SE3(np.eye(3), np.array([x, middle + outward * half_width, z]))
            for outward in (1.0, -1.0)
        ]
        if skeleton.followers:
            pairs = zip(*(_leg_starts(skeleton, leg, q) for leg in anatomy.legs), strict=True)
            starts = (_with_legs(skeleton, anatomy, pair, q) for pair in pairs)
            legs = anatomy.legs
            found = place_coupled_soles(skeleton, legs, soles, targets, starts, q, ROOM, NEAR)
            return Posture(q, *found)
        error = max(
            _place_sole(skeleton, leg, sole, target, q)
            for leg, sole, target in zip(anatomy.legs, soles, targets, strict=True)
        )
        offset = float(pin.centerOfMass(model, data, q)[0]) - x
        if abs(offset) < NEAR or error > 0.1:
            break
        x += offset
    return Posture(q, error, offset)


def stance_width(
    rest: list[pin.SE3],
    soles: tuple[Sole, Sole],
    length: float,
    widest: float = WIDEST_STANCE,
) -> float:
    """Distance of the soles from each other [m].

    That of the zero posture, but at most the part `widest` of the leg length [m]: while a robot
    walks, its CoM has to move from one sole to the other. Soles that stand narrower than at rest
    keep a gap, and so do soles that overlap at rest.
    """
    zero = float(rest[0].translation[1] - rest[1].translation[1])
    side_by_side = 0.5 * (soles[0].width + soles[1].width)
    with_gap = (1.0 + LEAST_GAP) * side_by_side
    return with_gap if zero < side_by_side else min(zero, max(widest * length, with_gap))


def _with_legs(
    skeleton: Skeleton, anatomy: Anatomy, angles: tuple[Array, Array], q: Array
) -> Array:
    """A copy of q with other angles of both legs."""
    full = q.copy()
    for leg, leg_angles in zip(anatomy.legs, angles, strict=True):
        full[_angles(skeleton, leg)] = leg_angles
    return full


def _place_sole(skeleton: Skeleton, leg: list[int], sole: Sole, target: pin.SE3, q: Array) -> float:
    """Solve the joints of a leg in q, in place; returns the remaining error [m] or [rad]."""

    def error(data: pin.Data) -> Array:
        T = data.oMi[leg[-1]] * sole.placement
        turn = pin.log3(target.rotation.T @ T.rotation)
        return np.concatenate([T.translation - target.translation, turn])

    return _solve(skeleton, leg, error, _leg_starts(skeleton, leg, q), q, ROOM)


def _place_hand(skeleton: Skeleton, arm: list[int], ahead: tuple[float, float], q: Array) -> None:
    """Move a hand in q, in place, as close to its target as the joint limits permit.

    `ahead` is the direction of the hand from its shoulder, to the front and to the left.
    """
    shoulder, hand = skeleton.placements[arm[0]].translation, hand_point(skeleton, arm[-1])
    reach = sum(np.linalg.norm(skeleton.model.jointPlacements[j].translation) for j in arm[1:])
    reach += np.linalg.norm(hand)
    direction = np.array([*ahead, HANDS_UP])
    target = shoulder + HAND_REACH * float(reach) * direction / np.linalg.norm(direction)

    def error(data: pin.Data) -> Array:
        return np.asarray(data.oMi[arm[-1]].act(hand) - target)

    starts = [skeleton.at_rest[_angles(skeleton, arm)] + bend for bend in (0.0, 0.4, -0.4)]
    _solve(skeleton, arm, error, iter(starts), q, ARM_ROOM)


def _leg_starts(skeleton: Skeleton, leg: list[int], q: Array) -> Iterator[Array]:
    """Start angles of a leg: the current ones, then a bent knee with hip and ankle opposed."""
    at = _angles(skeleton, leg)
    yield q[at]
    pitch = [i for i, joint in enumerate(leg) if _turns_in_pitch(skeleton, joint)]
    for bend in (0.8, 0.4):
        start = skeleton.at_rest[at].copy()
        for part, joint in zip(_pitch_pattern(len(pitch)), pitch, strict=True):
            axis = skeleton.placements[leg[joint]].rotation @ joint_axis(skeleton.model, leg[joint])
            start[joint] += bend * part * np.sign(axis[1])
        yield start


def _pitch_pattern(n: int) -> list[float]:
    """Angle of each pitch joint about +y as part of the knee angle: hip, knee, ankle."""
    return [-0.5, 1.0, -0.5, *[0.0] * (n - 3)] if n >= 3 else [0.0] * n


def _angles(skeleton: Skeleton, joints: list[int]) -> NDArray[np.intp]:
    return np.array([skeleton.model.idx_qs[j] for j in joints])


def _solve(
    skeleton: Skeleton,
    joints: list[int],
    error: Callable[[pin.Data], Array],
    starts: Iterator[Array],
    q: Array,
    room: float,
) -> float:
    """Minimize an error over some joints of q, in place; returns the largest remaining entry.

    Joints keep a distance of `room` [rad] from their limits, but at most a quarter of the range.
    """
    from scipy.optimize import least_squares

    model, data, at = skeleton.model, skeleton.model.createData(), _angles(skeleton, joints)
    lower, upper = model.lowerPositionLimit[at], model.upperPositionLimit[at]
    kept = np.minimum(room, 0.25 * (upper - lower))
    lower, upper = lower + kept, upper - kept
    rest = np.clip(skeleton.at_rest[at], lower, upper)

    def residual(angles: Array, pull: float) -> Array:
        full = q.copy()
        full[at] = angles
        pin.forwardKinematics(model, data, full)
        return np.concatenate([error(data), pull * (angles - rest)])

    best, least = rest, np.inf
    for start in starts:
        angles = np.clip(start, lower + 1e-6, upper - 1e-6)
        for pull in (REST_WEIGHT, 0.0):  # the weight selects a solution, then it is removed
            found = least_squares(
                residual, angles, args=(pull,), bounds=(lower, upper), xtol=1e-12, ftol=1e-12,
                gtol=1e-12, max_nfev=200,
            )  # fmt: skip
            angles = np.clip(found.x, lower + 1e-9, upper - 1e-9)
        left = float(np.abs(residual(angles, 0.0)[: -len(at)]).max())
        if left < least:
            best, least = angles, left
        if least <= NEAR:
            break
    q[at] = best
    return least
