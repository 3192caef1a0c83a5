"""A motion with lower torques: from a motion to its problem, and from the solution to a motion."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from mgs.core.constants import CONTACT_TOLERANCE
from mgs.core.errors import ConfigError
from mgs.core.progress import Progress
from mgs.core.short_repr import short_repr
from mgs.judge.motion_checks import zmp_margins
from mgs.motion import Motion
from mgs.motion.dynamics import analyse, lowest_points
from mgs.motion.energy import energy_of
from mgs.motion.joint_load import step_speeds
from mgs.motion.provenance import Optimisation
from mgs.robot.support_polygon import in_support
from mgs.search.whole_body.problem import Problem, Weights, bearing
from mgs.search.whole_body.solve import NO_VIOLATION, Solution, solve

LEAST_SAMPLES = 5
MOST_MARGIN = 0.02  # [m] that is asked for at most if nothing is said
LEAST_LOAD = 1e-9  # part of the weight
HANDS_OF_WALKS = ("walk", "kick", "sequence")  # motions whose hands may go where they like
HOLD_HANDS = 1e3  # weight of the hands in the others


@dataclass(frozen=True)
class Figures:
    """What a motion asks of its servos."""

    torque_rms: float  # over all joints and samples [N m]
    lasting_torque: float  # largest RMS torque of a joint, as a part of what it can give for long
    positive_work: float  # [J]
    cost_of_transport: float | None
    zmp_margin: float  # least [m]
    joint_speed: float  # largest, as a part of its limit

    def to_dict(self) -> dict[str, float | None]:
        """Convert to plain data."""
        return dataclasses.asdict(self)


@dataclass(frozen=True, eq=False)
class Optimised:
    """The motion that was found, with figures of both."""

    motion: Motion
    before: Figures
    after: Figures
    solution: Solution

    __repr__ = short_repr

    @property
    def holds(self) -> bool:
        """True if the motion keeps all limits of the problem."""
        return self.solution.violations.worst <= NO_VIOLATION

    def to_dict(self) -> dict[str, object]:
        """The figures as plain data."""
        return {
            "holds": self.holds,
            "before": self.before.to_dict(),
            "after": self.after.to_dict(),
            "objective": list(self.solution.objective),
            "violations": dataclasses.asdict(self.solution.violations),
        }


def optimise(
    motion: Motion,
    weights: Weights | None = None,
    *,
    margin: float | None = None,
    iterations: int = 15,
    progress: Progress | None = None,
) -> Optimised:
    """Lower the objective of `mgs.search.whole_body.problem`, beginning with a finished motion.

    Args:
        motion: motion of the pipeline; its footsteps, times and soles are kept.
        weights: of the objective. Default: torques first; hands are held in motions that use them.
        margin: least distance of the centre of pressure from the edge of a sole [m]. Default: the
            least ZMP margin of the motion, at most 20 mm.
        iterations: largest number of quadratic programs.
        progress: function that is called with the number of the program and of all of them.

    Raises:
        ConfigError: the motion is one whose dynamics the problem does not describe.
    """
    refuse_unfit(motion)
    before = figures_of(motion)
    if weights is None:
        weights = Weights(hands=default_hands(motion))
    margin = min(max(before.zmp_margin, 0.0), MOST_MARGIN) if margin is None else margin
    problem = Problem(
        motion.robot, motion.dt, motion.q, motion.soles, bearing(motion.support), weights, margin
    )
    solution = solve(problem, iterations, progress)
    found = _motion_of(motion, problem, solution)
    return Optimised(found, before, figures_of(found), solution)


def default_hands(motion: Motion) -> float:
    """Weight of the hands that suits a motion: those of a walk may go where they like."""
    return 0.0 if motion.gait.motion in HANDS_OF_WALKS else HOLD_HANDS


def refuse_unfit(motion: Motion) -> None:
    """Raise ConfigError for a motion whose dynamics the problem does not describe."""
    why = None
    if not motion.gait.is_balanced:
        why = "does not stand on its soles alone"
    elif motion.robot.coupling is not None:
        why = "is of a robot with coupled joints"
    elif motion.payload is not None:
        why = "carries a payload"
    elif _rolls(motion):
        why = "rolls over its heels and toes"
    elif motion.n_samples < LEAST_SAMPLES:
        why = f"has {motion.n_samples} samples, fewer than {LEAST_SAMPLES}"
    if why:
        raise ConfigError(motion.gait_name, f"{why}; such a motion cannot be optimised")


def _rolls(motion: Motion) -> bool:
    """Whether a sole is in support that is not level."""
    tilt = motion.soles_ref[..., 2] - lowest_points(motion.robot, motion.soles_ref)
    return bool(np.any(tilt[in_support(motion.support)] > CONTACT_TOLERANCE))


def figures_of(motion: Motion) -> Figures:
    """The figures of a motion that stands on its soles."""
    energy = energy_of(motion)
    assert energy is not None  # it stands on its soles
    margins = zmp_margins(motion, motion.zmp)
    by_joint = np.sqrt(np.mean(motion.torque**2, axis=0))
    return Figures(
        torque_rms=float(np.sqrt(np.mean(motion.torque**2))),
        lasting_torque=float((by_joint / motion.robot.lasting_torque).max()),
        positive_work=energy.positive_work,
        cost_of_transport=energy.cost_of_transport,
        zmp_margin=float(margins.min()),
        joint_speed=float((step_speeds(motion).max(axis=0) / motion.robot.speed_limit).max()),
    )


def _motion_of(motion: Motion, problem: Problem, solution: Solution) -> Motion:
    point = solution.point
    load = np.maximum(point.w[..., 2], LEAST_LOAD)
    load_left = np.where(problem.bears.all(axis=1), load[:, 0] / load.sum(axis=1), 0.0)
    load_left[problem.bears[:, 0] & ~problem.bears[:, 1]] = 1.0
    body = analyse(motion.robot, point.q, motion.dt, load_left)
    made = Optimisation(
        weights=dataclasses.asdict(problem.weights),
        margin=problem.margin,
        objective=(solution.objective[0], solution.objective[-1]),
    )
    return dataclasses.replace(
        motion,
        q=body.q,
        v=body.v,
        torque=body.torque,
        com=body.com,
        com_ref=body.com,
        zmp=body.zmp,
        zmp_ref=body.zmp,
        soles=body.soles,
        hands=body.hands,
        hands_ref=body.hands[..., :3],
        torso=body.torso,
        torso_ref=body.torso[:, 3:],
        provenance=dataclasses.replace(motion.provenance, optimised=made),
    )
