"""Tables of walks by velocity, read as the policies that look up in them do."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mgs.core.contact import Support
from mgs.core.errors import ConfigError, CycleError
from mgs.gait import load_gait
from mgs.motion import Motion
from mgs.motion.cycle import find_cycle
from mgs.motion_file.formats import Options
from mgs.motion_file.formats.lookup import LOOKUPS, Walk
from mgs.motion_file.formats.lookup.open_duck_poly import fit
from mgs.motion_file.formats.lookup.walk import mean_velocity, walk_of
from mgs.motion_file.formats.pickle_file import read_pickle
from mgs.pipeline import generate
from mgs.robot import load_robot
from tests.support.shipped import generated

FPS = 50.0
LENGTHS, TURNS = (0.02, 0.04), (0.0, 0.05)


def made(length: float, turn: float, **changes: float) -> Motion:
    values = {"walk.n_steps": 8, "com.passes": 0, **changes}
    values |= {"walk.step_length": length, "walk.step_yaw": turn}
    gait = load_gait("melson/walk_practical", tuple(f"{k}={v}" for k, v in values.items()))
    return generate(load_robot("melson"), gait, "walk").motion


@pytest.fixture(scope="module")
def walks() -> list[Walk]:
    return [walk_of(made(length, turn), FPS, 3) for length in LENGTHS for turn in TURNS]


class PolyReferenceMotion:
    """The reader of the Open Duck playground, with NumPy for JAX: single precision throughout."""

    def __init__(self, path: Path) -> None:
        data = pickle.loads(path.read_bytes())
        first = next(iter(data.values()))
        self.n = int(first["period"] * first["fps"])
        grid: dict[tuple[float, ...], Any] = {}
        for name, entry in data.items():
            key = tuple(float(part) for part in name.split("_"))
            rows = [np.flip(np.array(c, np.float32)) for c in entry["coefficients"].values()]
            grid[key] = np.array(rows)
        self.axes = [sorted({key[k] for key in grid}) for k in range(3)]
        self.data = {
            (x, y, z): grid[x, y, z]
            for x in self.axes[0]
            for y in self.axes[1]
            for z in self.axes[2]
        }

    def at(self, velocity: tuple[float, float, float], i: int) -> np.ndarray:
        key = tuple(
            min(axis, key=lambda value: abs(value - wanted))
            for axis, wanted in zip(self.axes, velocity, strict=True)
        )
        t = np.float32(i % self.n / self.n)
        return np.array([np.polyval(row, t) for row in self.data[key]], np.float32)


def test_polynomials_follow_the_frames(walks: list[Walk], tmp_path: Path):
    path = tmp_path / "table.pkl"
    written = LOOKUPS["open-duck-poly"].write(walks, path, Options())
    told = float(written.notes[0].split()[-2])
    motion = PolyReferenceMotion(path)
    assert motion.n == walks[0].n_frames
    for walk in walks:
        sampled, n = walk.sampled, walk.sampled.robot.n
        index = [sampled.robot.joint_names.index(name) for name in written.joints]
        found = np.array([motion.at(walk.velocity, i) for i in range(motion.n)])
        assert found.shape[1] == 2 * n + 8
        off = np.abs(found[:, :n] - sampled.joints[:-1, index])
        assert off.max() <= 1.005 * told  # it has three digits
        assert np.sqrt(np.mean(off**2)) < 0.02
        speed, turning = found[:, 2 * n + 2 : 2 * n + 5], found[:, 2 * n + 5 :]
        planned = sampled.base_linear_velocity[:-1], sampled.base_angular_velocity[:-1]
        assert np.sqrt(np.mean((speed - planned[0]) ** 2)) < 0.02
        assert np.sqrt(np.mean((turning - planned[1]) ** 2)) < 0.05
        assert np.abs(turning[:, 2].mean() - walk.velocity[2]) < 5e-3


def test_a_fit_of_all_powers_would_lose_its_digits(walks: list[Walk]):
    """Least squares in double precision, evaluated in single precision, is off by radians."""
    walk = walks[-1]
    phase = np.arange(walk.n_frames + 1) / walk.n_frames
    knee = walk.sampled.joints[:, walk.sampled.robot.joint_names.index("left_knee_pitch")]
    series = np.polynomial.Chebyshev.fit(phase, knee, 15, domain=[0, 1])
    powers = series.convert(kind=np.polynomial.Polynomial, domain=[-1, 1], window=[-1, 1]).coef
    single = np.polyval(powers[::-1].astype(np.float32), phase.astype(np.float32))
    _, error = fit(phase, knee)
    assert np.abs(series(phase) - knee).max() < error < 0.2
    assert np.abs(single - knee).max() > 5.0 * error


def test_a_grid_with_a_gap_is_refused(walks: list[Walk], tmp_path: Path):
    with pytest.raises(ConfigError, match=r"1 of the 4 points .* vx = 0.05, vy = 0 m/s, wz = 0.06"):
        LOOKUPS["open-duck-poly"].write(walks[:3], tmp_path / "a", Options())
    with pytest.raises(ConfigError, match="two walks have the velocity"):
        LOOKUPS["open-duck-poly"].write([*walks, walks[0]], tmp_path / "a", Options())
    assert list(tmp_path.iterdir()) == []


def test_walks_of_other_periods_are_refused(walks: list[Walk], tmp_path: Path):
    other = walk_of(made(0.03, 0.0, **{"walk.single_support": 0.6}), FPS, 3)
    with pytest.raises(ConfigError, match="all walks need the same period; they have 80 to 90"):
        LOOKUPS["open-duck-poly"].write([walks[0], other], tmp_path / "a", Options())


def test_a_table_of_toddlerbot_repeats_the_frames(walks: list[Walk], tmp_path: Path):
    path = tmp_path / "table.pkl"
    written = LOOKUPS["toddlerbot-zmp"].write(walks, path, Options())
    keys, com, stance, legs = pickle.loads(path.read_bytes())
    assert len(keys) == len(com) == len(stance) == len(legs) == len(walks)
    assert [name.partition("_")[0] for name in written.joints] == ["left"] * 6 + ["right"] * 6
    for walk in walks:
        nearest = int(np.argmin(np.linalg.norm(np.array(keys) - walk.velocity, axis=1)))
        index = [walk.sampled.robot.joint_names.index(name) for name in written.joints]
        assert legs[nearest].shape == (walk.n_frames, 12)
        assert np.abs(legs[nearest] - walk.sampled.joints[:-1, index]).max() < 1e-6
        assert stance[nearest][0].tolist() == [1.0, 0.0]
        wrap = np.abs(legs[nearest][0] - legs[nearest][-1]).max()
        assert wrap < 1.5 * np.abs(np.diff(legs[nearest], axis=0)).max()
        ahead = com[nearest][-1, 0] - com[nearest][0, 0]
        period = walk.n_frames / walk.sampled.fps
        assert ahead == pytest.approx(walk.velocity[0] * period, rel=0.1)
    assert read_pickle(path)[0] == keys


@pytest.mark.parametrize("name", ["melson/walk_arc", "coman/walk_arc"])
def test_a_cycle_can_begin_with_single_support_on_the_left(name: str):
    motion = generated(name).stages.motion
    cycle = find_cycle(motion, Support.LEFT)
    assert motion.support[cycle.start - 1] == Support.DOUBLE
    assert motion.support[cycle.start] == Support.LEFT


def test_the_velocity_of_a_cycle_gives_its_displacement():
    """Integrated in small steps in the frame of the robot."""
    motion = generated("melson/walk_arc").stages.motion
    cycle = find_cycle(motion)
    vx, vy, wz = mean_velocity(cycle, motion.dt)
    n = 20_000
    h = cycle.n_samples * motion.dt / n
    heading = wz * h * (np.arange(n) + 0.5)
    x = np.sum(vx * np.cos(heading) - vy * np.sin(heading)) * h
    y = np.sum(vx * np.sin(heading) + vy * np.cos(heading)) * h
    assert [x, y, wz * h * n] == pytest.approx(cycle.displacement.tolist(), abs=1e-9)


def test_a_walk_that_cannot_be_repeated_is_refused():
    with pytest.raises(CycleError):
        walk_of(generated("melson/kick").stages.motion, FPS, 3)
