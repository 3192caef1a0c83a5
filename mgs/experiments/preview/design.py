"""Analysis of the CoM generator of any gait: poles of its closed loop, and its step response.

The gains of the generator `preview` are compared with those of python-control, an independent
solution of the same linear-quadratic problem. Any other generator, such as `qp`, has no constant
gains and so no poles. The step response is that of the generator itself, which gets a reference of
the zero-moment point (ZMP) that jumps by a tenth of the length of a sole while both soles stand.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mgs.com_generator import generate_com
from mgs.core.arrays import Array
from mgs.core.contact import Support
from mgs.core.errors import ConfigError
from mgs.experiments.preview.servo import Servo, lqr_feedback
from mgs.gait import ZmpGait, load_gait
from mgs.motion_planner import PosturePlan, for_robot, plan_motion
from mgs.robot import load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

REST = 4.0  # [s] before and after the step
SETTLED = 0.02  # part of the step within which a response has settled
SOLE_PART = 0.1  # height of the step as a part of the length of a sole


@dataclass(frozen=True, eq=False)
class Design:
    """Properties of a CoM generator.

    Attributes:
        gait: name of the gait.
        robot: name of the robot.
        generator: name of the generator.
        dt: sampling period [s].
        com_height: height of the CoM [m].
        settings: weights and preview window of the generator `preview`, else empty.
        poles: poles of the closed loop (4,), largest first; empty without constant gains.
        gain_gap: relative difference of the feedback gains to those of python-control; None
            without constant gains.
        time: time from the step (N,) [s].
        zmp: response (N,) of the ZMP, relative to the step.
        com: response (N,) of the CoM, relative to the step.
    """

    gait: str
    robot: str
    generator: str
    dt: float
    com_height: float
    settings: dict[str, float]
    poles: tuple[complex, ...]
    gain_gap: float | None
    time: Array = field(repr=False)
    zmp: Array = field(repr=False)
    com: Array = field(repr=False)

    @property
    def overshoot(self) -> float:
        """Largest excess of the ZMP over the step after it, relative to the step."""
        return float(max(0.0, (self.zmp[self.time >= 0.0] - 1.0).max()))

    @property
    def undershoot(self) -> float:
        """Largest motion of the ZMP in the other direction, relative to the step."""
        return float(max(0.0, -self.zmp.min()))

    @property
    def settling_time(self) -> float:
        """Time after the step from which the ZMP stays within 2 % of it [s]."""
        away = np.flatnonzero(np.abs(self.zmp - 1.0) > SETTLED)
        return float(max(0.0, self.time[away[-1]] + self.dt))

    @property
    def time_constants(self) -> tuple[float, ...]:
        """Time constant of each pole [s]: -dt / ln |pole|; 0 for a pole at zero."""
        return tuple(
            float(-self.dt / np.log(abs(pole))) if abs(pole) > 0.0 else 0.0 for pole in self.poles
        )

    def to_dict(self) -> dict[str, object]:
        """Convert to plain data; poles are pairs of real and imaginary part."""
        return {
            "gait": self.gait,
            "robot": self.robot,
            "generator": self.generator,
            "dt": self.dt,
            "com_height": self.com_height,
            "settings": dict(self.settings),
            "poles": [[pole.real, pole.imag] for pole in self.poles],
            "time_constants": list(self.time_constants),
            "gain_gap": self.gain_gap,
            "overshoot": self.overshoot,
            "undershoot": self.undershoot,
            "settling_time": self.settling_time,
        }


def analyse(gait: str | Path, robot: str | Path | None = None) -> Design:
    """Analyse the CoM generator of a gait.

    Args:
        gait: name or path of the gait.
        robot: name or folder of the robot; None: the robot of the gait.

    Raises:
        ConfigError: the gait has no CoM generator, or names no robot and none is given.
        InfeasibleGaitError: the gait cannot be planned, or the generator cannot follow the step.
    """
    name, loaded = str(gait), load_gait(gait)
    if not isinstance(loaded, ZmpGait):
        raise ConfigError(
            name,
            f"motion {loaded.motion} has no generator of a CoM motion; use a walk or a kick, or a "
            "part of a sequence",
        )
    where = robot or loaded.robot
    if where is None:
        raise ConfigError(name, "the gait names no robot; give one with --robot")
    model = load_robot(where)
    resolved = for_robot(loaded, model)
    assert isinstance(resolved, ZmpGait)
    plan = plan_motion(model, resolved)
    assert not isinstance(plan, PosturePlan)
    tasks, com = plan_trajectories(plan), resolved.com
    height = SOLE_PART * model.spec.soles.left.length
    standing, before = standing_step(tasks, height)
    answer = generate_com(model, standing, com)
    start = standing.zmp_ref[0, 0]
    poles: tuple[complex, ...] = ()
    gap, settings = None, {}
    if com.generator == "preview":
        servo = Servo(tasks.dt, float(tasks.com_height[0]), com)
        poles = tuple(sorted((complex(p) for p in servo.closed_loop().poles()), key=abs))[::-1]
        gap = float(np.abs(servo.feedback / lqr_feedback(servo) - 1.0).max())
        names = ("preview", "weight_error", "weight_jerk")
        settings = {key: float(getattr(com, key)) for key in names}
    return Design(
        gait=name,
        robot=model.spec.name,
        generator=com.generator,
        dt=tasks.dt,
        com_height=float(tasks.com_height[0]),
        settings=settings,
        poles=poles,
        gain_gap=gap,
        time=tasks.dt * np.arange(-before, standing.n_samples - before, dtype=np.float64),
        zmp=(answer.zmp[:, 0] - start) / height,
        com=(answer.position[:, 0] - start) / height,
    )


def standing_step(tasks: TaskTrajectory, height: float) -> tuple[TaskTrajectory, int]:
    """Tasks of a robot that stands at the start of a gait while the ZMP reference jumps forward.

    Args:
        tasks: tasks of the gait.
        height: height of the step [m].

    Returns:
        the tasks, and the number of samples before the step.
    """
    before = round(REST / tasks.dt)
    n = 2 * before

    def first(values: Array) -> Array:
        return np.repeat(values[:1], n, axis=0)

    zmp_ref = first(tasks.zmp_ref)
    zmp_ref[before:, 0] += height
    standing = dataclasses.replace(
        tasks,
        support=np.full(n, Support.DOUBLE, np.int8),
        root=np.repeat(tasks.root[:1], n),
        zmp_ref=zmp_ref,
        load_left=first(tasks.load_left),
        soles=first(tasks.soles),
        hands=first(tasks.hands),
        com_height=first(tasks.com_height),
        torso=first(tasks.torso),
        com=None,
        posture=None,
        payload=None,
    )
    return standing, before
