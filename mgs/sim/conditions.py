"""What differs between the robot that was planned for and the one that walks: one draw of it.

Ranges are symmetric about the plan except where the plan is the best case (supply, latency, bumps).
A draw depends on the seed and its number alone, so that any one of a thousand can be repeated.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mgs.core.arrays import Array
from mgs.core.scene import Box
from mgs.core.short_repr import short_repr
from mgs.motion import Motion
from mgs.robot import Robot
from mgs.sim.settings import ServoName

BUMP_SIZE = 0.02  # [m] edge of a bump, a flat square


@dataclass(frozen=True, kw_only=True)
class Ranges:
    """How far conditions stray."""

    friction: tuple[float, float]  # of the pair sole and ground
    slope_deg: float  # of the floor, about x and about y, either way
    mass: float  # part of each link's mass, either way
    com: float  # [m] of all links alike, along each axis, either way
    gain: float  # part of each servo's stiffness, either way
    supply: float  # part of the stall torques that is missing at most
    joint_offset_deg: float  # standard deviation of each joint's zero
    latency: float  # [s] at most
    bump: float  # [m] height of one bump under each landing foot at most
    sag: tuple[float, float]  # factors on the sag of PD servos, the plan's is 1

    def scaled(self, factor: float) -> Ranges:
        """Ranges with every deviation from the plan multiplied."""
        low, high = self.friction  # the plan's is the higher one
        return Ranges(
            friction=(high + factor * (low - high), high),
            slope_deg=factor * self.slope_deg,
            mass=factor * self.mass,
            com=factor * self.com,
            gain=factor * self.gain,
            supply=factor * self.supply,
            joint_offset_deg=factor * self.joint_offset_deg,
            latency=factor * self.latency,
            bump=factor * self.bump,
            sag=(self.sag[0] ** factor, self.sag[1] ** factor),
        )


WIDE = Ranges(
    friction=(0.5, 1.0),
    slope_deg=1.0,
    mass=0.05,
    com=0.005,
    gain=0.2,
    supply=0.2,
    joint_offset_deg=0.3,
    latency=0.010,
    bump=0.002,
    sag=(0.25, 4.0),
)
RANGES: dict[str, Ranges] = {"wide": WIDE, "lab": WIDE.scaled(0.5)}


@dataclass(frozen=True, eq=False)
class Conditions:
    """One draw; n joints, n + 1 links (the base first)."""

    friction: float
    slope: Array  # (2,) about x and y [rad]
    mass: Array  # (n + 1,) factors
    com: Array  # (3,) shift of each link's CoM in its own frame [m]
    gain: Array  # (n,) factors
    supply: float  # factor on stall torques
    joint_offset: Array  # (n,) [rad]
    latency: float  # [s]
    bumps: Array  # (k, 3) x, y and height [m]
    sag: float  # factor on the sag of PD servos

    __repr__ = short_repr

    def figures(self, servo: ServoName = "ideal") -> dict[str, float]:
        """One number for each parameter that a kind of servo depends on."""
        figures = {
            "friction": self.friction,
            "slope_x_deg": float(np.degrees(self.slope[0])),
            "slope_y_deg": float(np.degrees(self.slope[1])),
            "mass": float(self.mass.mean()),
            "com_x": float(self.com[0]),
            "com_y": float(self.com[1]),
            "com_z": float(self.com[2]),
            "gain": float(self.gain.mean()),
            "supply": self.supply,
            "joint_offset_deg": float(np.degrees(np.sqrt(np.mean(self.joint_offset**2)))),
            "latency": self.latency,
            "bump": float(self.bumps[:, 2].max(initial=0.0)),
        }
        return figures | ({"sag": self.sag} if servo == "pd" else {})


def draw(motion: Motion, ranges: Ranges, seed: int, number: int) -> Conditions:
    """Draw number `number` (from 0) of the draws that `seed` starts."""
    rng, n = np.random.default_rng([seed, number]), motion.robot.n
    return Conditions(
        friction=float(rng.uniform(*ranges.friction)),
        slope=np.radians(rng.uniform(-ranges.slope_deg, ranges.slope_deg, 2)),
        mass=1.0 + rng.uniform(-ranges.mass, ranges.mass, n + 1),
        com=rng.uniform(-ranges.com, ranges.com, 3),
        gain=1.0 + rng.uniform(-ranges.gain, ranges.gain, n),
        supply=float(1.0 - rng.uniform(0.0, ranges.supply)),
        joint_offset=np.radians(rng.normal(0.0, ranges.joint_offset_deg, n)),
        latency=float(rng.uniform(0.0, ranges.latency)),
        bumps=_draw_bumps(motion, rng, ranges.bump),
        sag=float(np.exp(rng.uniform(*np.log(ranges.sag)))),
    )


def _draw_bumps(motion: Motion, rng: np.random.Generator, most: float) -> Array:
    """One bump (k, 3) somewhere under every footstep but those that the robot starts on.

    Its height is above the ground; on a box there is none.
    """
    bumps = []
    for step in motion.footsteps[2:]:
        sole = motion.robot.sole_spec(step.side)
        along = rng.uniform(-0.5, 0.5) * (sole.length - BUMP_SIZE)
        across = rng.uniform(-0.5, 0.5) * (sole.width - BUMP_SIZE)
        c, s = np.cos(step.yaw), np.sin(step.yaw)
        x, y = step.x + c * along - s * across, step.y + s * along + c * across
        bumps.append([x, y, rng.uniform(0.0, most)])
    return np.array(bumps).reshape(-1, 3)


def bumps(conditions: Conditions | None) -> list[Box]:
    """The bumps as boxes."""
    heights = [] if conditions is None else conditions.bumps.tolist()
    return [Box(x, y, 0.0, BUMP_SIZE, BUMP_SIZE, height) for x, y, height in heights]


def disturbed(robot: Robot, conditions: Conditions) -> Robot:
    """The robot that is there instead of the one planned for: masses, CoM and stall torques."""
    model = robot.model.copy()
    for joint, factor in enumerate(conditions.mass, start=1):
        link = robot.model.inertias[joint]
        lever = link.lever + conditions.com
        model.inertias[joint] = pin.Inertia(factor * link.mass, lever, factor * link.inertia)
    torque_limit = conditions.supply * robot.torque_limit
    there = dataclasses.replace(robot, model=model, torque_limit=torque_limit)
    vars(there)["geometry"] = robot.geometry  # the shapes are the same; parsing them takes time
    return there


def gravity_on_slope(slope: Array, gravity: float) -> Array:
    """Gravity (3,) [m/s^2] in the frame of a floor turned by slope (2,) about x and y [rad]."""
    turn = pin.rpy.rpyToMatrix(float(slope[0]), float(slope[1]), 0.0)
    return np.asarray(turn.T @ np.array([0.0, 0.0, -gravity]))
