"""Sequences as files: named gaits are read and changed, and the outcome holds everything."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.errors import ConfigError
from mgs.gait import SequenceGait, load_gait, parse_gait

INLINE = "gait: {mgs: 1, motion: walk, walk: {n_steps: 2}}"


def sequence(*parts: str, head: str = "robot: melson") -> str:
    lines = "\n".join(f"    - {{{part}}}" for part in parts)
    return f"mgs: 1\n{head}\nmotion: sequence\nsequence:\n  parts:\n{lines}\n"


def load(tmp_path: Path, *parts: str, assignments: tuple[str, ...] = ()) -> SequenceGait:
    (tmp_path / "a.yaml").write_text(sequence(*parts))
    gait = load_gait(tmp_path / "a.yaml", assignments)
    assert isinstance(gait, SequenceGait)
    return gait


def refusal(tmp_path: Path, *parts: str) -> str:
    with pytest.raises(ConfigError) as caught:
        load(tmp_path, *parts)
    return str(caught.value)


def test_a_named_gait_takes_the_place_of_its_name_with_its_changes(tmp_path: Path):
    change = "gait: melson/walk_5cm, set: {walk.n_steps: 4, ik: {solver: ik4}}, repeat: 3"
    part = load(tmp_path, change).sequence.parts[0]
    alone = load_gait("melson/walk_5cm", ("walk.n_steps=4", "ik={solver: ik4}"))
    assert (part.gait, part.repeat, part.label) == (alone, 3, "melson/walk_5cm")


def test_paths_are_relative_to_the_file_and_not_to_the_working_directory(
    tmp_path: Path, monkeypatch
):
    (tmp_path / "walks").mkdir()
    (tmp_path / "walks/mine.yaml").write_text("mgs: 1\nmotion: walk\nwalk: {n_steps: 7}")
    monkeypatch.chdir("/")
    part = load(tmp_path, "gait: walks/mine.yaml").sequence.parts[0]
    assert part.gait == load_gait(tmp_path / "walks/mine.yaml")


def test_a_gait_written_in_place_takes_robot_and_dt_of_the_sequence():
    text = sequence(INLINE, head="robot: coman\ndt: 0.005")
    gait = parse_gait(text, "a.yaml")
    assert isinstance(gait, SequenceGait)
    assert [(p.gait.robot, p.gait.dt, p.label) for p in gait.sequence.parts] == [
        ("coman", 0.005, "walk")
    ]


@pytest.mark.parametrize("name", ["melson/walk_turn_walk", "melson/figure_eight"])
def test_a_resolved_sequence_is_read_back_without_any_other_file(name: str):
    gait = load_gait(name)
    assert parse_gait(gait.to_yaml(), "resolved") == gait


def test_a_sequence_without_a_folder_names_no_other_file():
    """As in a motion file, which somebody else may have made."""
    with pytest.raises(
        ConfigError, match=r"sequence\.parts\.0: gait: 'melson/walk_5cm' is another"
    ):
        parse_gait(sequence("gait: melson/walk_5cm"), "a.mcap: gait.yaml")


def test_assignments_reach_the_sequence_its_parts_or_both(tmp_path: Path):
    gait = load(
        tmp_path, INLINE, "gait: melson/walk_5cm",
        assignments=("sequence.transition=0.5", "walk.n_steps=3", "dt=0.02", "robot=coman"),
    )  # fmt: skip
    assert (gait.sequence.transition, gait.dt, gait.robot) == (0.5, 0.02, "coman")
    for part in gait.sequence.parts:
        assert (part.gait.walk.n_steps, part.gait.dt, part.gait.robot) == (3, 0.02, "coman")


def test_the_com_tolerance_is_the_widest_of_a_part(tmp_path: Path):
    wide = "gait: melson/sway, set: {balance.com_tolerance: 0.003}"
    assert load(tmp_path, INLINE, wide).com_tolerance == 0.003


@pytest.mark.parametrize(
    ("part", "words"),
    [
        ("gait: nowhere", "sequence.parts.1: nowhere: no such file and no gait of that name"),
        ("gait: melson/walk_turn_walk", "a sequence cannot be part of a sequence; list its parts"),
        (
            "gait: coman/walk",
            "sequence.parts.1 (coman/walk): made for the robot coman, but the sequence for",
        ),
        ("gait: melson/sway, set: {dt: 0.02}", "sequence.parts.1 (melson/sway): dt = 0.02 s"),
        ("gait: melson/sway, set: 3", "sequence.parts.1: set: input should be keys and values"),
        ("gait: melson/sway, set: {walk..x: 3}", "sequence.parts.1: set: 'walk..x' is not of the"),
        ("gait: melson/sway, set: {dt.x: 3}", "sequence.parts.1: set: 'dt.x': there is no such"),
        ("gait: melson/sway, set: {dtt: 3}", "sequence.parts.1.gait.dtt: unknown key"),
        ("gait: melson/sway, repeat: 0", "sequence.parts.1.repeat: input should be greater"),
        (
            "gait: melson/sway, repeat: 1000",
            "sequence: 1001 parts with their repetitions; at most 1000 allowed",
        ),
        ("gait: melson/sway, times: 2", "sequence.parts.1.times: unknown key"),
        ("gait: {motion: fly}", "sequence.parts.1.gait.motion: input should be one of 'walk'"),
        ("gait: 3", "sequence.parts.1.gait: input should be a valid dictionary, found 3"),
        ("repeat: 2", "sequence.parts.1.gait: missing"),
        ("gait: melson/walk_5cm, set: {walk.step_yaw: 9}", "sequence.parts.1.gait.walk.step_yaw"),
    ],
)  # fmt: skip
def test_a_part_that_is_wrong_is_named(part: str, words: str, tmp_path: Path):
    message = refusal(tmp_path, INLINE, part)
    assert words in message
    assert all(line.startswith(f"{tmp_path / 'a.yaml'}: ") for line in message.splitlines())


def test_a_malformed_file_that_a_part_names_is_named_too(tmp_path: Path):
    (tmp_path / "b.yaml").write_text("mgs: [")
    message = refusal(tmp_path, "gait: b.yaml")
    assert message.startswith(
        f"{tmp_path / 'a.yaml'}: sequence.parts.0: {tmp_path / 'b.yaml'}: line"
    )


@pytest.mark.parametrize(
    "block", ["", "sequence: 3", "sequence: {}", "sequence: {parts: []}", "sequence: {parts: 3}"]
)
def test_a_sequence_without_parts_is_refused(block: str):
    with pytest.raises(ConfigError, match=r"a\.yaml: sequence"):
        parse_gait(f"mgs: 1\nmotion: sequence\n{block}", "a.yaml")


WORDS = st.sampled_from(
    ["gait", "set", "repeat", "name", "parts", "motion", "walk", "n_steps", "mgs", "dt", "robot"]
)
VALUES = st.sampled_from(
    ["melson/walk_5cm", "melson/walk_turn_walk", "walk", "sequence", "nowhere", 1, 2.5, None, True]
)
TREES = st.recursive(
    VALUES | st.integers(-3, 3) | st.text(max_size=4),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(WORDS | st.text(max_size=3), inner, max_size=4)
        | st.fixed_dictionaries({"gait": inner}, optional={"set": inner, "repeat": inner})
    ),
    max_leaves=8,
)


@given(TREES | TREES.map(lambda tree: {"parts": [tree]}))
def test_whatever_stands_in_a_sequence_it_is_one_or_a_config_error(tree):
    text = yaml.safe_dump({"mgs": 1, "robot": "melson", "motion": "sequence", "sequence": tree})
    try:
        gait = parse_gait(text, "a.yaml", folder=Path())
    except ConfigError as error:
        assert all(line.startswith("a.yaml: ") for line in str(error).splitlines())
    else:
        assert parse_gait(gait.to_yaml(), "resolved") == gait
