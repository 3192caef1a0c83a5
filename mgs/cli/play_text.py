"""What mgs play is about to send, and what it prints: a dry run, the servos found, the report."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mgs.cli.common import print_json, say
from mgs.core.short_text import clipped

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from mgs.motion.goals import Goals
    from mgs.robot.hardware.session import Result, Situation
    from mgs.robot.motors import Motors

    Ticks = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Plan:
    """What servos of a robot are to be told."""

    file: Path
    motors: Motors
    goals: Goals
    ticks: Ticks  # (K, n)

    @property
    def words(self) -> str:
        """What is sent, in one line."""
        goals = self.goals
        unit = "" if goals.unit is None else f", corrected for {clipped(goals.unit, 40)}"
        return (
            f"{len(self.ticks)} goals of {len(self.motors.ids)} servos at {goals.rate:g} Hz, "
            f"{goals.times[-1]:.2f} s: {goals.kind} joint angles{unit}"
        )

    def to_dict(self) -> dict[str, object]:
        """Plain dict for JSON, without the goals."""
        return {
            "file": str(self.file),
            "goals": self.goals.kind,
            "unit": self.goals.unit,
            "rate": self.goals.rate,
            "samples": len(self.ticks),
            "duration": float(self.goals.times[-1]),
            "joints": list(self.motors.joint_names),
            "servos": list(self.motors.ids),
        }


def print_dry_run(plan: Plan, as_json: bool) -> None:
    """Print what would be sent."""
    import numpy as np

    ticks, rate = plan.ticks, plan.goals.rate
    speed = np.abs(np.diff(ticks, axis=0)).max(axis=0, initial=0) * rate
    fastest = np.degrees(speed * plan.motors.resolution)
    if as_json:
        print_json(plan.to_dict() | {"dry_run": True, "ticks": ticks.tolist()})
        return
    say(f"dry run, nothing is sent\n{plan.words}")
    width = max(map(len, plan.motors.joint_names))
    say(f"{'joint':<{width}}   id  first   last lowest highest  fastest [deg/s]")
    for i, (name, servo) in enumerate(zip(plan.motors.joint_names, plan.motors.ids, strict=True)):
        row = ticks[:, i]
        say(
            f"{name:<{width}} {servo:>4} {row[0]:>6} {row[-1]:>6} {row.min():>6} {row.max():>7} "
            f"{fastest[i]:>8.0f}"
        )


def situation_words(plan: Plan, situation: Situation, options: dict[str, Any]) -> str:
    """Words for what was found on the line, and what is going to happen."""
    import numpy as np

    line = situation.line
    gap = np.degrees(np.abs(situation.gap) * plan.motors.resolution)
    worst = int(gap.argmax())
    lines = [
        plan.words,
        f"{len(line.servos)} servos answer on {options['port']}, {1e3 * line.answer:.2f} ms each; "
        f"{line.at_once(1.0 / plan.goals.rate)} of them are watched in a period; lowest voltage "
        f"{line.voltage:.1f} V",
        *(f"warning: {warning}" for warning in line.warnings),
        f"farthest from the first posture: {plan.motors.joint_names[worst]}, {gap[worst]:.1f} deg",
    ]
    if situation.approach_seconds:
        lines.append(
            f"the robot goes there in {situation.approach_seconds:.1f} s, at most "
            f"{options['approach_deg']:g} deg/s"
        )
    stop = "hold" if options["on_stop"] == "hold" else "lose their torque"
    lines.append(f"when stopped, servos {stop}; hang the robot up or hold it")
    return "\n".join(lines)


def report(plan: Plan, result: Result, situation: Situation, as_json: bool) -> None:
    """Print what was done."""
    parts = {"approach": result.approach, "motion": result.motion}
    if as_json:
        print_json(
            plan.to_dict()
            | {
                "stopped": result.stopped,
                "torque": result.holds,
                "answer_seconds": situation.line.answer,
                "voltage": situation.line.voltage,
                "warnings": list(situation.line.warnings),
                **{name: None if part is None else part.to_dict() for name, part in parts.items()},
            }
        )
        return
    for name, part in parts.items():
        if part is not None:
            say(f"{name}: {part.words}")
    say("servos hold their posture" if result.holds else "servos have no torque")
