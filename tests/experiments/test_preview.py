"""Tests of the preview control study.

Gains and simulations are compared with python-control and with derivations that share no code with
mgs: the Riccati recursion, and a plant whose states include the known future.
"""

from __future__ import annotations

import dataclasses
import json

import control
import numpy as np
import pytest
from numpy.typing import NDArray

from mgs.com_generator.preview import preview_gains
from mgs.core.errors import ConfigError, OutputExistsError
from mgs.experiments import run
from mgs.experiments.claim import Claim
from mgs.experiments.preview.cart import Cart
from mgs.experiments.preview.claims import accuracy_claim, step_claim, weight_claim
from mgs.experiments.preview.design import analyse
from mgs.experiments.preview.figures import NAMES, plot_design, plot_step, plot_windows
from mgs.experiments.preview.servo import Servo, lqr_feedback, simulate, step_reference
from mgs.experiments.preview.study import SOFT, STIFF, Study, fast_rms, follow, solve, stepping
from mgs.experiments.preview.variants import VARIANTS
from mgs.experiments.variant import Variant
from mgs.gait import ComParameters

Array = NDArray[np.float64]
SERVO = Servo(dt=0.01, com_height=0.27, parameters=ComParameters(weight_jerk=1e-6))
STIFFER = dataclasses.replace(SERVO, parameters=ComParameters(weight_jerk=STIFF))


@pytest.fixture(scope="module")
def study() -> Study:
    return solve()


@pytest.fixture(scope="module")
def claims(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Claim]:
    folder = tmp_path_factory.mktemp("figures")
    claims = run("preview", folder)
    assert sorted(path.name for path in folder.iterdir()) == sorted(f"{n}.png" for n in NAMES)
    with pytest.raises(OutputExistsError):
        run("preview", folder, force=False)
    return {claim.id: claim for claim in claims}


# --- gains, poles and simulations -------------------------------------------------------------


def iterated_feedback(servo: Servo) -> Array:
    """Feedback gains (4,) by the Riccati recursion from zero until convergence.

    Each step adds the cost of one more sample under the gain that is best for it. In this form
    rounding errors do not grow from step to step.
    """
    A, B, Q, R = servo.error_system()
    K, G = np.zeros((4, 4)), np.zeros((1, 4))
    for _ in range(20_000):
        previous, closed = K, A - B @ G
        K = Q + closed.T @ K @ closed + G.T @ R @ G
        G = np.linalg.solve(R + B.T @ K @ B, B.T @ K @ A)
        if np.abs(K - previous).max() < 1e-14 * np.abs(K).max():
            break
    return G[0]


def register_gains(servo: Servo) -> tuple[Array, Array]:
    """Feedback gains (4,) and preview gains (n,) by LQR for a plant that includes the future.

    The n known increments of the reference are states of a shift register. One dlqr of order 4 + n
    then gives all gains, without a formula for preview gains.
    """
    A, B, Q, R = servo.error_system()
    n = len(servo.gains.G_p)
    A_all, B_all, Q_all = np.zeros((4 + n, 4 + n)), np.zeros((4 + n, 1)), np.zeros((4 + n, 4 + n))
    A_all[:4, :4], B_all[:4], Q_all[:4, :4] = A, B, Q
    A_all[0, 4] = -1.0  # e[k+1] includes the next increment of the reference
    A_all[4:, 4:] = np.eye(n, k=1)
    gain = np.asarray(control.dlqr(A_all, B_all, Q_all, R)[0])[0]
    return gain[:4], gain[4:]


@pytest.mark.parametrize("servo", [SERVO, STIFFER], ids=["soft", "stiff"])
def test_feedback_gains_are_those_of_python_control_and_of_the_recursion(servo: Servo) -> None:
    np.testing.assert_allclose(servo.feedback, lqr_feedback(servo), rtol=1e-6)
    np.testing.assert_allclose(servo.feedback, iterated_feedback(servo), rtol=1e-6)


def test_preview_gains_are_those_of_a_plant_that_includes_the_future() -> None:
    feedback, future = register_gains(SERVO)
    np.testing.assert_allclose(SERVO.feedback, feedback, rtol=1e-6)
    scale = np.abs(SERVO.gains.G_p).max()
    np.testing.assert_allclose(SERVO.gains.G_p / scale, future / scale, atol=1e-6)


def test_poles_of_the_loop_are_those_of_the_lq_problem() -> None:
    A, B, _, _ = SERVO.error_system()
    expected = np.linalg.eigvals(A - B * SERVO.feedback)
    found = SERVO.closed_loop().poles()
    # a double pole splits by the root of the rounding error
    np.testing.assert_allclose(np.poly(found), np.poly(expected), atol=1e-9)
    assert np.abs(found).max() < 1.0


def test_the_simulated_loop_equals_the_control_law_sample_by_sample() -> None:
    g = preview_gains(0.01, 0.27, 1.6, 1.0, 1e-6)
    zmp_ref = step_reference(200, 100, 0.05)
    x, s, zmp = np.zeros(3), 0.0, np.empty(300)
    for k in range(300):
        zmp[k] = g.C @ x
        s += zmp[k] - zmp_ref[k]
        ahead = zmp_ref[np.minimum(k + 1 + np.arange(len(g.G_p)), 299)]
        x = g.A @ x + g.B * (-g.G_i * s - g.G_x @ x - g.G_p @ ahead)
    np.testing.assert_allclose(simulate(SERVO, zmp_ref), zmp, atol=1e-12)
    # the generator of mgs computes the same response by recursive doubling
    step = step_reference(300, 400, 0.1)
    np.testing.assert_allclose(follow(SERVO, step)[0], simulate(SERVO, step), atol=1e-9)


# --- claims -----------------------------------------------------------------------------------


def test_figures_of_the_example_of_the_paper(study: Study, claims: dict[str, Claim]) -> None:
    """Largest preview gain, errors with both windows; Kajita et al. show gains up to about 1200."""
    gains = study.cart.servo.gains.G_p
    assert -gains.min() == pytest.approx(1183, abs=5)
    assert claims["far_future"].values["ratio"] == pytest.approx(1.1e-3, abs=1e-4)
    long, short = claims["follows_reference"].values, claims["short_preview"].values
    assert (long["x"], long["y"]) == pytest.approx((0.034, 0.037), abs=0.002)
    assert (short["x"], short["y"]) == pytest.approx((0.053, 0.054), abs=0.002)
    assert study.short_cart.overshoot() == pytest.approx(0.149, abs=0.005)


def test_one_pass_of_the_filter_removes_most_of_the_model_error(study: Study) -> None:
    for before, after in study.filtered.values():
        assert 4e-3 < before < 15e-3  # [m]
        assert after < 0.3 * before


def test_claims_are_plain_data_and_name_their_source(claims: dict[str, Claim]) -> None:
    for claim in claims.values():
        content = json.loads(json.dumps(claim.to_dict(), allow_nan=False))
        assert content["note"]
        if content["class"] == "paper":
            assert "from memory" in content["source"]  # the text of the paper is not here


def test_the_accuracy_claim_fails_with_a_lazy_servo(study: Study) -> None:
    lazy = dataclasses.replace(study.cart, weight_jerk=1e-2)
    assert accuracy_claim(dataclasses.replace(study, cart=lazy)).holds is False


def test_the_step_claim_fails_for_a_zmp_that_overshoots(study: Study) -> None:
    wild = {**study.answers, SOFT: study.step * 1.2}
    claim = step_claim(dataclasses.replace(study, answers=wild))
    assert claim.holds is False
    assert claim.values["overshoot"] == pytest.approx(0.2)


def test_the_error_on_fast_steps_is_a_root_mean_square(study: Study) -> None:
    off = study.fast.zmp_ref + np.array([3e-3, 4e-3])  # 5 mm everywhere
    wrong = dataclasses.replace(study, fast_zmp={SOFT: off, STIFF: off})
    assert fast_rms(wrong, SOFT) == pytest.approx(5e-3)
    assert weight_claim(wrong).holds is False


def test_the_window_of_fast_steps_contains_all_steps_and_no_rest(study: Study) -> None:
    window = stepping(study)
    moving = np.any(np.diff(study.fast.zmp_ref, axis=0) != 0.0, axis=1)
    assert not moving[~(window[1:] | window[:-1])].any()
    assert window.sum() * study.fast.dt == pytest.approx(10 * 0.5 + 0.1, abs=0.02)


def test_a_variant_changes_the_example() -> None:
    cart = Cart().changed(Variant("all", ("dt=0.01",), amplitude=2.0, speed=0.5))
    assert (cart.dt, cart.step_length, cart.step_width) == pytest.approx((0.01, 0.6, 0.4))
    assert cart.step_time == pytest.approx(1.6)
    for variant in VARIANTS:  # every one names existing fields
        assert isinstance(Cart().changed(variant), Cart)


# --- generators of gaits ----------------------------------------------------------------------


def test_the_generator_of_a_walk_has_the_poles_of_its_cart_table() -> None:
    """In the limit of zero weight two poles are at exp(-omega dt), omega^2 = g / com_height.

    They are the stable zero of the cart-table and the mirror image of the unstable one.
    """
    design = analyse("melson/s1")
    assert design.generator == "preview" and design.gain_gap is not None
    assert design.gain_gap < 1e-6
    slowest = np.sqrt(design.com_height / 9.81)
    assert design.time_constants[:2] == pytest.approx((slowest, slowest), rel=1e-3)
    assert len(design.poles) == 4 and max(map(abs, design.poles)) < 1.0
    assert 0.0 < design.overshoot < 0.05 and design.settling_time < 0.1
    assert design.com[design.time == 0.0] == pytest.approx(0.5, abs=0.1)
    json.dumps(design.to_dict(), allow_nan=False)
    assert len(plot_design(design).axes) == 2


def test_a_generator_without_constant_gains_has_a_step_response_only() -> None:
    design = analyse("melson/walk_practical")
    assert design.generator == "qp" and design.poles == () and design.gain_gap is None
    assert design.zmp[0] == pytest.approx(0.0, abs=1e-3)
    assert design.zmp[-1] == pytest.approx(1.0, abs=1e-3)
    assert 0.0 < design.settling_time < 2.0
    assert len(plot_design(design).axes) == 1


def test_a_gait_without_a_generator_is_refused() -> None:
    with pytest.raises(ConfigError, match="keyframes has no generator"):
        analyse("melson/bow")
    with pytest.raises(ConfigError, match="--robot"):
        analyse("generic/walk")


# --- figures ----------------------------------------------------------------------------------


def test_the_figures_show_the_responses(study: Study) -> None:
    zmp = next(line for line in plot_step(study).axes[0].get_lines() if line.get_label() == "ZMP")
    np.testing.assert_allclose(np.asarray(zmp.get_ydata()), 1e3 * study.answers[SOFT])
    axes = plot_windows(study).axes
    for i, cart in enumerate((study.cart, study.short_cart)):
        for axis in range(2):
            lines = axes[2 * axis + i].get_lines()
            zmp = next(line for line in lines if line.get_label() == "ZMP")
            np.testing.assert_allclose(np.asarray(zmp.get_ydata()), cart.follow()[0][:, axis])
