"""Hypothesis strategies of malformed inputs: files of each format, and a command for them."""

from __future__ import annotations

import contextlib
import json
import random
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import yaml
from hypothesis import strategies as st

from mgs.library.manifest import writing
from mgs.library.points import plan_sweep
from mgs.library.run import identity_of, recipe_of
from mgs.motion_file import motion_bytes
from mgs.pipeline.request import generate
from tests.fuzz.case import Case
from tests.fuzz.changes import changed_bytes, changed_text, changed_tree, changed_yaml, shipped
from tests.fuzz.robots import changed_urdf, mjcf, robot, urdf
from tests.support.rewriting import rewritten

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
FREQUENT = [
    ("info", "a.mcap", "--json"), ("validate", "a.mcap", "--physics", "none", "--json"),
    ("export", "a.mcap", "-o", "out.csv"), ("export", "a.mcap", "--cycle", "-o", "out/a.npz"),
]  # fmt: skip
MOTION_COMMANDS = FREQUENT * 4 + [
    ("report", "a.mcap", "-o", "out/a.html"), ("plot", "a.mcap", "-o", "out"),
    ("replay", "a.mcap", "--engine", "mujoco", "--json"),
]  # fmt: skip
TABLE = "walk.step_length,walk.n_steps\n0.03,4\n0.05,6\n"
QUERIES = [
    "speed > 0.1 and survived", "number in [1, 2] or not verdict == 'pass'", "abs(vx) / 2 < 1",
]  # fmt: skip
TOKENS = [
    *("and", "or", "not", "(", ")", "[", "]", "in", "is", "None", "==", "<", "number", "vx", "-"),
    *("abs(", "1e999", "9223372036854775808", "'a'", '"', "\0", "\ud800", "*", "/", "lambda:", ","),
]


def gait(rng: random.Random) -> Case:
    """A gait file, to be generated."""
    text = shipped("gaits", rng.choice(GAITS))
    data = (
        changed_yaml(yaml.safe_load(text), rng)
        if rng.random() < 0.6
        else changed_text(text, rng).encode()
    )
    command = ("generate", "a.yaml", "--robot", "melson", "-o", "out/a.mcap")
    return Case("gait", {"a.yaml": data}, command)


def sweep(rng: random.Random) -> Case:
    """A sweep file, to be planned."""
    return Case(
        "sweep", {"s.yaml": changed_yaml(rng.choice(SWEEPS), rng)}, ("batch", "plan", "s.yaml")
    )


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
    command = rng.choice(MOTION_COMMANDS)
    return Case("motion file", {"a.mcap": data}, command)


def _change_of(rng: random.Random) -> Callable[[Any], None]:
    """Change of one attachment or one value of the metadata."""
    chosen = rng.choice(["gait.yaml", "robot.yaml", "robot.urdf", "metadata"])

    def change(record: Any) -> None:
        name = getattr(record, "name", "")
        if name == chosen and hasattr(record, "data"):
            text = record.data.decode()
            if chosen == "robot.urdf":
                record.data = changed_urdf(text, rng).encode("utf-8", "replace")
            else:
                record.data = changed_yaml(yaml.safe_load(text), rng)
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
    "mjcf": mjcf,
    "sweep": sweep,
    "table": table,
    "motion file": motion_file,
    "query": query,
}


def cases(kind: str) -> st.SearchStrategy[Case]:
    """Strategy of the inputs of a kind; the seed of what is random in one is what it draws."""
    return st.integers(0, 2**64 - 1).map(lambda seed: KINDS[kind](random.Random(seed)))
