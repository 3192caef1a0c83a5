"""Tests of the sensitivity of claims, with an experiment that is made up for the purpose."""

from __future__ import annotations

import sys
import types

import numpy as np
import pinocchio as pin
import pytest

from mgs.core.errors import InfeasibleGaitError
from mgs.experiments import NAMES, Claim
from mgs.experiments.sensitivity import measure, robustness
from mgs.experiments.variant import Variant
from mgs.robot import load_robot

VARIANTS = (Variant("slower", speed=0.5), Variant("larger", amplitude=1.5), Variant("huge", ("x",)))


def make_up(monkeypatch: pytest.MonkeyPatch, variants: tuple[Variant, ...]) -> None:
    """Register an experiment `made_up`: one claim on the speed, one on the amplitude, one of us."""

    def solve(progress, variant=None):
        if variant is not None and variant.settings:
            raise InfeasibleGaitError("out of reach")
        if progress is not None:
            progress(1, 1)
        return variant or Variant("as shipped")

    def all_claims(study):
        return [
            Claim("fast", "it is fast", study.speed, study.speed >= 1.0, source="X 1"),
            Claim("wide", "it is wide", study.amplitude, study.amplitude > 1.2, source="X 2"),
            Claim("same", "it is", "yes", True, source="X 3"),
            Claim("odd", "it is odd", study.speed, study.speed >= 1.0, kind="ours"),
        ]

    package = types.ModuleType("mgs.experiments.made_up")
    vars(package).update(solve=solve, all_claims=all_claims, VARIANTS=variants)
    monkeypatch.setitem(sys.modules, "mgs.experiments.made_up", package)


def test_a_claim_is_fragile_where_a_variant_changes_it(monkeypatch: pytest.MonkeyPatch):
    make_up(monkeypatch, VARIANTS[:2])
    seen: list[tuple[int, int]] = []
    found = {
        c.id: c.robustness
        for c in measure("made_up", lambda done, n: seen.append((done, n))).claims
    }
    assert found == {
        "fast": "fragile: breaks at slower (0.5)",
        "wide": "fragile: holds at larger (1.5)",
        "same": "robust",
        "odd": "ours",
    }
    assert seen == [(1, 3), (2, 3), (3, 3)]


def test_a_variant_that_is_refused_is_reported(monkeypatch: pytest.MonkeyPatch):
    make_up(monkeypatch, VARIANTS)
    found = measure("made_up")
    assert found.refused == {"huge": "out of reach"}
    assert set(found.variants) == {"slower", "larger"}
    assert next(c for c in found.claims if c.id == "same").robustness == "robust; not run at huge"
    assert found.to_dict()["refused"] == {"huge": "out of reach"}


def test_without_a_variant_nothing_is_known_of_the_robustness(monkeypatch: pytest.MonkeyPatch):
    make_up(monkeypatch, VARIANTS[2:])
    found = {c.id: c.robustness for c in measure("made_up").claims}
    assert found["same"] == "not measured; not run at huge"


def test_a_variant_without_a_value_is_named_and_not_counted():
    def claim(holds: bool, value: float) -> Claim:
        return Claim("delay", "later", f"{value} ms", holds, values={"ik1": value}, source="FI")

    variants = {"slower": {"delay": claim(True, 2.0)}, "small": {"delay": claim(False, np.nan)}}
    assert robustness(claim(True, 1.0), variants, []) == "robust; without a value at small"
    variants["fast"] = {"delay": claim(False, 3.0)}
    assert robustness(claim(True, 1.0), variants, []) == (
        "fragile: breaks at fast (3.0 ms); without a value at small"
    )


@pytest.mark.parametrize("name", NAMES)
def test_every_experiment_names_its_variants(name: str):
    package = __import__(f"mgs.experiments.{name}", fromlist=["VARIANTS"])
    names = [variant.name for variant in package.VARIANTS]
    assert len(set(names)) == len(names)


def test_the_robot_of_a_variant_has_other_masses_and_stops():
    robot = load_robot("coman")
    other = Variant("all", masses=1.2, stops=0.9).robot(robot)
    assert other.mass == pytest.approx(1.2 * robot.mass)
    np.testing.assert_allclose(other.lower, 0.9 * robot.lower)
    np.testing.assert_allclose(other.model.upperPositionLimit[7:], 0.9 * robot.upper)
    same = pin.centerOfMass(other.model, other.model.createData(), robot.standing_q)
    np.testing.assert_allclose(
        same, pin.centerOfMass(robot.model, robot.model.createData(), robot.standing_q), atol=1e-12
    )


def test_heavier_legs_lower_the_centre_of_mass():
    robot = load_robot("coman")
    heavy = Variant("legs", leg_masses=1.2).robot(robot)
    heights = [
        pin.centerOfMass(r.model, r.model.createData(), robot.standing_q)[2] for r in (heavy, robot)
    ]
    assert heights[0] < heights[1] - 1e-3
    assert robot.mass < heavy.mass < 1.2 * robot.mass
