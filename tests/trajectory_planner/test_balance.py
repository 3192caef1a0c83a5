"""References of a balance motion against closed forms, SciPy and the standing robot."""

from __future__ import annotations

import functools

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from numpy.polynomial import Polynomial
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from mgs.core.contact import Side, Support
from mgs.core.errors import InfeasibleGaitError
from mgs.gait import BalanceGait
from mgs.motion_planner import plan_motion
from mgs.pipeline import run_stages
from mgs.robot import load_robot
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories
from mgs.trajectory_planner.balance import COORDINATES, displacements
from tests.support.strategies import (
    BODY_TASKS,
    balance_gait,
    balances,
    constant,
    figure_eight,
    ramp,
    sine,
)

MELSON = load_robot("melson")
ROUNDING = 1e-12
s = Polynomial([0.0, 1.0])
BLEND = (30.0 * s**2 * (1.0 - s) ** 2).integ()  # rises from 0 to 1, at rest at both ends


def tasks_of(gait: BalanceGait) -> TaskTrajectory:
    return plan_trajectories(plan_motion(MELSON, gait))


def moved(times: np.ndarray, *channels: dict[str, object]) -> dict[str, np.ndarray]:
    """Displacements by task, summed over the channels; tasks that do not move are left out."""
    out = displacements(balance_gait(*channels).balance.channels, times)
    return {name: x for name, x in zip(COORDINATES, out.T, strict=True) if x.any()}


@functools.cache  # arrays of a Data are views that do not keep it alive
def standing() -> pin.Data:
    data = MELSON.model.createData()
    pin.framesForwardKinematics(MELSON.model, data, MELSON.standing_q)
    pin.centerOfMass(MELSON.model, data, MELSON.standing_q, False)
    return data


def blend(seconds: np.ndarray, duration: float) -> np.ndarray:
    return BLEND(np.clip(seconds / duration, 0.0, 1.0))


# --- waveforms --------------------------------------------------------------------------------

TIMES = np.array([0.0, 0.1, 0.37, 1.0, 2.5, 3.9])


@pytest.mark.parametrize("task", BODY_TASKS)
def test_a_channel_moves_its_own_task_and_no_other(task: str):
    assert BODY_TASKS == COORDINATES
    assert list(moved(TIMES, constant(task, 0.03))) == [task]


def test_a_constant_is_constant():
    assert_allclose(moved(TIMES, constant("com_y", -0.02))["com_y"], -0.02, atol=0)


def test_a_sine_has_its_amplitude_frequency_and_phase():
    found = moved(TIMES, sine("com_y", 0.02, 0.25, phase=0.4))["com_y"]
    expected = np.imag(0.02 * np.exp(1j * (0.5 * np.pi * TIMES + 0.4)))
    assert_allclose(found, expected, atol=ROUNDING)
    quarter = np.array([0.0, 1.0, 2.0, 3.0])
    found = moved(quarter, sine("torso_yaw", 0.3, 0.25))["torso_yaw"]
    assert_allclose(found, [0.0, 0.3, 0.0, -0.3], atol=ROUNDING)


def test_a_ramp_is_a_minimum_jerk_blend_between_its_times_and_stays_there():
    found = moved(TIMES, ramp("com_z", -0.05, 0.3, 2.3))["com_z"]
    assert_allclose(found, -0.05 * blend(TIMES - 0.3, 2.0), atol=ROUNDING)
    assert found[0] == found[1] == 0.0
    assert found[4] == found[5] == -0.05


@pytest.mark.parametrize("plane", ["xy", "xz", "yx", "yz", "zx", "zy"])
@pytest.mark.parametrize("task", ["com", "left_hand", "right_hand"])
def test_a_figure_eight_is_a_lemniscate_of_gerono_in_its_plane(task: str, plane: str):
    width, height, frequency = 0.06, 0.02, 0.4
    times = np.linspace(0.0, 1.0 / frequency, 401)
    found = moved(times, figure_eight(task, plane, width, height, frequency))
    assert set(found) == {f"{task}_{axis}" for axis in plane}
    across, up = (found[f"{task}_{axis}"] for axis in plane)
    assert np.ptp(across) == pytest.approx(width)
    assert np.ptp(up) == pytest.approx(height)
    u, v = 2.0 * across / width, 2.0 * up / height
    assert_allclose(v**2, 4.0 * u**2 * (1.0 - u**2), atol=1e-10)
    # it passes its middle twice, in two directions
    middle = np.flatnonzero(np.hypot(across, up) < 1e-9)
    assert list(middle) == [0, 200, 400]
    first, second = ([np.diff(x)[k] for x in (across, up)] for k in (0, 200))
    assert first[0] > 0.0 > second[0]
    assert first[1] > 0.0 and second[1] > 0.0


def test_channels_add_up():
    parts = [
        sine("com_y", 0.02, 0.7),
        sine("com_y", 0.01, 1.3, phase=1.0),
        constant("com_z", -0.01),
        figure_eight("com", "yz", 0.02, 0.01),
        ramp("torso_pitch", 0.2, 0.5, 1.5),
    ]
    together = displacements(balance_gait(*parts).balance.channels, TIMES)
    alone = [displacements(balance_gait(part).balance.channels, TIMES) for part in parts]
    assert_allclose(together, np.sum(alone, axis=0), atol=ROUNDING)


# --- easing -----------------------------------------------------------------------------------


def test_channels_are_faded_in_and_out_by_the_same_blend():
    tasks = tasks_of(
        balance_gait(constant("com_y", 0.02), constant("right_hand_z", 0.03), rest=0.4, ease=1.2)
    )
    times = 0.01 * np.arange(401)
    factor = np.minimum(blend(times - 0.4, 1.2), blend(3.6 - times, 1.2))
    data = standing()
    assert tasks.com is not None
    assert_allclose(tasks.com[:, 1], data.com[0][1] + 0.02 * factor, atol=ROUNDING)
    hand = tasks.hands[:, Side.RIGHT] + tasks.com
    expected = data.oMf[MELSON.hand_frames[Side.RIGHT]].translation + np.outer(
        factor, [0.0, 0.0, 0.03]
    )
    assert_allclose(hand, expected, atol=ROUNDING)


def test_a_com_height_is_reached_and_left_by_the_fading():
    tasks = tasks_of(balance_gait(sine("com_z", 0.005, 1.0), com_height=0.25))
    stood = standing().com[0][2]
    times = 0.01 * np.arange(401)
    inside = (times >= 1.5) & (times <= 2.5)
    expected = 0.25 + 0.005 * np.sin(2.0 * np.pi * times)
    assert_allclose(tasks.com_height[inside], expected[inside], atol=ROUNDING)
    assert_allclose(tasks.com_height[[0, 50, -51, -1]], stood, atol=ROUNDING)


@given(balances())
def test_at_both_ends_the_references_are_those_of_the_standing_robot(gait: BalanceGait):
    tasks = tasks_of(gait)
    data = standing()
    rest = round(gait.balance.rest / gait.dt)
    assert tasks.com is not None
    for k in (*range(rest + 1), *range(tasks.n_samples - 1 - rest, tasks.n_samples)):
        assert_allclose(tasks.com[k], data.com[0], atol=ROUNDING)
        torso = Rotation.from_quat(tasks.torso[k]).as_matrix()
        assert_allclose(torso, data.oMf[MELSON.torso_frame].rotation, atol=ROUNDING)
        for side in Side:
            sole = data.oMf[MELSON.sole_frames[side]]
            assert_allclose(tasks.soles[k, side, :3], sole.translation, atol=ROUNDING)
            if tasks.hands_asked[side]:
                hand = data.oMf[MELSON.hand_frames[side]].translation
                assert_allclose(tasks.hands[k, side] + tasks.com[k], hand, atol=ROUNDING)
        assert tasks.load_left[k] == pytest.approx(0.5 + data.com[0][1] / 0.0955, abs=1e-9)


def test_the_motion_begins_and_ends_without_speed_or_acceleration():
    """Differences over h of a motion with jerk j: at most j h^2 in speed, j h in acceleration."""
    h = 0.001
    tasks = tasks_of(balance_gait(constant("com_x", 0.02), dt=h, rest=0.5, ease=1.0))
    assert tasks.com is not None
    jerk = 60.0 * 0.02  # of a minimum-jerk blend over 1 s, at its ends
    for k in (500, 1500, 2500, 3500):
        before, here, after = tasks.com[k - 1 : k + 2, 0]
        assert abs(after - before) / (2.0 * h) < jerk * h**2
        assert abs(after - 2.0 * here + before) / h**2 < 1.01 * jerk * h


# --- what is asked ----------------------------------------------------------------------------


@given(balances())
def test_soles_stay_in_place_and_share_the_load(gait: BalanceGait):
    tasks = tasks_of(gait)
    assert np.all(tasks.support == Support.DOUBLE)
    assert np.all(tasks.soles == tasks.soles[0])
    assert np.all((tasks.load_left >= 0.0) & (tasks.load_left <= 1.0))
    assert tasks.com is not None
    # the moments of the two loads about the CoM cancel out
    y_left, y_right = tasks.soles[:, 0, 1], tasks.soles[:, 1, 1]
    carried = tasks.load_left * y_left + (1.0 - tasks.load_left) * y_right
    between = (tasks.com[:, 1] <= y_left) & (tasks.com[:, 1] >= y_right)
    assert_allclose(carried[between], tasks.com[between, 1], atol=1e-12)
    assert np.all(tasks.load_left[tasks.com[:, 1] > y_left] == 1.0)
    assert np.all(tasks.load_left[tasks.com[:, 1] < y_right] == 0.0)


@given(balances())
def test_only_tasks_with_a_channel_have_a_reference(gait: BalanceGait):
    tasks = tasks_of(gait)
    names = [channel.task for channel in gait.balance.channels]
    for side in Side:
        asked = any(name.startswith(f"{side.label}_hand") for name in names)
        assert tasks.hands_asked[side] == asked
        assert np.isnan(tasks.hands[:, side]).all() == (not asked)
        assert np.isfinite(tasks.hands[:, side]).all() == asked
    assert tasks.torso_asked == any(name.startswith("torso") for name in names)
    assert tasks.com is not None
    assert np.array_equal(tasks.zmp_ref, tasks.com[:, :2])
    assert np.array_equal(tasks.com_height, tasks.com[:, 2])
    assert_allclose(np.linalg.norm(tasks.torso, axis=1), 1.0, atol=ROUNDING)
    for values in (tasks.com, tasks.soles, tasks.torso, tasks.load_left):
        assert np.isfinite(values).all()


def test_the_torso_turns_by_yaw_pitch_and_roll_about_turned_axes():
    angles = {"torso_roll": 0.2, "torso_pitch": -0.4, "torso_yaw": 0.7}
    tasks = tasks_of(balance_gait(*(constant(task, value) for task, value in angles.items())))
    rest = Rotation.from_matrix(standing().oMf[MELSON.torso_frame].rotation)
    expected = Rotation.from_euler("ZYX", [0.7, -0.4, 0.2]) * rest
    for k in range(150, 251):
        gap = Rotation.from_quat(tasks.torso[k]) * expected.inv()
        assert gap.magnitude() < 1e-12
    half = Rotation.from_euler("ZYX", [0.35, -0.2, 0.1]) * rest  # in the middle of the fading in
    assert (Rotation.from_quat(tasks.torso[100]) * half.inv()).magnitude() < 1e-12


def test_a_torso_that_is_tilted_at_rest_turns_from_its_orientation_at_rest():
    robot = load_robot("coman")
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.standing_q)
    rest = data.oMf[robot.torso_frame].rotation
    tasks = plan_trajectories(plan_motion(robot, balance_gait(constant("torso_pitch", 0.3))))
    middle = Rotation.from_quat(tasks.torso[200]).as_matrix()
    assert_allclose(middle, pin.rpy.rpyToMatrix(0.0, 0.3, 0.0) @ rest, atol=ROUNDING)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_com_beyond_both_feet_is_refused_with_the_distance_and_the_channel(sign: float):
    with pytest.raises(InfeasibleGaitError, match=r"0\.200 m sideways.* smaller com_y"):
        run_stages(MELSON, balance_gait(constant("com_y", 0.2 * sign)))
    tasks = tasks_of(balance_gait(constant("com_y", 0.06 * sign)))  # 12 mm beyond a sole's centre
    assert tasks.load_left[200] == (1.0 if sign > 0.0 else 0.0)
