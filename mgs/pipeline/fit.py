"""A walk that fits the robot: sizes that a gait file leaves out, so that its legs have reserve.

`mgs.motion_planner.for_robot` derives sizes from the leg length. Whether the joints of a robot can
do the walk depends on its servos and ranges too. So the plan is made, its static figures are
looked at, and where they use more than 85 % of a limit, other sizes are tried, in this order: the
distance of the soles, the height of the CoM, rests and step times, and the length of the step. Of
each the best is kept, and the first walk with enough reserve is taken, less the changes that it can
do without: a higher CoM, for example, sways more. Where the best walk exceeds a limit, longer rests
are the last resort. No physics is simulated.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from mgs.core.config import build
from mgs.core.errors import ConfigError, InfeasibleGaitError
from mgs.core.progress import Progress
from mgs.gait import WalkGait
from mgs.motion.collisions import first_contact
from mgs.motion.joint_load import uses_of_legs
from mgs.motion_planner import for_robot
from mgs.motion_planner.standing import standing_figures
from mgs.pipeline.stages import Stages, run_stages
from mgs.robot import Robot, midpoint_width

MOST_USE = 0.85  # of a limit; the rest is the reserve
COLLISION_STEP = 10  # samples between those at which links are looked at
DIGITS = 4  # decimal places of values that are changed
LEAST_GAIN = 0.01  # part of a limit that a change has to give back to be kept
TIMES, RESTS = ("single_support", "double_support"), ("lead_in", "lead_out")
LENGTHS = ("step_length", "lateral", "step_yaw")
FACTORS = (  # on the derived sizes, in the order of their trial
    (("step_width",), (0.9, 0.8, 1.1)),
    (("com_height",), (1.02, 0.98, 0.96)),
    (RESTS, (1.5, 2.0)),
    (TIMES, (1.25,)),  # longer ones only: quick steps come in time with a robot's swaying
    (LENGTHS, (0.75, 0.5)),
)
LONGEST_RESTS = 3.0  # times the derived ones: kept only if the walk then keeps every limit


@dataclass(frozen=True)
class Fit:
    """What was tried for a walk whose sizes are derived from the robot."""

    use: float  # largest part of a limit that the walk uses; infinite if links touch
    limited_by: str  # what this limit is of
    changes: dict[str, float]  # values of `walk` that differ from the derived ones
    tried: int  # number of walks

    @property
    def has_reserve(self) -> bool:
        """Whether the reserve is kept."""
        return self.use <= MOST_USE

    def __str__(self) -> str:
        changed = ", ".join(f"{key} {x:g} {_unit(key)}" for key, x in self.changes.items())
        used = "links touch" if math.isinf(self.use) else f"{100 * self.use:.0f} % used"
        sizes = f"changed to {changed}" if changed else "as derived from the robot"
        return f"sizes {sizes}; limited by {self.limited_by}, {used} ({self.tried} tried)"


@dataclass(frozen=True, eq=False)
class _Candidate:
    changes: dict[str, float]
    stages: Stages
    use: float
    limited_by: str
    excess: float  # sum over the kinds of limits of what is used beyond the reserve


def fit_walk(
    robot: Robot, gait: WalkGait, name: str = "gait", progress: Progress | None = None
) -> tuple[Stages, Fit]:
    """The stages of the walk whose legs have the most reserve, and what was tried.

    Values that the gait file states are kept.

    Raises:
        ConfigError: values of the gait do not fit each other or this robot.
        InfeasibleGaitError: the robot can do none of the walks; the message is that of the first.
    """
    derived = for_robot(gait, robot)
    assert isinstance(derived, WalkGait)
    first: InfeasibleGaitError | None = None
    best: _Candidate | None = None
    changes: dict[str, float] = {}
    tried = 0
    as_derived: list[dict[str, float]] = [{}]
    for options in (as_derived, *_options(robot, gait, derived)):
        for option in options:
            tried += 1
            try:
                found = _candidate(robot, derived, changes | option, name, progress)
            except InfeasibleGaitError as error:
                first = first or error
                continue
            except ConfigError:
                if not option:
                    raise
                continue  # such as soles that would overlap, or too many samples
            if best is None or found.excess < best.excess - LEAST_GAIN:
                best = found
            if best.use <= MOST_USE:
                best, more = _with_fewest_changes(robot, derived, best, name, progress)
                return best.stages, Fit(best.use, best.limited_by, best.changes, tried + more)
        changes = {} if best is None else best.changes
    if best is None:
        assert first is not None
        raise first
    if best.use > 1.0 and (rests := _scaled(RESTS, LONGEST_RESTS, robot, gait, derived)):
        as_tall = {key: x for key, x in best.changes.items() if key != "com_height"}
        # on bent knees a robot bears a load at rest too: then its derived height is tried as well
        for kept in [best.changes, as_tall] if as_tall != best.changes else [as_tall]:
            tried += 1
            rested = _rested(robot, derived, kept | rests, name, progress)
            if rested is not None:
                best = rested
                break
    return best.stages, Fit(best.use, best.limited_by, best.changes, tried)


def _with_fewest_changes(
    robot: Robot,
    derived: WalkGait,
    best: _Candidate,
    name: str,
    progress: Progress | None,
) -> tuple[_Candidate, int]:
    """A walk with reserve less the changes that it can do without, and how many were made."""
    tried = 0
    for keys, _ in FACTORS:
        fewer = {key: x for key, x in best.changes.items() if key not in keys}
        if len(fewer) in (0, len(best.changes)):
            continue
        tried += 1
        try:
            found = _candidate(robot, derived, fewer, name, progress)
        except (InfeasibleGaitError, ConfigError):
            continue
        if found.use <= MOST_USE:
            best = found
    return best, tried


def _rested(
    robot: Robot,
    derived: WalkGait,
    changes: dict[str, float],
    name: str,
    progress: Progress | None,
) -> _Candidate | None:
    """The walk with long rests, over which joints recover from a load; None: it does not help."""
    try:
        found = _candidate(robot, derived, changes, name, progress)
    except (InfeasibleGaitError, ConfigError):  # such as too many samples
        return None
    return found if found.use <= 1.0 else None


def _candidate(
    robot: Robot,
    derived: WalkGait,
    changes: dict[str, float],
    name: str,
    progress: Progress | None,
) -> _Candidate:
    """A walk with other sizes, and what it uses."""
    walk = derived.walk.model_dump(exclude_unset=True) | changes
    tree = derived.model_dump(exclude_unset=True) | {"walk": walk}
    stages = run_stages(robot, build(WalkGait, tree, name), name, progress)
    touching = first_contact(robot, stages.motion.q, COLLISION_STEP)
    if touching is not None:
        return _Candidate(changes, stages, math.inf, f"the distance of {touching[1]}", math.inf)
    uses = uses_of_legs(stages.motion)
    most = max(uses, key=lambda use: use.part)
    excess = sum(max(0.0, use.part - MOST_USE) for use in uses)
    return _Candidate(changes, stages, most.part, f"the {most.of} of {most.joint}", excess)


def _options(robot: Robot, gait: WalkGait, derived: WalkGait) -> list[list[dict[str, float]]]:
    """Other values for the sizes that the gait file leaves out, in the order of their trial."""
    found = [
        [_scaled(keys, factor, robot, gait, derived) for factor in factors]
        for keys, factors in FACTORS
    ]
    return [options for options in found if options[0]]


def _scaled(
    keys: tuple[str, ...], factor: float, robot: Robot, gait: WalkGait, derived: WalkGait
) -> dict[str, float]:
    """Values that the gait file leaves out, times a factor."""
    values = {key: float(getattr(derived.walk, key)) for key in (*TIMES, *RESTS, *LENGTHS)}
    values["step_width"] = midpoint_width(robot)
    values["com_height"] = float(standing_figures(robot).com[2])
    free = [key for key in keys if key not in gait.walk.model_fields_set and values[key]]
    return {key: _rounded(key, values[key] * factor, gait.dt) for key in free}


def _unit(key: str) -> str:
    """Unit of a value that may change."""
    return "s" if key in TIMES or key in RESTS else "rad" if key == "step_yaw" else "m"


def _rounded(key: str, value: float, dt: float) -> float:
    """Durations as whole samples, lengths to a tenth of a millimetre."""
    whole = key in TIMES or key in RESTS
    return round(round(value / dt) * dt, 6) if whole else round(value, DIGITS)
