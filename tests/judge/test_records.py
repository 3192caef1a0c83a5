"""Tests of the records of long measurements: a motion is known again, and only that motion."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from records import prefix_of, read_record, write_record

from mgs.robot import Robot
from tests.support.replays import side_to_side


def test_a_motion_is_known_again_up_to_its_last_digits(melson: Robot, tmp_path: Path):
    motion, path = side_to_side(melson, 0.03, 0.5), tmp_path / "record.json"
    known, results = read_record(path)
    prefix = prefix_of("melson/sway", motion, known)
    write_record(path, known, results | {f"{prefix} mujoco": []})
    known, results = read_record(path)
    assert results == {f"{prefix} mujoco": []}
    noise = np.random.default_rng(0).uniform(-1e-8, 1e-8, motion.q.shape)
    same = dataclasses.replace(motion, q=motion.q + noise)
    assert prefix_of("melson/sway", same, known) == prefix
    assert len(known) == 1


def test_another_motion_gait_or_length_is_told_apart(melson: Robot):
    motion, known = side_to_side(melson, 0.03, 0.5), {}
    others = [side_to_side(melson, 0.0301, 0.5), side_to_side(melson, 0.03, 0.52)]
    prefixes = {prefix_of("melson/sway", one, known) for one in (motion, *others)}
    prefixes.add(prefix_of("melson/other", motion, known))
    assert len(prefixes) == len(known) == 4
