"""mgs schema: what an editor is told agrees with what mgs takes."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from mgs.gait import Gait, shipped_folder
from mgs.robot import RobotSpec
from tests.cli.malformed import LEAVES, NUMBERS, VALID
from tests.cli.run import run

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


@pytest.mark.parametrize("kind", ["gait", "robot"])
def test_the_schema_is_a_json_schema(kind: str):
    jsonschema.Draft202012Validator.check_schema(schema(kind))


@pytest.mark.parametrize(("kind", "path"), SHIPPED, ids=lambda value: getattr(value, "stem", value))
def test_every_shipped_file_meets_its_schema_and_no_other_key_does(kind: str, path: Path):
    tree = yaml.safe_load(path.read_text())
    assert problems(kind, tree) == []
    assert len(problems(kind, tree | {"colour": "red"})) == 1
    for key in ("walk", "torso"):  # a block of each kind
        if key in tree:
            assert len(problems(kind, tree | {key: tree[key] | {"colour": "red"}})) == 1


@pytest.mark.parametrize("kind", ["gait", "robot"])
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


def described(properties: dict[str, Any]) -> set[str]:
    return {key for key, field in properties.items() if field.get("description")}


def test_every_key_is_described():
    """So that an editor can say what a key means, and in which unit."""
    found = schema("gait")
    definitions = {name: d["properties"] for name, d in found["$defs"].items()}
    keys = set(found["properties"]) | {key for d in definitions.values() for key in d}
    assert keys >= {path[-1] for path in LEAVES}
    undescribed = {key for d in definitions.values() for key in set(d) - described(d)}
    assert undescribed == set()
    assert set(found["properties"]) - described(found["properties"]) <= {"walk", "com", "ik"}


@pytest.mark.parametrize(("kind", "model"), [("gait", Gait), ("robot", RobotSpec)])
def test_required_keys_are_those_without_a_default(kind: str, model: type[Gait] | type[RobotSpec]):
    required = {name for name, field in model.model_fields.items() if field.is_required()}
    assert set(schema(kind)["required"]) == required
