"""Level soles of a robot whose legs have coupled joints.

One motor may turn joints of both legs, so that the legs are solved together. Where it turns two
joints of a leg, a level sole is not always below the CoM while the base is upright: the base may
pitch, and the CoM comes as close to the middle of the soles as the legs permit. Over the angles r
of the motors, the pitch of the ground in the base frame and the place of the soles ahead,

    min |errors of both soles|^2 + |CoM - soles|^2 + weight^2 |r, pitch|^2,   lower <= r <= upper

then from the solution without the weight, and without the CoM where the soles are not exact then.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.robot.init.skeleton import Skeleton
from mgs.robot.init.sole import Sole

MOST_PITCH = 0.6  # [rad] of the base
MOST_AHEAD = 0.3  # [m] of the soles before the targets
PULL, UPRIGHT = 1e-3, 0.02  # weights of the angles' and the pitch's distance from rest [m/rad]


def place_coupled_soles(
    skeleton: Skeleton,
    legs: tuple[list[int], list[int]],
    soles: tuple[Sole, Sole],
    targets: list[pin.SE3],
    starts: Iterable[Array],
    q: Array,
    room: float,
    enough: float,
) -> tuple[float, float]:
    """Solve the joints of both legs in q, in place.

    Args:
        skeleton: bodies of the robot.
        legs: joints of both legs.
        soles: the soles.
        targets: their poses in the base frame while the base is upright; x is a first guess.
        starts: configurations (nq,) from which the search begins, one after the other.
        q: configuration (nq,), solved in place.
        room: distance from the limits [rad], but at most a quarter of the range.
        enough: error that ends the search [m] or [rad].

    Returns:
        The remaining error of the soles [m] or [rad], and the distance of the CoM before them [m].
    """
    from scipy.optimize import least_squares

    model, data = skeleton.model, skeleton.model.createData()
    free = [j for j in (*legs[0], *legs[1]) if j not in skeleton.followers]
    at = np.array([model.idx_qs[joint] for joint in free])
    lower, upper = model.lowerPositionLimit[at], model.upperPositionLimit[at]
    kept = np.minimum(room, 0.25 * (upper - lower))
    low = np.concatenate([lower + kept, [-MOST_PITCH, -MOST_AHEAD]])
    high = np.concatenate([upper - kept, [MOST_PITCH, MOST_AHEAD]])
    rest = np.clip(np.append(skeleton.at_rest[at], [0.0, 0.0]), low, high)

    pull = np.array([*[PULL] * len(free), UPRIGHT, 0.0])

    def place(x: Array) -> Array:
        full = q.copy()
        full[at] = x[:-2]
        skeleton.complete(full)
        return full

    def errors(x: Array) -> tuple[Array, float]:
        com = pin.centerOfMass(model, data, place(x))
        ground = pin.SE3(pin.rpy.rpyToMatrix(0.0, float(x[-2]), 0.0), np.zeros(3))
        ahead = pin.SE3(np.eye(3), np.array([x[-1], 0.0, 0.0]))
        found = []
        for leg, sole, target in zip(legs, soles, targets, strict=True):
            T, goal = data.oMi[leg[-1]] * sole.placement, ground * ahead * target
            found += [T.translation - goal.translation, pin.log3(goal.rotation.T @ T.rotation)]
        offset = ground.actInv(com)[0] - x[-1] - targets[0].translation[0]
        return np.concatenate(found), float(offset)

    def residual(x: Array, weight: float, balance: float) -> Array:
        soles_off, offset = errors(x)
        return np.concatenate([soles_off, [balance * offset], weight * pull * (x - rest)])

    best, least = rest, np.inf
    for start in starts:
        x = np.clip(np.append(start[at], [0.0, 0.0]), low + 1e-6, high - 1e-6)
        for weights in ((1.0, 1.0), (0.0, 1.0), (0.0, 0.0)):
            if not any(weights) and np.abs(errors(x)[0]).max() <= enough:
                break
            x = least_squares(
                residual, x, args=weights, bounds=(low, high), xtol=1e-12, ftol=1e-12, gtol=1e-12,
                max_nfev=200,
            ).x  # fmt: skip
            x = np.clip(x, low + 1e-9, high - 1e-9)
        left = float(np.abs(errors(x)[0]).max())
        if left < least:
            best, least = x, left
        if least <= enough:
            break
    q[:] = place(best)
    return least, errors(best)[1]
