from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from mgs.com_generator.preview import preview_gains
from mgs.core.errors import OutputExistsError
from mgs.experiments import run
from mgs.experiments.claim import Claim
from mgs.experiments.preview.figures import NAMES, plot_step
from mgs.experiments.preview.servo import Servo, iterated_feedback, simulate, step_reference
from mgs.experiments.preview.study import (
    SOFT,
    STIFF,
    Study,
    fast_rms,
    solve,
    step_claim,
    stepping,
    weight_claim,
)
from mgs.gait import ComParameters

SERVO = Servo(dt=0.01, com_height=0.27, parameters=ComParameters())


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


def test_every_claim_holds_and_is_plain_data(claims: dict[str, Claim]) -> None:
    assert len(claims) == 8
    for claim in claims.values():
        assert claim.holds is True, claim
        content = json.loads(json.dumps(claim.to_dict(), allow_nan=False))
        assert set(content) >= {"id", "claim", "figure", "holds", "note"}


def test_poles_of_the_loop_are_those_of_the_lq_problem() -> None:
    A, B, _, _ = SERVO.error_system()
    expected = np.linalg.eigvals(A - B * SERVO.feedback)
    found = SERVO.closed_loop().poles()
    # a double pole splits by the root of the rounding error
    np.testing.assert_allclose(np.poly(found), np.poly(expected), atol=1e-9)


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


def test_the_recursion_needs_only_the_weights() -> None:
    heavier = dataclasses.replace(SERVO, parameters=ComParameters(weight_jerk=1e-4))
    assert iterated_feedback(heavier)[0] < iterated_feedback(SERVO)[0]  # lazier
    np.testing.assert_allclose(iterated_feedback(heavier), heavier.feedback, rtol=1e-6)


def test_the_step_claim_fails_for_a_zmp_that_overshoots(study: Study) -> None:
    wild = {**study.answers, SOFT: study.step * 1.2}
    claim = step_claim(dataclasses.replace(study, answers=wild))
    assert claim.holds is False
    assert claim.values["overshoot"] == pytest.approx(0.2)
    assert claim.values["end"] == pytest.approx(0.02)


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


def test_the_step_figure_shows_the_response(study: Study) -> None:
    axes = plot_step(study).axes[0]
    zmp = next(line for line in axes.get_lines() if line.get_label() == "ZMP")
    np.testing.assert_allclose(np.asarray(zmp.get_ydata()), 1e3 * study.answers[SOFT])
