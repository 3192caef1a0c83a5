"""op3-action: action file of ROBOTIS OP3 (op3_action_module).

256 pages of 512 bytes with up to 7 keyframes each; page 1 begins the motion, each page leads to the
next one (`next`), the last page to none; of a cycle the last page leads back to page 2, and page 1
only approaches. Positions are ticks of 4096 per turn, 2048 at angle 0, at the place of the motor's
id, which is that of `motors` in robot.yaml or of --motors FILE. They are angles of the robot's own
URDF: directions and zeros are the business of the robot. The first keyframe is reached after the
approach (--approach, 2 s unless it is given, at most 2.06 s), from the present posture.

Times are in control cycles of 8 ms, so frames are taken at 125 Hz and reduced to keyframes:
straight lines between them stay within --tolerance (0.5 deg unless it is given) of the motion, but
for keyframes at least 64 ms apart, which the player needs. What the player makes of them, in whole
ticks and with its acceleration of 2 cycles, is computed, and its joint error is reported: it is
larger than the tolerance, since in each step the goal stands still for 3 cycles. Reading a file
back plays it, from its first keyframe on.

Set action_file_path of the action module to the file and play page 1. The file has no other pages,
such as those for getting up.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from mgs.core.errors import ConfigError, MgsError
from mgs.core.input_files import read_bytes
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.recorded import Reading, RecordedMotion
from mgs.motion_file.formats.robots.keyframes import keyframes
from mgs.motion_file.formats.robots.op3_pages import (
    JOINTS,
    PAGE,
    PAGES,
    STEPS,
    TIME_BASE,
    Page,
    PageStep,
    file_bytes,
    parse_page,
)
from mgs.motion_file.formats.robots.op3_player import (
    CHANGES,
    CYCLE,
    MIDDLE,
    SPEED_1,
    TURN,
    Step,
    Ticks,
    arrivals,
    play,
)
from mgs.robot import Robot

ACCEL = 2  # cycles; with fewer the player does not go to its target itself
LEAST_TIME, MOST_TIME = 2 * ACCEL + 1, 255  # cycles of a step
RATE_SLACK = 0.02  # part by which the rate of a cycle may differ from that of the player
FIRST = 1  # page at which a motion begins


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the pages."""
    if abs(sampled.fps * CYCLE - 1.0) > RATE_SLACK:
        raise ConfigError("fps", f"{sampled.fps:g} Hz: the player has {1.0 / CYCLE:g} Hz")
    names, index = chosen_joints(sampled.robot, options, None)
    ids = options.motors_of(sampled.robot, names).ids
    source = options.motors_source(sampled.robot)
    if other := [i for i in ids if not 1 <= i < JOINTS]:
        raise ConfigError(source, f"motors: id {other[0]}: a file has 1 to {JOINTS - 1}")
    joints = sampled.joints[:, index]
    ticks = _ticks(joints, names)
    chosen = keyframes(joints, options.tolerance, LEAST_TIME + CHANGES, MOST_TIME + CHANGES)
    times = [round(options.approach / CYCLE), *np.diff(chosen)]
    steps = [
        Step(ticks[frame], int(np.clip(time - CHANGES, LEAST_TIME, MOST_TIME)), accel=ACCEL)
        for frame, time in zip(chosen, times, strict=True)
    ]
    pages = _pages(steps, ids, sampled.motion.gait_name, loops=sampled.cycle is not None)
    path.write_bytes(file_bytes(pages))
    return Written(names, notes=_notes(sampled, joints, names, steps, len(pages)))


def _ticks(joints: np.ndarray, names: tuple[str, ...]) -> Ticks:
    ticks = np.rint(MIDDLE + joints * (TURN / (2.0 * math.pi))).astype(np.int64)
    beyond = (ticks < 0) | (ticks >= TURN)
    if beyond.any():
        joint = names[int(np.argmax(beyond.any(axis=0)))]
        raise MgsError(f"joint {joint} turns farther than half a turn, which no position can be")
    return ticks


def _pages(steps: list[Step], ids: tuple[int, ...], name: str, loops: bool) -> dict[int, Page]:
    """Pages by number."""
    rows = [
        PageStep(dict(zip(ids, step.target.tolist(), strict=True)), step.time) for step in steps
    ]
    groups = [rows[:1]] if loops else []
    rest = rows[1:] if loops else rows
    groups += [rest[k : k + STEPS] for k in range(0, len(rest), STEPS)]
    if len(groups) >= PAGES:
        raise MgsError(
            f"{len(rows)} keyframes take {len(groups)} pages, but an action file has {PAGES - 1}; "
            "use a larger --tolerance"
        )
    last = len(groups)
    after = {FIRST + k: FIRST + k + 1 for k in range(last)}
    after[last] = FIRST + 1 if loops else 0
    label = name.rpartition("/")[2]
    return {
        FIRST + k: Page(label, tuple(group), next=after[FIRST + k], accel=ACCEL)
        for k, group in enumerate(groups)
    }


def _notes(
    sampled: SampledMotion,
    joints: np.ndarray,
    names: tuple[str, ...],
    steps: list[Step],
    n_pages: int,
) -> tuple[str, ...]:
    """What is told of the keyframes: how many there are, and the joint error of the player."""
    error = np.degrees(np.abs(_played(steps)[: len(joints)] - joints))
    k, j = np.unravel_index(int(np.argmax(error)), error.shape)
    rms = math.sqrt(float(np.mean(error**2)))
    notes = [
        f"{len(steps)} keyframes on {n_pages} pages from page {FIRST} on",
        f"joint error of the robot's player: {rms:.2f} deg RMS, at most {error.max():.2f} deg "
        f"({names[j]} at {sampled.times[k]:.2f} s)",
        f"the first keyframe is reached after {CYCLE * (steps[0].time + CHANGES):.2f} s",
    ]
    if abs(sampled.fps * CYCLE - 1.0) > 1e-9:
        notes.append(
            f"played at {1.0 / CYCLE:g} Hz, a cycle takes {CYCLE * sampled.fps:.4f} times as long"
        )
    return tuple(notes)


def _played(steps: list[Step]) -> np.ndarray:
    """Joint angles (T, n) [rad] in each control cycle from the first keyframe to the last one."""
    at = arrivals(steps)
    goals = play(steps, steps[0].target)[at[0] : at[-1] + 1]
    return np.asarray((goals - MIDDLE) * (2.0 * math.pi / TURN))


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """What the player makes of page 1 and those that follow, until one comes again."""
    reading, data = Reading(path), read_bytes(path, PAGE * PAGES, "an action file")
    if len(data) != PAGE * PAGES:
        raise reading.error(f"{len(data)} bytes; an action file has {PAGE * PAGES}")
    steps: list[tuple[Page, PageStep]] = []
    number, seen = FIRST, set()
    while number and number not in seen:
        seen.add(number)
        page = parse_page(data[PAGE * number : PAGE * (number + 1)])
        if page is None:
            raise reading.error(f"the checksum of page {number} is wrong")
        if page.schedule != TIME_BASE:
            raise reading.error(f"page {number} counts speeds, not times; it cannot be read")
        steps += [(page, step) for step in page.steps] * page.repeat
        number = page.next
    ids = sorted({i for _, step in steps for i in step.positions})
    if not ids or not set(ids) <= set(steps[0][1].positions):
        raise reading.error(f"page {FIRST} should begin with a keyframe of all joints that move")
    played = _played(_in_order(steps, ids))
    return RecordedMotion(
        layout="op3-action",
        fps=1.0 / CYCLE,
        joint_names=_names(ids, robot),
        order=None,
        joints=reading.array("its keyframes", played, None, len(ids)),
        extra={"ids": ids},
    )


def _in_order(steps: list[tuple[Page, PageStep]], ids: list[int]) -> list[Step]:
    """Steps with times in cycles; a joint that a step leaves out stays where it is."""
    found, target = [], np.zeros(len(ids), dtype=np.int64)
    for page, step in steps:
        target = np.array(
            [step.positions.get(i, int(x)) for i, x in zip(ids, target, strict=True)],
            dtype=np.int64,
        )
        speed = max(page.speed, 1)
        time, pause = (step.time * speed) // SPEED_1, (step.pause * SPEED_1) // speed
        found.append(Step(target, time, pause, page.accel))
    return found


def _names(ids: list[int], robot: Robot | None) -> tuple[str, ...] | None:
    """Joints of the motors; None if that is not known."""
    turned = {} if robot is None else {m.id: joint for joint, m in robot.spec.motors.items()}
    return tuple(turned[i] for i in ids) if set(ids) <= turned.keys() else None
