"""Joints that are coupled: one motor turns several of them (`mimic` in a URDF).

A follower turns in proportion to its leader,

    q_follower = multiplier q_leader + offset

so that all joint angles are q = S r + s0, where r holds the angles of the joints that are free to
move by themselves. Torques of the joints then act on the motors as S^T tau, and a follower has no
motor of its own.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from mgs.core.arrays import Array


@dataclass(frozen=True)
class Follower:
    """How a joint follows another one."""

    leader: str
    multiplier: float
    offset: float  # [rad]

    def angle(self, leader: float) -> float:
        """Angle of the follower at an angle of its leader [rad]."""
        return self.multiplier * leader + self.offset


@dataclass(frozen=True, eq=False)
class Coupling:
    """Coupled joints of a robot with n joints, by their places in its joint arrays."""

    n: int
    followers: NDArray[np.intp]  # (f,)
    leaders: NDArray[np.intp]  # (f,) of each follower; no leader is a follower itself
    multipliers: Array  # (f,)
    offsets: Array  # (f,) [rad]

    @functools.cached_property
    def motors(self) -> NDArray[np.bool_]:
        """Mask (n,) of the joints that are no followers."""
        mask = np.ones(self.n, dtype=np.bool_)
        mask[self.followers] = False
        return mask

    @functools.cached_property
    def S(self) -> Array:
        """Matrix (n, n) that gives all angles from those of the motors; 0 in followers' columns."""
        S = np.diag(self.motors.astype(np.float64))
        S[self.followers, self.leaders] = self.multipliers
        return S

    @functools.cached_property
    def s0(self) -> Array:
        """Angles (n,) of the joints while all motors are at 0 [rad]."""
        s0 = np.zeros(self.n)
        s0[self.followers] = self.offsets
        return s0

    def complete(self, q: Array) -> None:
        """Set the angles of the followers in q (..., n) by those of their leaders, in place."""
        q[..., self.followers] = self.multipliers * q[..., self.leaders] + self.offsets

    def misses(self, q: Array) -> Array:
        """Distances (..., f) of the followers in q (..., n) from their places [rad]."""
        there = self.multipliers * q[..., self.leaders] + self.offsets
        return np.asarray(q[..., self.followers] - there)

    def at_motors(self, torque: Array) -> Array:
        """S^T tau: torques (..., n) of the motors that make joint torques (..., n); followers 0."""
        return np.asarray(torque @ self.S)


def read_followers(root: ElementTree.Element) -> dict[str, Follower]:
    """Followers in a URDF whose numbers have been checked, by the name of the joint.

    A joint that follows a follower is given with the leader of the latter. A chain of followers
    that ends nowhere is given as it is: its leader is a follower, or no joint.
    """
    direct = {}
    for joint in root.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and joint.get("type") != "fixed":
            direct[joint.get("name", "")] = Follower(
                mimic.get("joint", ""),
                float(mimic.get("multiplier", "1")),
                float(mimic.get("offset", "0")),
            )
    return {name: _resolved(name, direct) for name in direct}


def _resolved(name: str, direct: Mapping[str, Follower]) -> Follower:
    found, seen = direct[name], {name}
    while found.leader in direct and found.leader not in seen:
        seen.add(found.leader)
        above = direct[found.leader]
        offset = found.multiplier * above.offset + found.offset
        found = Follower(above.leader, found.multiplier * above.multiplier, offset)
    return found


def coupling_of(names: tuple[str, ...], followers: Mapping[str, Follower]) -> Coupling | None:
    """The coupling of joints with these names; None if none of them is coupled."""
    if not followers:
        return None
    order = [name for name in names if name in followers]
    return Coupling(
        n=len(names),
        followers=np.array([names.index(name) for name in order]),
        leaders=np.array([names.index(followers[name].leader) for name in order]),
        multipliers=np.array([followers[name].multiplier for name in order]),
        offsets=np.array([followers[name].offset for name in order]),
    )
