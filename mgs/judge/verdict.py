"""Pass or fail of a motion: static checks and physics replays put together.

Tolerances of a replay: the robot stays up to the end and one second longer, ends within
max(10 % of the distance, 20 mm) and 5 deg of its plan, and holds no servo at its limit for longer
than 50 ms in a row: the stall torque of an ideal servo, the speed-torque line of any other.
A ball that is kicked has, 0.1 s after contact, at least half the sole's speed and 0.3 m/s, within
10 deg of the direction asked. A motion without balance stands at its end, upright within 10 deg
with a fifth of the weight on each sole, and nothing else is asked of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mgs.judge.html import verdict_table
from mgs.judge.motion_checks import Check
from mgs.judge.servo_cases import ServoSweep
from mgs.motion.energy import Energy
from mgs.sim import Agreement, EngineName, MissingEngine, Replay, ServoName, Strike, agreement
from mgs.sim.figures import STANDING_LOAD, STANDING_TILT_DEG
from mgs.sim.poses import FALL_TILT

POSITION_RATIO, POSITION_FLOOR = 0.10, 0.020  # of the distance; [m]
YAW_LIMIT_DEG = 5.0
FALL_TILT_DEG = float(np.degrees(FALL_TILT))
SATURATION_LIMIT = 0.050  # [s] in a row
BALL_SPEED_RATIO, BALL_SPEED_FLOOR = 0.5, 0.3  # of the sole's speed; [m/s]
BALL_DIRECTION_DEG = 10.0


@dataclass(frozen=True, eq=False)
class Verdict:
    """All findings on one motion."""

    file: str  # or, of a motion that was not read from a file, the name of its gait
    checks: tuple[Check, ...]  # static ones first, then those of each replay
    replays: tuple[Replay, ...]
    monte_carlo: dict[str, object] | None = None  # as `mgs.judge.monte_carlo.summary` gives it
    servo_sweep: tuple[ServoSweep, ...] | None = None  # by engine; no check depends on it
    engines_missing: tuple[MissingEngine, ...] = ()  # engines that are not installed
    energy: Energy | None = None  # of the plan; None: its torques are not known
    left_out: tuple[str, ...] = ()  # checks that are not made, since there is no plan to follow
    guesses: tuple[str, ...] = ()  # keys of robot.yaml whose values were guessed

    @property
    def passed(self) -> bool:
        """Whether no check fails."""
        return all(check.ok for check in self.checks)

    @property
    def failed(self) -> tuple[str, ...]:
        """Names of the checks that fail."""
        return tuple(check.name for check in self.checks if not check.ok)

    @property
    def servo(self) -> ServoName | None:
        """Servos of the first replays, after whose engines checks are named; None: no replays."""
        return self.replays[0].servo if self.replays else None

    @property
    def engines(self) -> tuple[EngineName, ...]:
        """Engines of the replays, each once."""
        return tuple(dict.fromkeys(replay.engine for replay in self.replays))

    @property
    def agreement(self) -> Agreement | None:
        """How far two engines agree with the servos of the first replays; None: not two."""
        first = [replay for replay in self.replays if replay.servo == self.servo]
        return agreement(*first) if len(first) == 2 else None

    def __repr__(self) -> str:
        return f"<Verdict on {self.file}: {self._in_words}>"

    def _repr_html_(self) -> str:
        """Table for a notebook."""
        return verdict_table(f"{self.file}: {self._in_words}", self.checks)

    @property
    def _in_words(self) -> str:
        engines = ", ".join(self.engines) or "no physics"
        if self.engines_missing:
            engines += f" ({', '.join(m.engine for m in self.engines_missing)} missing)"
        n, failed = len(self.checks), self.failed
        told = f"fail: {', '.join(failed)}; {len(failed)} of" if failed else "pass,"
        return f"{told} {n} checks, {engines}"

    def to_dict(self) -> dict[str, object]:
        """The verdict as plain data, in the shape that `mgs validate --json` prints."""
        agreed = self.agreement
        return {
            "file": self.file,
            "verdict": "pass" if self.passed else "fail",
            "checks": [check.to_dict() for check in self.checks],
            "checks_left_out": list(self.left_out),
            "guesses": list(self.guesses),
            "energy": None if self.energy is None else self.energy.to_dict(),
            "servo": self.servo,
            "physics": list(self.engines),  # empty: static checks alone
            "engines_missing": [engine.to_dict() for engine in self.engines_missing],
            "replays": [replay.to_json() for replay in self.replays],
            "agreement": None if agreed is None else agreed.to_dict(),
            "monte_carlo": self.monte_carlo,
            "servo_sweep": None
            if self.servo_sweep is None
            else [sweep.to_dict() for sweep in self.servo_sweep],
        }


def judge(
    file: str,
    checks: list[Check],
    replays: list[Replay],
    monte_carlo: dict[str, object] | None = None,
) -> Verdict:
    """Verdict on a motion from its static checks and its replays.

    Checks are named after the engine, such as mujoco_upright; those of replays with other servos
    than the first one's after engine and servos, such as mujoco_pd_upright.
    """
    first = replays[0].servo if replays else None
    names = [r.engine if r.servo == first else f"{r.engine}_{r.servo}" for r in replays]
    pairs = zip(replays, names, strict=True)
    physical = [check for replay, name in pairs for check in replay_checks(replay, name)]
    return Verdict(file, (*checks, *physical), tuple(replays), monte_carlo)


def replay_checks(replay: Replay, name: str | None = None) -> list[Check]:
    """What a replay must show; a robot that fell is not measured further.

    Args:
        replay: the replay to judge.
        name: first part of the names of the checks; None: the engine.
    """
    name = name or replay.engine
    if not replay.is_balanced:
        tilted, load = replay.end_tilt_deg, replay.end_load
        return [
            Check(
                f"{name}_stands", tilted <= STANDING_TILT_DEG, tilted, STANDING_TILT_DEG,
                "deg of tilt at the end", None, "torso",
            ),
            Check(
                f"{name}_soles_bear", load >= STANDING_LOAD, load, STANDING_LOAD,
                "of the weight at the end", None, "less loaded sole",
            ),
        ]  # fmt: skip
    tilt = replay.max_tilt_deg
    sank = replay.fell and tilt <= FALL_TILT_DEG
    where = "base below its least height" if sank else "torso"
    upright = Check(
        f"{name}_upright",
        not replay.fell,
        tilt,
        FALL_TILT_DEG,
        "deg of tilt",
        replay.fall_time,
        where,
    )
    if replay.fell:
        return [upright]
    distance = float(np.hypot(*replay.planned_distance))
    allowed = max(POSITION_RATIO * distance, POSITION_FLOOR)
    yaw = abs(replay.yaw_error_deg)
    saturation = replay.torque_saturation
    joint = replay.torque_saturation_joint or ""
    return [
        upright,
        _at_most(f"{name}_position", replay.position_error, allowed, "m from plan"),
        _at_most(f"{name}_yaw", yaw, YAW_LIMIT_DEG, "deg from plan"),
        _at_most(f"{name}_saturation", saturation, SATURATION_LIMIT, "s in a row", joint),
        *(check for strike in replay.strikes for check in strike_checks(name, strike)),
    ]


def strike_checks(engine: str, strike: Strike) -> list[Check]:
    """What a struck ball must show."""
    least = max(BALL_SPEED_RATIO * strike.sole_speed, BALL_SPEED_FLOOR)
    struck = strike.time is not None and strike.ball_speed >= least
    speed, turn = strike.ball_speed, abs(strike.direction_error_deg)
    return [
        Check(f"{engine}_ball_speed", struck, speed, least, "m/s at least", strike.time, "ball"),
        _at_most(f"{engine}_ball_direction", turn, BALL_DIRECTION_DEG, "deg", "ball"),
    ]


def _at_most(name: str, value: float, limit: float, unit: str, where: str = "") -> Check:
    return Check(name, value <= limit, value, limit, unit, None, where)
