"""Rolling feet: soles that turn about heel and toe, and the ZMP that stays on what bears."""

import numpy as np
import pinocchio as pin
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial import ConvexHull

from mgs.core.contact import Side, Support
from mgs.core.errors import ConfigError
from mgs.gait import load_gait
from mgs.gait.load import parse_gait
from mgs.motion_planner import plan_motion
from mgs.robot import load_robot
from mgs.robot.support_polygon import support_polygon, support_spans
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories
from mgs.trajectory_planner.com_height import pendulum_above

COMAN = load_robot("coman")


def rolling_walk(**walk):
    keys = {"n_steps": 4, "step_length": 0.15, "double_support": 0.4, "first_support": "left"}
    keys |= {"foot_roll": {"toe_off": 0.3, "heel_strike": 0.2}} | walk
    tree = {"mgs": 1, "robot": "coman", "motion": "walk", "dt": 0.01, "walk": keys}
    return parse_gait(yaml.safe_dump(tree), "rolling walk")


def corners(tasks: TaskTrajectory) -> np.ndarray:
    """Corners (N, 2, 4, 3) of the soles, placed by Pinocchio."""
    out = np.empty((tasks.n_samples, 2, 4, 3))
    for side in Side:
        sole = COMAN.sole_spec(side)
        at = 0.5 * np.array([sole.length, sole.width, 0.0])
        local = [at * [x, y, 0.0] for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        for k, pose in enumerate(tasks.soles[:, side]):
            out[k, side] = [pin.XYZQUATToSE3(pose).act(point) for point in local]
    return out


def bears(tasks: TaskTrajectory, side: Side) -> np.ndarray:
    return np.isin(tasks.support, (Support.DOUBLE, Support.single(side)))


@settings(max_examples=25, deadline=None)
@given(
    toe_off=st.floats(0.0, 0.8),
    heel_strike=st.floats(0.0, 0.8),
    length=st.floats(0.05, 0.3),
    yaw=st.floats(-0.2, 0.2),
    landing=st.floats(0.0, 0.4),
)
def test_what_touches_the_ground_stays_and_nothing_is_below_it(
    toe_off: float, heel_strike: float, length: float, yaw: float, landing: float
):
    gait = rolling_walk(
        step_length=length,
        step_yaw=yaw,
        step_width=0.25,
        landing=landing,
        foot_roll={"toe_off": toe_off, "heel_strike": heel_strike},
    )
    tasks = plan_trajectories(plan_motion(COMAN, gait))
    at = corners(tasks)
    assert at[..., 2].min() > -1e-12
    for side in Side:
        z, down = at[:, side, :, 2], bears(tasks, side)
        assert np.all(np.sort(z[down], axis=1)[:, 1] < 1e-12)  # an edge, two corners, bears
        touches = (z < 1e-12) & down[:, None]
        both = touches[1:] & touches[:-1]
        moved = np.linalg.norm(np.diff(at[:, side], axis=0), axis=-1)
        assert moved[both].max() < 1e-12
    tilt = at[..., 2].max(axis=2)  # of each sole
    double = tasks.support == Support.DOUBLE
    assert np.all(tilt[double].min(axis=1) < 1e-12)  # one sole is level
    assert_allclose(tilt[np.arange(len(tilt)), tasks.root], 0.0, atol=1e-12)


def test_the_longest_step_rolls_as_far_as_asked_and_the_ends_do_not():
    tasks = plan_trajectories(plan_motion(COMAN, rolling_walk(landing=0.0)))
    up = np.array(
        [[pin.XYZQUATToSE3(pose).rotation[2, 0] for pose in both] for both in tasks.soles]
    )
    pitch = -np.arcsin(up)  # (N, 2): turning about y to the left lowers the toe
    lifts = np.flatnonzero(np.diff(tasks.support.astype(int)) != 0) + 1
    found = []
    for k in lifts:
        if tasks.support[k] != Support.DOUBLE:  # lift-off
            side = Side.LEFT if tasks.support[k] == Support.RIGHT else Side.RIGHT
            found.append(("toe", round(float(pitch[k, side]), 9)))
        else:  # touch-down
            side = Side.LEFT if tasks.support[k - 1] == Support.RIGHT else Side.RIGHT
            found.append(("heel", round(float(pitch[k, side]), 9)))
    toes = [value for kind, value in found if kind == "toe"]
    heels = [value for kind, value in found if kind == "heel"]
    assert toes == [0.0, 0.3, 0.3, 0.3]  # nobody is behind before the first step
    assert heels == [-0.2, -0.2, -0.2, 0.0]  # the last step closes the feet
    assert np.abs(np.diff(pitch, n=2, axis=0)).max() / 0.01**2 < 100.0  # no corner in the pitch


@pytest.mark.parametrize(("toe_off", "samples"), [(0.3, 10), (0.0, 20)])
def test_a_sole_that_comes_down_alone_takes_two_thirds_of_the_double_support(
    toe_off: float, samples: int
):
    walk = rolling_walk(double_support=0.3, foot_roll={"toe_off": toe_off, "heel_strike": 0.2})
    tasks = plan_trajectories(plan_motion(COMAN, walk))
    touch = np.flatnonzero(np.diff(tasks.support == Support.DOUBLE)) + 1
    touch = touch[tasks.support[touch] == Support.DOUBLE]
    front = np.where(tasks.support[touch - 1] == Support.LEFT, Side.RIGHT, Side.LEFT)
    for k, side in zip(touch[:-1], front[:-1], strict=True):  # the last step closes the feet
        heights = corners(tasks)[k : k + 30, side, :, 2].max(axis=1)
        assert np.all(np.diff(heights[: samples + 1]) < 0.0)
        assert_allclose(heights[samples:], 0.0, atol=1e-12)


def test_a_step_backward_does_not_roll():
    level = plan_trajectories(plan_motion(COMAN, rolling_walk(step_length=-0.1)))
    assert_allclose(level.soles[..., 3:5], 0.0, atol=0.0)


def test_the_zmp_stays_on_the_hull_of_the_edges_that_bear():
    tasks = plan_trajectories(plan_motion(COMAN, rolling_walk()))
    at = corners(tasks)
    for k in range(tasks.n_samples):
        points = [at[k, side][at[k, side, :, 2] < 1e-9] for side in Side if bears(tasks, side)[k]]
        hull = ConvexHull(np.concatenate(points)[:, :2])
        assert (hull.equations[:, :2] @ tasks.zmp_ref[k] + hull.equations[:, 2]).max() < 1e-9


def test_support_polygons_are_hulls_of_what_bears():
    """Oracle: SciPy's hull of the corners on the ground, in the middle of each span."""
    tasks = plan_trajectories(plan_motion(COMAN, rolling_walk()))
    at, shapes = corners(tasks), set()
    for span in support_spans(COMAN, tasks.soles, tasks.support):
        k = (span.start + span.end) // 2
        polygon = support_polygon(COMAN, tasks.soles[span.start], span.support, span.bears)
        down = [at[k, side][at[k, side, :, 2] < 2.5e-4, :2] for side in span.support.sides]
        hull = ConvexHull(np.concatenate(down))
        x, y = polygon.T
        area = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
        assert area == pytest.approx(hull.volume, rel=1e-2)  # the first sample is not quite level
        shapes.add((span.support, tuple(len(corner) for corner in down)))
    assert (Support.DOUBLE, (2, 4)) in shapes and (Support.DOUBLE, (4, 2)) in shapes


def test_a_pendulum_above_its_zmp_follows_the_equation():
    """C - c'' / omega^2 = p, by finite differences of a smooth ZMP; at rest c = p."""
    dt, height = 1e-3, 0.5
    t = np.arange(0.0, 4.0, dt)
    zmp = np.column_stack([0.1 * np.tanh(4.0 * (t - 2.0)), np.full_like(t, 0.03)])
    com = pendulum_above(zmp, height, dt)
    acceleration = np.diff(com, n=2, axis=0) / dt**2
    assert_allclose(com[1:-1] - acceleration * height / 9.81, zmp[1:-1], atol=2e-4)
    assert_allclose(com[:, 1], 0.03, atol=1e-12)


def test_rolling_on_boxes_is_refused():
    gait = load_gait("coman/stairs")
    walk = gait.walk.model_copy(update={"foot_roll": rolling_walk().walk.foot_roll})
    with pytest.raises(ConfigError, match="foot_roll"):
        plan_motion(COMAN, gait.model_copy(update={"walk": walk}))
