"""What a robot can do as it is: engines load it, and the default walk keeps its limits.

These are the checks of a robot folder that need more than the folder: a robot may be sound by
itself, and still an engine refuses it, or its walk leaves a limit.
"""

from __future__ import annotations

from mgs.core.engines import available_engines
from mgs.core.errors import MgsError
from mgs.judge.motion_checks import check_motion
from mgs.pipeline import request
from mgs.robot import Robot
from mgs.robot.soundness import Finding
from mgs.sim.engine import make_engine
from mgs.sim.settings import DEFAULTS


def check_use(robot: Robot) -> list[Finding]:
    """Load a robot in every installed engine, and plan the default walk."""
    return [_engines(robot), _walk(robot)]


def _engines(robot: Robot) -> Finding:
    problems = []
    for name in available_engines():
        try:
            make_engine(name, robot, DEFAULTS[name]).close()
        except MgsError as error:
            problems.append(str(error))
    return Finding(
        "engines",
        not problems,
        "; ".join(problems)
        or f"loaded by {', '.join(available_engines()) or 'none: none is there'}",
        "compare links, inertias and limits of the URDF with what the engine says",
    )


def _walk(robot: Robot) -> Finding:
    remedy = "see what the message or the check names; other sizes of the walk may help"
    try:
        motion = request.generate(robot, "walk")
    except MgsError as error:
        return Finding("default_walk", False, f"no default walk: {error}", remedy)
    # what has no time, such as the RMS torque, is a property of a whole walk
    checks = [check for check in check_motion(motion) if check.time is not None]
    failed = [check for check in checks if not check.ok]
    told = "; ".join(
        f"{c.name} {c.value:.3g} of {c.limit:.3g} {c.unit} {c.where}".rstrip() for c in failed
    )
    figure = told or "the default walk keeps every limit"
    return Finding("default_walk", not failed, figure, remedy)
