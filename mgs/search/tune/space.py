"""Which keys of a walk are varied, and between which bounds.

Bounds are in proportion to the robot: lengths to the leg length L and to the soles, durations to
sqrt(L / g), gains on torques to 1 / (m g L)^2. Every key of a gait file can be added, bounded
otherwise or fixed.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, get_args

from mgs.com_generator.qp import default_margin
from mgs.core.config import build, read_assignment, set_value
from mgs.core.constants import GRAVITY
from mgs.core.contact import Side
from mgs.core.errors import ConfigError
from mgs.gait import WalkGait
from mgs.gait.walk import FootRollParameters, SwingProfile
from mgs.motion_planner.phases import MIN_SAMPLES
from mgs.motion_planner.standing import MIN_ARM_JOINTS, standing_figures
from mgs.robot import Robot, leg_length, midpoint_width
from mgs.robot.limbs import arm_joints
from mgs.search.tune.objective import LEAST_CLEARANCE, ObjectiveName

Value = float | str
DIGITS = 4  # significant digits of a value that is tried, or of the distance of its bounds
TIMES = ("walk.single_support", "walk.double_support")  # rounded to whole samples
FREE_STRETCH = 1.1  # of a leg, with which the CoM keeps its height
LEAST_WIDTH = 1.25  # of a step, as a part of the width of the sole
SHORTEST_STEP, QUICK_STEP = 0.05, 0.1  # parts of the largest step
STEP_KEYS = ("walk.step_length", "walk.lateral", "walk.step_yaw")


@dataclass(frozen=True)
class Parameter:
    """One key that is varied: a number between bounds, or one of several values."""

    key: str  # dotted; an element of a list by its number, such as walk.zmp_offset.0
    low: float = 0.0
    high: float = 0.0
    log: bool = False  # whether ratios matter rather than differences
    choices: tuple[Value, ...] = ()  # empty: a number
    own: float | None = None  # what null stands for in a gait file

    def place(self, value: float) -> float:
        """Where a number lies between the bounds: 0 at the lower one, 1 at the upper one."""
        if self.log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def at(self, place: float) -> float:
        """The number at a place between 0 and 1."""
        place = min(max(place, 0.0), 1.0)
        if self.log:
            return self.low * (self.high / self.low) ** place
        return self.low + place * (self.high - self.low)

    def in_words(self) -> str:
        """Bounds or values."""
        if self.choices:
            return ", ".join(map(str, self.choices))
        return f"{self.low:.4g} to {self.high:.4g}"


@dataclass(frozen=True)
class Space:
    """The start gait, whose sizes are resolved, and the keys that are varied."""

    gait: WalkGait
    parameters: tuple[Parameter, ...]
    speed: float | None  # [m/s] that every walk has; None: step sizes are free

    def start(self) -> dict[str, Value]:
        """Values of the start gait, at the nearest bound where they lie outside."""
        found: dict[str, Value] = {}
        for parameter in self.parameters:
            value = value_at(self.gait, parameter.key)
            if parameter.choices:
                found[parameter.key] = value if value in parameter.choices else parameter.choices[0]
            else:
                value = parameter.own if value is None else value
                value = parameter.low if value is None else float(value)
                found[parameter.key] = min(max(value, parameter.low), parameter.high)
        return found

    def gait_of(
        self, values: Mapping[str, Value], source: str = "a walk of the search"
    ) -> WalkGait:
        """The gait with values in place of its own, rounded.

        Raises:
            ConfigError: the values do not fit each other; the message begins with `source`.
        """
        tree = self.gait.model_dump()
        for key, value in values.items():
            _set(tree, key, self.rounded(key, value), "the search")
        walk = tree["walk"]
        if self.speed is not None:
            step_time = walk["single_support"] + walk["double_support"]
            factor = step_time / step_duration(self.gait) * self.speed / steady_speed(self.gait)
            for key in STEP_KEYS:
                name = key.partition(".")[2]
                if key not in values and walk[name]:
                    walk[name] = round(factor * walk[name], 5)
        return build(WalkGait, tree, source)

    def rounded(self, key: str, value: Value) -> Value:
        """A value as it is tried: whole samples, whole numbers, or few digits."""
        if isinstance(value, str):
            return value
        if isinstance(value_at(self.gait, key), int):
            return round(value)
        if key in TIMES:
            samples = max(MIN_SAMPLES, round(value / self.gait.dt))
            return round(samples * self.gait.dt, 6)
        bounds = {p.key: p for p in self.parameters}.get(key)
        if bounds is None or bounds.log:
            return float(f"{value:.{DIGITS}g}")
        return round(value, DIGITS - 1 - math.floor(math.log10(bounds.high - bounds.low)))


def step_duration(gait: WalkGait) -> float:
    """Duration of one double and one single support phase [s]."""
    return gait.walk.single_support + gait.walk.double_support


def steady_speed(gait: WalkGait) -> float:
    """Length of a step divided by its duration [m/s]; sideways steps advance every second time."""
    walk = gait.walk
    return math.hypot(walk.step_length, 0.5 * walk.lateral) / step_duration(gait)


def value_at(gait: WalkGait, key: str) -> Any:
    """Value of a gait at a dotted key; None where the block that it belongs to is left out.

    Raises:
        ConfigError: there is no such key.
    """
    node: Any = gait.model_dump()
    for part in key.split("."):
        if node is None:
            return None
        try:
            node = node[int(part)] if isinstance(node, list) else node[part]
        except (KeyError, IndexError, ValueError, TypeError):
            raise ConfigError(key, "a walk has no such key; mgs schema gait lists them") from None
    return node


def _set(tree: dict[str, Any], key: str, value: Any, source: str) -> None:
    """Set a value at a dotted key, whose last part may be the number of an element of a list."""
    head, _, last = key.rpartition(".")
    node: Any = tree
    for part in head.split("."):
        node = node.get(part) if isinstance(node, dict) else None
    if isinstance(node, list):
        node[int(last)] = value
    else:
        set_value(tree, key, value, source)


def make_space(
    robot: Robot,
    gait: WalkGait,
    objective: ObjectiveName,
    *,
    speed: float | None = None,
    pins: Iterable[str] = (),
    frees: Iterable[str] = (),
) -> Space:
    """The keys that are varied for an objective.

    Args:
        robot: robot that bounds are in proportion to.
        gait: start gait with resolved sizes.
        objective: what is sought; for "speed" the step sizes are varied too.
        speed: speed that every other walk keeps [m/s]; None: that of the start gait.
        pins: assignments `key=value` of keys that are not varied.
        frees: `key=low:high` or `key=value,value` of keys that are varied so.

    Raises:
        ConfigError: an assignment is malformed, a key is unknown, or bounds are not allowed.
    """
    gait = _with_rolling_feet(gait)
    found = {p.key: _reaching(p, gait) for p in default_parameters(robot, gait, objective)}
    own = {key: p.own for key, p in found.items()}
    for key, value in (read_assignment(text, "--pin") for text in pins):
        value_at(gait, key)
        tree = gait.model_dump()
        _set(tree, key, value, "--pin")
        gait = build(WalkGait, tree, f"--pin {key}")
        found = {k: p for k, p in found.items() if k != key and not k.startswith(f"{key}.")}
    for text in frees:
        parameter = _freed(text)
        value_at(gait, parameter.key)
        for value in parameter.choices or (parameter.low, parameter.high):
            one = Space(gait, (parameter,), None)
            one.gait_of({parameter.key: value}, f"--free {parameter.key}")
        found[parameter.key] = replace(parameter, own=own.get(parameter.key))
    if not found:
        raise ConfigError("--pin", "every key is fixed, so that nothing is left to search")
    kept = None
    if objective != "speed" and steady_speed(gait) > 0.0:
        kept = steady_speed(gait) if speed is None else speed
    elif speed is not None:
        raise ConfigError("--speed", "only a walk with steps forward or sideways has a speed to "
                          "keep, and the objective speed keeps none")  # fmt: skip
    return Space(gait, tuple(found.values()), kept)


def _with_rolling_feet(gait: WalkGait) -> WalkGait:
    """Gait that gives pitches of the soles, which are 0 where it leaves them out."""
    if gait.walk.boxes or gait.walk.foot_roll is not None:
        return gait
    walk = gait.walk.model_copy(update={"foot_roll": FootRollParameters()})
    return gait.model_copy(update={"walk": walk})


def _reaching(parameter: Parameter, gait: WalkGait) -> Parameter:
    """A parameter whose bounds reach the value of the start gait, but for the least clearance."""
    value = value_at(gait, parameter.key)
    if parameter.choices or value is None:
        return parameter
    fixed = parameter.key == "walk.step_height" or (parameter.log and value <= 0.0)
    low = parameter.low if fixed else min(parameter.low, value)
    return replace(parameter, low=low, high=max(parameter.high, value))


def _freed(text: str) -> Parameter:
    """Parameter of `key=low:high` or `key=value,value`."""
    key, equals, bounds = text.partition("=")
    key = key.strip()
    low, colon, high = bounds.partition(":")
    if colon:
        try:
            numbers = float(low), float(high)
        except ValueError:
            raise ConfigError("--free", f"{text!r}: the bounds should be two numbers") from None
        if not (math.isfinite(numbers[0]) and numbers[0] < numbers[1] < math.inf):
            raise ConfigError("--free", f"{text!r}: the lower bound should be below the upper one")
        log = numbers[0] > 0.0 and numbers[1] > 30.0 * numbers[0]
        return Parameter(key, *numbers, log=log)
    choices = tuple(read_assignment(f"{key}={part}", "--free")[1] for part in bounds.split(","))
    if not (equals and key and len(choices) > 1):
        raise ConfigError("--free", f"{text!r} is not of the form key=low:high or key=value,value")
    return Parameter(key, choices=choices)


def default_parameters(robot: Robot, gait: WalkGait, objective: ObjectiveName) -> list[Parameter]:
    """Parameters of a walk with bounds in proportion to the robot."""
    leg, width = leg_length(robot), midpoint_width(robot)
    time = math.sqrt(leg / GRAVITY)
    sole = robot.sole_spec(Side.LEFT)
    height = float(standing_figures(robot).com[2])
    per_torque = 1.0 / (robot.mass * GRAVITY * leg) ** 2
    qp, clik = gait.com.generator == "qp", gait.ik.solver == "clik"
    arms = all(len(arm_joints(robot, side)) >= MIN_ARM_JOINTS for side in Side)
    listed = gait.walk.steps or gait.walk.footsteps or gait.walk.goal
    found = [
        Parameter("walk.single_support", 1.2 * time, 8.0 * time, log=True),
        Parameter("walk.double_support", 0.3 * time, 6.0 * time, log=True),
        Parameter("walk.com_height", 0.88 * height, 1.04 * height, own=height),
        Parameter("walk.step_height", 1.05 * LEAST_CLEARANCE * leg, 0.2 * leg),
        Parameter("walk.landing", 0.0, 0.5),
        Parameter("walk.swing_profile", choices=get_args(SwingProfile)),
        Parameter("walk.zmp_offset.0", -0.15 * sole.length, 0.15 * sole.length),
        Parameter("walk.zmp_offset.1", -0.1 * sole.width, 0.25 * sole.width),
        Parameter("walk.zmp_travel", 0.0, 0.3 * sole.length),
        Parameter("com.weight_jerk", 1e-8, 1e-2, log=True),
    ]
    if not gait.walk.boxes:
        found += [
            Parameter("walk.foot_roll.toe_off", 0.0, 0.5),
            Parameter("walk.foot_roll.heel_strike", 0.0, 0.4),
            Parameter("walk.leg_stretch", 0.94, FREE_STRETCH, own=FREE_STRETCH),
        ]
    if not listed:
        narrow = min(LEAST_WIDTH * sole.width, 0.9 * width)  # narrow steps sway less
        found.append(Parameter("walk.step_width", narrow, 1.15 * width, own=width))
        if objective == "speed":
            found += _step_sizes(gait, leg)
    if qp:
        most = 0.45 * min(sole.length, sole.width)
        found.append(Parameter("com.margin", 0.0, most, own=default_margin(robot)))
    if arms and gait.walk.hands == "held":
        found.append(Parameter("walk.arm_swing", 0.0, 2.0))
    if clik:
        found.append(Parameter("ik.gamma_joint", 0.02, 2.0, log=True))
        found.append(Parameter("ik.gamma_grav", 0.0, 100.0 * per_torque))
    return found


def quick_steps(robot: Robot) -> dict[str, float]:
    """Values by key of quick and low steps.

    In them the CoM stays near the middle between the soles, and the next sole is on the ground
    before a lean has grown: it does so in proportion to exp(t / sqrt(h / g)). Arms that swing keep
    the quick legs from turning the soles. Step sizes are the most that such steps begin with.
    """
    leg = leg_length(robot)
    time = math.sqrt(leg / GRAVITY)
    sizes = {key: QUICK_STEP * most for key, most in _largest_steps(leg).items()}
    return sizes | {
        "walk.single_support": 1.25 * time,
        "walk.double_support": 0.4 * time,
        "walk.step_height": 1.15 * LEAST_CLEARANCE * leg,
        "walk.landing": 0.05,
        "walk.arm_swing": 1.0,
        "com.weight_jerk": 1e-5,
    }


def _largest_steps(leg: float) -> dict[str, float]:
    """Sizes [m, m, rad] that no step exceeds."""
    return {"walk.step_length": leg, "walk.lateral": 0.5 * leg, "walk.step_yaw": 0.8}


def _step_sizes(gait: WalkGait, leg: float) -> list[Parameter]:
    """Step sizes of a walk that are not zero, with the sign that they have."""
    found = []
    for key, high in _largest_steps(leg).items():
        value = value_at(gait, key)
        if value > 0.0:
            found.append(Parameter(key, SHORTEST_STEP * high, min(high, 1.0)))
        elif value < 0.0:
            found.append(Parameter(key, -min(high, 1.0), -SHORTEST_STEP * high))
    return found
