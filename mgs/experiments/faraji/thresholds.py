"""Numbers that stand for the words of the papers, chosen before the runs."""

from __future__ import annotations

FASTER = 1.1  # ratio from which on a comparison without a number counts: "slower", "later", "worse"
CONSIDERABLE = 1.1  # ratio up to which a change is not "considerable" and a loss is "slight"
TWO_ORDERS = 10.0**1.5  # "roughly 2 orders of magnitude": 1.5 or more
FEW_MILLIMETRES = 5e-3  # [m] "down to few millimeters"
NOT_ALTERED = 5e-3  # [m] horizontal CoM error of a balance that is "not altered"
NEARLY_ZERO = 0.1  # torque, or motion of a frozen knee, relative to the one it is compared with
DRASTIC = 0.5  # largest ratio of a quantity that decreases "drastically"
THREE_TIMES = 3.0  # the paper's own number
HARD = 1e-4  # [m] and [rad] largest error of hard rows that are met
VIBRATION = 0.5  # reversals per period from which on a knee vibrates
BENT_KNEE_DEG = 5.0  # [deg] knee angle from which on a knee is not straight any more
