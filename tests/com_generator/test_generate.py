"""What every CoM generator of mgs has to fulfil, whichever method it uses."""

from __future__ import annotations

import pytest
from numpy.testing import assert_allclose

from mgs.com_generator import generate_com
from mgs.core.geometry import polygon_margins
from mgs.core.plugins import COM_GENERATORS
from mgs.gait import ComParameters
from mgs.motion_planner import plan_motion
from mgs.robot import Robot
from mgs.trajectory_planner import plan_trajectories
from tests.support.polygons import support_hull
from tests.support.strategies import walk_gait

GRAVITY = 9.81


@pytest.mark.parametrize("name", COM_GENERATORS.own)
def test_every_generator_moves_the_com_from_rest_to_rest_with_the_zmp_on_the_soles(
    melson: Robot, name: str
) -> None:
    """Derivatives by central differences, ZMP by the cart-table model, polygon by Qhull."""
    tasks = plan_trajectories(
        plan_motion(melson, walk_gait(n_steps=4, step_length=0.04, lead_out=1.8))
    )
    com = generate_com(melson, tasks, ComParameters(generator=name))
    xy, dt = com.position[:, :2], tasks.dt
    assert_allclose(com.position[:, 2], tasks.com_height, rtol=0, atol=1e-12)
    assert_allclose(com.velocity[[0, -1]], 0.0, atol=1e-3)  # [m/s]
    rate = (xy[2:] - xy[:-2]) / (2.0 * dt)
    assert_allclose(com.velocity[1:-1, :2], rate, atol=2e-3)  # [m/s]; second order in dt
    lever = tasks.com_height[:, None] / GRAVITY
    assert_allclose(com.zmp, xy - lever * com.acceleration[:, :2], rtol=0, atol=1e-9)
    for k, point in enumerate(com.zmp):
        assert polygon_margins(point[None], support_hull(melson, tasks, k))[0] > 0.0
