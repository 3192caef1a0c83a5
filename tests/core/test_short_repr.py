"""One-line reprs of large objects, each object that the library hands out among them."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
import pytest

from mgs.core.short_repr import short_repr
from mgs.gait import load_gait
from mgs.motion import Motion
from mgs.motion.cycle import find_cycle
from mgs.motion.dynamics import analyse
from mgs.motion.servo_commands import servo_commands
from mgs.pipeline import Generated, generate
from mgs.robot import Robot, load_robot, servos_of
from mgs.sim import available_engines, replay
from mgs.sim.conditions import RANGES, draw
from tests.support.shipped import generated

LONGEST = 1500


@dataclasses.dataclass(frozen=True)
class Record:
    """A dataclass of everything that may be long."""

    array: np.ndarray
    text: str
    entries: tuple[int, ...]
    number: float

    __repr__ = short_repr


def test_arrays_are_shown_by_type_and_shape_and_long_values_are_cut():
    record = Record(np.zeros((1000, 3), np.float32), "x" * 1000, tuple(range(1000)), 0.5)
    text = repr(record)
    assert text.startswith("Record(array=<float32 (1000, 3)>, text='xxx")
    assert text.endswith(", entries=(0, 1, 2, ...), number=0.5)")
    assert len(text) < 200


def test_fields_that_are_not_large_are_shown_whole():
    assert repr(Record(np.eye(2), "a", (1, 2), 3.0)) == (
        "Record(array=<float64 (2, 2)>, text='a', entries=(1, 2), number=3.0)"
    )


def products(value: object, name: str) -> Iterator[tuple[str, object]]:
    """An object and, where they are dataclasses, all those that it is made of."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        yield name, value
        for field in dataclasses.fields(value):
            yield from products(getattr(value, field.name), f"{name}.{field.name}")
    elif isinstance(value, tuple | list):
        for i, entry in enumerate(value):
            yield from products(entry, f"{name}[{i}]")


def is_short(value: object) -> bool:
    text = repr(value)
    return len(text) < LONGEST and "\n" not in text and "array(" not in text


@pytest.mark.parametrize(
    "gait", ["melson/walk_5cm", "melson/kick", "melson/pick_up", "melson/bow", "coman_legs/squat"]
)
def test_every_product_of_the_stages_has_a_short_repr(gait: str):
    stages = generated(gait).stages
    found = dict(products(stages, "stages"))
    assert len(found) > 5
    inside = ("stages.motion.robot.", "stages.motion.gait.")  # of what is no product of theirs
    long = [name for name in found if not name.startswith(inside) and not is_short(found[name])]
    assert long == [], "give these `__repr__ = short_repr`"


def test_motions_robots_and_what_is_made_of_a_motion_have_a_short_repr(melson: Robot):
    gait = load_gait("melson/walk_practical", com__passes=0, walk__n_steps=8)
    made = generate(melson, gait, "walk")
    motion = made.motion
    body = analyse(melson, motion.q, motion.dt, np.full(motion.n_samples, 0.5))
    conditions = draw(motion, RANGES["wide"], 0, 0)
    for value in (
        *(made, motion, melson, body, conditions),
        *(find_cycle(motion), servo_commands(motion), servos_of(melson)),
    ):
        assert is_short(value), type(value)
    assert repr(melson) == f"<Robot melson: {melson.n} joints, {melson.mass:.2f} kg>"
    assert isinstance(made, Generated)
    assert repr(motion) == (
        f"<Motion walk of melson: walk, {motion.duration:.2f} s, {motion.n_samples} samples of "
        "0.01 s, solver clik>"
    )


@pytest.mark.skipif(not available_engines(), reason="needs an engine")
@pytest.mark.parametrize("falls", [False, True])
def test_a_replay_says_how_it_ended(falls: bool):
    motion = generated("melson/bow").stages.motion
    if falls:
        q = motion.q.copy()
        q[:, 7 + motion.robot.joint_names.index("left_knee_pitch")] += 0.8
        motion = dataclasses.replace(motion, q=q)
    found = replay(motion, available_engines()[-1])
    assert found.fell == falls
    assert is_short(found) and is_short(found.trace)
    fate = f"fell at {found.fall_time:.2f} s" if falls else "stays up"
    assert f"in {found.engine}, servos ideal: {fate}, ends " in repr(found)


def test_a_motion_shows_itself_as_a_picture():
    motion = generated("melson/walk_5cm").stages.motion
    assert isinstance(motion, Motion)
    assert motion._repr_png_().startswith(b"\x89PNG\r\n")
    assert load_robot(motion.robot) is motion.robot
