"""What the action player of ROBOTIS OP3 makes of keyframes, tick by tick.

The player (op3_action_module) is called once per control cycle. A step takes `time` cycles in three
sections, and one more cycle for each change of section, in which the goal stands still:

    PRE   accel cycles, from the speed at the end of the step before to the main speed
    MAIN  at the main speed
    POST  accel cycles: down to rest if the joint turns round, pauses or ends here, else as MAIN;
          the last goal but one is the target of the step

It computes in whole ticks (4096 per turn) and whole speeds, and reads its goal back between two
sections by a conversion to radians, which loses a tick of some angles. All of this is here, so that
the error of an exported motion is that of the robot's own player. Numbers are those of C: division
rounds towards zero, shifting down.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Ticks = NDArray[np.int64]

TURN, MIDDLE = 4096, 2048
CYCLE = 0.008  # [s] control_cycle in OP3.robot
CHANGES = 3  # cycles of a step in which the section changes
MAX_SPEED = 1023
SPEED_1 = 32  # speed of a page at which `time` is in cycles
# A tick, converted to radians and back as the player does it.
READ_BACK: Ticks = np.array(
    [int(((v - MIDDLE) * math.pi / 2048.0 + math.pi) * 2048.0 / math.pi) for v in range(TURN)]
)


@dataclass(frozen=True, eq=False)
class Step:
    """One keyframe: where the joints go, and how long it takes."""

    target: Ticks  # (n,)
    time: int  # cycles, without the changes of section
    pause: int = 0  # cycles
    accel: int = 0  # cycles

    @property
    def cycles(self) -> int:
        """Cycles from the beginning of the step to the beginning of the next one."""
        accel, total = self.sections
        del accel
        return total + CHANGES + (self.pause + 1 if self.pause else 0)

    @property
    def sections(self) -> tuple[int, int]:
        """Cycles of acceleration, and of the whole way, as the player shortens them."""
        total = max(self.time, 1)
        if total > 2 * self.accel:
            return self.accel, total
        accel = (total - 1) >> 1
        return accel, total if accel else 0


def arrivals(steps: Sequence[Step]) -> list[int]:
    """Cycle, from 0, in which each step reaches its target."""
    ends = np.cumsum([step.cycles for step in steps])
    pauses = [step.pause + 1 if step.pause else 0 for step in steps]
    return [int(end) - pause - 1 for end, pause in zip(ends, pauses, strict=True)]


def play(steps: Sequence[Step], start: Ticks) -> Ticks:
    """Goals (C, n) [ticks] of all control cycles, from joints at `start` (n,)."""
    goals: list[Ticks] = []
    speed = np.zeros_like(start)
    before = start
    for k, step in enumerate(steps):
        after = steps[k + 1].target if k + 1 < len(steps) else step.target
        moved, speed = _play_step(step, before, after, speed, k + 1 == len(steps))
        held = goals[-1] if goals else start
        for goal in moved:
            held = held if goal is None else goal
            goals.append(held)
        before = step.target
    return np.array(goals).reshape(-1, len(start))


def _play_step(
    step: Step, before: Ticks, after: Ticks, last_speed: Ticks, is_last: bool
) -> tuple[list[Ticks | None], Ticks]:
    """Goals of the cycles of one step, None where the goal stands still, and the final speeds."""
    target, moving = step.target, step.target - before
    onward = ((before < target) & (target < after)) | ((before > target) & (target > after))
    rests = ~onward | bool(step.pause) | is_last
    accel, total = step.sections
    pre, main = 2 * accel, 2 * (total - accel)
    way = _divide(moving * 2560, 12) - last_speed * pre
    main_speed = np.where(
        rests, _divide(way, max(2 * main, 1)), _divide(way, max(pre + 2 * main, 1))
    )
    main_speed = np.clip(main_speed, -MAX_SPEED, MAX_SPEED)
    goals: list[Ticks | None] = [None]
    start, goal, speed, gained = before, before, last_speed, np.zeros_like(before)
    for count in range(1, accel + 1):
        more = _divide((main_speed - last_speed) * count, accel)
        speed = np.where(moving == 0, speed, last_speed + more)
        gained = _ramp(last_speed, more, count)
        goal = np.where(moving == 0, start, start + gained)
        goals.append(goal)
    goals.append(None)
    start, cruise = READ_BACK[np.clip(goal, 0, TURN - 1)], total - 2 * accel
    covered = np.where(
        rests,
        moving - gained - (_divide(main_speed * accel * 12, 5) >> 8),
        _divide((moving - gained) * cruise, max(total - accel, 1)),
    )
    for count in range(1, cruise + 1):
        goal = np.where(moving == 0, start, start + _divide(covered * count, cruise))
        speed = np.where(moving == 0, speed, main_speed)
        goals.append(goal)
    goals.append(None)
    start, rest = READ_BACK[np.clip(goal, 0, TURN - 1)], moving - covered - gained
    final_speed = speed
    for count in range(1, accel + 1):
        less = _divide(-final_speed * count, accel)
        if count == accel - 1:
            there = target
        else:
            there = start + np.where(
                rests, _ramp(final_speed, less, count), _divide(rest * count, accel)
            )
            speed = np.where(moving == 0, speed, np.where(rests, final_speed + less, main_speed))
        goal = np.where(moving == 0, start, there)
        goals.append(goal)
    if step.pause:
        goals += [None] * (step.pause + 1)
        speed = np.zeros_like(speed)
    return goals, speed


def _divide(a: Ticks, b: int) -> Ticks:
    """Quotient, rounded towards zero."""
    return np.asarray(np.sign(a) * (np.abs(a) // b))


def _ramp(speed: Ticks, change: Ticks, count: int) -> Ticks:
    """Ticks covered in `count` cycles in which a speed changes evenly."""
    return np.asarray(_divide((speed + (change >> 1)) * count * 144, 15) >> 9)
