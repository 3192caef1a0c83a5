"""Every error that a user can cause.

MgsError                     exit code 1: the work could not be done
├── InputError               exit code 2: malformed or missing input
│   ├── ConfigError          a gait or robot file, or a value on the command line
│   └── MotionFileError      an MCAP file that is damaged or not ours
├── InfeasibleGaitError      the gait is well formed, but this robot cannot do it
│   ├── FootstepError        two soles would overlap
│   ├── IkError              a task is missed
│   ├── SeamError            a part of a sequence does not begin as the one before ends
│   └── JointLimitError      a joint would leave its range
├── CycleError               a motion has no two steps that could be repeated
├── SimulationError          an engine is missing, or its model differs from ours
│   └── DivergenceError      the simulation left the realm of numbers
└── OutputExistsError        a file is in the way
"""

from __future__ import annotations

from pathlib import Path
from typing import Any


class MgsError(Exception):
    """Base of all errors that mgs raises on purpose."""

    exit_code = 1

    def __reduce__(self) -> tuple[Any, ...]:
        """Carry message and data between processes; pickle would call __init__ with the message."""
        return _unpickle, (type(self), self.args, self.__dict__)


def _unpickle(kind: type[MgsError], args: tuple[Any, ...], data: dict[str, Any]) -> MgsError:
    error = kind.__new__(kind, *args)
    error.__dict__.update(data)
    return error


class InputError(MgsError):
    """Something that came from outside is malformed or missing."""

    exit_code = 2


class ConfigError(InputError):
    """A value in a file or on the command line is missing, unknown or out of range.

    Up to `MOST_TOLD` problems are told; `n_problems` is their number where not all were collected.
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

    def __init__(self, first: int, second: int, gap: float, advice: str) -> None:
        super().__init__(f"footsteps {first} and {second} overlap by {-1e3 * gap:.1f} mm; {advice}")
        self.first, self.second, self.gap = first, second, gap  # indices, [m]


class IkError(InfeasibleGaitError):
    """No configuration meets a task at one instant."""

    def __init__(self, t: float, task: str, residual: float, tolerance: float, unit: str) -> None:
        super().__init__(
            f"t = {t:.3f} s: {task} is {residual:.3g} {unit} off, {tolerance:.3g} {unit} allowed; "
            "it is probably out of reach: try a shorter step_length, a lower com_height or "
            "a longer single_support; in a kick a nearer ball or shorter swings; in a balance "
            "motion smaller channels or a longer ease; in keyframes less, or more time"
        )
        self.t, self.task, self.residual, self.tolerance = t, task, residual, tolerance


class JointLimitError(InfeasibleGaitError):
    """A joint would leave its range."""

    def __init__(self, t: float, joint: str, position: float, lower: float, upper: float) -> None:
        excess = max(lower - position, position - upper)
        super().__init__(
            f"t = {t:.3f} s: joint {joint} at {position:.4f} rad is {excess:.4f} rad outside "
            f"its range [{lower:.4f}, {upper:.4f}]; try a larger ik.gamma_joint, a shorter "
            "step_length, smaller channels or another com_height, or set ik.on_limit: record to "
            "keep the motion"
        )
        self.t, self.joint, self.position = t, joint, position


class SeamError(InfeasibleGaitError):
    """A part of a sequence does not begin where, or as, the one before it has ended."""

    def __init__(self, part: str, difference: str, remedy: str) -> None:
        super().__init__(
            f"{part} does not begin as the part before it ends: {difference}; {remedy}"
        )
        self.part, self.difference = part, difference


class CycleError(MgsError):
    """A motion has no two steps that could be repeated."""


class SimulationError(MgsError):
    """A physics engine is missing, or its model of the robot differs from Pinocchio's."""


class DivergenceError(SimulationError):
    """A simulation has left the realm of numbers."""


class OutputExistsError(MgsError):
    """A file is in the way of an output."""

    def __init__(self, path: str | Path) -> None:
        super().__init__(f"{path} exists; use --force to replace it, or -o to write elsewhere")
        self.path = str(path)
