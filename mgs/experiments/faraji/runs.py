"""Runs of the experiments of Faraji and Ijspeert; see the package."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mgs.core.arrays import Array
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.progress import Progress
from mgs.experiments.channels import scaled_waves
from mgs.experiments.variant import BASE, Variant
from mgs.gait import BalanceGait, load_gait
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
DURATIONS = {SQUAT: 5.0, STRETCHED: 5.0, TILTING: 5.0, LEAN: 7.0, TWIST: 7.0, SWAY: 7.0}  # [s]
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
RESERVES = ("", ", reserve")
FINE_DT = 0.002  # [s] sampling period of task A


@dataclass(frozen=True)
class Key:
    """Identification of one run: gait, method, iterations and variant."""

    gait: str
    method: str
    n: int = MANY
    variant: str = ""  # key of SETTINGS; for SWAY also a height, or a height and such a key

    @property
    def label(self) -> str:
        """Method, with its iterations if it is iterated."""
        return f"{self.method}, n = {self.n}" if self.method in ITERATED else self.method


BENT, GRADIENTS = "ik.faraji.bent_start=true", "ik.faraji.descent=conjugate_gradients"
EQUAL, WEIGHTED = "ik.faraji.soft.com=[1, 1, 1]", "ik.faraji.soft.com=[100, 100, 1]"
SETTINGS: dict[str, tuple[str, ...]] = {  # of the variants of a run
    "": (),
    "fine": (f"dt={FINE_DT}",),
    "5 ms": ("dt=0.005",),
    "2 ms": ("dt=0.002",),
    "5 ms, reserve": ("dt=0.005", "ik.faraji.reserve=true"),
    "2 ms, reserve": ("dt=0.002", "ik.faraji.reserve=true"),
    "fine, gradients": (f"dt={FINE_DT}", GRADIENTS),
    "bent": (BENT,),
    "gradients": (GRADIENTS,),
    "polygon": ("ik.faraji.region=polygon",),
    "gamma 0": ("ik.faraji.gamma=0",),
    "gamma 100": ("ik.faraji.gamma=100",),
    "gamma 100, fast": ("ik.faraji.gamma=100",),
    "weighted": (WEIGHTED,),
    "slow": ("dt=0.1", "balance.duration=70.0", "balance.rest=5.0", "balance.ease=10.0"),
    "quiet": (),
    "quiet, weighted": (WEIGHTED,),
}
FASTER = 2.0  # factor of the frequencies of the variant "fast"
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
    keys = [Key(SQUAT, m, n, "fine") for m, n in methods()]
    keys += [Key(SQUAT, "ik2", n, "fine, gradients") for n in (MANY, FEW)]
    keys += [Key(SQUAT, m, MANY) for m in ("ik1", "ik2", "ik4", "ik5")]
    keys += [Key(gait, m, n) for gait in (STRETCHED, TILTING) for m, n in methods()]
    for gait in (STRETCHED, TILTING):
        for variant in ("bent", "gradients"):
            keys += [Key(gait, "ik2", n, variant) for n in (MANY, FEW)]
    keys += [Key(TILTING, "ik4", MANY, f"{dt} ms{more}") for dt in "52" for more in RESERVES]
    keys += [Key(LEAN, f"ik{i}") for i in (1, 2, 3, 4)]
    keys += [Key(LEAN, m, MANY, "weighted") for m in ("ik2", "ik4")]
    keys += [Key(TWIST, f"ik{i}") for i in (1, 3, 4)]
    keys += [Key(STRETCHED, "ik4", MANY, variant) for variant in ("polygon", "gamma 0")]
    keys += [
        Key(STRETCHED, m, MANY, f"gamma 100{x}") for m in ("ik4", "ik5") for x in ("", ", fast")
    ]
    keys += [Key(SWAY, "ik4", FEW, f"{height:g}") for height in CROUCHES]
    keys += [Key(SWAY, "ik4", FEW, f"{CROUCHES[i]:g}, weighted") for i in (0, -1)]
    keys += [Key(SWAY, "ik4", FEW, variant) for variant in ("quiet", "quiet, weighted")]
    keys += [Key(TWIST, "ik4", MANY, "slow")]
    return keys


def solve(progress: Progress | None = None, variant: Variant | None = None) -> Study:
    """Generate all runs."""
    variant = variant or BASE
    robot = variant.robot(load_robot(ROBOT))
    runs: dict[Key, Run] = {}
    keys = all_keys()
    for i, key in enumerate(keys):
        runs[key] = run_one(robot, key, variant)
        if progress is not None:
            progress(i + 1, len(keys))
    return Study(robot, runs)


def run_one(robot: Robot, key: Key, variant: Variant = BASE) -> Run:
    """Generate one run; missed tasks are recorded instead of refused."""
    gait = gait_of(key, variant)
    stages = run_stages(robot, gait, f"{ROBOT}/{key.gait}")
    ends = gait.balance.rest + gait.balance.ease
    first, last = round(ends / gait.dt), round((gait.balance.duration - ends) / gait.dt)
    return Run(stages, slice(first, last + 1))


def gait_of(key: Key, variant: Variant = BASE) -> BalanceGait:
    """Gait of the run with a key, in a variant of the experiment."""
    height, _, rest = key.variant.partition(", ")
    is_height = key.gait == SWAY and height != "quiet"
    settings = [
        *PAPER.get(key.gait, ()),
        f"ik.solver={key.method}",
        f"ik.iterations={key.n}",
        "ik.on_limit=record",
        "ik.faraji.reserve=false",  # the reserve is ours
        EQUAL,
        f"balance.duration={DURATIONS[key.gait]}",
        *(() if key.gait == SWAY else SIMULATED),
        *variant.settings,
        *SETTINGS[rest if is_height else key.variant],
    ]
    if is_height:
        settings.append(f"balance.com_height={Z_MAX + float(height)}")
    gait = load_gait(f"{ROBOT}/{key.gait}", tuple(settings))
    assert isinstance(gait, BalanceGait)
    speed = variant.speed * (FASTER if key.variant.endswith("fast") else 1.0)
    if key.variant == "slow":
        speed /= SLOWER
    still = key.variant.startswith("quiet")
    return scaled_waves(gait, 0.0 if still else variant.amplitude, speed)
