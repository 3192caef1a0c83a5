"""Runs of the experiments of Mistry et al.; see the package."""

from __future__ import annotations

from dataclasses import dataclass

from mgs.core.progress import Progress
from mgs.experiments.channels import scaled_waves
from mgs.experiments.mistry.physics import Played, play_motion
from mgs.experiments.variant import BASE, Variant
from mgs.gait import BalanceGait, Gait, load_gait
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot, load_robot

SWAY, EIGHT, WALK = "coman/sway", "coman/hand_eight", "melson/walk_5cm"
VELOCITY, ACCELERATION = "prioritized", "prioritized-acceleration"
TRACKING, PROJECTED = "tracking", "projected"
EQUATION_7, EQUATION_16, FOOTNOTE_3 = "equation_7", "equation_16", "footnote_3"
NO_FEEDBACK = 1e-9  # practically zero feedback of task errors
LOW_FEEDBACK = 0.02
FINE_DT = 0.001  # [s]
_CHANNELS = "balance.channels=[{{task: right_hand_x, wave: constant, value: {x}}}]"


@dataclass(frozen=True)
class Key:
    """Identification of one run."""

    gait: str
    solver: str = VELOCITY
    null_space: str = EQUATION_16
    variant: str = ""  # key of SETTINGS


SETTINGS: dict[str, tuple[str, ...]] = {
    "": (),
    "fine": (f"dt={FINE_DT}",),
    "no feedback": (f"ik.prioritized.feedback={NO_FEEDBACK}",),
    "low feedback": (f"ik.prioritized.feedback={LOW_FEEDBACK}",),
    "no level E": ("ik.prioritized.extraneous=[]",),
    "no clip": ("ik.prioritized.catch_up=null",),
    "out of reach": (_CHANNELS.format(x=0.35),),
    "hand at rest": (_CHANNELS.format(x=0.0),),
    "no handover": ("ik.prioritized.handover=0",),
}


@dataclass(frozen=True, eq=False)
class Study:
    """All runs of the experiment, and replays of two of them in physics."""

    robot: Robot  # COMAN
    runs: dict[Key, Stages]
    played: dict[str, Played]  # by gait, solver eq. (16)

    def __getitem__(self, key: Key) -> Stages:
        """Run with this key."""
        return self.runs[key]


def all_keys() -> list[Key]:
    """Keys of all runs."""
    printed = (EQUATION_7, EQUATION_16, FOOTNOTE_3)
    keys = [Key(gait, VELOCITY, form) for gait in (SWAY, EIGHT) for form in (*printed, TRACKING)]
    keys += [Key(gait, ACCELERATION, EQUATION_16) for gait in (SWAY, EIGHT)]
    keys += [Key(SWAY, VELOCITY, EQUATION_16, v) for v in ("no feedback", "low feedback")]
    keys += [Key(SWAY, solver, TRACKING, "fine") for solver in (VELOCITY, ACCELERATION)]
    keys += [Key(SWAY, ACCELERATION, TRACKING)]
    keys += [Key(EIGHT, VELOCITY, form) for form in (PROJECTED,)]
    keys += [Key(EIGHT, VELOCITY, PROJECTED, "no clip")]
    keys += [Key(EIGHT, VELOCITY, EQUATION_16, v) for v in ("no level E", "hand at rest")]
    keys += [Key(EIGHT, VELOCITY, f, "out of reach") for f in (EQUATION_16, FOOTNOTE_3, TRACKING)]
    keys += [Key(WALK, VELOCITY, EQUATION_16), Key(WALK, VELOCITY, TRACKING)]
    keys += [Key(WALK, VELOCITY, PROJECTED, v) for v in ("", "no handover")]
    return keys


def solve(progress: Progress | None = None, variant: Variant | None = None) -> Study:
    """Generate all runs and play two of them; missed tasks are recorded instead of refused."""
    variant = variant or BASE
    robots = {name: variant.robot(load_robot(name)) for name in ("coman", "melson")}
    runs: dict[Key, Stages] = {}
    keys, played = all_keys(), {}
    for i, key in enumerate(keys):
        robot = robots[key.gait.split("/")[0]]
        runs[key] = run_stages(robot, gait_of(key, variant), key.gait)
        if progress is not None:
            progress(i + 1, len(keys) + 2)
    for i, gait in enumerate((SWAY, EIGHT), start=1):
        played[gait] = play_motion(runs[Key(gait)].motion)
        if progress is not None:
            progress(len(keys) + i, len(keys) + 2)
    return Study(robots["coman"], runs, played)


def gait_of(key: Key, variant: Variant = BASE) -> Gait:
    """Gait of the run with a key, in a variant of the experiment."""
    settings = (
        f"ik.solver={key.solver}",
        f"ik.prioritized.null_space={key.null_space}",
        "ik.on_limit=record",
        *variant.settings,
        *SETTINGS[key.variant],
    )
    gait = load_gait(key.gait, settings)
    if not isinstance(gait, BalanceGait) or key.variant == "out of reach":
        return gait
    return scaled_waves(gait, variant.amplitude, variant.speed)
