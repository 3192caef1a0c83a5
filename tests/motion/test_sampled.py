"""Frames of a motion at other rates, compared with SciPy and with differences of finer frames."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation, Slerp

from mgs.core.errors import ConfigError
from mgs.core.geometry import compose_planar
from mgs.motion import Motion
from mgs.motion.cycle import find_cycle
from mgs.motion.sampled import SampledMotion, sample
from tests.support.shipped import generated

TURNING = "melson/walk_arc"


@pytest.fixture(scope="module")
def walk() -> Motion:
    return generated("melson/walk_practical").stages.motion


@pytest.fixture(scope="module")
def turning() -> Motion:
    return generated(TURNING).stages.motion


def test_without_a_rate_the_frames_are_the_planned_samples(walk: Motion):
    frames = sample(walk)
    assert np.array_equal(frames.q, walk.q)
    assert np.array_equal(frames.v, walk.v)
    assert np.array_equal(frames.support, walk.support)
    assert (frames.interval, frames.fps) == (walk.dt, 1.0 / walk.dt)


@pytest.mark.parametrize("fps", [30.0, 50.0, 59.94, 100.0, 333.0])
def test_first_and_last_sample_are_kept_and_at_rest(turning: Motion, fps: float):
    frames = sample(turning, fps)
    assert np.array_equal(frames.q[0], turning.q[0])
    assert np.abs(frames.q[-1] - turning.q[-1]).max() < 1e-15
    assert not frames.v[[0, -1]].any()
    assert 0.0 <= frames.times[-1] - turning.duration < 1.0 / fps


def test_at_planned_times_the_frames_are_the_planned_samples(turning: Motion):
    frames = sample(turning, 50.0)
    n = min(frames.n_frames, len(turning.q[::2]))
    assert np.abs(frames.q[:n] - turning.q[::2][:n]).max() < 1e-14
    assert np.array_equal(frames.support[:n], turning.support[::2][:n])


def test_between_samples_the_base_stays_near_the_great_arc(turning: Motion):
    """A spline and pieces of constant angular velocity differ by h^2 / 8 of its acceleration."""
    frames = sample(turning, 333.0)
    inside = frames.times < turning.duration
    arc = Slerp(turning.times, Rotation.from_quat(turning.q[:, 3:7]))(frames.times[inside])
    apart = (Rotation.from_quat(frames.base_quat_xyzw[inside]) * arc.inv()).magnitude()
    acceleration = np.abs(np.diff(frames.v[:, 3:6], axis=0)).max() * 333.0
    assert apart.max() < 1.05 * np.sqrt(3.0) * turning.dt**2 / 8.0 * acceleration
    assert np.allclose(np.linalg.norm(frames.base_quat_xyzw, axis=1), 1.0, rtol=0, atol=1e-14)


@pytest.mark.parametrize("as_cycle", [False, True])
def test_velocities_are_the_derivatives_of_the_positions(turning: Motion, as_cycle: bool):
    """Central differences over 0.1 ms of the curve, by Pinocchio's difference of configurations."""
    cycle = find_cycle(turning) if as_cycle else None
    ratio, fps = 200, 50.0
    coarse, fine = sample(turning, fps, cycle), sample(turning, ratio * fps, cycle)
    model, h = turning.robot.model, 1.0 / (ratio * fps)
    worst = np.zeros(coarse.v.shape[1])
    for k in range(1, coarse.n_frames - 1):
        pair = fine.q[ratio * k - 1], fine.q[ratio * k + 1]
        worst = np.maximum(worst, np.abs(pin.difference(model, *pair) / (2 * h) - coarse.v[k]))
    assert worst.max() < 2e-4 * np.abs(coarse.v).max()


def test_accelerations_are_the_derivatives_of_the_velocities(walk: Motion):
    frames, fine = sample(walk, 50.0), sample(walk, 10_000.0)
    middle = 200 * np.arange(1, frames.n_frames - 1)
    slope = (fine.v[middle + 1] - fine.v[middle - 1])[:, 6:] * 5000.0
    found = frames.joint_acceleration[1:-1]
    assert np.abs(slope - found).max() < 2e-2 * np.abs(found).max()


def test_a_cycle_continues_where_it_ends(turning: Motion):
    """Frames after its last one, moved by the displacement, are those at its beginning."""
    cycle = find_cycle(turning)
    frames: SampledMotion = sample(turning, 50.0, cycle, closed=True)
    assert frames.n_frames == cycle.n_samples * turning.dt * 50.0 + 1
    first, last = frames.q[0], frames.q[-1]
    assert np.array_equal(first[7:], last[7:])
    yaw = [Rotation.from_quat(q[3:7]).as_euler("ZYX")[0] for q in (first, last)]
    start, end = ((q[0], q[1], angle) for q, angle in zip((first, last), yaw, strict=True))
    moved = compose_planar(cycle.displacement, start)
    assert np.abs(moved - np.array(end)).max() < 1e-12
    steps = np.diff(frames.q, axis=0)
    assert np.abs(np.diff(np.vstack([steps[-1], steps[0]]), axis=0)).max() < 1.5 * (
        np.abs(np.diff(steps, axis=0)).max()
    )


def test_the_base_of_a_cycle_is_that_of_the_walk_but_for_what_was_taken_off(turning: Motion):
    cycle = find_cycle(turning)
    base = turning.q[cycle.start : cycle.start + cycle.n_samples, :7]
    relative = Rotation.from_quat(cycle.base[:, 3:]) * Rotation.from_quat(base[:, 3:]).inv()
    assert (relative * relative[0].inv()).magnitude().max() < 0.02
    moved = relative[0].apply(base[:, :3] - base[0, :3]) + cycle.base[0, :3]
    assert np.abs(moved - cycle.base[:, :3]).max() < 2e-3


def test_a_cycle_takes_a_whole_number_of_frames(walk: Motion):
    cycle = find_cycle(walk)
    period = cycle.n_samples * walk.dt
    with pytest.raises(ConfigError, match=r"not a whole number; use \d") as caught:
        sample(walk, 33.3, cycle)
    fitting = float(str(caught.value).rpartition("use ")[2])
    assert sample(walk, fitting, cycle).n_frames == round(fitting * period)
    near = sample(walk, 33.3, cycle, nearest=True)
    assert near.fps == pytest.approx(near.n_frames / period)
    assert abs(near.fps - 33.3) < 0.5 / period


@pytest.mark.parametrize("fps", [0.0, -1.0, float("nan"), float("inf"), 1e9])
def test_a_rate_out_of_range_is_refused(walk: Motion, fps: float):
    with pytest.raises(ConfigError, match=r"fps: .* is out of range"):
        sample(walk, fps)
