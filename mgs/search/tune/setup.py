"""What a search needs to know before it begins: sizes, engines, servos and margin."""

from __future__ import annotations

from collections.abc import Iterable

from mgs.core.errors import ConfigError, InfeasibleGaitError
from mgs.gait import Gait, WalkGait
from mgs.judge.motion_checks import check_motion
from mgs.motion_planner import for_robot
from mgs.pipeline import run_stages
from mgs.pipeline.fit import fit_walk
from mgs.robot import Robot, servos_of
from mgs.search.tune.evaluate import TuneTask
from mgs.search.tune.objective import ObjectiveName, known_score, plan_figures
from mgs.search.tune.space import make_space
from mgs.sim import EngineName, ServoName

N_DRAWS = {"robust": 24, "speed": 8, "energy": 8, "torque": 8}
RANGES_OF = {"robust": "wide", "speed": "lab", "energy": "lab", "torque": "lab"}
SAVING: tuple[ObjectiveName, ...] = ("energy", "torque")  # whose walks have to beat the start gait


def make_task(
    robot: Robot,
    gait: Gait,
    objective: ObjectiveName,
    *,
    engines: tuple[EngineName, ...],
    speed: float | None = None,
    margin: float | None = None,
    pins: Iterable[str] = (),
    frees: Iterable[str] = (),
    ranges: str | None = None,
    n_draws: int | None = None,
    seed: int = 0,
) -> TuneTask:
    """The task of a search.

    Args:
        robot: the robot.
        gait: start gait, which has to be a walk.
        objective: what is sought.
        engines: physics engines in which a walk has to pass.
        speed: speed to keep [m/s]; None: that of the start gait.
        margin: least distance of the ZMP from the edge of the support polygon [m]; None: 0, and
            that of the start gait where energy or torques are to be saved.
        pins: assignments `key=value` of keys that are not varied.
        frees: `key=low:high` or `key=value,value` of keys that are varied so.
        ranges: random conditions, "wide" or "lab"; None: "wide" for robustness, else "lab".
        n_draws: random conditions in each engine with each kind of servos; 0: none, not for
            robustness; None: 24 for robustness, else 8.
        seed: of the random conditions.

    Raises:
        ConfigError: the gait is no walk, or an option does not fit it.
    """
    if not isinstance(gait, WalkGait):
        raise ConfigError(f"{gait.motion} gait", "only a walk (motion: walk) can be tuned")
    resolved = with_sizes(robot, gait)
    if objective == "robust" and n_draws == 0:
        raise ConfigError("--draws", "robustness cannot be sought without random conditions")
    space = make_space(robot, resolved, objective, speed=speed, pins=pins, frees=frees)
    score = 0.0
    if objective in SAVING:
        own_margin, score = planned(robot, resolved, objective)
        margin = own_margin if margin is None else margin
    return TuneTask(
        robot=robot,
        space=space,
        objective=objective,
        engines=engines,
        servos=servos_for(robot),
        ranges=ranges or RANGES_OF[objective],
        n_draws=N_DRAWS[objective] if n_draws is None else n_draws,
        seed=seed,
        least_margin=margin or 0.0,
        least_score=score,
    )


def with_sizes(robot: Robot, gait: WalkGait) -> WalkGait:
    """The walk with the sizes that `mgs generate` chooses for those that the gait leaves out."""
    if gait.walk.sizes == "given":
        return gait
    try:
        found = fit_walk(robot, gait)[0].motion.gait
    except InfeasibleGaitError:  # the search may find a walk that the robot can do
        found = for_robot(gait, robot)
    assert isinstance(found, WalkGait)
    return found


def servos_for(robot: Robot) -> tuple[ServoName, ...]:
    """Ideal servos, and those of robot.yaml if it describes them well enough, else PD servos."""
    try:
        servos_of(robot)
    except ConfigError:
        return "ideal", "pd"
    return "ideal", "model"


def planned(robot: Robot, gait: WalkGait, objective: ObjectiveName) -> tuple[float, float]:
    """ZMP margin [m] and score of a plan, should it pass everything; zeros without a plan."""
    try:
        motion = run_stages(robot, gait).motion
    except InfeasibleGaitError:
        return 0.0, 0.0
    margin = next(check.value for check in check_motion(motion) if check.name == "zmp_margin")
    return max(0.0, margin), known_score(objective, plan_figures(motion)) or 0.0
