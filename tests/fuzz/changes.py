"""Random changes of trees, texts and bytes, by which sound inputs become malformed ones."""

from __future__ import annotations

import contextlib
import json
import math
import random
from functools import cache
from typing import Any

import yaml

from mgs.core.shipped import shipped_folder

SCALARS: list[Any] = [
    *(0, 1, -1, 3.0, 1e308, -1e308, 1e-320, math.nan, math.inf, 2**63, 10**400, True, None),
    *(
        "",
        "\0",
        "\x1b[31m",
        "a" * 5000,
        "$x^{$",
        "../../../etc/hostname",
        "<&>'\"",
        "world",
        "base",
    ),
    *("010", "1:30", "é\u2028", [], {}, [[[[1]]]], {"a": {"b": 1}}, [1, 2, 3], [0.1] * 3, "melson"),
]
FRAGMENTS = [
    *("&a ", "*a", "!!int ", "\t", "\r", "\ufeff", "\0", "- ", ": ", "{", "}", "[", "]", "#", '"'),
    *("'", "|", "<<: ", "1_0", "07", "\\ud800", "\x1b", "<", ">", "&lt;", "<!--", "]]>"),
]
FACTORS = [0.0, -1.0, 0.5, 0.9, 1.1, 2.0, 10.0, 1000.0]


@cache
def shipped(kind: str, name: str) -> str:
    """Text of a file that ships with mgs."""
    return (shipped_folder("gaits" if kind == "gaits" else "robots") / name).read_text()


def changed_tree(tree: Any, rng: random.Random) -> Any:
    """Tree with a few values replaced, scaled, exchanged, removed or added."""
    tree = json.loads(json.dumps(tree))
    for _ in range(rng.randint(1, 3)):
        paths = _paths(tree)
        if not paths:
            break
        *parents, last = rng.choice(paths)
        node = tree
        for key in parents:
            node = node[key]
        match rng.randrange(6):
            case 0:
                del node[last]
            case 1 if isinstance(node, dict):
                node[rng.choice(["x", "", "goal", "steps", "\x1b"])] = rng.choice(SCALARS)
            case 2 if isinstance(node[last], int | float):
                with contextlib.suppress(OverflowError):  # an integer made before
                    node[last] = type(node[last])(node[last] * rng.choice(FACTORS))
            case 3:
                node[last] = node[
                    rng.choice(list(node if isinstance(node, dict) else range(len(node))))
                ]
            case _:
                node[last] = rng.choice(SCALARS)
        tree = json.loads(json.dumps(tree))  # no value is at two places
    return tree


def _paths(tree: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Keys and indices that lead to every value inside a tree."""
    lists = enumerate(tree if isinstance(tree, list) else ())
    items = tree.items() if isinstance(tree, dict) else lists
    return [path for key, value in items for path in [(*at, key), *_paths(value, (*at, key))]]


def changed_text(text: str, rng: random.Random) -> str:
    """Text with a few pieces inserted, removed, repeated or replaced."""
    for _ in range(rng.randint(1, 4)):
        at, length = rng.randrange(len(text) + 1), rng.choice([1, 1, 2, 10, 100])
        repeated = text[at : at + length] * rng.choice([2, 50])
        piece = rng.choice([rng.choice(FRAGMENTS), repeated, ""])
        text = text[:at] + piece + text[at + rng.choice([0, length]) :]
    return text


def changed_bytes(data: bytes, rng: random.Random) -> bytes:
    """Bytes with a few of them changed, removed or repeated."""
    found = bytearray(data)
    for _ in range(rng.randint(1, 8)):
        at = rng.randrange(len(found) + 1)
        match rng.randrange(4):
            case 0:
                del found[at : at + rng.choice([1, 8, 1000])]
            case 1:
                found[at:at] = found[at : at + rng.choice([1, 8, 1000])]
            case _ if at < len(found):
                found[at] = rng.choice([0, 255, rng.randrange(256)])
            case _:
                pass
    return bytes(found)


def changed_yaml(tree: Any, rng: random.Random) -> bytes:
    """YAML text of a changed tree, at times changed itself."""
    unicode = rng.random() < 0.5
    text = yaml.safe_dump(changed_tree(tree, rng), allow_unicode=unicode, sort_keys=False)
    if rng.random() < 0.3:
        text = changed_text(text, rng)
    return text.encode("utf-8", "replace")
