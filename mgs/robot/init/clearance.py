"""Arms that keep clear of legs and trunk while the robot walks.

While a robot walks its thighs swing, but its arms hang nearly still. Where a forearm or a hand
would touch anything but its own arm, the hands are placed further out or forward. There they also
have room to sway, and are clear of the thighs in a squat or a bow, if they can be.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.contact import Side
from mgs.robot.init.anatomy import Anatomy
from mgs.robot.init.collisions import Watched, nearly_touching, steps_on_the_spot
from mgs.robot.init.skeleton import Skeleton
from mgs.robot.robot import Robot
from mgs.robot.roles import find_roles

# Directions of the hands that are tried, forward and outward, as of `find_posture`: nearest first.
HANDS = (
    (0.2, 0.25), (0.2, 0.35), (0.45, 0.25), (0.45, 0.35), (0.2, 0.5), (0.45, 0.5), (0.8, 0.25),
    (0.2, 0.8), (0.8, 0.35), (0.45, 0.8), (0.8, 0.5), (0.8, 0.8),
)  # fmt: skip
HOLDING = 0.8  # of the torque that a servo of an arm bears for long; the rest moves the hand
RAISED = 0.65  # [rad] a little more than the generic squat and bow bend the hips (0.60 on OP3)
N_RAISED = 13  # number of angles up to RAISED that are tried
MOST_NAMED = 3  # largest number of pairs of links in a note


def kept_apart(skeleton: Skeleton, anatomy: Anatomy, links: list[str]) -> Watched:
    """Tells which two links may never touch near the posture, though their boxes are close.

    These are the lower half of one leg and of the other leg, and the forearm with its hand and
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
    placed: Callable[[tuple[float, float]], tuple[Robot, Array]],
    notes: list[str],
) -> tuple[Robot, Array | None, list[tuple[str, str]]]:
    """The robot with arms that keep clear, as far as their servos can bear it.

    Also its new configuration (nq,), or None if that is as it was, and the pairs of links that may
    still touch in a step.

    Args:
        robot: the robot with its arms as they hang at first.
        skeleton: its bodies.
        anatomy: its limbs.
        links: name of the link of each body.
        placed: gives the robot and its configuration for a direction of the hands.
        notes: takes a line where the arms were moved, and one where they may still touch.
    """
    if anatomy.arms is None:
        return robot, None, []
    forearms = set().union(*(_forearm(skeleton, arm, links) for arm in anatomy.arms))
    apart = kept_apart(skeleton, anatomy, links)
    stepping = {skeleton.name(joint) for leg in anatomy.legs for joint in leg}

    def touching(candidate: Robot) -> list[list[tuple[str, str]]]:
        """Pairs that touch in a step, if the robot sways as well, and while the hips bend."""
        moving = [i for i, name in enumerate(candidate.joint_names) if name in stepping]
        return [
            [pair for pair in nearly_touching(candidate, apart, each) if forearms & set(pair)]
            for each in (
                steps_on_the_spot(candidate, moving, sways=False),
                steps_on_the_spot(candidate, moving, sways=True),
                _bent_hips(candidate),
            )
        ]

    first = touching(robot)
    if not first[0]:
        return robot, None, []
    named = ", ".join(f"{one} and {other}" for one, other in first[0][:MOST_NAMED])
    found, found_q, still = robot, None, first
    for hands in HANDS:
        candidate, q = placed(hands)
        if not _holds(candidate, skeleton, anatomy):
            continue
        left = touching(candidate)
        if list(map(len, left)) < list(map(len, still)):
            found, found_q, still = candidate, q, left
        if not any(left):
            break
    if found_q is not None:
        notes.append(f"hands held further out or forward, since in a step {named} would get close")
    if still[0]:
        notes.append(
            f"the shapes of {', '.join(' and '.join(pair) for pair in still[0])} may touch in a "
            "step; they are listed in ignore_collisions, since they are larger than the links"
        )
    return found, found_q, still[0]


def _bent_hips(robot: Robot) -> Iterator[Array]:
    """Configurations (nq,) whose hips bend more and more; none if the hips have no pitch joints."""
    roles = find_roles(robot)
    hips = [roles[name] for side in Side if (name := f"{side.label}_hip_pitch") in roles]
    for angle in np.linspace(0.0, RAISED, N_RAISED)[1:] if hips else ():
        q = robot.standing_q.copy()
        for hip in hips:  # a positive angle of the role moves the thigh back
            bent = robot.posture[hip.joint] - hip.sign * angle
            q[FLOATING_BASE_NQ + hip.joint] = np.clip(
                bent, robot.lower[hip.joint], robot.upper[hip.joint]
            )
        yield q


def _holds(robot: Robot, skeleton: Skeleton, anatomy: Anatomy) -> bool:
    """Whether the servos of the arms can hold them where they are for as long as one likes."""
    joints = {skeleton.name(joint) for arm in anatomy.arms or () for joint in arm}
    data = robot.model.createData()
    held = pin.computeGeneralizedGravity(robot.model, data, robot.standing_q)[FLOATING_BASE_NV:]
    of_arms = np.array([name in joints for name in robot.joint_names])
    return bool(np.all(np.abs(held) <= HOLDING * robot.lasting_torque, where=of_arms))


def _forearm(skeleton: Skeleton, arm: list[int], links: list[str]) -> set[str]:
    """Links below the elbow, with hand and fingers; an elbow may be close to the trunk."""
    return _below(skeleton, arm[min(len(arm) // 2 + 1, len(arm) - 1)], links)


def _below(skeleton: Skeleton, body: int, links: list[str]) -> set[str]:
    """Links of a body and of all bodies that it carries."""
    return {links[each] for each in skeleton.below(body)}
