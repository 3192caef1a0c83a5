"""Action files of ROBOTIS OP3: bytes by their published layout, and the player by mechanics."""

from __future__ import annotations

import dataclasses
import itertools
import re
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.errors import ConfigError, MgsError, MotionFileError
from mgs.motion import Motion
from mgs.motion.cycle import find_cycle
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import FORMATS, Options
from mgs.motion_file.formats.robots.keyframes import keyframes
from mgs.motion_file.formats.robots.op3_pages import (
    INVALID,
    Page,
    PageStep,
    file_bytes,
    page_bytes,
    parse_page,
)
from mgs.motion_file.formats.robots.op3_player import CYCLE, Step, arrivals, play
from mgs.robot import MotorSpec
from tests.support.bus_robots import with_motors
from tests.support.shipped import generated

TICK = 2.0 * np.pi / 4096


@pytest.fixture(scope="module")
def walk() -> Motion:
    motion = generated("melson/walk_practical").stages.motion
    return dataclasses.replace(motion, robot=with_motors(motion.robot))


def decoded(data: bytes, number: int) -> dict[str, Any]:
    """Page by the offsets that action_file_define.h states, one field after the other."""
    page = data[512 * number : 512 * (number + 1)]
    steps = []
    for k in range(page[20]):
        step = page[64 + 64 * k : 128 + 64 * k]
        steps.append(
            {"position": struct.unpack("<31H", step[:62]), "pause": step[62], "time": step[63]}
        )
    return {
        "name": page[:14].rstrip(b"\0").decode(),
        "repeat": page[15],
        "schedule": page[16],
        "speed": page[22],
        "accel": page[24],
        "next": page[25],
        "exit": page[26],
        "pgain": set(page[32:63]),
        "sum": sum(page) % 256,
        "steps": steps,
    }


def test_an_action_file_is_decoded_by_its_published_layout(walk: Motion, tmp_path: Path):
    export_motion(walk, tmp_path / "a.bin", "op3-action")
    data = (tmp_path / "a.bin").read_bytes()
    assert len(data) == 256 * 512
    pages = [decoded(data, k) for k in range(256)]
    assert {page["sum"] for page in pages} == {0xFF}
    used = [k for k, page in enumerate(pages) if page["steps"]]
    assert used == list(range(1, len(used) + 1))
    assert [pages[k]["next"] for k in used] == [*used[1:], 0]
    for k in used:
        page = pages[k]
        assert (page["schedule"], page["speed"], page["repeat"]) == (0x0A, 32, 1)
        assert page["name"] == "walk_practica"  # 13 characters
        assert page["pgain"] == {0x55} and page["exit"] == 0
    # the keyframes are samples of the plan at the times that the steps take
    steps = [step for k in used for step in pages[k]["steps"]]
    at = np.cumsum([step["time"] + 3 for step in steps]) * 0.008
    times = at - at[0]
    assert at[0] == pytest.approx(2.0, abs=0.008)
    for j in range(19):
        ticks = np.array([step["position"][j + 1] for step in steps])
        plan = np.interp(times, walk.times, walk.q[:, 7 + j])
        assert np.abs((ticks - 2048) * TICK - plan).max() < TICK
    for unused in (0, *range(20, 31)):
        assert {step["position"][unused] for step in steps} == {0x4000}


@given(
    name=st.text("abcXYZ_0", max_size=13),
    steps=st.lists(
        st.builds(
            PageStep,
            st.dictionaries(st.integers(1, 30), st.integers(0, 4095)),
            st.integers(0, 255),
            st.integers(0, 255),
        ),
        max_size=7,
    ),
    links=st.tuples(st.integers(0, 255), st.integers(0, 255)),
    flip=st.integers(1, 255),
)
def test_a_page_reads_back_and_a_damaged_one_is_noticed(
    name: str, steps: list[PageStep], links: tuple[int, int], flip: int
):
    page = Page(name, tuple(steps), next=links[0], exit=links[1])
    data = page_bytes(page)
    assert len(data) == 512
    assert parse_page(data) == page
    assert parse_page(data[:100] + bytes([data[100] ^ flip]) + data[101:]) is None


def trapezoids(steps: list[Step], start: np.ndarray) -> np.ndarray:
    """Goals of every cycle by mechanics in real numbers: ramps, even speed, ramps.

    Within a step a joint covers its way in `time` cycles, at rest for one cycle before each of the
    three sections. At a keyframe where it goes on in the same direction it keeps its speed.
    """
    rows, place, speed = [], start.astype(float), np.zeros(len(start))
    for k, step in enumerate(steps):
        n, a = step.time, step.accel
        way = step.target - place
        after = steps[k + 1].target if k + 1 < len(steps) else step.target
        onward = (way * (after - step.target) > 0) & (k + 1 < len(steps))
        # way = (speed + main) a / 2 + main (n - 2 a) + (main a if onward else main a / 2)
        main = (way - 0.5 * speed * a) / np.where(onward, n - 0.5 * a, n - a)
        begin = place.copy()
        rows.append(place.copy())
        for c in range(1, a + 1):
            rows.append(begin + speed * c + (main - speed) * c**2 / (2 * a))
        rows.append(rows[-1].copy())
        ramped = begin + 0.5 * (speed + main) * a
        for c in range(1, n - 2 * a + 1):
            rows.append(ramped + main * c)
        rows.append(rows[-1].copy())
        cruised = ramped + main * (n - 2 * a)
        for c in range(1, a + 1):
            rows.append(
                np.where(onward, cruised + main * c, cruised + main * c - main * c**2 / (2 * a))
            )
        place, speed = step.target.astype(float), np.where(onward, main, 0.0)
    return np.array(rows)


@given(
    st.lists(
        st.tuples(st.integers(-600, 600), st.integers(-600, 600), st.integers(40, 120)),
        min_size=1,
        max_size=6,
    ),
    st.integers(2, 8),
)
def test_the_player_moves_as_mechanics_say(keys: list[tuple[int, int, int]], accel: int):
    """The robot's player in whole ticks, against ramps and even speeds in real numbers.

    Its speeds are whole numbers of 3/160 of a tick per cycle, at most 1023 of them, and it loses up
    to a tick at each change of section; a keyframe that it passes too fast it turns back to.
    """
    steps = [
        Step(2048 + np.array(key[:2]) // len(keys) * (k + 1), key[2], accel=accel)
        for k, key in enumerate(keys)
    ]
    start = np.array([2048, 2048])
    goals = play(steps, start)
    assert len(goals) == sum(step.time + 3 for step in steps)
    for at, step in zip(arrivals(steps), steps, strict=True):
        assert np.abs(goals[at] - step.target).max() <= 12
        assert np.array_equal(goals[at - 1], step.target)  # the last goal but one is the target
    apart = np.abs(goals - trapezoids(steps, start))
    assert apart.max() < 12.0  # 1 deg


@given(
    st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=60),
    st.floats(0.001, 0.5),
    st.integers(1, 6),
    st.integers(12, 20),
)
def test_lines_between_keyframes_stay_near_the_motion(
    angles: list[float], tolerance: float, least: int, most: int
):
    joints = np.array(angles)[:, None]
    found = keyframes(joints, tolerance, least, most)
    assert found[0] == 0 and found[-1] == len(joints) - 1
    gaps = np.diff(found)
    assert gaps.max() <= max(most, least) and np.all(gaps[:-1] >= least)
    for i, j in itertools.pairwise(found):
        line = np.interp(np.arange(i, j + 1), [i, j], joints[[i, j], 0])
        off = np.abs(joints[i : j + 1, 0] - line).max()
        assert off <= tolerance or j - i <= least or j == len(joints) - 1


def test_the_error_that_is_told_is_that_of_the_player(walk: Motion, tmp_path: Path):
    exported = export_motion(walk, tmp_path / "a.bin", "op3-action")
    recorded = FORMATS["op3-action"].read(tmp_path / "a.bin", walk.robot)
    assert recorded.fps == 125.0 and recorded.joint_names == walk.robot.joint_names
    error = np.degrees(np.abs(recorded.joints - exported.sampled.joints))
    _, told, first = exported.written.notes
    rms, worst = (float(x) for x in re.findall(r"([\d.]+) deg", told))
    assert np.sqrt(np.mean(error**2)) == pytest.approx(rms, abs=0.006)
    assert error.max() == pytest.approx(worst, abs=0.006)
    assert first == "the first keyframe is reached after 2.00 s"


def test_a_larger_tolerance_takes_fewer_keyframes(walk: Motion, tmp_path: Path):
    def count(degrees: float) -> int:
        options = Options(tolerance=float(np.radians(degrees)))
        exported = export_motion(walk, tmp_path / "a", "op3-action", options=options, force=True)
        return int(exported.written.notes[0].split()[0])

    assert count(0.1) > count(1.0) > count(10.0)


def test_a_cycle_leads_back_behind_its_approach(walk: Motion, tmp_path: Path):
    cycle = find_cycle(walk)
    export_motion(walk, tmp_path / "a.bin", "op3-action", cycle)
    data = (tmp_path / "a.bin").read_bytes()
    pages = [decoded(data, k) for k in range(256)]
    used = [k for k, page in enumerate(pages) if page["steps"]]
    assert len(pages[1]["steps"]) == 1
    assert [pages[k]["next"] for k in used] == [*used[1:], 2]
    steps = [step for k in used[1:] for step in pages[k]["steps"]]
    period = sum(step["time"] + 3 for step in steps) * CYCLE
    assert period == pytest.approx(cycle.n_samples * walk.dt, abs=CYCLE)
    assert steps[-1]["position"] == pages[1]["steps"][0]["position"]


def test_what_an_action_file_cannot_hold_is_refused(walk: Motion, tmp_path: Path):
    path = tmp_path / "a.bin"
    with pytest.raises(ConfigError, match="100 Hz: the player has 125 Hz"):
        export_motion(walk, path, "op3-action", fps=100.0)
    motors = {n: MotorSpec(id=k + 20, model="XM430") for k, n in enumerate(walk.robot.joint_names)}
    options = Options(motors=motors, motors_file="motors.yaml")
    with pytest.raises(ConfigError, match="id 31: a file has 1 to 30"):
        export_motion(walk, path, "op3-action", options=options)
    assert list(tmp_path.iterdir()) == []


def test_too_many_keyframes_are_refused_with_a_remedy():
    from mgs.motion_file.formats.robots.op3_action import _pages

    steps = [Step(np.array([2048]), 5, accel=2)] * 1786
    with pytest.raises(MgsError, match=r"1786 keyframes take 256 pages.*larger --tolerance"):
        _pages(steps, (1,), "long", loops=False)


def pages_of(*pages: Page) -> bytes:
    return file_bytes({k + 1: page for k, page in enumerate(pages)})


STEP = PageStep({1: 2048}, 20)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "0 bytes; an action file has 131072"),
        (bytes(131072), "the checksum of page 1 is wrong"),
        (pages_of(Page("a", ())), "should begin with a keyframe"),
        (pages_of(Page("a", (STEP,), schedule=0)), "counts speeds, not times"),
        (pages_of(Page("a", (STEP, PageStep({2: 5}, 20)))), "a keyframe of all joints"),
    ],
)
def test_a_damaged_action_file_is_refused(data: bytes, message: str, tmp_path: Path):
    path = tmp_path / "a.bin"
    path.write_bytes(data)
    with pytest.raises(MotionFileError, match=message):
        FORMATS["op3-action"].read(path)


def test_pauses_repeats_and_joints_that_are_left_out_are_played(tmp_path: Path):
    first = Page("a", (PageStep({1: 2048, 2: 1000}, 20),), next=2)
    again = Page("b", (PageStep({1: 2448, 2: INVALID - 1}, 40, pause=10),), repeat=1)
    again = Page("b", (PageStep({1: 2448}, 40, pause=10),), repeat=2)
    path = tmp_path / "a.bin"
    path.write_bytes(pages_of(first, again))
    recorded = FORMATS["op3-action"].read(path)
    assert recorded.joint_names is None and recorded.extra == {"ids": [1, 2]}
    assert np.allclose(recorded.joints[:, 1], (1000 - 2048) * TICK, rtol=0, atol=2 * TICK)
    assert recorded.joints[-1, 0] == pytest.approx(400 * TICK, abs=6 * TICK)
    # two steps of 40 cycles with 3 changes of section, and a pause with one more change between
    assert recorded.n_frames == 2 * 43 + 11 + 1
