"""Claims of Kajita et al. on preview control, and statements of ours; see the package."""

from __future__ import annotations

import dataclasses

import numpy as np

from mgs.experiments.claim import Claim
from mgs.experiments.preview.study import (
    SHORT_PREVIEW,
    SOFT,
    STEP,
    STEP_BEFORE,
    STIFF,
    Study,
    fast_rms,
)

SIGNIFICANT = 0.10  # relative change that counts; fixed before any result was seen
VERY_SMALL = 0.01  # part of the largest gain
FAR_FUTURE = 2.0  # [s]
SETTLED_AFTER = 0.5  # [s] time after a step at which the remaining error is measured
METHOD = ("preview",)
MEMORY = " (from memory)"  # the text of the paper is not part of this project
SOURCE = f"Kajita 2003, preview control{MEMORY}"


def all_claims(study: Study) -> list[Claim]:
    """All claims of the study: those of the paper in its order, then ours."""
    return [
        far_future_claim(study),
        accuracy_claim(study),
        short_preview_claim(study),
        Claim(
            "short_preview_stable",
            "the system remains stable in spite of the lack of future information",
            "",
            "not applicable",
            "cannot fail: the preview is an input of the closed loop and does not change its poles",
            source=f"Kajita 2003, preview window{MEMORY}",
        ),
        filter_claim(study),
        Claim(
            "spiral_stairs",
            "the method generates a walk on spiral stairs",
            "",
            "not applicable",
            "the robot HRP-2P and the stairs are not described; the gait coman/stairs walks up "
            "straight stairs (docs/gallery.md)",
            source=f"Kajita 2003, stairs{MEMORY}",
        ),
        step_claim(study),
        weight_claim(study),
    ]


def far_future_claim(study: Study) -> Claim:
    """Claim: the far future does not matter."""
    servo = study.cart.servo
    longer = servo.parameters.model_copy(update={"preview": 2.0 * FAR_FUTURE})
    G_p = np.abs(dataclasses.replace(servo, parameters=longer).gains.G_p)
    ratio = float(G_p[round(FAR_FUTURE / servo.dt) - 1 :].max() / G_p.max())
    return Claim(
        "far_future",
        "information on the far future is not needed, since the preview gain becomes very small "
        f"farther than {FAR_FUTURE:g} s ahead",
        f"{100.0 * ratio:.2g} % of the largest gain",
        ratio < VERY_SMALL,
        f"less than {100 * VERY_SMALL:g} % counts as very small. Parameters of the paper: CoM "
        "height 0.814 m, period 5 ms, Q_e 1, R 1e-6",
        {"ratio": ratio},
        SOURCE,
        METHOD,
    )


def accuracy_claim(study: Study) -> Claim:
    """Claim: the ZMP follows its reference."""
    x, y = study.cart.errors()
    return Claim(
        "follows_reference",
        f"with a preview of {study.cart.preview:g} s the ZMP follows its reference with good "
        "accuracy",
        f"RMS error {100 * x:.1f} % of the step length, {100 * y:.1f} % of the step width",
        bool(max(x, y) < SIGNIFICANT),
        f"less than {100 * SIGNIFICANT:.0f} % counts as good. The reference jumps from footprint "
        f"to footprint; {study.cart.step_length:g} m and {study.cart.step_width:g} m in "
        f"{study.cart.step_time:g} s, which are ours",
        {"x": float(x), "y": float(y)},
        SOURCE,
        METHOD,
    )


def short_preview_claim(study: Study) -> Claim:
    """Claim: a short preview window follows worse."""
    long, short = study.cart.errors(), study.short_cart.errors()
    ratio = short / long
    return Claim(
        "short_preview",
        f"with a preview of {SHORT_PREVIEW:g} s the ZMP does not follow its reference well",
        f"RMS error {100 * short[0]:.1f} % of the step length, {100 * short[1]:.1f} % of the step "
        f"width; {ratio[0]:.2f} and {ratio[1]:.2f} times those with {study.cart.preview:g} s",
        bool(ratio.max() >= 1.0 + SIGNIFICANT),
        f"an error that is {100 * SIGNIFICANT:.0f} % larger on one axis counts. The ZMP leaves the "
        f"range of its reference by {100 * study.short_cart.overshoot():.1f} % of a step, with the "
        f"longer preview by {100 * study.cart.overshoot():.1f} %",
        {"x": float(short[0]), "y": float(short[1])},
        SOURCE,
        METHOD,
    )


def filter_claim(study: Study) -> Claim:
    """Claim: a second preview control compensates the error of the simple model."""
    told = [
        f"{name} {1e3 * before:.2f} to {1e3 * after:.2f} mm"
        for name, (before, after) in study.filtered.items()
    ]
    return Claim(
        "model_error",
        "preview control also compensates the ZMP error that the difference between the simple "
        "model and the multibody model causes",
        "; ".join(told),
        all(after <= (1.0 - SIGNIFICANT) * before for before, after in study.filtered.values()),
        "mean distance of the ZMP of the whole robot from its plan, before and after one pass of "
        f"the dynamic filter; at least {100 * SIGNIFICANT:.0f} % less counts",
        {f"{name} after": after for name, (_, after) in study.filtered.items()},
        f"Kajita 2003, abstract and dynamic filter{MEMORY}",
        ("preview", "dynamic filter"),
    )


def step_claim(study: Study) -> Claim:
    """Claim of ours: the ZMP converges to a step that is known in advance."""
    error = (study.answers[SOFT] - study.step) / STEP
    overshoot, undershoot = float(error[STEP_BEFORE:].max()), float(-error[:STEP_BEFORE].min())
    settled = float(np.abs(error[STEP_BEFORE + round(SETTLED_AFTER / study.soft.dt) :]).max())
    return Claim(
        "step",
        "the ZMP converges to a step that is known in advance",
        f"overshoot {100 * overshoot:.2f} %, error {100 * settled:.1e} % after "
        f"{SETTLED_AFTER:g} s, {1e3 * STEP * abs(float(error[-1])):.1e} mm at the end",
        max(overshoot, settled, abs(float(error[-1]))) < SIGNIFICANT,
        f"Melson, weight_jerk {SOFT:g}; each below {100 * SIGNIFICANT:.0f} % of the step. Before "
        f"the step the ZMP undershoots by {100 * undershoot:.2f} %",
        {"overshoot": overshoot, "undershoot": undershoot, "settled": settled},
        kind="ours",
    )


def weight_claim(study: Study) -> Claim:
    """Claim of ours: with a smaller weight of the jerk the ZMP follows fast steps closer."""
    values = {f"{weight:g}": fast_rms(study, weight) for weight in (SOFT, STIFF)}
    soft, stiff = values.values()
    return Claim(
        "weight_jerk",
        f"on steps of 0.5 s the ZMP follows closer with weight_jerk {STIFF:g} than with {SOFT:g}",
        f"{1e3 * stiff:.2f} and {1e3 * soft:.2f} mm RMS",
        stiff <= (1.0 - SIGNIFICANT) * soft,
        "Melson, ten steps of 5 cm, double support 0.1 s; ZMP of the cart-table, from the first "
        "weight shift to the last",
        values,
        kind="ours",
    )
