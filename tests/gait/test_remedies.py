"""Remedies: each names keys that its kind of gait has, and only those that can have an effect."""

from __future__ import annotations

import re
from typing import Any, get_args, get_origin

import pytest
from pydantic import BaseModel

from mgs.core.errors import (
    ComNotAtRestError,
    ComOutsideFeetError,
    ConfigError,
    FootstepError,
    IkError,
    InfeasibleGaitError,
    JointLimitError,
    JointSpeedError,
    MgsError,
    ZmpMarginError,
)
from mgs.gait import GAITS, KickGait, load_gait
from mgs.gait.remedies import REMEDIES, Change, remedies_for, remedy_of
from tests.support.strategies import (
    balance_gait,
    constant,
    keyframes_gait,
    pick_up_gait,
    walk_gait,
)

MISS = IkError(1.25, "CoM", 3e-3, 2e-4, "m")
LIMIT = JointLimitError(1.25, "knee", -0.1, 0.0, 2.2)
CHANGES = [
    pytest.param(kind, change, id=f"{kind.__name__}-{error.__name__}-{change.text}-{change.key}")
    for kind, remedies in REMEDIES.items()
    for error, changes in remedies.items()
    for change in changes
]
GAITS_OF_ALL_KINDS = [
    walk_gait(),
    KickGait(mgs=1, motion="kick"),
    balance_gait(constant("com_y", 0.01)),
    keyframes_gait({"time": 1.0, "crouch": 2.0}),
    pick_up_gait(object=[0.1, -0.1, 0.1]),
]
KEY = re.compile(r"\b[a-z]+(?:_[a-z]+)*(?:\.[a-z_]+)+")


def model_of(annotation: Any) -> type[BaseModel] | None:
    """The pydantic model that a field holds, if it holds one."""
    options = [annotation, *get_args(annotation)] if get_origin(annotation) else [annotation]
    models = [o for o in options if isinstance(o, type) and issubclass(o, BaseModel)]
    return models[0] if models else None


def assert_key_exists(kind: type[BaseModel], key: str) -> None:
    """Oracle: the fields that pydantic checks gait files against."""
    model: type[BaseModel] | None = kind
    for name in key.split("."):
        assert model is not None and name in model.model_fields, f"{kind.__name__} has no {key}"
        model = model_of(model.model_fields[name].annotation)


@pytest.mark.parametrize(("kind", "change"), CHANGES)
def test_a_remedy_names_a_key_of_its_own_kind_of_gait(kind: type[BaseModel], change: Change):
    assert_key_exists(kind, change.key)
    assert change.text.count("{}") == 1
    assert change.key.split(".")[0] in (
        *kind.model_fields["motion"].annotation.__args__,
        "com",
        "ik",
    )


def test_every_kind_of_gait_has_a_remedy_for_a_missed_task_and_for_a_joint_limit():
    assert {type(gait) for gait in GAITS_OF_ALL_KINDS} | {GAITS["sequence"]} == set(GAITS.values())
    for gait in GAITS_OF_ALL_KINDS:
        for error in (MISS, LIMIT):
            assert remedy_of(gait, error).startswith("use ")


@pytest.mark.parametrize("gait", GAITS_OF_ALL_KINDS, ids=lambda gait: gait.motion)
@pytest.mark.parametrize("error", [MISS, LIMIT], ids=lambda error: type(error).__name__)
def test_a_remedy_speaks_of_no_other_kind_of_gait(gait: Any, error: MgsError):
    keys = KEY.findall(remedy_of(gait, error))
    assert keys
    for key in keys:
        assert_key_exists(type(gait), key)


def test_the_remedy_of_a_walk_names_the_keys_that_the_walk_sets():
    told = remedy_of(walk_gait(step_length=0.05), MISS)
    assert told == (
        "use a shorter walk.step_length, a longer walk.single_support or a lower walk.com_height"
    )
    assert "a smaller walk.step_width" in remedy_of(walk_gait(step_width=0.3), MISS)
    assert "walk.step_length" not in remedy_of(walk_gait(step_length=0.0, step_yaw=0.1), MISS)
    footsteps = [{"side": "left", "x": 0.1, "y": 0.05}]
    placed = walk_gait(n_steps=None, footsteps=footsteps)
    assert "walk.footsteps nearer to each other" in remedy_of(placed, MISS)
    assert "walk.footsteps farther from each other" in remedy_of(
        placed, FootstepError(1, 2, -1e-3, 0.05)
    )


@pytest.mark.parametrize(("solver", "told"), [("clik", True), ("ik4", False)])
def test_gamma_joint_is_a_remedy_only_for_the_solver_that_has_it(solver: str, told: bool):
    gait = walk_gait(ik={"solver": solver})
    assert ("ik.gamma_joint" in remedy_of(gait, LIMIT)) == told
    assert "ik.on_limit: record" in remedy_of(gait, LIMIT)


@pytest.mark.parametrize(
    ("gait", "block"), [(walk_gait(), "walk"), (KickGait(mgs=1, motion="kick"), "kick")]
)
def test_a_com_without_rest_or_margin_is_told_the_keys_of_its_own_block(gait: Any, block: str):
    rest = remedy_of(gait, ComNotAtRestError(4e-3, 2e-3, (2e-3, 1e-3)))
    assert rest == f"use a longer {block}.lead_out or a longer com.preview"
    margin = remedy_of(gait, ZmpMarginError(0.0, "double", 0.0, -0.147))
    keys = [f"{block}.{key}" for key in ("zmp_offset", "lead_in", "lead_out")]
    assert KEY.findall(margin) == keys


def test_an_error_without_a_known_remedy_stays_as_it_is():
    assert remedy_of(walk_gait(), ConfigError("a.yaml", "wrong")) == ""
    too_fast = JointSpeedError(0.0, "knee", 7.0, 6.0)
    assert remedy_of(load_gait("melson/walk_kick_walk"), too_fast) == ""
    assert remedy_of(load_gait("melson/walk_kick_walk"), MISS) == ""


def test_a_remedy_is_added_to_an_error_that_passes_and_has_none():
    gait = balance_gait(constant("com_y", 0.2))
    with pytest.raises(ComOutsideFeetError) as caught, remedies_for(gait):
        raise ComOutsideFeetError(0.2)
    assert str(caught.value).endswith("; use a smaller com_y in balance.channels")
    own = InfeasibleGaitError("too far")
    own.remedy = "come nearer"
    with pytest.raises(InfeasibleGaitError) as caught, remedies_for(gait):
        raise own
    assert str(caught.value) == "too far; come nearer"


def test_other_peoples_errors_pass_unchanged():
    with pytest.raises(ZeroDivisionError), remedies_for(walk_gait()):
        _ = 1 / 0
