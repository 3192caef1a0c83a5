"""From a gait to a motion: what holds across all four stages."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from numpy.testing import assert_allclose

from mgs.contact import Side
from mgs.errors import ConfigError, FootstepError, InfeasibleGaitError, MgsError
from mgs.gait import Gait, load_gait
from mgs.motion import Motion
from mgs.pipeline import Stages, generate
from mgs.robot import Robot, load_robot
from tests.strategies import legal_gaits, walk_gait, walks

MELSON = load_robot("melson")
SHORT = {"n_steps": 2, "step_length": 0.05, "first_support": "left", "double_support": 0.5}
ARRAYS = {
    "support": (),
    "q": (26,),
    "v": (25,),
    "torque": (19,),
    "com": (3,),
    "com_ref": (3,),
    "zmp": (2,),
    "zmp_ref": (2,),
    "soles": (2, 7),
    "soles_ref": (2, 7),
    "hands": (2, 7),
    "hands_ref": (2, 3),
    "torso": (7,),
    "torso_ref": (4,),
}


def assert_sound(motion: Motion) -> None:
    joints = motion.robot.n
    shapes = ARRAYS | {"q": (7 + joints,), "v": (6 + joints,), "torque": (joints,)}
    for name, shape in shapes.items():
        values = getattr(motion, name)
        assert values.shape == (motion.n_samples, *shape), name
        assert np.all(np.isfinite(values)), name
    assert_allclose(np.linalg.norm(motion.q[:, 3:7], axis=1), 1.0, atol=1e-12)


def test_a_motion_holds_every_stage_at_every_sample(shipped):
    motion, stages = shipped.stages.motion, shipped.stages
    assert_sound(motion)
    assert motion.n_samples == stages.plan.n_samples
    assert motion.duration == pytest.approx((motion.n_samples - 1) * shipped.gait.dt)
    assert_allclose(motion.times, np.arange(motion.n_samples) * shipped.gait.dt, rtol=0)
    assert np.array_equal(motion.q[:, 7:], stages.joints.angles)
    assert np.array_equal(motion.com_ref, stages.com.position)
    assert np.array_equal(motion.zmp_ref, stages.tasks.zmp_ref)
    assert np.array_equal(motion.soles_ref, stages.tasks.soles)
    assert motion.footsteps == stages.plan.footsteps
    assert motion.solver["solver"] == shipped.gait.ik.solver


def test_walk_5cm_takes_12_s(walk_5cm: Stages):
    assert (walk_5cm.motion.n_samples, walk_5cm.motion.duration) == (1201, 12.0)


def test_a_walk_takes_the_robot_where_its_steps_add_up_to(shipped_walk):
    """The place midway between the soles goes from the origin to that of the last two footsteps."""
    motion, walk = shipped_walk.stages.motion, shipped_walk.gait.walk
    middle = motion.soles[:, :, :2].mean(axis=1)
    assert_allclose(middle[0], 0.0, atol=1e-4)
    if not walk.step_yaw:
        sideways = sum(
            walk.lateral
            for footstep in motion.footsteps[2:-1]
            if footstep.side.sign * walk.lateral > 0.0
        )
        goal = [(walk.n_steps - 1) * walk.step_length, sideways]
        assert_allclose(middle[-1], goal, atol=1e-4)


def test_a_motion_starts_as_it_stands_and_ends_as_it_started(walk_5cm: Stages):
    """Soles abreast, CoM midway between them, all at rest: ready for the next motion."""
    motion = walk_5cm.motion
    for k in (0, -1):
        middle = motion.soles[k, :, :2].mean(axis=0)
        assert_allclose(motion.com[k, :2], middle, atol=1e-4)
        assert_allclose(motion.zmp[k], middle, atol=1e-3)
        assert np.abs(motion.v[k]).max() < 5e-3


def test_the_whole_robots_zmp_stays_near_the_reference_in_a_slow_walk(walk_5cm: Stages):
    """What the cart-table model leaves out costs 4 mm at most at 2.4 s a step."""
    motion = walk_5cm.motion
    assert np.linalg.norm(motion.zmp - motion.zmp_ref, axis=1).max() < 4e-3


def test_base_twists_are_those_of_the_base_pose(walk_5cm: Stages):
    """The base's speed, turned into the world, is the rate of its position."""
    motion = walk_5cm.motion
    rate = (motion.q[2:, :3] - motion.q[:-2, :3]) / (2.0 * motion.dt)
    x, y, z, w = motion.q[1:-1, 3:7].T
    ahead = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], axis=1)
    # along the base's own x axis; the base turns by less than 1e-2 rad in a sample
    assert_allclose(np.sum(rate * ahead, axis=1), motion.v[1:-1, 0], atol=2e-4)


def test_the_same_gait_gives_the_same_motion_bit_for_bit(melson: Robot):
    gait = load_gait("melson/walk_practical")
    first, second = (generate(melson, gait).motion for _ in range(2))
    for name in ARRAYS:
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes(), name


def test_a_finer_sampling_gives_the_same_motion(melson: Robot):
    """Joint angles belong to time and not to samples: halving dt moves them little."""
    ik = {"gamma_joint": 0.35, "gamma_grav": 1.6}
    com = {"weight_jerk": 1e-10}  # so stiff that its dependence on dt does not show
    coarse = generate(melson, walk_gait(0.01, com, ik, **SHORT)).motion
    fine = generate(melson, walk_gait(0.005, com, ik, **SHORT)).motion
    assert fine.n_samples == 2 * coarse.n_samples - 1
    assert_allclose(fine.com[::2], coarse.com, atol=1e-3)
    assert np.abs(fine.q[::2, 7:] - coarse.q[:, 7:]).max() < 0.02  # [rad], one degree


def test_stages_are_timed_by_name(walk_5cm: Stages):
    stages = ["motion_planner", "trajectory_planner", "com_generator", "ik_solver", "dynamics"]
    assert list(walk_5cm.seconds) == stages
    assert all(seconds > 0.0 for seconds in walk_5cm.seconds.values())


@pytest.mark.parametrize(
    ("walk", "error"),
    [
        ({"step_width": 0.05}, FootstepError),
        ({"com_height": 0.5}, InfeasibleGaitError),
        ({"double_support": 0.01}, ConfigError),
    ],
)
def test_errors_of_the_stages_reach_the_caller(melson: Robot, walk: dict, error: type[MgsError]):
    with pytest.raises(error):
        generate(melson, walk_gait(**SHORT | walk))


@settings(max_examples=12)
@given(walks(max_steps=3))
def test_a_moderate_walk_is_generated_or_refused_with_a_reason(gait: Gait):
    try:
        motion = generate(MELSON, gait).motion
    except InfeasibleGaitError as error:
        assert str(error)
    else:
        assert_sound(motion)
        assert np.all(motion.q[:, 7:] >= MELSON.lower) and np.all(motion.q[:, 7:] <= MELSON.upper)
        for side in Side:
            assert motion.soles[:, side, 2].min() > -1e-4  # [m]; nothing enters the ground


@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(legal_gaits(max_steps=3, longest=3.0))
def test_a_legal_gait_is_generated_or_refused_with_a_reason(gait: Gait):
    """Most are far beyond any robot; none may end in anything but a motion or one of our errors."""
    try:
        motion = generate(MELSON, gait).motion
    except MgsError as error:
        assert str(error)
    else:
        assert_sound(motion)
