"""Thresholds that several claims share."""

from __future__ import annotations

BROKEN_DEG = 10.0  # [deg] least violation of a joint limit
HARD = 1e-4  # [m] and [rad] largest error of hard rows
REGION = 1e-9  # tolerance of joint limits and safety region
