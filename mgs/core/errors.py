"""Every error that a user can cause.

MgsError                     exit code 1: the work could not be done
├── InputError               exit code 2: malformed or missing input
│   ├── ConfigError          a gait or robot file, or a value on the command line
│   └── MotionFileError      an MCAP file that is damaged or was not written by mgs
├── InfeasibleGaitError      the gait is well formed, but this robot cannot do it
│   ├── FootstepError        two soles would overlap
│   ├── ComOutsideFeetError  the CoM is asked to go sideways beyond both feet
│   ├── ComNotAtRestError    the CoM still moves when the motion ends
│   ├── ZmpMarginError       the ZMP cannot keep its distance from the edge of the support polygon
│   ├── IkError              a task is not met
│   ├── JointLimitError      a joint would leave its range
│   ├── JointSpeedError      a joint would have to move faster than its servo can
│   └── SeamError            a part of a sequence does not begin as the one before it ends
├── CycleError               a motion has no two steps that could be repeated
├── SimulationError          an engine is missing, or its model differs from Pinocchio's
│   └── DivergenceError      the simulation has produced values that are not finite
├── HardwareError            a servo, or the port to it, does not do what it should
├── LogError                 a log cannot be compared with a motion
└── OutputExistsError        a file is in the way
"""

from __future__ import annotations

from pathlib import Path
from typing import Any


class MgsError(Exception):
    """Base of all errors that mgs raises on purpose: facts, and a remedy where one is known.

    The code that finds an error often does not know which kind of gait was asked for. It states
    facts alone; `mgs.gait.remedies` adds the remedy for that kind, which ends the message.
    """

    exit_code = 1
    remedy = ""

    def __str__(self) -> str:
        """The facts, followed by the remedy."""
        facts = super().__str__()
        return f"{facts}; {self.remedy}" if self.remedy else facts

    def __reduce__(self) -> tuple[Any, ...]:
        """Carry message and data between processes; pickle would call __init__ with the message."""
        return _unpickle, (type(self), self.args, self.__dict__)


def _unpickle(kind: type[MgsError], args: tuple[Any, ...], data: dict[str, Any]) -> MgsError:
    error = kind.__new__(kind, *args)
    error.__dict__.update(data)
    return error


class InputError(MgsError):
    """Something that comes from outside is malformed or missing."""

    exit_code = 2


class ConfigError(InputError):
    """A value in a file or on the command line is missing, unknown or out of range.

    The message lists up to `MOST_TOLD` problems; `n_problems` is the number of all problems where
    more were found than collected.
    """

    MOST_TOLD = 20

    def __init__(
        self, source: str | Path, problems: str | list[str], n_problems: int | None = None
    ) -> None:
        self.source = str(source)
        self.problems = [problems] if isinstance(problems, str) else list(problems)
        told = self.problems[: self.MOST_TOLD]
        more = (n_problems or len(self.problems)) - len(told)
        lines = [*told, f"and {more} more problems"] if more else told
        super().__init__("\n".join(f"{self.source}: {line}" for line in lines))


class MotionFileError(InputError):
    """A motion file is damaged, truncated or was not written by mgs."""

    def __init__(self, path: str | Path, problem: str) -> None:
        self.path = str(path)
        super().__init__(f"{path}: {problem}")


class InfeasibleGaitError(MgsError):
    """The gait is well formed, but this robot cannot do it."""


class FootstepError(InfeasibleGaitError):
    """Two soles would overlap on the ground."""

    def __init__(self, first: int, second: int, gap: float, distance: float) -> None:
        super().__init__(
            f"footsteps {first} and {second} overlap by {-1e3 * gap:.1f} mm; their centres are "
            f"{distance:.3f} m apart"
        )
        self.first, self.second = first, second  # numbers of the footsteps
        self.gap, self.distance = gap, distance  # of the edges, of the centres [m]


class ComOutsideFeetError(InfeasibleGaitError):
    """The CoM is asked to go sideways beyond both feet."""

    def __init__(self, distance: float) -> None:
        super().__init__(
            f"the CoM is asked to go {distance:.3f} m sideways from the middle, beyond both feet"
        )
        self.distance = distance  # [m]


class ComNotAtRestError(InfeasibleGaitError):
    """The CoM still moves, or is beside its goal, when the motion ends."""

    def __init__(self, speed: float, distance: float, allowed: tuple[float, float]) -> None:
        super().__init__(
            f"the CoM still moves at {1e3 * speed:.1f} mm/s, {1e3 * distance:.1f} mm from its goal "
            f"when the motion ends ({1e3 * allowed[0]:g} mm/s and {1e3 * allowed[1]:g} mm are "
            "allowed)"
        )
        self.speed, self.distance, self.allowed = speed, distance, allowed  # [m/s], [m], both


class ZmpMarginError(InfeasibleGaitError):
    """No CoM motion keeps the ZMP inside the support polygon by the margin asked for."""

    def __init__(self, t: float, support: str, margin: float, widest: float) -> None:
        reach = (
            f"at most {1e3 * widest:.1f} mm"
            if widest > 0.0
            else f"it is {-1e3 * widest:.1f} mm outside"
        )
        super().__init__(
            f"t = {t:.3f} s: in {support} support no CoM motion keeps the ZMP {1e3 * margin:.1f} "
            f"mm inside the support polygon, {reach}"
        )
        self.t, self.support = t, support  # [s], left, right or double
        self.margin, self.widest = margin, widest  # asked for and possible, negative: outside [m]


class IkError(InfeasibleGaitError):
    """No configuration meets a task at one instant."""

    def __init__(
        self, t: float, task: str, residual: float, tolerance: float, unit: str, cause: str = ""
    ) -> None:
        super().__init__(
            f"t = {t:.3f} s: {task} is {residual:.3g} {unit} off, {tolerance:.3g} {unit} allowed"
            f"{'; ' if cause else ''}{cause}"
        )
        self.t, self.task, self.unit = t, task, unit  # time [s]
        self.residual, self.tolerance = residual, tolerance  # in the unit


class JointLimitError(InfeasibleGaitError):
    """A joint would leave its range."""

    def __init__(self, t: float, joint: str, position: float, lower: float, upper: float) -> None:
        excess = max(lower - position, position - upper)
        super().__init__(
            f"t = {t:.3f} s: joint {joint} at {position:.4f} rad is {excess:.4f} rad outside "
            f"its range [{lower:.4f}, {upper:.4f}] rad"
        )
        self.t, self.joint, self.position = t, joint, position  # [s], name, [rad]


class JointSpeedError(InfeasibleGaitError):
    """A joint would have to move faster than its servo can."""

    def __init__(self, t: float, joint: str, speed: float, limit: float) -> None:
        super().__init__(
            f"t = {t:.3f} s: joint {joint} would have to move at {speed:.2f} rad/s, but its servo "
            f"reaches {limit:.2f} rad/s"
        )
        self.t, self.joint, self.speed, self.limit = t, joint, speed, limit  # [s], name, [rad/s]


class SeamError(InfeasibleGaitError):
    """A part of a sequence does not begin where, or in the posture in which, the last one ended."""

    def __init__(self, part: str, difference: str, remedy: str) -> None:
        super().__init__(f"{part} does not begin as the part before it ends: {difference}")
        self.part, self.difference, self.remedy = part, difference, remedy


class CycleError(MgsError):
    """A motion has no two steps that could be repeated."""


class SimulationError(MgsError):
    """A physics engine is missing, or its model of the robot differs from Pinocchio's."""


class DivergenceError(SimulationError):
    """A simulation has produced values that are not finite."""


class HardwareError(MgsError):
    """A servo, or the port to it, does not do what it should."""


class LogError(MgsError):
    """A log of a robot cannot be compared with a motion: it is too short, still or ambiguous."""


class OutputExistsError(MgsError):
    """A file is in the way of an output."""

    def __init__(self, path: str | Path, remedy: str = "use --force to replace it") -> None:
        super().__init__(f"{path} exists; {remedy}, or -o to write elsewhere")
        self.path = str(path)
