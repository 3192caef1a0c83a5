"""Numbers that stand for the words of the paper, chosen before the runs."""

from __future__ import annotations

FASTER = 1.1  # ratio from which on a comparison without a number counts
MET = 1e-4  # [m] and [rad] largest error of a task that is met
SINGULAR = 1e-3  # least singular value of a regular J_A, with rows in m and rad
EIGHT_PERIOD = 4.0  # [s] of the figure eight, gaits/coman/hand_eight.yaml
