"""How far two engines agree on one motion.

Contact forces of single physics steps chatter, in every engine its own way: they are compared as
means over `WINDOW`. What is compared ends with the shorter replay, if a robot fell.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from mgs.core.arrays import Array
from mgs.core.geometry import wrap_angle
from mgs.sim.measure import travel
from mgs.sim.replay import Replay

WINDOW = 0.05  # [s]
LEAST_LOAD = 0.5  # of the mean load, for there to be a ZMP worth comparing


@dataclass(frozen=True)
class Agreement:
    """Differences of two replays of the same motion."""

    engines: tuple[str, str]
    same_fate: bool  # both stayed up, or both fell
    load: float  # on a sole, root mean square over time and soles, relative to the mean of both
    zmp: float  # root mean square [m]
    tilt_deg: float  # largest difference of the two tilts
    end_position: float  # of the midpoint between the soles [m]
    end_yaw_deg: float  # of the mean heading of the soles

    def to_dict(self) -> dict[str, object]:
        """Convert to plain data."""
        return {**dataclasses.asdict(self), "engines": list(self.engines)}


def agreement(a: Replay, b: Replay) -> Agreement:
    """Compare two replays of one motion with the same servos."""
    n, dt = min(len(a.trace.t), len(b.trace.t)), float(a.trace.t[1])
    contacts = [_smooth(replay.trace.contacts[:n], dt) for replay in (a, b)]
    loads = [found[:, :, 2] for found in contacts]
    weight = float(np.mean([load.sum(axis=1) for load in loads]))
    carried = np.all([load.sum(axis=1) > LEAST_LOAD * weight for load in loads], axis=0)
    zmps = [
        found[carried, :, 3:].sum(axis=1) / found[carried, :, 2:3].sum(axis=1) for found in contacts
    ]
    tilts = np.degrees(a.trace.tilt[:n] - b.trace.tilt[:n])
    apart = travel(a.trace.soles[:n]) - travel(b.trace.soles[:n])
    return Agreement(
        engines=(a.engine, b.engine),
        same_fate=a.fell == b.fell,
        load=_rms(loads[0] - loads[1]) / weight,
        zmp=_rms(np.linalg.norm(zmps[0] - zmps[1], axis=1)),
        tilt_deg=float(np.abs(tilts).max()),
        end_position=float(np.linalg.norm(apart[:2])),
        end_yaw_deg=float(abs(np.degrees(wrap_angle(apart[2])))),
    )


def _smooth(contacts: Array, dt: float) -> Array:
    size = max(1, round(WINDOW / dt))
    return np.asarray(uniform_filter1d(contacts, size, axis=0, mode="nearest"))


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(np.square(x)))) if x.size else 0.0
