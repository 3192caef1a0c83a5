"""The direction in which a robot faces, from several signs that are weighed against each other.

With every joint at 0 or nearest to it, the feet stand side by side. Of the two directions across
the line between them, the one with more weight of signs is forward.
"""

from __future__ import annotations

import math
import re

import numpy as np

from mgs.core.arrays import Array
from mgs.robot.init.anatomy import standing_bodies
from mgs.robot.init.skeleton import Skeleton
from mgs.robot.init.source import Source
from mgs.robot.urdf_text import joint_axis

KNEE_RANGE, KNEE_BEND, TOES, NAMES = 2.0, 0.5, 1.0, 2.5  # weights of the signs
DECISIVE_RANGE = 0.2  # least asymmetry of a knee's range, as part of the range, that is a sign
LEAST_BEND = 0.05  # least distance of a knee from the line between hip and ankle, per leg length
DECISIVE_TOES = 0.15  # least difference between toe and heel, as part of the length of the foot
LEFT = re.compile(r"(^|[_\-.])(left|l)([_\-.]|$)", re.IGNORECASE)
RIGHT = re.compile(r"(^|[_\-.])(right|r)([_\-.]|$)", re.IGNORECASE)


def heading(skeleton: Skeleton, source: Source) -> float:
    """Yaw of the forward direction in the base frame, a multiple of a quarter turn [rad].

    Signs that contradict each other are noted in the source.
    """
    feet = standing_bodies(skeleton, source)
    ends = [skeleton.points_at_rest(foot).mean(axis=0) for foot in feet]
    apart = np.abs(ends[0] - ends[1])[:2]
    ahead = np.array([1.0, 0.0] if apart[1] >= apart[0] else [0.0, 1.0])
    votes = forward_signs(skeleton, feet, ahead)
    total = sum(votes.values())
    if total < 0.0:
        ahead = -ahead
    for_it, against = (
        [sign for sign, vote in votes.items() if vote * (total or 1.0) * way > 0.0]
        for way in (1.0, -1.0)
    )
    if against:
        source.notes.append(
            f"signs of the forward direction contradict each other: {', '.join(for_it)} for the "
            f"direction taken, {', '.join(against)} for the opposite one"
        )
    return math.atan2(ahead[1], ahead[0]) if ahead.min() < 0.0 or ahead[1] else 0.0


def forward_signs(skeleton: Skeleton, feet: tuple[int, int], ahead: Array) -> dict[str, float]:
    """Weights of the signs that a robot faces along `ahead` (2,); negative: the opposite way."""
    legs = [(_knee(skeleton, foot), foot) for foot in feet]
    signs = {
        "the range of the knees": (KNEE_RANGE, [_knee_range(skeleton, *leg) for leg in legs]),
        "the bend of the knees at 0": (KNEE_BEND, [_knee_bend(skeleton, *leg) for leg in legs]),
        "the length of the toes": (TOES, [_toes(skeleton, foot) for foot in feet]),
    }
    votes = {
        name: weight * float(np.sign(round(float(np.sum(directions, axis=0) @ ahead), 9)))
        for name, (weight, directions) in signs.items()
    }
    votes["the names of left and right"] = NAMES * _names(skeleton, feet, ahead)
    return {name: vote for name, vote in votes.items() if vote}


def _knee(skeleton: Skeleton, foot: int) -> int:
    """The joint nearest to mid-leg whose axis is not vertical."""
    path = skeleton.path(foot)
    heights = {j: skeleton.placements[j].translation[2] for j in path}
    ground = skeleton.points_at_rest(foot)[:, 2].min()
    candidates = [j for j in path if abs(_axis_in_base(skeleton, j)[2]) < 0.5]
    middle = 0.5 * (heights[path[0]] + ground)
    return min(candidates or path, key=lambda j: abs(heights[j] - middle))


def _knee_range(skeleton: Skeleton, knee: int, foot: int) -> Array:
    """Forward (2,) if a knee bends farther one way, since bending moves the foot backward."""
    at, model = int(skeleton.model.idx_qs[knee]), skeleton.model
    up = model.upperPositionLimit[at] - skeleton.at_rest[at]
    down = skeleton.at_rest[at] - model.lowerPositionLimit[at]
    if abs(up - down) < DECISIVE_RANGE * (up + down):
        return np.zeros(2)
    arm = skeleton.placements[foot].translation - skeleton.placements[knee].translation
    moved = np.cross(_axis_in_base(skeleton, knee), arm) * (up - down)
    return np.asarray(-moved[:2])


def _knee_bend(skeleton: Skeleton, knee: int, foot: int) -> Array:
    """Forward (2,) if a knee lies beside the line from the hip to the foot: knees bend forward."""
    path = skeleton.path(foot)
    pitch = [j for j in path if abs(_axis_in_base(skeleton, j)[2]) < 0.5]
    hip = skeleton.placements[pitch[0]].translation
    ankle = skeleton.placements[foot].translation
    line = ankle - hip
    offset = skeleton.placements[knee].translation - hip
    beside = offset - line * (offset @ line) / (float(line @ line) or 1.0)
    far = np.linalg.norm(beside[:2]) > LEAST_BEND * np.linalg.norm(line)
    return np.asarray(beside[:2]) if far else np.zeros(2)


def _toes(skeleton: Skeleton, foot: int) -> Array:
    """Forward (2,) if a foot reaches farther from its ankle to one end than to the other one."""
    points = skeleton.points_at_rest(foot)[:, :2] - skeleton.placements[foot].translation[:2]
    front, back = points.max(axis=0), -points.min(axis=0)
    return np.where(np.abs(front - back) > DECISIVE_TOES * (front + back), front - back, 0.0)


def _names(skeleton: Skeleton, feet: tuple[int, int], ahead: Array) -> float:
    """1 if the foot named left is on the left of a robot that faces along `ahead`, else -1."""
    sides = {}
    for foot in feet:
        name = " ".join((skeleton.name(foot), *skeleton.links[foot]))
        words = re.split(r"\s+", name)
        left, right = (any(rule.search(word) for word in words) for rule in (LEFT, RIGHT))
        if left != right:
            sides[left] = skeleton.points_at_rest(foot).mean(axis=0)[:2]
    if len(sides) != 2:
        return 0.0
    to_left = np.array([-ahead[1], ahead[0]])
    return float(np.sign((sides[True] - sides[False]) @ to_left))


def _axis_in_base(skeleton: Skeleton, joint: int) -> Array:
    return np.asarray(skeleton.placements[joint].rotation @ joint_axis(skeleton.model, joint))
