"""How far a motion is from what was asked of it, at its worst sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.core.geometry import rotation_angles
from mgs.motion import Motion


@dataclass(frozen=True)
class Tracking:
    """Largest distances of a motion from what was asked of it, [m] and [rad]."""

    sole_position: float
    sole_rotation: float
    hand_position: float
    torso_rotation: float
    com: float


def tracking_errors(motion: Motion) -> Tracking:
    """Largest distance of soles, hands and CoM from their references [m] and [rad]."""
    soles, hands = motion.soles - motion.soles_ref, motion.hands[..., :3] - motion.hands_ref
    turn = rotation_angles(motion.soles[..., 3:], motion.soles_ref[..., 3:])
    return Tracking(
        sole_position=float(np.linalg.norm(soles[..., :3], axis=-1).max()),
        sole_rotation=float(turn.max()),
        hand_position=float(np.linalg.norm(hands, axis=-1).max()),
        torso_rotation=float(rotation_angles(motion.torso[:, 3:], motion.torso_ref).max()),
        com=float(np.linalg.norm(motion.com - motion.com_ref, axis=-1).max()),
    )
