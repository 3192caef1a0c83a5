"""Everything that a page shows of a replay in physics, as plain data for its script."""

from __future__ import annotations

from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.motion import Motion
from mgs.report.page.arrays import packed
from mgs.report.page.motion_data import MOST_SAMPLES, kept_samples
from mgs.sim import Replay

LEAST_FORCE = 1e-3  # of the weight; a sole with less has no centre of pressure


def replay_data(motion: Motion, replay: Replay, most: int = MOST_SAMPLES) -> dict[str, Any]:
    """Configurations, contact forces with their centres of pressure, tilt, and balls over time."""
    trace = replay.trace
    kept = kept_samples(len(trace.t), most)
    arrays = {
        "t": packed(trace.t[kept], "f4"),
        "base": packed(trace.q[kept, :3], "f4"),
        "turn": packed(trace.q[kept, 3:FLOATING_BASE_NQ]),
        "q": packed(trace.q[kept, FLOATING_BASE_NQ:]),
        "torque": packed(trace.torque[kept]),
        "force": packed(trace.contacts[kept, :, :3].reshape(len(kept), 6)),
        "pressure": packed(
            centres_of_pressure(trace.contacts[kept], trace.soles[kept]).reshape(len(kept), 6), "f4"
        ),
        "tilt": packed(np.degrees(trace.tilt[kept])),
    }
    if trace.balls.shape[1]:
        places = trace.balls[kept, :, :3]
        arrays["balls"] = packed(places.reshape(len(kept), -1), "f4")
    fate = f"fell at {replay.fall_time:.2f} s" if replay.fell else "stays up"
    return {
        "engine": replay.engine,
        "name": f"{replay.engine} {replay.version}, {replay.servo} servos",
        "fate": fate,
        "fell": replay.fell,
        "arrays": arrays,
    }


def centres_of_pressure(contacts: Array, soles: Array) -> Array:
    """Centres of pressure (M, 2, 3) of soles with contacts (M, 2, 5), at the height of the soles.

    Not a number where a sole bears nothing.
    """
    vertical = contacts[..., 2]
    bears = vertical > LEAST_FORCE * max(float(vertical.max(initial=0.0)), 1e-9)
    centre = np.full((*vertical.shape, 3), np.nan)
    np.divide(contacts[..., 3:], vertical[..., None], out=centre[..., :2], where=bears[..., None])
    centre[..., 2] = np.where(bears, soles[..., 2], np.nan)
    return centre
