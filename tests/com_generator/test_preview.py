"""Preview control against dense least squares, a plain simulation and python-control."""

from __future__ import annotations

import re

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial import ConvexHull

from mgs.com_generator import ComTrajectory, generate_com
from mgs.com_generator.preview import follow_zmp, preview_gains
from mgs.core.errors import ComNotAtRestError, ConfigError, InfeasibleGaitError, MgsError
from mgs.gait import ComParameters
from mgs.gait.remedies import remedies_for
from mgs.trajectory_planner import TaskTrajectory
from tests.support.preview import (
    DT,
    HEIGHT,
    TUNINGS,
    augmented,
    cart_table,
    follow,
    simulate,
    steps_after,
)
from tests.support.strategies import numbers, walk_gait

GRAVITY = 9.81

# --- optimality -------------------------------------------------------------------------------


def dense_optimum(zmp_ref: np.ndarray, dt: float, height: float, weight_jerk: float) -> np.ndarray:
    """CoM (N, 2) from rest at 0 that minimises sum e^2 + R du^2 over the whole horizon at once."""
    A, B, C = cart_table(dt, height)
    n = len(zmp_ref)
    response = np.empty((n, 3))  # of the state to one sample of unit jerk
    response[0] = B
    for k in range(1, n):
        response[k] = A @ response[k - 1]

    def lower_triangle(column: np.ndarray) -> np.ndarray:
        matrix = np.zeros((n, n))
        for j in range(n):
            matrix[j + 1 :, j] = column[: n - j - 1]
        return matrix

    to_zmp = lower_triangle(response @ C)
    change = np.eye(n) - np.eye(n, k=-1)
    rows = np.concatenate([to_zmp, np.sqrt(weight_jerk) * change])
    targets = np.concatenate([zmp_ref, np.zeros((n, 2))])
    jerk, *_ = np.linalg.lstsq(rows, targets, rcond=None)
    return lower_triangle(response[:, 0]) @ jerk


def test_preview_control_is_the_least_squares_optimum():
    """The oracle knows no Riccati equation: it solves the whole horizon as dense least squares.

    They agree only while the first window holds a constant reference, so a gait must open with a
    double support at least as long as the window. The last window is left out: past its horizon
    the oracle cares for nothing.
    """
    preview, dt = 3.2, 0.02  # [s]
    zmp_ref = steps_after(preview, dt)
    com = follow(zmp_ref, dt, preview=preview, weight_jerk=1e-6).position[:, :2]
    gap = (com - dense_optimum(zmp_ref, dt, HEIGHT, 1e-6))[: -round(preview / dt)]
    assert np.ptp(com[:, 0]) > 0.15  # it does move
    # [m]; the window cuts what is felt of a step 3.2 s ahead, exp(-6 * 3.2) of 50 mm
    assert_allclose(gap, 0.0, atol=5e-9)


def test_a_longer_window_comes_nearer_to_the_optimum():
    dt = 0.02  # [s]
    zmp_ref = steps_after(3.2, dt)
    optimum = dense_optimum(zmp_ref, dt, HEIGHT, 1e-6)
    gaps = []
    for preview in (0.4, 0.8, 1.6):
        com = follow(zmp_ref, dt, preview=preview, weight_jerk=1e-6).position[:, :2]
        gaps.append(np.abs(com - optimum)[:-160].max())
    assert gaps[0] > 5.0 * gaps[1] > 25.0 * gaps[2]


@pytest.mark.parametrize(("dt", "height", "weight_error", "weight_jerk"), TUNINGS)
def test_gains_are_those_of_python_control(dt, height, weight_error, weight_jerk):
    gains = preview_gains(dt, height, 1.6, weight_error, weight_jerk)
    At, Bt = augmented(dt, height)
    G, _, poles = control.dlqr(At, Bt, np.diag([weight_error, 0, 0, 0]), [[weight_jerk]])
    assert_allclose([gains.G_i, *gains.G_x], G[0], rtol=1e-6)  # Riccati's condition is about 1e9
    assert np.abs(poles).max() < 1.0


@pytest.mark.parametrize(("dt", "height", "weight_error", "weight_jerk"), TUNINGS)
def test_gains_are_where_dynamic_programming_ends(dt, height, weight_error, weight_jerk):
    """Value iteration from nothing, and the preview gains as what one reference adds to it.

    With the value z^T K z - 2 b^T z of a state z, a reference that comes j samples from now enters
    as b = (Ac^T)^j K (1, 0, 0, 0), less a weight of its own now.
    """
    At, Bt = augmented(dt, height)
    Q = np.diag([weight_error, 0.0, 0.0, 0.0])
    K = Q.copy()
    for _ in range(round(12.0 / dt)):  # [s]; the closed loop forgets within two
        G = (Bt.T @ K @ At) / (weight_jerk + Bt.T @ K @ Bt)
        K = Q + At.T @ K @ (At - Bt @ G)
        K = 0.5 * (K + K.T)
    gains = preview_gains(dt, height, 1.6, weight_error, weight_jerk)
    assert_allclose([gains.G_i, *gains.G_x], G[0], rtol=1e-5)
    Ac = At - Bt @ G
    weight = float(weight_jerk + (Bt.T @ K @ Bt)[0, 0])
    b = K[:, 0]
    for G_p in gains.G_p[:60]:
        # -G_p > 0: the jerk leans towards a reference that lies ahead
        expected = -float(Bt[:, 0] @ b) / weight
        assert_allclose(G_p, expected, rtol=1e-4, atol=1e-6 * abs(gains.G_p[0]))
        b = Ac.T @ b


# --- the closed loop --------------------------------------------------------------------------


@pytest.mark.parametrize(("dt", "height", "weight_error", "weight_jerk"), TUNINGS)
def test_all_samples_at_once_are_a_simulation_step_by_step(dt, height, weight_error, weight_jerk):
    parameters = {"preview": 1.6, "weight_error": weight_error, "weight_jerk": weight_jerk}
    zmp_ref = steps_after(1.8, dt)
    com = follow(zmp_ref, dt, height, **parameters)
    states = simulate(zmp_ref, dt, height, ComParameters(**parameters))
    for found, expected in zip(
        (com.position, com.velocity, com.acceleration), states.transpose(1, 0, 2), strict=True
    ):
        # rounding, a few hundred samples long and magnified by gains of up to 1e6
        assert_allclose(found[:, :2], expected, atol=1e-8 * max(1.0, np.abs(expected).max()))


def test_velocity_and_acceleration_integrate_to_the_position(walk_5cm):
    """The jerk is constant over a sample; it follows from the acceleration alone."""
    com, dt = walk_5cm.com, walk_5cm.tasks.dt
    c, v, a = com.position[:, :2], com.velocity[:, :2], com.acceleration[:, :2]
    jerk = np.diff(a, axis=0) / dt
    assert_allclose(v[1:], v[:-1] + dt * a[:-1] + dt**2 / 2 * jerk, atol=1e-12)
    ahead = c[:-1] + dt * v[:-1] + dt**2 / 2 * a[:-1] + dt**3 / 6 * jerk
    assert_allclose(c[1:], ahead, atol=1e-12)
    assert np.all(com.velocity[:, 2] == 0.0) and np.all(com.acceleration[:, 2] == 0.0)
    assert np.all(com.position[:, 2] == walk_5cm.tasks.com_height)


def test_the_zmp_is_that_of_a_cart_on_a_table(walk_5cm):
    com = walk_5cm.com
    sideways = com.position[:, 2:] / GRAVITY * com.acceleration[:, :2]
    assert_allclose(com.zmp, com.position[:, :2] - sideways, atol=1e-14)


def test_a_step_seen_in_time_is_followed_without_drift_or_overshoot():
    """The cart leaves before the step; after it the ZMP stays within a tenth of the step."""
    zmp_ref = np.zeros((800, 2))
    zmp_ref[400:] = [0.1, -0.05]
    com = follow(zmp_ref)
    assert com.position[399, 0] > 0.03  # [m]; halfway, as a cart must be
    error = (com.zmp - zmp_ref) / zmp_ref[-1]
    assert np.abs(error[:300]).max() < 1e-3
    assert np.abs(error[450:]).max() < 1e-2
    assert np.abs(error[600:]).max() < 1e-6
    assert np.abs(error).max() < 0.7  # a jump is met half before and half after
    assert_allclose(com.position[-1, :2], zmp_ref[-1], atol=1e-7)


@pytest.mark.parametrize("preview", [0.3, 1.6])
def test_it_matters_not_where_in_the_world_a_walk_begins(preview: float):
    """However short the window, which knows nothing of what lies beyond it."""
    zmp_ref, shift = steps_after(1.8), np.array([3.0, -5.0])
    here, there = follow(zmp_ref, preview=preview), follow(zmp_ref + shift, preview=preview)
    assert_allclose(there.position[:, :2], here.position[:, :2] + shift, atol=1e-11)
    assert_allclose(there.zmp, here.zmp + shift, atol=1e-11)
    still = follow(np.tile(shift, (400, 1)), preview=preview)
    assert_allclose(still.zmp, np.tile(shift, (400, 1)), atol=1e-12)


@given(st.integers(0, 4), numbers(-2.0, 2.0), numbers(-2.0, 2.0))
@settings(max_examples=10)
def test_the_response_is_linear_and_the_axes_do_not_mix(seed: int, a: float, b: float):
    rng = np.random.default_rng(seed)
    refs = [np.repeat(rng.uniform(-0.1, 0.1, (8, 1)), 50, axis=0) for _ in range(2)]
    for ref in refs:
        ref[:180] = ref[0]
        ref[-180:] = ref[-1]
    alone = [follow(np.column_stack([ref, 0 * ref])).position[:, 0] for ref in refs]
    mixed = follow(np.column_stack([a * refs[0] + b * refs[1], refs[1]])).position
    assert_allclose(mixed[:, 0], a * alone[0] + b * alone[1], atol=1e-9)
    assert_allclose(mixed[:, 1], alone[1], atol=1e-9)


# --- gaits ------------------------------------------------------------------------------------


def test_the_zmp_of_every_shipped_walk_follows_its_reference_within_2_mm(shipped_walk):
    if shipped_walk.gait.com.generator == "qp":
        pytest.skip("the QP departs from the reference on purpose")
    tasks = shipped_walk.stages.tasks
    error = (
        generate_com(shipped_walk.robot, tasks, shipped_walk.gait.com).zmp - tasks.zmp_ref
    )  # not yet corrected
    assert np.sqrt(np.mean(np.sum(error**2, axis=1))) < 2e-3


def test_every_shipped_gait_begins_and_ends_at_rest_above_its_soles(shipped):
    if not shipped.gait.is_balanced:
        pytest.skip("it begins lying")
    com, tasks = shipped.stages.com, shipped.stages.tasks
    sole = shipped.robot.spec.soles.left
    length, width = sole.length, sole.width
    for k, speed in ((0, 1e-3), (-1, 2e-3)):
        assert np.linalg.norm(com.velocity[k]) < speed
        assert np.linalg.norm(com.acceleration[k]) < 0.02
        corners = [
            pose[:2] + rotation @ [sx * length / 2, sy * width / 2]
            for pose in tasks.soles[k]
            for rotation in [planar_rotation(pose[5], pose[6])]
            for sx in (-1, 1)
            for sy in (-1, 1)
        ]
        planes = ConvexHull(corners).equations
        margins = -(planes[:, :2] @ com.position[k, :2] + planes[:, 2])
        assert margins.min() > 0.02  # [m]


def planar_rotation(sine: float, cosine: float) -> np.ndarray:
    """Rotation of the plane from the sine and cosine of half the angle."""
    c, s = cosine**2 - sine**2, 2.0 * sine * cosine
    return np.array([[c, -s], [s, c]])


# --- refusals ---------------------------------------------------------------------------------


def follow_reference(tasks: TaskTrajectory, parameters: ComParameters) -> ComTrajectory:
    return follow_zmp(tasks.zmp_ref, tasks.com_height, tasks.dt, parameters)


def reference(dt: float, height: float) -> TaskTrajectory:
    """Tasks of which only the ZMP reference, the height and dt matter here."""
    zmp_ref = steps_after(1.8, dt)
    n = len(zmp_ref)
    return TaskTrajectory(
        dt=dt,
        support=np.zeros(n, np.int8),
        root=np.zeros(n, np.int8),
        zmp_ref=zmp_ref,
        load_left=np.full(n, 0.5),
        soles=np.zeros((n, 2, 7)),
        hands=np.zeros((n, 2, 3)),
        com_height=np.full(n, height),
        torso=np.tile([0.0, 0.0, 0.0, 1.0], (n, 1)),
    )


@pytest.mark.parametrize(
    "weights",
    [
        {"weight_error": 1e-12, "weight_jerk": 1e6},
        {"weight_error": 1e-300, "weight_jerk": 1e-6},
        {"weight_error": 5e-324, "weight_jerk": 1e6},  # their ratio is infinite
    ],
)
def test_weights_without_a_stabilising_gain_are_refused(weights: dict[str, float]):
    with pytest.raises(ConfigError, match="no stabilising preview gain") as caught:
        follow_reference(reference(DT, HEIGHT), ComParameters(**weights))
    assert caught.value.source == "com"


@settings(max_examples=60)
@given(
    st.sampled_from([1e-3, 1e-2, 0.1]),
    st.floats(-4.0, 0.47),
    st.floats(-300.0, 12.0),
    st.floats(-300.0, 6.0),
    numbers(0.1, 1.6),
)
def test_any_weights_give_a_finite_motion_or_a_refusal(dt, height, error, jerk, preview):
    parameters = ComParameters(preview=preview, weight_error=10.0**error, weight_jerk=10.0**jerk)
    try:
        com = follow_reference(reference(dt, 10.0**height), parameters)
    except MgsError as refusal:
        assert isinstance(refusal, ConfigError | InfeasibleGaitError)
    else:
        for values in (com.position, com.velocity, com.acceleration, com.zmp):
            assert np.all(np.isfinite(values))
        assert_allclose(com.position[-1, :2], steps_after(1.8, dt)[-1], atol=1e-3)


def test_a_lazy_com_that_still_moves_at_the_end_is_refused_with_the_remedy():
    lazy = ComParameters(weight_error=1e-6, weight_jerk=1e2)
    refusal = pytest.raises(ComNotAtRestError, match=r"still moves .* walk\.lead_out")
    with refusal as caught, remedies_for(walk_gait()):
        follow_reference(reference(DT, HEIGHT), lazy)
    zmp_ref = steps_after(1.8)
    (place, velocity, _) = simulate(zmp_ref, DT, HEIGHT, lazy)[-1]
    told = [float(x) for x in re.findall(r"[\d.]+", str(caught.value))[:2]]
    found = [np.linalg.norm(velocity), np.linalg.norm(place - zmp_ref[-1])]
    assert_allclose(told, 1e3 * np.array(found), atol=0.05)  # mm/s and mm, one decimal
