"""Gait files that are wrong for certain, as bytes: one strategy for each way to go wrong."""

from __future__ import annotations

import copy
import math
from typing import Any

import yaml
from hypothesis import strategies as st

VALID: dict[str, Any] = {
    "mgs": 1,
    "robot": "melson",
    "motion": "walk",
    "dt": 0.01,
    "walk": {
        "n_steps": 4,
        "step_length": 0.05,
        "lateral": 0.0,
        "step_yaw": 0.0,
        "step_width": 0.1,
        "first_support": "left",
        "lead_in": 1.8,
        "double_support": 0.3,
        "single_support": 0.5,
        "lead_out": 1.8,
        "step_height": 0.02,
        "com_height": 0.28,
        "zmp_offset": [0.0, 0.0],
        "hands": "free",
    },
    "com": {"generator": "preview", "preview": 1.6, "weight_error": 1.0, "weight_jerk": 1e-8},
    "ik": {
        "solver": "clik",
        "gamma_joint": 0.35,
        "gamma_grav": 0.0,
        "gamma_grav_ramp": 0.2,
        "gamma_momentum": 0.5,
        "double_support": "shared",
        "iterations": 3,
        "torso": "free",
        "on_limit": "refuse",
    },
}
Path = tuple[str, ...]
LEAVES: list[Path] = [
    (*group, key)
    for group in ((), ("walk",), ("com",), ("ik",))
    for key, value in (VALID[group[0]] if group else VALID).items()
    if not isinstance(value, dict)
]


def at(path: Path) -> Any:
    node = VALID
    for key in path:
        node = node[key]
    return node


NUMBERS = [path for path in LEAVES if isinstance(at(path), float)]
COUNTS: list[Path] = [("walk", "n_steps"), ("ik", "iterations")]
CHOICES: list[Path] = [
    ("motion",),
    ("walk", "first_support"),
    ("ik", "solver"),
    ("ik", "double_support"),
    ("ik", "on_limit"),
]
REQUIRED: list[Path] = [("mgs",), ("robot",), ("motion",), ("walk",), ("walk", "n_steps")]
SIGNED: list[Path] = [("walk", "step_length"), ("walk", "lateral"), ("walk", "step_yaw")]
POSITIVE = [path for path in [*NUMBERS, *COUNTS] if path not in SIGNED]
BLOCKS: list[Path] = [(), ("walk",), ("com",), ("ik",)]
TEXT = st.text(max_size=20)
LONG_TEXT = st.text(min_size=1, max_size=3).map(lambda text: text * 3000)


def written(tree: Any) -> bytes:
    return yaml.safe_dump(tree, sort_keys=False, allow_unicode=True).encode()


def changed(path: Path, value: Any) -> bytes:
    """The valid file with another value at one place."""
    tree = copy.deepcopy(VALID)
    node = tree
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value
    return written(tree)


def without(path: Path) -> bytes:
    tree = copy.deepcopy(VALID)
    node = tree
    for key in path[:-1]:
        node = node[key]
    del node[path[-1]]
    return written(tree)


VALID_BYTES = written(VALID)


@st.composite
def missing(draw: st.DrawFn) -> bytes:
    return without(draw(st.sampled_from(REQUIRED)))


@st.composite
def unknown(draw: st.DrawFn) -> bytes:
    """Another key in a block: an invented one, a misspelt one, or one of another block."""
    block = draw(st.sampled_from(BLOCKS))
    own = set(at(block))
    foreign = sorted({path[-1] for path in LEAVES} - own)
    misspelt = st.sampled_from(sorted(own)).map(lambda key: key[1:] + key[0])
    key = draw(st.sampled_from(foreign) | misspelt | TEXT | LONG_TEXT)
    return changed((*block, key if key not in own else key + "_"), draw(st.floats() | TEXT))


@st.composite
def wrong_type(draw: st.DrawFn) -> bytes:
    """A text where a number belongs, a fraction where a count belongs, a group, a list ..."""
    path = draw(st.sampled_from([*LEAVES, *BLOCKS[1:]]))
    if path == ("robot",):  # any text may name a robot
        return changed(path, draw(st.booleans() | st.integers() | st.floats() | st.dates()))
    wrong = st.booleans() | st.dates() | st.dictionaries(TEXT, TEXT, min_size=1, max_size=3)
    if path != ("walk", "zmp_offset"):
        wrong |= st.lists(st.floats(), max_size=3)
    else:
        wrong |= st.lists(st.floats(-1, 1), max_size=1) | st.lists(TEXT, min_size=2)
    if path in CHOICES:
        wrong |= st.integers() | st.floats() | TEXT.map(lambda text: f"not a choice {text}")
    else:
        wrong |= TEXT | LONG_TEXT
    if path in COUNTS:
        wrong |= st.floats(1.0, 20.0)
    return changed(path, draw(wrong))


@st.composite
def not_finite(draw: st.DrawFn) -> bytes:
    return changed(
        draw(st.sampled_from([*NUMBERS, *COUNTS])), draw(st.sampled_from([math.nan, math.inf]))
    )


@st.composite
def negative(draw: st.DrawFn) -> bytes:
    path = draw(st.sampled_from(POSITIVE))
    whole, broken = st.integers(max_value=-1), st.floats(max_value=-1e-300, allow_infinity=False)
    return changed(path, draw(whole if path in COUNTS else broken))


@st.composite
def huge(draw: st.DrawFn) -> bytes:
    """Numbers beyond every range of the format, up to thousands of digits."""
    path = draw(st.sampled_from([*NUMBERS, *COUNTS, ("mgs",)]))
    if path in (*COUNTS, ("mgs",)):
        return changed(path, draw(st.integers(20_001, 10**18) | st.integers(1, 999).map(power)))
    return changed(path, draw(st.floats(1.1e12, allow_infinity=False) | st.just(10**400)))


def power(exponent: int) -> int:
    return 20_001 * 10**exponent


@st.composite
def contradictory(draw: st.DrawFn) -> bytes:
    """Values that are each in range, but not together."""
    tree = copy.deepcopy(VALID)
    kind = draw(st.sampled_from(["rest", "samples", "closing step"]))
    if kind == "rest":
        tree["walk"]["lead_out"] = draw(st.floats(0.1, 1.5))
    elif kind == "samples":
        tree["walk"]["n_steps"] = draw(st.integers(10_000, 20_000))
        tree["dt"] = draw(st.floats(1e-4, 1e-3))
    else:
        tree["walk"]["n_steps"] = 1
    return written(tree)


@st.composite
def deep(draw: st.DrawFn) -> bytes:
    """Nested far deeper than any file of ours, at the top or in some value."""
    levels = draw(st.integers(40, 2000))
    opening = draw(st.sampled_from(["[", "{a: ", "- ", "? ", "[{a: "]))
    at_top = f"{opening * levels}".encode()
    key = draw(st.sampled_from([path[-1] for path in LEAVES]))
    flow = "[{" if opening in ("- ", "? ") else opening
    inside = VALID_BYTES + f"x_{key}: {flow * levels}\n".encode()
    return draw(st.sampled_from([at_top, inside]))


@st.composite
def binary(draw: st.DrawFn) -> bytes:
    """Bytes that no text has, alone or in the middle of the valid file."""
    stray = draw(st.sampled_from([b"\x00", b"\xff", b"\xc0\x80", b"\x1b", b"\xed\xa0\x80"]))
    place = draw(st.integers(0, len(VALID_BYTES)))
    inserted = VALID_BYTES[:place] + stray + VALID_BYTES[place:]
    image = b"\x89PNG\r\n\x1a\n" + draw(st.binary(max_size=300))
    motion_file = b"\x89MCAP0\r\n" + draw(st.binary(max_size=300))
    return draw(st.sampled_from([inserted, image, motion_file]))


@st.composite
def broken_yaml(draw: st.DrawFn) -> bytes:
    """Text that YAML does not know, or that we refuse to read: tags, aliases, repeated keys."""
    key = draw(st.sampled_from(sorted(VALID)))
    value = yaml.safe_dump({key: VALID[key]}).encode()
    bad = [
        *(b"\n\tx: 1\n", b"'open\n", b"x: [1\n", b"x: b: c\n", b"---\nmgs: 1\n", b"}\n", b"x\n"),
        *(b"x: !!int ''\n", b"x: &a 1\ny: *a\n", b"x: *nowhere\n", b"%YAML 9\n", b"<<: 5\n"),
        *(b"x: !!python/object/apply:os.system [ls]\n", b"{[1]: 2}\n", b"x: 2020-99-99\n"),
        value,  # a block that is there already
    ]
    return VALID_BYTES + draw(st.sampled_from(bad))


@st.composite
def no_mapping(draw: st.DrawFn) -> bytes:
    """Anything but keys and values at the top."""
    scalars = st.none() | st.booleans() | st.integers() | st.floats() | TEXT
    return written(draw(scalars | st.lists(scalars, max_size=30)))


@st.composite
def many_problems(draw: st.DrawFn) -> bytes:
    """Wrong in more places than can be told."""
    count, length = draw(st.integers(21, 100)), draw(st.integers(1, 30))
    return written(VALID | {f"{'key ' * length}{i}": i for i in range(count)})


KINDS = {
    "missing": missing(),
    "unknown": unknown(),
    "wrong type": wrong_type(),
    "not finite": not_finite(),
    "negative": negative(),
    "huge": huge(),
    "contradictory": contradictory(),
    "deep": deep(),
    "binary": binary(),
    "broken YAML": broken_yaml(),
    "no mapping": no_mapping(),
    "many problems": many_problems(),
    "too large a file": st.integers(1_000_001, 2_000_000).map(lambda n: VALID_BYTES + b"#" * n),
}
