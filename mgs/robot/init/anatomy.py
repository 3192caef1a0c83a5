"""Identification of legs, waist, arms and head from the shape of the kinematic tree.

Feet are the bodies whose surface reaches the ground while the robot stands with every joint at 0.
Legs are the joints between the feet and the body that carries both. Arms are the longest pair of
mirror-symmetric chains outside the legs; an arm ends where it branches into fingers. z points up
and x forward (ROS REP 103).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from mgs.core.errors import ConfigError
from mgs.robot.init.skeleton import BASE, Skeleton
from mgs.robot.init.source import Source

GROUND_LAYER = 0.02  # parts of the height: thickness of the layer in which feet are searched
SOLE_LAYER = 0.004  # parts of the height: a body this close above the lowest one stands as well
MIRRORED = 0.03  # parts of the height: tolerance of mirror symmetry


@dataclass(frozen=True)
class Anatomy:
    """Pinocchio joint ids of each limb, from the trunk outward."""

    legs: tuple[list[int], list[int]]  # left and right
    waist: list[int]  # from the body that carries the legs to the one that carries the arms
    arms: tuple[list[int], list[int]] | None
    head: list[int]
    locked: dict[int, str]  # reason for each locked joint
    pelvis: int  # body that carries the legs
    torso: int  # body that carries the arms

    @property
    def feet(self) -> tuple[int, int]:
        """Bodies of the left and the right foot."""
        return self.legs[0][-1], self.legs[1][-1]


def find_anatomy(skeleton: Skeleton, source: Source) -> Anatomy:
    """Assign the joints of a robot to its limbs.

    Raises:
        ConfigError: the robot does not have two equal legs; the message states what was found.
    """
    feet = _feet(skeleton, source)
    paths = [skeleton.path(foot) for foot in feet]
    shared = [a for a, b in zip(*paths, strict=False) if a == b]
    pelvis = shared[-1] if shared else BASE
    left, right = (path[len(shared) :] for path in paths)
    if len(left) != len(right):
        raise ConfigError(
            source.path,
            f"the legs have different numbers of joints: {len(left)} to {skeleton.name(feet[0])} "
            f"and {len(right)} to {skeleton.name(feet[1])}",
        )
    locked = {body: "toe" for foot in feet for body in skeleton.below(foot) if body != foot}
    for side in (left, right):  # other bodies that a leg carries
        hanging = {body for joint in side for body in skeleton.below(joint)} - {*side}
        locked |= {body: "on a leg" for body in hanging if body not in locked}
    in_legs = {*left, *right, *locked}
    rest = [j for j in range(2, skeleton.model.njoints) if j not in in_legs and j not in shared]
    arms = _arms(skeleton, rest)
    if arms is None:
        return Anatomy((left, right), *_without_arms(skeleton, rest, shared, locked, pelvis))
    torso = int(skeleton.model.parents[arms[0][0]])
    waist = [j for j in skeleton.path(torso) if j not in shared]
    waist += [j for j in reversed(shared) if j not in skeleton.path(torso)]
    arms = _without_fingers(skeleton, arms, source.leaders)
    for side in arms:
        locked |= {b: "finger" for b in skeleton.below(side[0]) if b not in side}
    taken = {*in_legs, *waist, *arms[0], *arms[1], *locked}
    head = _head(skeleton, [j for j in rest if j not in taken])
    locked |= {j: "neither leg, arm, waist nor head" for j in rest if j not in {*taken, *head}}
    return Anatomy((left, right), waist, arms, head, locked, pelvis, torso)


def _without_arms(
    skeleton: Skeleton, rest: list[int], shared: list[int], locked: dict[int, str], pelvis: int
) -> tuple[list[int], None, list[int], dict[int, str], int, int]:
    """Waist, arms, head, locked joints, pelvis and torso of a robot without arms."""
    chain = _head(skeleton, rest)
    locked = locked | {j: "neither leg, arm, waist nor head" for j in rest if j not in chain}
    torso = chain[-1] if chain else pelvis
    return chain, None, [], locked, pelvis, torso


def _feet(skeleton: Skeleton, source: Source) -> tuple[int, int]:
    """Bodies of the left and the right foot."""
    feet = standing_bodies(skeleton, source)
    middles = [skeleton.points_at_rest(foot)[:, 1].mean() for foot in feet]
    left, right = feet if middles[0] > middles[1] else feet[::-1]
    return left, right


def standing_bodies(skeleton: Skeleton, source: Source) -> tuple[int, int]:
    """The two bodies that reach the ground, without toes, in any order."""
    bodies = range(1, skeleton.model.njoints)
    low = {body: float(skeleton.points_at_rest(body)[:, 2].min()) for body in bodies}
    top = max(float(skeleton.points_at_rest(body)[:, 2].max()) for body in bodies)
    ground = min(low.values())
    height = top - ground
    if low[BASE] <= ground + GROUND_LAYER * height:
        raise ConfigError(
            source.path,
            f"the base link {skeleton.links[BASE][0]} reaches down to the ground; mgs supports "
            "only robots that stand on two legs, and z must point up with every joint at 0",
        )
    limbs: dict[int, list[int]] = {}  # bodies near the ground by the first body of their limb
    for body in bodies:
        if low[body] <= ground + GROUND_LAYER * height:
            limbs.setdefault(_first_of_limb(skeleton, body, low, ground, height), []).append(body)
    feet = []
    for near in limbs.values():
        lowest = min(low[body] for body in near)
        feet.append(min(b for b in near if low[b] <= lowest + SOLE_LAYER * height))
    if len(feet) != 2:
        names = ", ".join(skeleton.links[foot][0] for foot in feet)
        raise ConfigError(
            source.path,
            "mgs supports only robots that stand on two legs; with every joint at 0 and z up the "
            f"ground is reached by {names}",
        )
    return feet[0], feet[1]


def _first_of_limb(
    skeleton: Skeleton, body: int, low: dict[int, float], ground: float, height: float
) -> int:
    """Highest body on the path to `body` that carries no other body near the ground."""
    first = body
    for above in reversed(skeleton.path(body)[:-1]):
        ends = [b for b in skeleton.below(above) if low[b] <= ground + GROUND_LAYER * height]
        if any(body not in skeleton.path(b) and b not in skeleton.path(body) for b in ends):
            break
        first = above
    return first


def _arms(skeleton: Skeleton, rest: list[int]) -> tuple[list[int], list[int]] | None:
    """Joints of the longest pair of mirror-symmetric chains, left first."""
    origins = {j: skeleton.placements[j].translation for j in rest}
    lows = [skeleton.points_at_rest(b)[:, 2] for b in range(1, skeleton.model.njoints)]
    height = float(max(z.max() for z in lows) - min(z.min() for z in lows))
    leaves = [j for j in rest if not skeleton.children(j)]
    best: tuple[float, list[int], list[int]] | None = None
    for a, b in itertools.permutations(leaves, 2):
        mirrored = origins[b] * [1.0, -1.0, 1.0]
        if not origins[a][1] > MIRRORED * height:
            continue
        if np.abs(origins[a] - mirrored).max() > MIRRORED * height:
            continue
        left, right = skeleton.path(a), skeleton.path(b)
        shared = [i for i, j in zip(left, right, strict=False) if i == j]
        left, right = left[len(shared) :], right[len(shared) :]
        length = sum(
            float(np.linalg.norm(origins[j] - origins[i])) for i, j in itertools.pairwise(left)
        )
        if len(left) == len(right) and (best is None or length > best[0]):
            best = length, left, right
    return None if best is None else (best[1], best[2])


def _without_fingers(
    skeleton: Skeleton, arms: tuple[list[int], list[int]], leaders: set[str]
) -> tuple[list[int], list[int]]:
    """Arms up to the hand: up to a branch, or up to the first joint that other joints mimic."""
    n = len(arms[0])
    for arm in arms:
        for i, joint in enumerate(arm):
            if skeleton.name(joint) in leaders:
                n = min(n, i)
            elif len(skeleton.children(joint)) > 1:
                n = min(n, i + 1)
    n = max(n, 1)
    return arms[0][:n], arms[1][:n]


def _head(skeleton: Skeleton, rest: list[int]) -> list[int]:
    """Chain of `rest` that reaches highest, up to its first branch."""
    roots = [j for j in rest if int(skeleton.model.parents[j]) not in rest]
    if not roots:
        return []
    tops = [max(skeleton.points_at_rest(b)[:, 2].max() for b in skeleton.below(j)) for j in roots]
    chain = [roots[int(np.argmax(tops))]]
    while len(following := skeleton.children(chain[-1])) == 1:
        chain += following
    return chain
