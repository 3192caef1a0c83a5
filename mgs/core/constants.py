"""Figures that several rooms share, each written once."""

from __future__ import annotations

import math

GRAVITY = 9.81  # [m/s^2], as Pinocchio's

# Coordinates of the floating base: q is (..., 7 + n), its position and quaternion first; v is
# (..., 6 + n), its twist first.
FLOATING_BASE_NQ, FLOATING_BASE_NV = 7, 6

# How far an IK solver may leave its tasks. The CoM's is the default of a gait, which may widen it.
POSITION_TOLERANCE = 1e-4  # [m], of soles and hands
COM_TOLERANCE = 2e-4  # [m]
ROTATION_TOLERANCE = math.radians(0.01)  # [rad], of soles and torso

CONTACT_TOLERANCE = 5e-4  # [m] that a sole in support may move, sink or float

# The Coulomb coefficient that plans and static checks count on, on the safe side of dry rubber.
FRICTION = 0.5
