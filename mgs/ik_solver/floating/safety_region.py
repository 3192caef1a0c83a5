"""The region of joint positions and speeds from which a joint can always be stopped.

Eq. (6) of S. Faraji and A. J. Ijspeert, "Singularity-tolerant inverse kinematics for bipedal
robots: an efficient use of computational power to reduce energy consumption", IEEE Robotics and
Automation Letters 2(2), 2017: an ellipse over position and speed, as wide as the joint's range and
as high as its largest speed,

    (2 q - (ql + qu))^2 / (qu - ql - 2 qs)^2 + (qdot / qdot_max)^2 <= 1 .

With qdot = (q - q_prev) / dt each joint's inequality is one quadratic in one variable, hence
exactly an interval of q. With h = (qu - ql) / 2 - qs, d = dt qdot_max, m = (ql + qu) / 2:

    a = 1 / h^2,  b = 1 / d^2,  q in [c - r, c + r],
    c = (a m + b q_prev) / (a + b),  r = sqrt(a + b - a b (q_prev - m)^2) / (a + b)

The polygon bounds the speed by a line that falls towards the limits, after W. Suleiman, "On
inverse kinematics with inequality constraints: new insights into minimum jerk trajectory
generation", Advanced Robotics 30(17), 2016. It serves for comparison.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from mgs.core.arrays import Array
from mgs.gait import FarajiParameters
from mgs.robot import Robot

POLYGON_SPEED = 0.02  # [rad/s] allowed at a limit; at 0 a joint could never leave the limit again


class SafetyRegion:
    """Safety region of n joints.

    Attributes:
        lower, upper: (n,) limits less the margin [rad].
        middle: (n,) middle of the range [rad].
        speed_max: (n,) largest speed, in mid-range [rad/s].
        dt: sampling period [s].
    """

    def __init__(
        self,
        lower: Array,
        upper: Array,
        speed_max: Array,
        dt: float,
        shape: Literal["ellipse", "polygon"] = "ellipse",
    ) -> None:
        self.lower, self.upper, self.speed_max, self.dt = lower, upper, speed_max, dt
        self.is_ellipse = shape == "ellipse"
        self.middle, self._d = 0.5 * (lower + upper), dt * speed_max
        a, b = 4.0 / (upper - lower) ** 2, 1.0 / self._d**2
        self._sum, self._product = a + b, a * b
        self._shift, self._weight = a * self.middle / self._sum, b / self._sum
        self._square = np.empty_like(lower)
        self._slope = 4.0 * speed_max / (upper - lower)  # [1/s] of the polygon's edges

    @classmethod
    def of_robot(cls, robot: Robot, tuning: FarajiParameters, dt: float) -> SafetyRegion:
        """Region of the joints of a robot with the settings of ik3 to ik5."""
        fastest = robot.speed_limit if tuning.speed_max is None else tuning.speed_max
        return cls(
            robot.lower + tuning.margin,
            robot.upper - tuning.margin,
            np.minimum(fastest, robot.speed_limit),
            dt,
            tuning.region,
        )

    def interval(self, q_prev: Array, low: Array, high: Array) -> int:
        """Fill low and high (n,) with the interval of each joint one step after q_prev (n,).

        Returns the number of recovering joints, which cannot reach the region in one step. Their
        interval is the one position that is nearest to the region.
        """
        if not self.is_ellipse:
            return self._polygon_interval(q_prev, low, high)
        square, total = self._square, self._sum
        np.subtract(q_prev, self.middle, out=square)
        square *= square
        square *= self._product
        np.subtract(total, square, out=square)  # the square of r (a + b)
        recovering = bool(square.min() < 0.0)
        if recovering:
            outside = square < 0.0
            np.maximum(square, 0.0, out=square)
        np.sqrt(square, out=square)
        square /= total
        np.multiply(self._weight, q_prev, out=high)
        high += self._shift
        np.subtract(high, square, out=low)
        high += square
        if not recovering:
            return 0
        back = q_prev + np.clip(np.clip(q_prev, self.lower, self.upper) - q_prev, -self._d, self._d)
        low[outside] = high[outside] = back[outside]
        return int(outside.sum())

    def _polygon_interval(self, q_prev: Array, low: Array, high: Array) -> int:
        """Interval by |qdot| <= min(qdot_max, v0 + slope * distance from the nearer limit)."""
        s, v = self._slope * self.dt, POLYGON_SPEED * self.dt
        steep = np.minimum(s, 0.999)  # steeper lines do not bound the far side
        low[:] = np.maximum.reduce(
            [
                q_prev - self._d,
                self.lower,
                (q_prev - v + s * self.lower) / (1.0 + s),
                (q_prev - v - steep * self.upper) / (1.0 - steep),
            ]
        )
        high[:] = np.minimum.reduce(
            [
                q_prev + self._d,
                self.upper,
                (q_prev + v + s * self.upper) / (1.0 + s),
                (q_prev + v - steep * self.lower) / (1.0 - steep),
            ]
        )
        outside = low > high
        back = q_prev + np.clip(np.clip(q_prev, self.lower, self.upper) - q_prev, -self._d, self._d)
        low[outside] = high[outside] = back[outside]
        return int(outside.sum())

    def excess(self, q_prev: Array, q: Array) -> Array:
        """Excess (..., n) of steps from q_prev to q (..., n) over the region; 0 or less inside.

        The excess is the left side of eq. (6) minus 1 for the ellipse, and the speed above its
        bound [rad/s] for the polygon.
        """
        speed = (q - q_prev) / self.dt
        if self.is_ellipse:
            half = 0.5 * (self.upper - self.lower)
            place = (q - self.middle) / half
            return np.asarray(place**2 + (speed / self.speed_max) ** 2 - 1.0)
        room = np.minimum(q - self.lower, self.upper - q)
        bound = np.minimum(self.speed_max, POLYGON_SPEED + self._slope * room)
        return np.asarray(np.maximum(np.abs(speed) - bound, -room))
