"""Runs of the experiments of Faraji and Ijspeert, and measurements on them; see the package."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ, FLOATING_BASE_NV
from mgs.core.progress import Progress
from mgs.experiments.variant import BASE, Variant
from mgs.gait import BalanceGait, load_gait
from mgs.ik_solver.floating.safety_region import SafetyRegion
from mgs.ik_solver.hard_soft import FarajiReport
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot, load_robot

ROBOT = "coman_legs"
ITERATED = ("ik2", "ik4", "ik5")  # methods with n iterations
BOUNDED = ("ik3", "ik4", "ik5")
MANY, FEW = 15, 3  # numbers of iterations n
SQUAT, STRETCHED, TILTING, LEAN = "squat", "squat_stretched", "squat_tilting", "lean"
SWAY, TWIST = "sway_twist", "twist"
Z_MAX = 0.5497  # [m] height of the CoM with straight legs
# Heights and channels of tasks A, B and C; the paper states only the frequency of task A. The
# shipped gaits squat less deep and more slowly: these squats exceed the continuous knee torque.
_SINE = "{task: com_z, wave: sine, amplitude: 0.05, frequency: 1.0}"
_TILT = (
    "{task: torso_roll, wave: sine, amplitude: 0.1745, frequency: 0.5}, "
    "{task: torso_pitch, wave: sine, amplitude: 0.1745, frequency: 0.5, phase: 1.5708}"
)
PAPER: dict[str, tuple[str, ...]] = {
    SQUAT: ("balance.com_height=0.4797", f"balance.channels=[{_SINE}]"),
    STRETCHED: ("balance.com_height=0.5197", f"balance.channels=[{_SINE}]"),
    TILTING: ("balance.com_height=0.5197", f"balance.channels=[{_SINE}, {_TILT}]"),
}
CROUCHES = (
    0.02,
    -0.02,
    -0.04,
    -0.06,
    -0.08,
    -0.1,
    -0.13,
)  # [m] relative to Z_MAX; the first one is out of reach
SLOWER = 10  # factor of slowing down, for a motion without lag
FINE_DT = 0.002  # [s] sampling period of task A
BENT_DEG = 15.0  # [deg] knee angle from which on the knee has left the stretched posture
WELL_BENT_DEG = 30.0  # [deg] knee angle from which on the knee returns to its reference


@dataclass(frozen=True)
class Key:
    """Identification of one run: gait, method, iterations and variant."""

    gait: str
    method: str
    n: int = MANY
    variant: str = ""  # key of VARIANTS, or a height for SWAY

    @property
    def label(self) -> str:
        """Method, with its iterations if it is iterated."""
        return f"{self.method}, n = {self.n}" if self.method in ITERATED else self.method


VARIANTS = {
    "": (),
    "fine": (f"dt={FINE_DT}",),
    "polygon": ("ik.faraji.region=polygon",),
    "gamma 0": ("ik.faraji.gamma=0",),
    "equal weights": ("ik.faraji.soft.com=[1.0, 1.0, 1.0]",),
    "slow": ("dt=0.1", "balance.duration=110.0", "balance.rest=5.0", "balance.ease=10.0"),
    "quiet": (),
}
SIMULATED = (
    "ik.faraji.margin=0",
    "ik.faraji.speed_max=4.0",
)  # Table I, simulation; SWAY uses the values for the robot


@dataclass(frozen=True, eq=False)
class Run:
    """Run with the samples in which its channels have their full amplitude."""

    stages: Stages
    window: slice

    @property
    def dt(self) -> float:
        """Sampling period [s]."""
        return self.stages.motion.dt

    @property
    def times(self) -> Array:
        """Sample times (N,) [s]."""
        return self.stages.motion.times

    @property
    def joints(self) -> Array:
        """Joint angles (N, n) [rad]."""
        return self.stages.motion.q[:, FLOATING_BASE_NQ:]

    @property
    def seconds_per_solve(self) -> float:
        """Mean time of stage 4 per sample [s]."""
        return self.stages.seconds["ik_solver"] / len(self.joints)

    def com_error(self) -> Array:
        """CoM minus its reference (m, 3) in the window [m]."""
        motion = self.stages.motion
        return (motion.com - motion.com_ref)[self.window]

    def com_velocity_error(self) -> Array:
        """CoM velocity minus its reference (m - 1, 3), from sample to sample [m/s]."""
        return np.diff(self.com_error(), axis=0) / self.dt

    def speeds(self) -> Array:
        """Joint speeds (m - 1, n) in the window, from sample to sample [rad/s]."""
        return np.diff(self.joints[self.window], axis=0) / self.dt

    def accelerations(self) -> Array:
        """Joint accelerations (m - 2, n) in the window, from second differences [rad/s^2]."""
        return np.diff(self.joints[self.window], 2, axis=0) / self.dt**2


@dataclass(frozen=True, eq=False)
class Study:
    """All runs of the experiment."""

    robot: Robot
    runs: dict[Key, Run]

    def __getitem__(self, key: Key) -> Run:
        """Run with this key."""
        return self.runs[key]

    def joint(self, name: str) -> list[int]:
        """Indices of the left and the right joint with a name such as KneeSag."""
        return [self.robot.joint_names.index(side + name) for side in "LR"]


def methods(names: Iterable[str] = ("ik1", "ik2", "ik3", "ik4", "ik5")) -> list[tuple[str, int]]:
    """All methods with MANY iterations, and iterated methods also with FEW iterations."""
    return [(name, n) for name in names for n in (MANY, FEW) if n == MANY or name in ITERATED]


def all_keys() -> list[Key]:
    """Keys of all runs, in the order of the tasks."""
    keys = [Key(SQUAT, m, n, variant) for variant in ("fine", "") for m, n in methods()]
    keys += [Key(gait, m, n) for gait in (STRETCHED, TILTING, LEAN, TWIST) for m, n in methods()]
    keys += [Key(LEAN, "ik4", MANY, "equal weights"), Key(LEAN, "ik2", MANY, "equal weights")]
    keys += [Key(STRETCHED, "ik4", MANY, variant) for variant in ("polygon", "gamma 0")]
    keys += [Key(SWAY, "ik4", FEW, f"{height:g}") for height in CROUCHES]
    keys += [Key(SWAY, "ik4", FEW, "quiet"), Key(TWIST, "ik4", MANY, "slow")]
    return keys


def solve(progress: Progress | None = None, variant: Variant | None = None) -> Study:
    """Generate all runs."""
    variant = variant or BASE
    robot = variant.robot(load_robot(ROBOT))
    runs: dict[Key, Run] = {}
    keys = all_keys()
    for i, key in enumerate(keys):
        runs[key] = run_one(robot, key, variant.settings)
        if progress is not None:
            progress(i + 1, len(keys))
    return Study(robot, runs)


def run_one(robot: Robot, key: Key, settings: tuple[str, ...] = ()) -> Run:
    """Generate one run; missed tasks are recorded instead of refused."""
    gait = gait_of(key, settings)
    stages = run_stages(robot, gait, f"{ROBOT}/{key.gait}")
    ends = gait.balance.rest + gait.balance.ease
    first, last = round(ends / gait.dt), round((gait.balance.duration - ends) / gait.dt)
    return Run(stages, slice(first, last + 1))


def gait_of(key: Key, more: tuple[str, ...] = ()) -> BalanceGait:
    """Gait of the run with a key, with more settings."""
    settings = [
        *PAPER.get(key.gait, ()),
        f"ik.solver={key.method}",
        f"ik.iterations={key.n}",
        "ik.on_limit=record",
    ]
    settings += VARIANTS.get(key.variant, ())
    if key.gait != SWAY:
        settings += SIMULATED
    elif key.variant not in VARIANTS:
        settings.append(f"balance.com_height={Z_MAX + float(key.variant)}")
    gait = load_gait(f"{ROBOT}/{key.gait}", (*settings, *more))
    assert isinstance(gait, BalanceGait)
    if key.variant == "slow":
        return _rescaled(gait, 1.0 / SLOWER)
    return _rescaled(gait, 0.0) if key.variant == "quiet" else gait


def _rescaled(gait: BalanceGait, factor: float) -> BalanceGait:
    """Channels slowed down by a factor; for a factor of 0 only the height remains."""
    channels = []
    for channel in gait.balance.channels:
        field = "frequency" if factor else "amplitude"
        value = getattr(channel, field) * factor
        channels.append(channel.model_copy(update={field: value}))
    balance = gait.balance.model_copy(update={"channels": channels})
    return gait.model_copy(update={"balance": balance})


def region_excess(study: Study, run: Run) -> float:
    """Largest violation of joint limits [rad] or safety region [-]; 0 or less if there is none."""
    gait = run.stages.gait
    tuning = gait.ik.faraji
    robot, joints = study.robot, run.joints
    assert tuning.speed_max is not None
    speed = np.minimum(tuning.speed_max, robot.speed_limit)
    region = SafetyRegion(robot.lower, robot.upper, speed, run.dt, tuning.region)
    outside = np.maximum(robot.lower - joints, joints - robot.upper).max()
    return float(max(region.excess(joints[:-1], joints[1:]).max(), outside))


def limit_excess_deg(run: Run, robot: Robot, joints: list[int]) -> float:
    """Largest violation of the limits of some joints [deg]; negative: least distance from them."""
    angles = run.joints[run.window][:, joints]
    excess = np.maximum(robot.lower[joints] - angles, angles - robot.upper[joints])
    return float(np.degrees(excess.max()))


def hard_error(run: Run) -> float:
    """Largest error of a hard row [m] or [rad], as reported by the solver."""
    return report_of(run).hard_error


def report_of(run: Run) -> FarajiReport:
    """The report of the solver."""
    return run.stages.joints.report_of(FarajiReport)


def escape_delay(study: Study, run: Run, bent_deg: float = BENT_DEG) -> float:
    """Mean delay [s] with which a knee reaches an angle after it was stretched.

    The delay is relative to the reference: an exact solution has this angle when the reference
    falls to the CoM height that belongs to the angle.
    """
    knee = run.joints[:, study.joint("KneeSag")[0]]
    bent = np.deg2rad(bent_deg)
    height, wanted = _height_of_knee(run, knee, bent), run.stages.motion.com_ref[:, 2]
    delays = []
    for k in range(run.window.start + 1, run.window.stop):
        later = np.flatnonzero(knee[k:] >= bent)
        if wanted[k - 1] > height >= wanted[k] and len(later):
            delays.append(later[0] * run.dt)
    return float(np.mean(delays))


def _height_of_knee(run: Run, knee: Array, angle: float) -> float:
    """CoM height [m] at which the knee has an angle, interpolated from the samples of the run."""
    z, angles = run.stages.motion.com[run.window, 2], knee[run.window]
    order = np.argsort(angles)
    return float(np.interp(angle, angles[order], z[order]))


def rejoining_acceleration(study: Study, run: Run) -> float:
    """Largest acceleration of a well-bent knee on its way back to the reference [rad/s^2]."""
    knees = study.joint("KneeSag")
    bent = run.joints[run.window][1:-1, knees] > np.deg2rad(WELL_BENT_DEG)
    return float(np.abs(run.accelerations()[:, knees][bent]).max())


def knee_torque(study: Study, run: Run) -> float:
    """Mean magnitude [N m] of both knee torques in the window."""
    return float(np.abs(run.stages.motion.torque[run.window][:, study.joint("KneeSag")]).mean())


def knee_difference_deg(study: Study, run: Run) -> float:
    """Largest difference between the two knee angles in the window [deg]."""
    left, right = study.joint("KneeSag")
    angles = run.joints[run.window]
    return float(np.degrees(np.abs(angles[:, left] - angles[:, right]).max()))


def power(run: Run) -> tuple[float, float]:
    """Mean values of sum |tau qdot| [W] and sum tau^2 [(N m)^2] in the window."""
    motion = run.stages.motion
    torque, speed = motion.torque[run.window], motion.v[run.window, FLOATING_BASE_NV:]
    return (
        float(np.mean(np.sum(np.abs(torque * speed), axis=1))),
        float(np.mean(np.sum(torque**2, axis=1))),
    )
