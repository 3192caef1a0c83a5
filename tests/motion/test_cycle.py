"""One cycle of a walk: periodic, on its soles, and the robot walks on it."""

from __future__ import annotations

import cmath
import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_allclose

from mgs.core.errors import CycleError
from mgs.core.geometry import compose_planar, planar_middle
from mgs.gait import load_gait
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.motion.cycle import Cycle, find_cycle
from mgs.pipeline import run_stages
from mgs.pipeline.join import Displacement, join, moved
from mgs.robot import load_robot
from mgs.sim import replay
from tests.support.shipped import generated

MELSON = load_robot("melson")


@pytest.fixture(scope="module", params=["melson/walk_practical", "melson/walk_arc"])
def walk(request: pytest.FixtureRequest) -> Motion:
    return generated(request.param).stages.motion


def test_twenty_cycles_in_a_row_have_no_jump(walk: Motion):
    """At the wraps they step, and positions bend, no further than anywhere in the walk."""
    cycle = find_cycle(walk)
    n = cycle.n_samples
    q, v = (np.tile(values, (20, 1)) for values in (cycle.position, cycle.velocity))
    for values, whole, order in (
        (q, walk.q[:, 7:], 1),
        (v, walk.v[:, 6:], 1),
        (q, walk.q[:, 7:], 2),
    ):
        steps = np.abs(np.diff(values, order, axis=0))
        across = np.zeros(len(steps), dtype=bool)
        for wrap in range(n, 20 * n, n):
            across[wrap - order : wrap] = True
        assert across.sum() == 19 * order
        usual = np.abs(np.diff(whole, order, axis=0)).max(axis=0)
        assert np.all(steps[across].max(axis=0) <= 1.01 * usual)
    assert_allclose(v[n : 2 * n], (q[n + 1 : 2 * n + 1] - q[n - 1 : 2 * n - 1]) / (2 * walk.dt))


def test_the_step_across_the_wrap_is_the_one_that_the_walk_takes_there(walk: Motion):
    cycle = find_cycle(walk)
    k, n = cycle.start, cycle.n_samples
    across = cycle.position[0] - cycle.position[-1]
    assert_allclose(across, walk.q[k + n, 7:] - walk.q[k + n - 1, 7:], atol=2e-4)  # [rad]
    quicker = cycle.velocity[0] - cycle.velocity[-1]
    assert_allclose(quicker, walk.v[k + n, 6:] - walk.v[k + n - 1, 6:], atol=0.02)  # [rad/s]


def test_a_cycle_begins_as_the_walk_and_stays_by_it(walk: Motion):
    cycle = find_cycle(walk)
    k, n = cycle.start, cycle.n_samples
    assert np.array_equal(cycle.position[0], walk.q[k, 7:])
    off = np.abs(cycle.position - walk.q[k : k + n, 7:]).max()
    assert cycle.mismatch * (n - 1) / n - 1e-3 < off < cycle.mismatch + 1e-3
    assert cycle.mismatch < 0.02
    across = np.abs(walk.q[k + n, 7:] - walk.q[k, 7:])
    assert across.max() == pytest.approx(cycle.mismatch)
    assert MELSON.joint_names[int(np.argmax(across))] == cycle.joint


def test_a_cycle_is_two_steps_long_in_time_and_on_the_ground(walk: Motion):
    cycle, gait = find_cycle(walk), walk.gait.walk
    assert cycle.n_samples * walk.dt == pytest.approx(
        2 * (gait.single_support + gait.double_support)
    )
    x, y, yaw = cycle.displacement
    assert yaw == pytest.approx(2 * gait.step_yaw, abs=1e-12)
    chord = gait.step_length * (1 + cmath.exp(1j * gait.step_yaw))  # two chords, one turned
    if gait.step_yaw == 0.0:
        assert_allclose([x, y], [2 * gait.step_length, 0.0], atol=1e-12)
    else:
        assert abs(complex(x, y)) == pytest.approx(abs(chord), rel=0.02)  # begun within a step


def test_on_the_support_sole_the_other_sole_stays_where_the_walk_has_it(walk: Motion):
    """What the joints give up to be periodic is below half a millimetre at the soles."""
    cycle, model, data = find_cycle(walk), MELSON.model, MELSON.model.createData()
    for j in range(0, cycle.n_samples, 5):
        k = cycle.start + j
        relative = []
        for joints in (cycle.position[j], walk.q[k, 7:]):
            q = pin.neutral(model)
            q[7:] = joints
            pin.framesForwardKinematics(model, data, q)
            left, right = (data.oMf[frame] for frame in MELSON.sole_frames)
            relative.append(left.actInv(right))
        apart = relative[0].actInv(relative[1])
        assert np.linalg.norm(apart.translation) < 5e-4
        assert np.linalg.norm(pin.log3(apart.rotation)) < 5e-3


def test_a_walk_whose_posture_runs_away_is_refused_with_the_figure():
    fastest = generated("melson/walk_fastest").stages.motion
    with pytest.raises(
        CycleError, match=r"\w+ differs by 0\.0\d+ rad at best, 0\.02 rad allowed"
    ) as caught:
        find_cycle(fastest)
    assert "use a larger walk.n_steps or ik.solver: ik4" in str(caught.value)


@pytest.mark.parametrize("name", ["melson/walk_5cm", "melson/sway"])
def test_a_motion_without_enough_steps_is_refused(name: str):
    with pytest.raises(CycleError, match="at least 5 equal steps"):
        find_cycle(generated(name).stages.motion)


def test_in_a_sequence_a_cycle_lies_within_one_part(walk: Motion):
    """The rest between two walks, which is as periodic as can be, is none."""
    twice = join([walk, moved(walk, Displacement(np.array([1.0, 0.5, 0.3])))])
    cycle = find_cycle(twice)
    start = cycle.start % (walk.n_samples - 1)
    assert cycle.n_samples == find_cycle(walk).n_samples
    assert start == find_cycle(walk).start


def continued(walk: Motion, cycle: Cycle, n: int) -> Motion:
    """The walk with n cycles in place of one."""
    k, period = cycle.start, cycle.n_samples
    lap = part(walk, slice(k, k + period + 1))
    q, v = lap.q.copy(), lap.v.copy()
    q[:, 7:] = np.vstack([cycle.position, cycle.position[:1]])
    v[:, 6:] = np.vstack([cycle.velocity, cycle.velocity[:1]])
    lap = dataclasses.replace(lap, q=q, v=v)
    origin = planar_middle(walk.soles_ref[k])
    step = compose_planar(compose_planar(origin, cycle.displacement), inverse(origin))
    poses = [np.zeros(3)]
    for _ in range(n - 1):
        poses.append(compose_planar(step, poses[-1]))
    laps = [moved(lap, Displacement(pose)) for pose in poses]
    after = moved(part(walk, slice(k + period, None)), Displacement(poses[-1]))
    return join([part(walk, slice(0, k + 1)), *laps, after])


def inverse(pose: np.ndarray) -> np.ndarray:
    turned = complex(pose[0], pose[1]) * cmath.exp(-1j * pose[2])
    return np.array([-turned.real, -turned.imag, -pose[2]])


def part(motion: Motion, samples: slice) -> Motion:
    arrays = {k: v[samples] for k, v in vars(motion).items() if isinstance(v, np.ndarray)}
    return dataclasses.replace(motion, **arrays)


@pytest.mark.slow
def test_the_robot_walks_on_twenty_cycles_and_stops():
    pytest.importorskip("mujoco")
    gait = load_gait("melson/walk_practical")
    walk = run_stages(MELSON, gait, "walk").motion
    cycle = find_cycle(walk)
    long = continued(walk, cycle, 20)
    assert long.n_samples == walk.n_samples + 19 * cycle.n_samples
    assert np.abs(np.diff(long.q[:, 7:], axis=0)).max() / long.dt < MELSON.speed_limit.max()
    result = replay(long, "mujoco")
    assert [check.name for check in replay_checks(result) if not check.ok] == []
    assert result.planned_distance[0] == pytest.approx(0.45 + 19 * cycle.displacement[0])
    assert result.max_tilt_deg < 3.0
