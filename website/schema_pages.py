"""Reference pages of gait, robot and sweep files, made from their JSON schemas.

The schemas are those that `mgs schema` prints, so that a page names every key that a file may have,
with its range, its default and its unit, and no other.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

Schema = Mapping[str, Any]

INTRODUCTIONS = {
    "gait": "A gait file describes one motion in YAML. The key `motion` chooses its kind; each "
    "kind has a section below, and the blocks of keys that several kinds share follow after them.",
    "robot": "The file `robot.yaml` of a robot folder says what a URDF leaves open: soles, hands, "
    "posture and servos. `mgs robot init` drafts it.",
    "sweep": "A sweep file describes a gait library: one gait, and keys of it that vary.",
}
RANGES = (
    ("minimum", "at least {}"),
    ("exclusiveMinimum", "above {}"),
    ("ge", "at least {}"),
    ("maximum", "at most {}"),
    ("exclusiveMaximum", "below {}"),
    ("le", "at most {}"),
)
WORDS = {"number": "number", "integer": "integer", "string": "text", "boolean": "true or false"}


def schema_of(kind: str) -> dict[str, Any]:
    """JSON schema of a kind of file: `gait`, `robot` or `sweep`."""
    from mgs.gait import gait_schema
    from mgs.library.sweep import Sweep
    from mgs.robot import RobotSpec

    if kind == "gait":
        return gait_schema()
    return (RobotSpec if kind == "robot" else Sweep).model_json_schema()


def schema_page(kind: str) -> str:
    """Markdown page on all keys of a kind of file."""
    schema = schema_of(kind)
    models: dict[str, Schema] = schema.get("$defs", {})
    lines = [f"# Keys of {kind} files", "", INTRODUCTIONS[kind], ""]
    lines += [
        f"This page is made from the schema that `mgs schema {kind}` prints. Editors use that "
        "schema to complete keys and to mark errors. Unknown keys are refused.",
        "",
    ]
    top = [part["$ref"] for part in schema.get("oneOf", [])]
    order = [_name(reference) for reference in top]
    if not top:
        lines += _table(schema)
        order = list(_mentioned(schema["properties"]))
    for name in order:  # grows while models mention others
        order += [other for other in _mentioned(models[name]) if other not in order]
    for name in order:
        lines += _section(name, models[name])
    return "\n".join(lines)


def _section(name: str, model: Schema) -> list[str]:
    motion = model.get("properties", {}).get("motion", {}).get("const")
    heading = f"`motion: {motion}`" if motion else name
    text = str(model.get("description", ""))
    lines = [f"## {heading} {{#{name.lower()}}}", "", text, ""]
    if "properties" in model:
        return lines + _table(model)
    return [*lines, f"Value: {describe(model)}.", ""]


def _table(model: Schema) -> list[str]:
    required = model.get("required", [])
    rows = ["| key | value | default | meaning |", "| --- | --- | --- | --- |"]
    for key, field in model["properties"].items():
        default = "required" if key in required else _default(field)
        meaning = _cell(str(field.get("description", "")))
        rows.append(f"| `{key}` | {_cell(describe(field))} | {_cell(default)} | {meaning} |")
    return [*rows, ""]


def _default(field: Schema) -> str:
    return f"`{json.dumps(field['default'])}`" if "default" in field else "none"


def _cell(text: str) -> str:
    return re.sub(r"\s+", " ", text).replace("|", "\\|").replace("<", "&lt;")


def describe(field: Schema) -> str:
    """Values that a key accepts, in words and with links to the models that it holds."""
    if "$ref" in field:
        name = _name(field["$ref"])
        return f"[{name}](#{name.lower()})"
    if "const" in field:
        return f"`{json.dumps(field['const'])}`"
    if "enum" in field:
        return ", ".join(f"`{value}`" for value in field["enum"])
    for word in ("anyOf", "oneOf"):
        if word in field and "type" not in field:
            return " or ".join(dict.fromkeys(describe(part) for part in field[word]))
    match field.get("type"):
        case "null":
            return "`null`"
        case "array":
            return _describe_list(field)
        case "object":
            inside = field.get("additionalProperties")
            if not inside:
                return "block of keys"
            return f"mapping of names to {describe(inside if isinstance(inside, Mapping) else {})}"
        case None:
            return "any value"
        case kind:
            ranges = [text.format(f"{field[key]:g}") for key, text in RANGES if key in field]
            return " ".join([WORDS[kind], ", ".join(ranges)]).strip()


def _describe_list(field: Schema) -> str:
    least, most = field.get("minItems"), field.get("maxItems")
    items = field.get("prefixItems")
    inside = ", ".join(map(describe, items)) if items else describe(field.get("items", {}))
    if least is not None and least == most:
        return f"list of {least}: {inside}"
    bounds = [f"at least {least}"] if least else []
    bounds += [f"at most {most}"] if most else []
    return f"list{f' ({chr(44).join(bounds)})' if bounds else ''} of {inside}"


def _name(reference: str) -> str:
    return reference.rpartition("/")[2]


def _mentioned(part: object) -> Iterator[str]:
    """Names of the models that a part of a schema refers to, in their order."""
    if isinstance(part, Mapping):
        if "$ref" in part:
            yield _name(str(part["$ref"]))
        for value in part.values():
            yield from _mentioned(value)
    elif isinstance(part, list):
        for value in part:
            yield from _mentioned(value)
