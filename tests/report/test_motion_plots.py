from __future__ import annotations

import dataclasses
import itertools
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from numpy.typing import NDArray

from mgs.core.contact import Side
from mgs.core.errors import OutputExistsError
from mgs.core.geometry import convex_hull, polygon_margins
from mgs.motion import Motion
from mgs.pipeline import Stages
from mgs.report import MOTION_PLOTS, plot_motion
from mgs.report.balance import plot_balance, section, support_bounds
from mgs.report.canvas import INK, SIDE_COLOURS
from mgs.report.ground import footstep_corners, plot_above
from mgs.report.joints import (
    JointSet,
    joint_sets,
    plot_positions,
    plot_torques,
    plot_velocities,
    split_side,
)
from mgs.robot import Robot

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def motion(walk_5cm: Stages) -> Motion:
    return walk_5cm.motion


def lines(axes: Axes) -> dict[str, Array]:
    """Curves (N, 2) in axes by label."""
    return {str(line.get_label()): np.asarray(line.get_xydata()) for line in axes.get_lines()}


def test_every_plot_is_written_and_none_is_overwritten(motion: Motion, tmp_path: Path) -> None:
    calls: list[tuple[int, int]] = []
    paths = plot_motion(motion, tmp_path / "plots", "svg", progress=lambda *x: calls.append(x))
    assert calls == [(i, 5) for i in range(1, 6)]
    assert [path.stem for path in paths] == list(MOTION_PLOTS)
    for path in paths:
        assert ET.parse(path).getroot().tag.endswith("svg")
    paths[0].unlink()  # a later file is in the way: the first must not be written again
    with pytest.raises(OutputExistsError):
        plot_motion(motion, tmp_path / "plots", "svg")
    assert not paths[0].exists()


def test_the_view_from_above_shows_the_motion(motion: Motion) -> None:
    axes = plot_above(motion).axes[0]
    found = lines(axes)
    np.testing.assert_allclose(found["ZMP, whole body"], 1e3 * motion.zmp)
    np.testing.assert_allclose(found["ZMP, reference"], 1e3 * motion.zmp_ref)
    np.testing.assert_allclose(found["CoM"], 1e3 * motion.com[:, :2])
    assert axes.get_aspect() == 1.0
    soles = [c for c in axes.collections if isinstance(c, PolyCollection)]
    assert [len(c.get_paths()) for c in soles] == [2, 2]
    assert sorted(text.get_text() for text in axes.texts) == ["0", "0", "1", "2"]


def test_drawn_footsteps_have_the_final_positions_of_the_soles(motion: Motion) -> None:
    final = footstep_corners(motion)
    for side in Side:
        spec, pose = motion.robot.sole_spec(side), motion.soles[-1, side]
        x = np.sort(pose[0] + 0.5 * spec.length * np.array([-1, -1, 1, 1]))
        y = np.sort(pose[1] + 0.5 * spec.width * np.array([-1, -1, 1, 1]))
        np.testing.assert_allclose(np.sort(final[side][-1, :, 0]), x, atol=1e-5)
        np.testing.assert_allclose(np.sort(final[side][-1, :, 1]), y, atol=1e-5)


def test_balance_shows_the_motion_of_each_axis(motion: Motion) -> None:
    for axis, axes in enumerate(plot_balance(motion).axes):
        found = lines(axes)
        times_and = np.column_stack([motion.times, 1e3 * motion.zmp[:, axis]])
        np.testing.assert_allclose(found["ZMP, whole body"], times_and)
        np.testing.assert_allclose(found["CoM"][:, 1], 1e3 * motion.com[:, axis])
        assert axes.get_xlim() == (0.0, motion.duration)


def test_the_zmp_is_within_its_bounds_if_and_only_if_it_is_inside_the_polygon() -> None:
    rng = np.random.default_rng(5)
    for _ in range(50):
        polygon = convex_hull(rng.normal(size=(rng.integers(3, 9), 2)))
        points = rng.normal(size=(200, 2))
        inside = polygon_margins(points, polygon) >= 0.0
        in_range = np.all((points >= polygon.min(axis=0)) & (points <= polygon.max(axis=0)), axis=1)
        for axis in (0, 1):
            low, high = section(polygon, points[:, 1 - axis], axis).T
            within = (points[:, axis] >= low) & (points[:, axis] <= high) & in_range
            np.testing.assert_array_equal(within, inside)


def test_a_section_along_an_edge_is_the_edge() -> None:
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    np.testing.assert_allclose(section(square, np.array([0.0, 0.5, 1.0, 7.0]), 0), [[0.0, 2.0]] * 4)
    np.testing.assert_allclose(section(square, np.array([-3.0, 1.0]), 1), [[0.0, 1.0]] * 2)


def test_bounds_in_single_support_are_those_of_the_support_sole(motion: Motion) -> None:
    k = int(np.flatnonzero(motion.support == 1)[10])
    sole, spec = motion.soles[k, Side.LEFT], motion.robot.sole_spec(Side.LEFT)
    x, y = support_bounds(motion)[k]
    np.testing.assert_allclose(x, sole[0] + 0.5 * spec.length * np.array([-1, 1]), atol=1e-5)
    np.testing.assert_allclose(y, sole[1] + 0.5 * spec.width * np.array([-1, 1]), atol=1e-5)


def test_joint_sets_contain_every_joint_once_and_pair_the_sides(melson: Robot) -> None:
    sets = joint_sets(melson)
    indices = [i for joints in sets for _, i in joints.joints]
    assert sorted(indices) == list(range(melson.n))
    assert [s.title for s in sets if s.group == "arm"] == [
        "shoulder pitch",
        "shoulder roll",
        "elbow pitch",
    ]
    knee = next(s for s in sets if s.title == "knee pitch")
    assert {side: melson.joint_names[i] for side, i in knee.joints} == {
        Side.LEFT: "left_knee_pitch",
        Side.RIGHT: "right_knee_pitch",
    }


def test_joints_outside_all_groups_are_drawn_too(melson: Robot) -> None:
    bare = dataclasses.replace(melson, spec=melson.spec.model_copy(update={"groups": {}}))
    sets = joint_sets(bare)
    assert {s.group for s in sets} == {"other"}
    assert sum(len(s.joints) for s in sets) == melson.n


@pytest.mark.parametrize(
    ("name", "side", "rest"),
    [
        ("left_knee", Side.LEFT, "knee"),
        ("RightKnee", Side.RIGHT, "Knee"),
        ("r_hip_roll", Side.RIGHT, "hip_roll"),
        ("LHipLat", Side.LEFT, "HipLat"),
        ("knee_left", Side.LEFT, "knee"),
        ("knee_R", Side.RIGHT, "knee"),
        ("waist_yaw", None, "waist_yaw"),
        ("roll", None, "roll"),
        ("Lift", None, "Lift"),
        ("left", None, "left"),
    ],
)
def test_sides_are_read_from_common_names(name: str, side: Side | None, rest: str) -> None:
    assert split_side(name) == (side, rest)


def panels(motion: Motion, axes: list[Axes]) -> list[tuple[JointSet, Axes]]:
    shown = [ax for ax in axes if ax.get_lines()]
    return list(zip(joint_sets(motion.robot), shown, strict=True))


@pytest.mark.parametrize(
    ("plot", "data"),
    [
        (plot_positions, lambda m: np.degrees(m.q[:, 7:])),
        (plot_velocities, lambda m: np.degrees(m.v[:, 6:])),
        (plot_torques, lambda m: m.torque),
    ],
)
def test_joint_plots_show_every_joint(motion: Motion, plot, data) -> None:  # type: ignore[no-untyped-def]
    values = data(motion)
    for joints, axes in panels(motion, plot(motion).axes):
        found = lines(axes)
        for side, i in joints.joints:
            label = "middle" if side is None else side.label
            np.testing.assert_allclose(found[label][:, 1], values[:, i])
            assert axes.get_ylim()[0] <= values[:, i].min() <= values[:, i].max()
            assert values[:, i].max() <= axes.get_ylim()[1]


def test_position_limits_are_drawn_in_the_colours_of_their_joints(motion: Motion) -> None:
    robot = motion.robot
    for joints, axes in panels(motion, plot_positions(motion).axes):
        flat = [line for line in axes.get_lines() if len(np.asarray(line.get_ydata())) == 2]
        drawn = {
            round(float(np.asarray(line.get_ydata())[0]), 6): line.get_color() for line in flat
        }
        expected: dict[float, set[Side | None]] = {}
        for side, i in joints.joints:
            for limit in (robot.lower[i], robot.upper[i]):
                expected.setdefault(round(float(np.degrees(limit)), 6), set()).add(side)
        assert set(drawn) == set(expected)
        for level, sides in expected.items():
            assert axes.get_ylim()[0] < level < axes.get_ylim()[1]
            alone = next(iter(sides)) if len(sides) == 1 else None
            assert drawn[level] == (INK if alone is None else SIDE_COLOURS[alone])


def test_torque_limits_are_drawn_if_the_torques_are_close_to_them(motion: Motion) -> None:
    for joints, axes in panels(motion, plot_torques(motion).axes):
        peak = max(np.abs(motion.torque[:, i]).max() for _, i in joints.joints)
        limit = motion.robot.torque_limit[joints.joints[0][1]]
        drawn = [line for line in axes.get_lines() if len(np.asarray(line.get_ydata())) == 2]
        assert bool(drawn) == (peak > 0.5 * limit)
        assert f"peak {100 * peak / limit:.0f} %" in axes.get_title(loc="right")


def test_footsteps_of_long_walks_are_not_all_numbered(motion: Motion) -> None:
    long = dataclasses.replace(
        motion,
        footsteps=tuple(itertools.islice(itertools.cycle(motion.footsteps), 200)),
    )
    assert len(plot_above(long).axes[0].texts) <= 40


def test_very_long_walks_have_different_scales_and_a_note(motion: Motion) -> None:
    first, last = motion.footsteps[0], motion.footsteps[-1]
    far = dataclasses.replace(motion, footsteps=(first, dataclasses.replace(last, x=10.0)))
    axes = plot_above(far).axes[0]
    assert axes.get_aspect() == "auto"
    assert "different scales" in axes.get_title(loc="right")
