"""Tests of the experiments of Mistry et al.: claims by id."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

from mgs.experiments import Claim, run


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Claim], Path]:
    folder = tmp_path_factory.mktemp("mistry")
    seen: list[tuple[int, int]] = []
    claims = run("mistry", folder, lambda done, total: seen.append((done, total)))
    assert seen[-1][0] == seen[-1][1] == len(seen)
    return {claim.id: claim for claim in claims}, folder


def test_every_claim_holds(found: tuple[dict[str, Claim], Path]):
    claims, _ = found
    assert [claim.id for claim in claims.values() if claim.holds is not True] == []


def test_critical_tasks_are_met_in_every_form(found: tuple[dict[str, Claim], Path]):
    for name in ("sway_com", "eight_critical"):
        values = found[0][name].values
        assert len(values) == 4
        assert 0.0 < max(values.values()) <= 1e-4


def test_the_hand_is_met_by_the_tracking_form_only(found: tuple[dict[str, Claim], Path]):
    hand = found[0]["eight_tracking"].values
    assert max(hand["prioritized tracking"], hand["prioritized-acceleration tracking"]) < 1e-3
    assert hand["prioritized projected"] > 0.01


def test_without_feedback_the_soles_drift(found: tuple[dict[str, Claim], Path]):
    drift = found[0]["sway_drift"].values
    assert drift["no feedback"] > 10.0 * drift["prioritized tracking"]


def test_the_handover_removes_the_jump(found: tuple[dict[str, Claim], Path]):
    values = found[0]["walk_handover"].values
    assert values["no handover"] > 5.0 * values["switch"]


def test_figures_are_written(found: tuple[dict[str, Claim], Path]):
    images = sorted(found[1].glob("*.png"))
    assert [path.stem for path in images] == ["hand_eight", "hand_errors", "handover", "sway"]
    for path in images:
        with Image.open(path) as image:
            assert len(image.convert("RGB").getcolors(1 << 24) or []) > 20
