"""Arms that keep clear of legs and trunk while the robot walks.

While a robot walks its thighs swing, but its arms hang nearly still. Where a forearm or a hand
would touch anything but its own arm, the hands are placed further out.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NV
from mgs.robot.init.anatomy import Anatomy
from mgs.robot.init.collisions import Watched, nearly_touching
from mgs.robot.init.skeleton import Skeleton
from mgs.robot.robot import Robot

# Each is tried in turn, since shoulders bear more the further out the hands are.
OUTWARD = (
    0.25,
    0.3,
    0.35,
    0.45,
    0.6,
    0.8,
)  # directions of the hands that are tried; 0.96 down, 0.2 forward
MOST_NAMED = 3  # largest number of pairs of links in a note


def kept_apart(skeleton: Skeleton, anatomy: Anatomy, links: list[str]) -> Watched:
    """Tells which two links may never touch near the posture, though their boxes are close.

    These are the lower half of one leg and of the other leg, and the lower half of an arm and
    everything but that arm. `links` holds the name of the link of each body.
    """
    shins = {links[joint] for leg in anatomy.legs for joint in leg[len(leg) // 2 :]}
    arms = [(_below(skeleton, arm[0], links), _forearm(skeleton, arm, links))
            for arm in anatomy.arms or ()]  # fmt: skip

    def watched(one: str, other: str) -> bool:
        if one in shins and other in shins:
            return True
        return any(
            (one in forearm and other not in arm) or (other in forearm and one not in arm)
            for arm, forearm in arms
        )

    return watched


def with_clear_arms(
    robot: Robot,
    skeleton: Skeleton,
    anatomy: Anatomy,
    links: list[str],
    placed: Callable[[float], tuple[Robot, Array]],
    notes: list[str],
) -> tuple[Robot, Array | None]:
    """The robot with arms that keep clear, and its new configuration (nq,); None: as it was.

    Args:
        robot: the robot with its arms as they hang at first.
        skeleton: its bodies.
        anatomy: its limbs.
        links: name of the link of each body.
        placed: gives the robot and its configuration for a direction of the hands.
        notes: takes a line where the arms were moved, or touch in each of the directions.
    """
    if anatomy.arms is None:
        return robot, None
    forearms = set().union(*(_forearm(skeleton, arm, links) for arm in anatomy.arms))
    apart = kept_apart(skeleton, anatomy, links)

    def touching(candidate: Robot) -> list[tuple[str, str]]:
        left, right = anatomy.legs
        stepping = {skeleton.name(joint) for joint in [*left, *right]}
        moving = [i for i, name in enumerate(candidate.joint_names) if name in stepping]
        watched = nearly_touching(candidate, apart, moving)
        return [pair for pair in watched if forearms & set(pair)]

    first = touching(robot)
    if not first:
        return robot, None
    named = ", ".join(f"{one} and {other}" for one, other in first[:MOST_NAMED])
    for outward in OUTWARD:
        candidate, q = placed(outward)
        if not _holds(candidate, skeleton, anatomy):
            break
        if not touching(candidate):
            notes.append(f"arms held further out, since {named} would touch in a step")
            return candidate, q
    notes.append(f"{named} may touch in a step, and the arms cannot be held clear of it")
    return robot, None


def _holds(robot: Robot, skeleton: Skeleton, anatomy: Anatomy) -> bool:
    """Whether the servos of the arms can hold them where they are for as long as one likes."""
    joints = {skeleton.name(joint) for arm in anatomy.arms or () for joint in arm}
    data = robot.model.createData()
    held = pin.computeGeneralizedGravity(robot.model, data, robot.standing_q)[FLOATING_BASE_NV:]
    of_arms = np.array([name in joints for name in robot.joint_names])
    return bool(np.all(np.abs(held) <= robot.lasting_torque, where=of_arms))


def _forearm(skeleton: Skeleton, arm: list[int], links: list[str]) -> set[str]:
    """Links of the lower half of an arm, with hand and fingers."""
    return _below(skeleton, arm[len(arm) // 2], links)


def _below(skeleton: Skeleton, body: int, links: list[str]) -> set[str]:
    """Links of a body and of all bodies that it carries."""
    return {links[each] for each in skeleton.below(body)}
