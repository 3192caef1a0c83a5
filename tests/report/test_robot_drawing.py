from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

from mgs.core.contact import Side, Support
from mgs.pipeline import Stages
from mgs.report import picture_strip, write_picture
from mgs.report.canvas import SIDE_COLOURS, new_figure
from mgs.report.picture import pose_samples
from mgs.report.poses import Pose, plot_poses
from mgs.report.robot_drawing import FRONT, RIGHT_SIDE, box_corners, draw_robot, view_from
from mgs.robot import Robot


@pytest.mark.parametrize("angles", [(0.0, 0.0), (-90.0, 0.0), (-58.0, 14.0), (200.0, -80.0)])
def test_views_are_right_handed_frames(angles: tuple[float, float]) -> None:
    view = view_from(*angles)
    axes = np.stack([view.right, view.up, view.towards])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_front_and_side_views_have_the_right_directions() -> None:
    forward, left, up = np.eye(3)
    np.testing.assert_allclose(FRONT.project(left), [1.0, 0.0], atol=1e-12)  # his left, our right
    np.testing.assert_allclose(RIGHT_SIDE.project(forward), [1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(RIGHT_SIDE.project(up), [0.0, 1.0], atol=1e-12)


def test_drawn_boxes_have_the_size_of_the_robot_and_stand_on_the_ground(melson: Robot) -> None:
    upright = melson.standing_q.copy()
    upright[7:] = 0.0
    z = box_corners(melson, upright)[..., 2]
    assert np.ptp(z) == pytest.approx(0.5, abs=1e-3)  # Melson's published height [m]
    assert box_corners(melson, melson.standing_q)[..., 2].min() == pytest.approx(0.0, abs=1e-6)


def test_limbs_have_the_colour_of_their_side(melson: Robot) -> None:
    axes = new_figure(2.0, 2.0).subplots()
    draw_robot(axes, melson, melson.standing_q, FRONT)
    (drawn,) = axes.collections
    assert isinstance(drawn, PolyCollection)
    colours = np.asarray(drawn.get_facecolor())[:, :3]
    x = np.array([path.vertices[:-1, 0].mean() for path in drawn.get_paths()])  # type: ignore[index]
    for side in Side:  # from the front, the robot's left is at positive x
        hue = np.array(to_rgb(SIDE_COLOURS[side]))
        of_side = np.linalg.norm(
            colours / np.linalg.norm(colours, axis=1, keepdims=True) - hue / np.linalg.norm(hue),
            axis=1,
        )
        chosen = of_side < 1e-6
        assert chosen.sum() > 20
        assert np.all(side.sign * x[chosen] > 0.0)


def test_a_ghost_is_drawn_as_an_outline(melson: Robot) -> None:
    axes = new_figure(2.0, 2.0).subplots()
    draw_robot(axes, melson, melson.standing_q, FRONT, ghost=True)
    assert len(np.asarray(axes.collections[0].get_facecolor())) == 0


def test_poses_fit_into_their_axes(melson: Robot) -> None:
    away = melson.standing_q.copy()
    away[:2] += [3.0, -2.0]  # each pose is drawn where it stands
    figure = plot_poses(melson, [Pose(away, view) for view in (FRONT, RIGHT_SIDE)], columns=2)
    for axes in figure.axes:
        low, high = axes.dataLim.min, axes.dataLim.max
        assert axes.get_xlim()[0] <= low[0] and high[0] <= axes.get_xlim()[1]
        assert axes.get_ylim()[0] <= low[1] and high[1] <= axes.get_ylim()[1]


def test_the_strip_shows_rest_and_the_middles_of_steps(walk_5cm: Stages) -> None:
    motion = walk_5cm.motion
    samples = pose_samples(motion, 8)
    assert samples == [0, 420, 780, 1200]  # 3.0 + 1.2 s and 6.6 + 1.2 s
    assert [motion.support[k] for k in samples] == [
        Support.DOUBLE,
        Support.LEFT,
        Support.RIGHT,
        Support.DOUBLE,
    ]
    strip, ground = picture_strip(motion).axes
    assert len(strip.collections) == len(samples)
    assert len(ground.get_lines()) == 3


def test_the_picture_is_small_and_of_full_size(walk_5cm: Stages, tmp_path: Path) -> None:
    path = write_picture(walk_5cm.motion, tmp_path / "walk.png")
    assert 10_000 < path.stat().st_size < 200_000
