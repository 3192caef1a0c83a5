"""The moment that friction gives a sole against linear programs, dynamics and physics."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog

from mgs.core.contact import Side, Support
from mgs.core.geometry import (
    quat_xyzw_from_yaw,
    rotate_planar,
    sole_corners,
    yaw_from_quat_xyzw,
)
from mgs.core.spans import spans
from mgs.judge.motion_checks import check_motion
from mgs.judge.yaw_friction import yaw_limits, yaw_moment
from mgs.motion import Motion
from mgs.motion.dynamics import WholeBodyMotion, analyse
from mgs.sim import available_engines, replay
from mgs.sim.settings import DEFAULTS
from tests.support.shipped import generated

LENGTH, WIDTH, FRICTION, WEIGHT = 0.10, 0.06, 0.5, 30.0
PLACE, HEADING = np.array([0.4, -0.3]), 0.7


def lying(x: float, y: float) -> np.ndarray:
    """World point at x, y of the sole at PLACE."""
    return PLACE + rotate_planar([x, y], HEADING)


def limits(zmp: np.ndarray, force: np.ndarray) -> tuple[float, float]:
    sole = np.concatenate([PLACE, [0.0], quat_xyzw_from_yaw(HEADING)])
    wrench = np.concatenate([force, np.zeros(3)])
    low, high = yaw_limits(wrench[None], zmp[None], sole[None], LENGTH, WIDTH, FRICTION)
    return float(low[0]), float(high[0])


def most_by_corner_forces(
    zmp: np.ndarray, force: np.ndarray, sign: int, edges: np.ndarray
) -> float | None:
    """Largest moment times sign about the vertical through the ZMP, of forces at the corners.

    Each force is inside the cone of `edges` (k, 3), and the ZMP is where it is told to be. None:
    there are no such forces.
    """
    corners = sole_corners([*PLACE, HEADING], LENGTH, WIDTH)
    arms = np.pad(corners - zmp, ((0, 0), (0, 1)))
    forces = np.broadcast_to(edges, (4, *edges.shape))
    moments = np.cross(arms[:, None], forces)
    rows = np.concatenate([forces, moments], axis=-1).reshape(-1, 6).T
    found = linprog(
        -sign * rows[5], A_eq=rows[:5], b_eq=[*force, 0.0, 0.0], bounds=(0, None), method="highs"
    )
    return None if found.status == 2 else -float(found.fun)


def pyramid() -> np.ndarray:
    """Edges of the pyramid inside the friction cone, along the edges of the sole."""
    corners = [(sx, sy) for sx in (1, -1) for sy in (1, -1)]
    turned = rotate_planar(FRICTION / np.sqrt(2.0) * np.array(corners, float), HEADING)
    return np.column_stack([turned, np.ones(4)])


def cone() -> np.ndarray:
    """Edges of the friction cone, many of them."""
    turn = np.linspace(0.0, 2.0 * np.pi, 128, endpoint=False)
    return np.column_stack([FRICTION * np.cos(turn), FRICTION * np.sin(turn), np.ones(128)])


on_the_sole = st.tuples(st.floats(-0.049, 0.049), st.floats(-0.029, 0.029))
pulls = st.tuples(st.floats(-0.45, 0.45), st.floats(-0.45, 0.45))


@given(on_the_sole, pulls)
def test_the_closed_form_is_what_a_linear_program_over_corner_forces_finds(
    at: tuple[float, float], pull: tuple[float, float]
):
    zmp, force = lying(*at), WEIGHT * np.array([*pull, 1.0])
    low, high = limits(zmp, force)
    for sign, limit in ((1, high), (-1, -low)):
        most = most_by_corner_forces(zmp, force, sign, pyramid())
        if most is None:  # the sole slides
            assert limit == 0.0
        else:
            assert limit == pytest.approx(most, abs=1e-9 * WEIGHT)
            assert limit >= -1e-9 * WEIGHT  # pressure gathered at the ZMP gives no moment


@given(on_the_sole, pulls)
def test_friction_cones_give_at_least_what_the_closed_form_promises(
    at: tuple[float, float], pull: tuple[float, float]
):
    zmp, force = lying(*at), WEIGHT * np.array([*pull, 1.0])
    low, high = limits(zmp, force)
    for sign, limit in ((1, high), (-1, -low)):
        most = most_by_corner_forces(zmp, force, sign, cone())
        if limit > 0.0:
            assert most is not None
            assert limit <= most + 1e-4 * WEIGHT * LENGTH  # the cone has 128 edges


def test_a_sole_pressed_in_its_middle_bears_friction_times_its_half_diagonal_at_most():
    low, high = limits(PLACE, np.array([0.0, 0.0, WEIGHT]))
    half_diagonal = 0.5 * np.hypot(LENGTH, WIDTH)
    assert high == -low == pytest.approx(FRICTION / np.sqrt(2) * 0.5 * (LENGTH + WIDTH) * WEIGHT)
    assert 0.9 * FRICTION * half_diagonal * WEIGHT < high < FRICTION * half_diagonal * WEIGHT


def test_a_sole_pressed_at_a_corner_turns_freely():
    corner = sole_corners([*PLACE, HEADING], LENGTH, WIDTH)[0]
    assert limits(corner, np.array([0.0, 0.0, WEIGHT])) == pytest.approx((0.0, 0.0), abs=1e-12)


@pytest.fixture(scope="module")
def fastest() -> Motion:
    return generated("melson/walk_fastest").stages.motion


def body_of(motion: Motion) -> WholeBodyMotion:
    load = np.choose(motion.support, [0.5, 1.0, 0.0])
    return analyse(motion.robot, motion.q, motion.dt, load)


def test_the_moment_is_the_rate_of_the_angular_momentum_and_the_arm_of_the_force(fastest: Motion):
    body, model = body_of(fastest), fastest.robot.model
    data, found = model.createData(), yaw_moment(body.wrench, body.zmp)
    for k in range(0, fastest.n_samples, 7):
        rate = pin.computeCentroidalMomentumTimeVariation(
            model, data, body.q[k], body.v[k], body.a[k]
        )
        arm = data.com[0][:2] - body.zmp[k]
        moment = rate.angular[2] + arm[0] * rate.linear[1] - arm[1] * rate.linear[0]
        assert found[k] == pytest.approx(moment, abs=1e-9)


def test_the_check_tells_the_worst_ratio_with_its_time_and_place(fastest: Motion):
    found = next(check for check in check_motion(fastest) if check.name == "yaw_friction")
    assert found.ok and found.time is not None
    body, k = body_of(fastest), round(found.time / fastest.dt)
    side = Support(fastest.support[k]).sides[0]
    assert found.where == f"{side.label} support, friction 0.5"
    assert found.value == pytest.approx(abs(yaw_moment(body.wrench, body.zmp)[k]))
    # elsewhere on either sole a smaller part of the moment is used
    for other in Side:
        at = fastest.support == Support.single(other)
        spec = fastest.robot.sole_spec(other)
        low, high = yaw_limits(
            body.wrench[at], body.zmp[at], body.soles[at, other], spec.length, spec.width
        )
        needed = yaw_moment(body.wrench, body.zmp)[at]
        assert np.all(needed <= found.value / found.limit * high + 1e-12)
        assert np.all(needed >= found.value / found.limit * low - 1e-12)


def least_friction(motion: Motion) -> float:
    """Friction at which the closed form just holds the worst sample, by bisection."""
    body, low, high = body_of(motion), 0.1, 1.0
    while high - low > 1e-3:
        middle, holds = 0.5 * (low + high), True
        for side in Side:
            at, spec = motion.support == Support.single(side), motion.robot.sole_spec(side)
            given = body.wrench[at], body.zmp[at], body.soles[at, side]
            least, most = yaw_limits(*given, spec.length, spec.width, middle)
            needed = yaw_moment(body.wrench, body.zmp)[at]
            holds = holds and bool(np.all((needed >= least) & (needed <= most)))
        low, high = (low, middle) if holds else (middle, high)
    return high


@pytest.mark.skipif("mujoco" not in available_engines(), reason="MuJoCo is not installed")
def test_the_support_sole_turns_where_the_friction_is_too_low_and_only_there(fastest: Motion):
    enough = least_friction(fastest)
    # the outer pyramid, of sqrt(2) times the friction, holds every wrench that any pressure can
    certainly_too_low = enough / np.sqrt(2.0)

    def turn(friction: float) -> float:
        """Largest turn of a sole within a single support [deg]."""
        settings = dataclasses.replace(DEFAULTS["mujoco"], friction=friction)
        soles = replay(fastest, "mujoco", settings).trace.soles
        turns = [
            np.ptp(np.unwrap(yaw_from_quat_xyzw(soles[start + 2 : end - 2, support.sides[0], 3:])))
            for start, end in spans(fastest.support)
            if (support := Support(fastest.support[start])) is not Support.DOUBLE
        ]
        return float(np.degrees(max(turns)))

    # compliant contacts let the sole turn by a third of a degree on any floor
    assert turn(1.05 * enough) < 1.1 * turn(1.0)
    assert turn(0.8 * certainly_too_low) > 5.0 * turn(1.0)
