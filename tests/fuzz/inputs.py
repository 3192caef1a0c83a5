"""Hypothesis strategies of malformed inputs: files of each format, and a command for them."""

from __future__ import annotations

import contextlib
import json
import random
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import yaml
from hypothesis import strategies as st

from mgs.core.shipped import shipped_folder
from mgs.library.manifest import writing
from mgs.library.points import plan_sweep
from mgs.library.run import identity_of, recipe_of
from mgs.motion_file import motion_bytes
from mgs.pipeline.request import generate
from tests.support.rewriting import rewritten

SCALARS: list[Any] = [
    *(0, 1, -1, 3.0, 1e308, -1e308, 1e-320, float("nan"), float("inf"), 2**63, 10**400, True, None),
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
ATTRIBUTES = ["0", "-1", "1e308", "1e-320", "nan", "inf", "nan nan nan", "0 0 0", "1 2", "", "${a}"]
ATTRIBUTES += [
    "world",
    "base",
    "root_joint",
    "universe",
    "&#27;[31m",
    "a" * 3000,
    "&#xd7ff;",
    "\xff",
]
FRAGMENTS = ["&a ", "*a", "!!int ", "\t", "\r", "\ufeff", "\0", "- ", ": ", "{", "}", "[", "]", "#"]
FRAGMENTS += [
    '"',
    "'",
    "|",
    "<<: ",
    "1_0",
    "07",
    "\\ud800",
    "\x1b",
    "<",
    ">",
    "&lt;",
    "<!--",
    "]]>",
]


@dataclass(frozen=True)
class Case:
    """Files in an empty folder, and a command about them."""

    kind: str
    files: dict[str, bytes]
    command: tuple[str, ...]


@cache
def shipped(kind: str, name: str) -> str:
    """Text of a file that ships with mgs."""
    return (shipped_folder("gaits" if kind == "gaits" else "robots") / name).read_text()


GAITS = [f"{robot}/{name}.yaml" for robot, name in (
    ("melson", "walk_5cm"), ("melson", "bow"), ("melson", "kick"), ("melson", "pick_up"),
    ("melson", "walk_turn_walk"), ("melson", "walk_to_pose"), ("coman", "stairs"),
)]  # fmt: skip
SWEEPS: list[dict[str, Any]] = [
    {"mgs": 1, "base": "melson/walk_5cm", "axes": {"walk.step_length": [0.03, 0.05]}},
    {"mgs": 1, "base": "melson/walk_5cm", "sampling": "sobol", "samples": 8, "seed": 1,
     "axes": {"walk.step_length": {"uniform": [0.0, 0.05]}, "walk.n_steps": {"integers": [2, 9]}},
     "filters": ["walk.step_length / walk.single_support < 0.2"]},
    {"mgs": 1, "base": "melson/walk_5cm", "axes": {"dt": {"logspace": [0.001, 0.1, 3]},
     "walk.step_length": {"linspace": [0.0, 0.1, 3]}}},
]  # fmt: skip
TABLE = "walk.step_length,walk.n_steps\n0.03,4\n0.05,6\n"
QUERIES = [
    "speed > 0.1 and survived",
    "number in [1, 2] or not verdict == 'pass'",
    "abs(vx) / 2 < 1",
]
TOKENS = [
    "and",
    "or",
    "not",
    "(",
    ")",
    "[",
    "]",
    "in",
    "is",
    "None",
    "==",
    "<",
    "number",
    "vx",
    "-",
]
TOKENS += [
    "abs(",
    "1e999",
    "9223372036854775808",
    "'a'",
    '"',
    "\0",
    "\ud800",
    "*",
    "/",
    "lambda:",
    ",",
]


def _paths(tree: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Keys and indices that lead to every value inside a tree."""
    items = (
        tree.items()
        if isinstance(tree, dict)
        else enumerate(tree if isinstance(tree, list) else ())
    )
    return [path for key, value in items for path in [(*at, key), *_paths(value, (*at, key))]]


def changed_tree(tree: Any, rng: random.Random) -> Any:
    """Tree with a few values replaced, removed or added."""
    tree = json.loads(json.dumps(tree))
    for _ in range(rng.randint(1, 3)):
        paths = _paths(tree)
        if not paths:
            break
        *parents, last = rng.choice(paths)
        node = tree
        for key in parents:
            node = node[key]
        match rng.randrange(4):
            case 0:
                del node[last]
            case 1 if isinstance(node, dict):
                node[rng.choice(["x", "", "goal", "steps", "\x1b"])] = rng.choice(SCALARS)
            case _:
                node[last] = rng.choice(SCALARS)
    return tree


def changed_text(text: str, rng: random.Random) -> str:
    """Text with a few pieces inserted, removed, repeated or replaced."""
    for _ in range(rng.randint(1, 4)):
        at, length = rng.randrange(len(text) + 1), rng.choice([1, 1, 2, 10, 100])
        piece = rng.choice(
            [rng.choice(FRAGMENTS), text[at : at + length] * rng.choice([2, 50]), ""]
        )
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


def _yaml(tree: Any, rng: random.Random) -> bytes:
    text = yaml.safe_dump(
        changed_tree(tree, rng), allow_unicode=rng.random() < 0.5, sort_keys=False
    )
    if rng.random() < 0.3:
        text = changed_text(text, rng)
    return text.encode("utf-8", "replace")


def gait(rng: random.Random) -> Case:
    """A gait file, to be generated."""
    text = shipped("gaits", rng.choice(GAITS))
    data = (
        _yaml(yaml.safe_load(text), rng) if rng.random() < 0.6 else changed_text(text, rng).encode()
    )
    command = ("generate", "a.yaml", "--robot", "melson", "-o", "out/a.mcap")
    return Case("gait", {"a.yaml": data}, command)


def robot(rng: random.Random) -> Case:
    """A robot folder, to be shown or checked."""
    spec, urdf = (shipped("robots", f"melson/{name}") for name in ("robot.yaml", "robot.urdf"))
    data, text = spec.encode(), urdf
    if rng.random() < 0.5:
        data = _yaml(yaml.safe_load(spec), rng)
    else:
        text = _changed_urdf(urdf, rng)
    files = {"r/robot.yaml": data, "r/robot.urdf": text.encode("utf-8", "replace")}
    return Case("robot", files, ("robot", rng.choice(["show", "check"]), "r"))


def urdf(rng: random.Random) -> Case:
    """A URDF, of which a robot is to be made."""
    text = _changed_urdf(shipped("robots", f"{rng.choice(['melson', 'coman'])}/robot.urdf"), rng)
    command = ("robot", "init", "a.urdf", "-o", "out")
    return Case("urdf", {"a.urdf": text.encode("utf-8", "replace")}, command)


def _changed_urdf(text: str, rng: random.Random) -> str:
    """URDF with values of attributes replaced, elements repeated, or its text changed."""
    lines = text.splitlines(keepends=True)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(lines))
        match rng.randrange(4):
            case 0:
                del lines[at]
            case 1:
                lines.insert(at, lines[rng.randrange(len(lines))] * rng.choice([1, 2, 200]))
            case 2:
                lines[at] = changed_text(lines[at], rng)
            case _:
                head, quote, rest = lines[at].partition('="')
                if quote:
                    after = rest.partition('"')[2]
                    lines[at] = f'{head}="{rng.choice(ATTRIBUTES)}"{after}'
        if not lines:
            break
    return "".join(lines)


def sweep(rng: random.Random) -> Case:
    """A sweep file, to be planned."""
    return Case("sweep", {"s.yaml": _yaml(rng.choice(SWEEPS), rng)}, ("batch", "plan", "s.yaml"))


def table(rng: random.Random) -> Case:
    """A table of a sweep, to be planned."""
    tree = {"mgs": 1, "base": "melson/walk_5cm", "sampling": "table", "table": "t.csv"}
    text = changed_text(TABLE * rng.choice([1, 20]), rng)
    files = {"s.yaml": yaml.safe_dump(tree).encode(), "t.csv": text.encode("utf-8", "replace")}
    return Case("table", files, ("batch", "plan", "s.yaml", "--json"))


@cache
def motion() -> bytes:
    """A short motion file."""
    return motion_bytes(generate("melson", "melson/bow", dt=0.1))


def motion_file(rng: random.Random) -> Case:
    """A motion file whose bytes, attachments or metadata are changed."""
    if rng.random() < 0.4:
        data = changed_bytes(motion(), rng)
    else:
        data = rewritten(motion(), library=rng.choice(["other", None]), change=_change_of(rng))
    command = rng.choice([
        ("info", "a.mcap", "--json"), ("validate", "a.mcap", "--physics", "none", "--json"),
        ("export", "a.mcap", "-o", "out.csv"),
    ])  # fmt: skip
    return Case("motion file", {"a.mcap": data}, command)


def _change_of(rng: random.Random) -> Callable[[Any], None]:
    """Change of one attachment or one value of the metadata."""
    chosen = rng.choice(["gait.yaml", "robot.yaml", "robot.urdf", "metadata"])

    def change(record: Any) -> None:
        name = getattr(record, "name", "")
        if name == chosen and hasattr(record, "data"):
            text = record.data.decode()
            if chosen == "robot.urdf":
                record.data = _changed_urdf(text, rng).encode("utf-8", "replace")
            else:
                record.data = _yaml(yaml.safe_load(text), rng)
        elif chosen == "metadata" and hasattr(record, "metadata") and hasattr(record, "name"):
            key = rng.choice(sorted(record.metadata))
            value = record.metadata[key]
            made = rng.choice(
                ["", "NaN", "1e999", "[[[", "9" * 5000, "-1", changed_text(value, rng)]
            )
            with contextlib.suppress(ValueError, TypeError):  # this value is no JSON
                made = rng.choice([made, json.dumps(changed_tree(json.loads(value), rng))])
            record.metadata = {**record.metadata, key: made.encode("utf-8", "replace").decode()}

    return change


@cache
def library() -> bytes:
    """Manifest of a small gait library, whose gaits have figures but no files."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "s.yaml").write_text(yaml.safe_dump(SWEEPS[0]))
        plan = plan_sweep(folder / "s.yaml")
        with writing(folder, identity_of(plan, recipe_of(plan)), plan.keys) as manifest:
            for number, (length,) in enumerate(plan.points):
                figures = {"vx": length, "vy": 0.0, "wz": 0.0, "speed": length, "survived": 1}
                row = {"number": number, "verdict": "pass", "walk.step_length": length, **figures}
                manifest.keep(row)
        return (folder / "manifest.sqlite").read_bytes()


def query(rng: random.Random) -> Case:
    """A condition on a library, or a library whose manifest is changed."""
    data, where = library(), rng.choice(QUERIES)
    if rng.random() < 0.4:
        data = changed_bytes(data, rng)
    else:
        words = where.split()
        for _ in range(rng.randint(1, 6)):
            words.insert(rng.randrange(len(words) + 1), rng.choice(TOKENS) * rng.choice([1, 1, 60]))
        where = " ".join(words).replace("\0", "")
    where = where.encode("utf-8", "replace").decode()
    command = rng.choice([
        ("library", "query", "l", "--where", where, "--json"),
        ("library", "query", "l", "--order", where), ("library", "report", "l", "--json"),
    ])  # fmt: skip
    return Case("query", {"l/manifest.sqlite": data}, command)


KINDS: dict[str, Callable[[random.Random], Case]] = {
    "gait": gait,
    "robot": robot,
    "urdf": urdf,
    "sweep": sweep,
    "table": table,
    "motion file": motion_file,
    "query": query,
}


def cases(kind: str) -> st.SearchStrategy[Case]:
    """Strategy of the inputs of a kind; the seed of what is random in one is what it draws."""
    return st.integers(0, 2**64 - 1).map(lambda seed: KINDS[kind](random.Random(seed)))


def write(case: Case, folder: Path) -> None:
    """Write the files of a case into a folder."""
    for name, data in case.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
