"""Tests of mgs schema: the schemas agree with the files that mgs accepts."""

from __future__ import annotations

import copy
import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from mgs.core.config import Model
from mgs.core.shipped import shipped_folder
from mgs.gait import BalanceGait, SequenceGait, WalkGait
from mgs.robot import RobotSpec
from tests.support.commands import run
from tests.support.malformed import LEAVES, NUMBERS, VALID
from tests.support.strategies import balance_gait, constant, figure_eight, ramp, sine, walk_gait

jsonschema = pytest.importorskip("jsonschema")

SHIPPED = [
    *(("gait", path) for path in sorted(shipped_folder("gaits").rglob("*.yaml"))),
    *(("robot", path) for path in sorted(shipped_folder("robots").rglob("robot.yaml"))),
]


def schema(kind: str) -> dict[str, Any]:
    result = run("schema", kind)
    assert (result.exit_code, result.stderr) == (0, "")
    content: dict[str, Any] = json.loads(result.stdout)
    return content


def problems(kind: str, tree: Any) -> list[str]:
    validator = jsonschema.Draft202012Validator(schema(kind))
    return [error.message for error in validator.iter_errors(tree)]


@pytest.mark.parametrize("kind", ["gait", "robot", "sweep", "motors", "unit"])
def test_the_schema_is_a_json_schema(kind: str):
    jsonschema.Draft202012Validator.check_schema(schema(kind))


@pytest.mark.parametrize(("kind", "path"), SHIPPED, ids=lambda value: getattr(value, "stem", value))
def test_every_shipped_file_meets_its_schema_and_no_other_key_does(kind: str, path: Path):
    tree = yaml.safe_load(path.read_text())
    assert problems(kind, tree) == []
    assert len(problems(kind, tree | {"colour": "red"})) == 1
    # a block of each kind
    for key in ("walk", "balance", "keyframes", "pick_up", "sequence", "torso"):
        if key in tree:
            assert len(problems(kind, tree | {key: tree[key] | {"colour": "red"}})) == 1


@pytest.mark.parametrize("kind", ["gait", "robot", "sweep", "motors", "unit"])
def test_nothing_at_all_does_not_meet_the_schema(kind: str):
    assert problems(kind, {}) != []
    assert problems(kind, []) != []


@pytest.mark.parametrize("path", NUMBERS, ids=".".join)
@pytest.mark.parametrize("value", ["0.1", True, 1e13, -1e13, {}, [0.1]])
def test_the_schema_refuses_the_numbers_that_mgs_refuses(path: tuple[str, ...], value: object):
    tree = copy.deepcopy(VALID)
    node = tree
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value
    assert problems("gait", VALID) == []
    assert problems("gait", tree) != []


def described(definition: dict[str, Any]) -> set[str]:
    return {key for key, field in definition["properties"].items() if field.get("description")}


def test_every_key_is_described():
    """An editor can show the meaning and the unit of every key."""
    definitions = schema("gait")["$defs"]
    keys = {key for d in definitions.values() for key in d["properties"]}
    assert keys >= {path[-1] for path in LEAVES}
    for name, definition in definitions.items():
        assert described(definition) == set(definition["properties"]), name
        assert definition.get("description"), name


# numbers that are counts, fractions, factors, or weights of sums without a unit
WITHOUT_UNIT = {
    *("mgs", "n_steps", "repeat", "passes", "iterations", "tolerance", "feedback", "landing"),
    *("arm_swing", "damping", "gamma", "weight_joint", "weight_limit", "gamma_momentum"),
    *("samples", "seed", "soft"),
}


def takes_numbers(field: dict[str, Any]) -> bool:
    inner = [*field.get("anyOf", []), field.get("items"), field.get("additionalProperties")]
    return field.get("type") in ("number", "integer") or any(
        takes_numbers(part) for part in inner if isinstance(part, dict)
    )


@pytest.mark.parametrize("kind", ["gait", "robot", "motors", "unit"])
def test_descriptions_can_be_read_alone(kind: str):
    """Each is a sentence or noun phrase, with the unit of numbers and the meaning of null."""
    content = schema(kind)
    for name, definition in {**content["$defs"], kind: content}.items():
        for key, field in definition.get("properties", {}).items():
            text = field["description"]
            assert re.match(r"[A-Z][a-z].*\.$|[A-Z]+ .*\.$", text), f"{name}.{key}: {text}"
            assert not text.startswith(("Of ", "At ", "As ")), f"{name}.{key}: {text}"
            if takes_numbers(field) and key not in WITHOUT_UNIT:
                assert "[" in text, f"{name}.{key}: unit missing in {text!r}"
            if "default" in field and field["default"] is None:
                told = "null: " in text or "leave it out" in text
                assert told, f"{name}.{key}: meaning of null missing in {text!r}"


@pytest.mark.parametrize("model", [WalkGait, BalanceGait, SequenceGait, RobotSpec])
def test_required_keys_are_those_without_a_default(model: type[Model]):
    required = {name for name, field in model.model_fields.items() if field.is_required()}
    found = schema("robot") if model is RobotSpec else schema("gait")["$defs"][model.__name__]
    assert set(found["required"]) == required


def test_the_schema_takes_both_kinds_of_gait_with_every_kind_of_channel():
    eight = figure_eight("com", "yz", 0.02, 0.01)
    channels = [sine("com_y", 0.02), constant("com_z", -0.01), ramp("com_x", 0.01, 1.0, 2.0), eight]
    for gait in (walk_gait(), balance_gait(*channels)):
        assert problems("gait", yaml.safe_load(gait.to_yaml())) == []


@pytest.mark.parametrize(
    "change",
    [
        {"motion": "fly"},
        {"motion": "walk"},
        {"walk": {"n_steps": 2}},
        {"com": {"preview": 1.0}},
        {"balance": {"duration": 4.0}},
        {"balance": {"duration": 4.0, "channels": []}},
        {"balance": {"duration": 4.0, "channels": [sine("com", 0.1)]}},
        {"balance": {"duration": 4.0, "channels": [sine("com_y", 2.1)]}},
        {"balance": {"duration": 4.0, "channels": [sine("com_y", 0.1) | {"wave": "sinus"}]}},
        {"balance": {"duration": 4.0, "channels": [sine("com_y", 0.1) | {"width": 0.1}]}},
        {"balance": {"duration": 4.0, "channels": [{"task": "com_y", "amplitude": 0.1}]}},
        {"ik": {"prioritized": {"critical": ["feet"]}}},
        {"ik": {"faraji": {"soft": {"com": [1.0]}}}},
    ],
)
def test_the_schema_refuses_what_is_wrong_in_a_balance_motion(change: dict[str, Any]):
    tree = yaml.safe_load(balance_gait(sine("com_y", 0.1)).to_yaml())
    assert problems("gait", tree) == []
    assert problems("gait", tree | change) != []
