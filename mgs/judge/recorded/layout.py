"""Which layout a file of somebody else's motion has: the one in which the robot stands.

Every layout whose files end like this one is tried. Of those that can be read, the one counts in
which links are where the joints put them, stated velocities are those of the positions, and the
robot stands. Two layouts that differ in none of this and give different motions are told apart by
the user alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mgs.core.errors import ConfigError, MgsError
from mgs.core.short_repr import short_repr
from mgs.judge.audit.body import body_along
from mgs.judge.audit.orientation import BETTER
from mgs.judge.audit.run import LEAST_SAMPLES
from mgs.judge.audit.tree import JointPoses, joint_poses
from mgs.judge.audit.velocities import velocity_findings
from mgs.judge.recorded.placed import Choices, Placed, place_recorded
from mgs.motion_file.formats import FORMATS, RecordedMotion, find_format
from mgs.motion_file.formats.plain.csv_table import rate_of
from mgs.motion_file.formats.recorded import Reading
from mgs.motion_file.joint_log import read_csv_log
from mgs.robot import Robot
from mgs.robot.orders import robot_order

JOINT_TABLE = "joint-table"  # a CSV table with a head line that names joints, and a time
FAR_LINKS = 5e-3  # [m] beyond which links are not where the joints put them


@dataclass(frozen=True, eq=False)
class Candidate:
    """A layout in which a file can be read."""

    layout: str
    placed: Placed
    link_error: float  # [m] mean distance of links from where the joints put them; 0: not stated
    n_velocity: int  # findings on its stated velocities

    __repr__ = short_repr

    @property
    def misfit(self) -> float:
        """How unlikely it is; 0 is the best."""
        return self.placed.score + self.link_error / FAR_LINKS + self.n_velocity


def layouts() -> list[str]:
    """Names of the layouts that can be read."""
    return [*(name for name, entry in FORMATS.items() if entry.readable), JOINT_TABLE]


def read_placed(
    path: Path, robot: Robot, layout: str | None, choices: Choices
) -> tuple[str, Placed]:
    """The motion of a file on a robot, and the layout that it has.

    Args:
        path: the file or folder.
        robot: whose motion it is.
        layout: one of `layouts()`; None: it is found out.
        choices: what the user says of the file.

    Raises:
        ConfigError: no layout fits, or several do; or the user has to choose something else.
        MgsError: a library is missing.
    """
    if layout is not None:
        recorded = _read(path, robot, layout, choices)
        return layout, place_recorded(recorded, robot, choices, str(path))
    if path.suffix == ".mcap":
        raise ConfigError(path, "a motion file; all commands read it as it is")
    fitting, unlike, unclear = [], [], []
    for name in _possible(path):
        try:
            recorded = _read(path, robot, name, choices)
        except MgsError as error:
            unlike.append(f"not {name}: {_reason(error, path)}")
            continue
        try:
            fitting.append(_candidate(name, recorded, robot, choices, path))
        except MgsError as error:
            unclear.append(f"as {name}: {_reason(error, path)}")
    if not fitting:
        raise ConfigError(path, unclear or ["it has no layout that is known", *unlike])
    fitting.sort(key=lambda candidate: candidate.misfit)
    best = fitting[0]
    for other in fitting[1:]:
        q = other.placed.given.q
        same = q.shape == best.placed.given.q.shape and np.allclose(q, best.placed.given.q)
        if not same and other.misfit < BETTER * best.misfit + 0.1:
            raise ConfigError(
                path,
                f"may have the layout {best.layout} or {other.layout}, which give different "
                f"motions; choose one with --layout",
            )
    return best.layout, best.placed


def _possible(path: Path) -> list[str]:
    suffix, folder = "" if path.is_dir() else path.suffix.lower(), path.is_dir()
    names = [
        name
        for name, entry in FORMATS.items()
        if (entry.suffix, not entry.suffix) == (suffix, folder) and entry.readable
    ]
    if not names:
        told = f"end in {suffix!r}" if suffix else "have no ending"
        raise ConfigError(path, f"files of no layout {told}; say which layout it has by --layout")
    return [*names, JOINT_TABLE] if suffix == ".csv" else names


def _reason(error: MgsError, path: Path) -> str:
    return str(error).removeprefix(f"{path}: ")


def _read(path: Path, robot: Robot, layout: str, choices: Choices) -> RecordedMotion:
    if layout != JOINT_TABLE:
        return find_format(layout).read(path, robot, choices.order)
    log = read_csv_log(path)
    if not np.isfinite(log.position).all():
        raise ConfigError(path, "has cells without a number, so that it is a log and no motion")
    return RecordedMotion(
        layout=JOINT_TABLE,
        fps=rate_of(Reading(path), log.times),
        joint_names=log.names,
        order=None,
        joints=log.position,
    )


def _candidate(
    layout: str, recorded: RecordedMotion, robot: Robot, choices: Choices, path: Path
) -> Candidate:
    placed = place_recorded(recorded, robot, choices, str(path))
    given = placed.given
    error, n_velocity = 0.0, 0
    if recorded.links is not None:
        names = recorded.links.names
        if names is None and recorded.order is not None:
            names = robot_order(robot, recorded.order).links
        if names is not None and len(names) == recorded.links.position.shape[1]:
            error = _link_error(robot, joint_poses(robot, given.q), names, recorded)
    if given.n_samples >= LEAST_SAMPLES:
        n_velocity = len(velocity_findings(given, body_along(given)))
    return Candidate(layout, placed, error, n_velocity)


def _link_error(
    robot: Robot, poses: JointPoses, names: tuple[str, ...], recorded: RecordedMotion
) -> float:
    """Mean distance of links from where the joints put them [m]."""
    assert recorded.links is not None
    apart = []
    for b, name in enumerate(names):
        if robot.model.existBodyName(name):
            frame = robot.model.frames[robot.model.getBodyId(name)]
            R, p = poses.R[frame.parentJoint], poses.p[frame.parentJoint]
            there = p + R @ frame.placement.translation
            apart.append(np.linalg.norm(there - recorded.links.position[:, b], axis=1).mean())
    return float(np.mean(apart)) if apart else 0.0
