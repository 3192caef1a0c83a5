"""Whatever is written into a file or after --set becomes a model or one ConfigError."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.config import read_assignment
from mgs.core.errors import ConfigError, InputError, MgsError
from mgs.core.limits import MAX_FILE, MAX_NESTING
from mgs.core.yaml_text import parse_yaml
from mgs.gait import GAITS, BalanceGait, Gait, WalkGait, load_gait, parse_gait

WALK = "mgs: 1\nmotion: walk\nwalk: {n_steps: 4}\n"


def gait_with(line: str) -> Gait:
    """A gait whose walk block has one more entry."""
    return parse_gait(f"mgs: 1\nmotion: walk\nwalk: {{n_steps: 4, {line}}}", "a.yaml")


def refusal(text: str, *assignments: str) -> str:
    with pytest.raises(ConfigError) as caught:
        parse_gait(text, "a.yaml", assignments)
    return str(caught.value)


# --- values -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("step_length: .nan", "found nan"),
        ("step_length: .inf", "found inf"),
        ("step_length: 1e999", "found inf"),
        ("step_length: true", "found True"),
        ("step_length: yes", "found 'yes'"),
        ('step_length: "0.05"', "found '0.05'"),
        ("step_length: [0.05]", "found [0.05]"),
        ("step_length: 2020-01-01", "found '2020-01-01'"),
        ("step_length: null", "found None"),
        ("step_length: 1.01", "less than or equal to 1 [m], found 1.01"),
        ("step_height: 0", "greater than 0 [m], found 0"),
        ("first_support: Left", "'left' or 'right', found 'Left'"),
        ("zmp_offset: [0.0]", "found [0.0]"),
        ("lead_in: 60.5", "less than or equal to 60 [s], found 60.5"),
        (f"step_length: 0x{'F' * 6000}", "found a number of thousands of digits"),
    ],
)
def test_a_value_of_the_wrong_kind_or_size_is_named_with_its_key(line: str, found: str):
    with pytest.raises(ConfigError) as caught:
        gait_with(line)
    assert str(caught.value).startswith(f"a.yaml: walk.{line.partition(':')[0]}: ")
    assert found in str(caught.value)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("zmp_offset: [0.0, -1.5]", "zmp_offset.1: {} greater than or equal to -1 [m], found -1.5"),
        ("goal: {yaw: 4}", "goal.yaw: {} less than or equal to 3.1416 [rad], found 4"),
        ("boxes: [{x: 0, length: 1, width: 1, height: 2}]", "boxes.0.height: {} less than or equal "
         "to 1 [m], found 2"),
        ("arm_swing: -1.0", "arm_swing: {} greater than or equal to 0, found -1.0"),
    ],
)  # fmt: skip
def test_a_range_is_told_with_the_unit_of_the_key(line: str, message: str):
    """Inside lists and blocks too; a number without a unit has none in the message."""
    told = refusal(f"mgs: 1\nmotion: walk\nwalk: {{{line}}}").splitlines()
    assert "a.yaml: walk." + message.format("input should be") in told


def test_a_decimal_comma_is_refused():
    assert "walk.step_length: " in refusal("mgs: 1\nmotion: walk\nwalk:\n  step_length: 0,05")
    assert "walk.05: " in refusal("mgs: 1\nmotion: walk\nwalk: {n_steps: 2, step_length: 0,05}")


@pytest.mark.parametrize("value", ["3.5", '"3"', "true", "0", "-1", "20001", "1e300"])
def test_a_count_is_a_whole_number_in_its_range(value: str):
    assert "walk.n_steps: " in refusal(f"mgs: 1\nmotion: walk\nwalk: {{n_steps: {value}}}")


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("1e-6", 1e-6),
        ("1E-6", 1e-6),
        ("+2e-3", 2e-3),
        ("1.0e-6", 1e-6),
        ("1.e-2", 1e-2),
        ("1", 1.0),
    ],
)
def test_numbers_are_numbers_with_and_without_a_dot(text: str, number: float):
    assert gait_with(f"step_height: {text}" if number < 0.5 else f"step_length: {text}")
    assert parse_yaml(f"a: {text}", "a.yaml") == {"a": number}
    assert parse_yaml(f"a: -{text.lstrip('+')}", "a.yaml") == {"a": -number}


@pytest.mark.parametrize("text", ["e5", "1e", "1e+", "a1e5", "1e5m", "0x1e-6", "1-e5"])
def test_words_that_look_like_numbers_stay_words(text: str):
    assert parse_yaml(f"a: {text}", "a.yaml") == {"a": text}


# --- keys -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "mgs: 1\nmotion: walk\nwalk: {n_step: 4}",
            "walk.n_step: unknown key; did you mean 'n_steps'?",
        ),
        (WALK + "com: {preveiw: 1.0}", "com.preveiw: unknown key; did you mean 'preview'?"),
        (WALK + "ik: {gama_grav: 1.0}", "ik.gama_grav: unknown key; did you mean 'gamma_grav'?"),
        (WALK + "robt: melson", "robt: unknown key; did you mean 'robot'?"),
        (WALK + "zzz: 1", "zzz: unknown key; known here: com, dt, ik, mgs, motion, robot, walk"),
    ],
)
def test_an_unknown_key_is_refused_with_the_nearest_known_one(text: str, message: str):
    assert f"a.yaml: {message}" in refusal(text)


BALANCE = "mgs: 1\nmotion: balance\nbalance: {duration: 4.0, channels: [%s]}"
SINE = "task: com_y, wave: sine, amplitude: 0.1, frequency: 1.0"
WAVES = "should be one of 'constant', 'sine', 'ramp', 'figure_eight'"


@pytest.mark.parametrize(
    ("channel", "message"),
    [
        (f"{{{SINE}, amplitud: 1.0}}", "0.amplitud: unknown key; did you mean 'amplitude'?"),
        (
            f"{{{SINE}}}, {{{SINE}, zzz: 1.0}}",
            "1.zzz: unknown key; known here: amplitude, frequency, phase, task, wave",
        ),
        (
            "{wave: figure_eight, task: com, width: 0.1, height: 0.1, frequency: 1.0, plan: yz}",
            "0.plan: unknown key; did you mean 'plane'?",
        ),
        ("{task: com_y, amplitude: 0.1}", f"0.wave: missing, {WAVES}"),
        ("{task: com_y, wave: sinus}", f"0.wave: input {WAVES}, found 'sinus'"),
        ("{task: com_y, wave: 3}", f"0.wave: input {WAVES}, found 3"),
        ("{task: com_y, wave: [sine]}", f"0.wave: input {WAVES}, found ['sine']"),
        ("{task: com_y, wave: null}", f"0.wave: input {WAVES}, found None"),
        ("{task: com_y, wave: sine, amplitude: 0.1}", "0.frequency: missing, it has no default"),
        (
            "{task: com_y, wave: constant, value: far}",
            "0.value: input should be a valid number, found 'far'",
        ),
        ("sine", "0: input should be a valid dictionary, found 'sine'"),
    ],
)
def test_what_is_wrong_in_a_list_of_several_kinds_is_told_as_anywhere_else(
    channel: str, message: str
):
    """By keys of the file alone, and with the keys that the entry's own kind knows."""
    assert refusal(BALANCE % channel) == f"a.yaml: balance.channels.{message}"


def test_a_long_value_of_the_key_that_names_the_kind_is_cut():
    message = refusal(BALANCE % f'{{task: com_y, wave: "{"x" * 5000}\\e[31m"}}')
    assert len(message) < 250 and message.isprintable()


@pytest.mark.parametrize("motion", ["fly", "3", "[walk]", "Walk"])
def test_an_unknown_motion_is_refused_with_those_that_there_are(motion: str):
    for block, key in (
        ("walk: {n_step: 2}", "walk.n_step"),
        ("balance: {rst: 1.0}", "balance.rst"),
        ("keyframes: {rst: 1.0}", "keyframes.rst"),
        ("pick_up: {objct: 1.0}", "pick_up.objct"),
    ):
        lines = refusal(f"mgs: 1\nmotion: {motion}\n{block}").splitlines()
        *others, last = [repr(kind) for kind in GAITS]
        listed = f"{', '.join(others)} or {last}, found {yaml.safe_load(motion)!r}"
        assert f"a.yaml: motion: input should be {listed}" in lines
        assert any(line.startswith(f"a.yaml: {key}: unknown key; did you mean") for line in lines)


@pytest.mark.parametrize("block", ["walk: {n_steps: 2}", "balance: {duration: 4.0}"])
def test_a_motion_is_never_guessed(block: str):
    assert "a.yaml: motion: missing, it has no default" in refusal(f"mgs: 1\n{block}")


def test_every_problem_is_told_at_once():
    message = refusal("mgs: 2\nmotion: fly\nwalk: {n_steps: 0, step_lenght: 0.1}\ndt: 7.0")
    for key in ("mgs: ", "motion: ", "walk.n_steps: ", "walk.step_lenght: ", "dt: "):
        assert f"a.yaml: {key}" in message


def test_messages_are_short_and_hold_nothing_that_a_terminal_would_obey():
    message = refusal(f'mgs: 1\nmotion: "{chr(92)}e[31m"\n"{chr(92)}x07": 1\nwalk: "{"x" * 9999}"')
    lines = message.splitlines()
    assert all(line.isprintable() for line in lines)
    assert "\\x1b[31m" in message and "\\x07" in message
    assert max(map(len, lines)) < 250


def test_a_missing_key_is_named():
    assert "a.yaml: balance.duration: missing" in refusal("mgs: 1\nmotion: balance\nbalance: {}")
    assert "a.yaml: mgs: missing" in refusal("motion: walk\nwalk: {n_steps: 2}")


@pytest.mark.parametrize("text", [WALK + "mgs: 1\n", "a: 1\n'a': 2", "{b: {c: 1, c: 1}}"])
def test_a_key_given_twice_is_refused_with_its_line(text: str):
    message = refusal(text)
    assert "appears twice" in message
    assert "line " in message


# --- files ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text", ["", "# only a comment\n", "5", "walk", "[1, 2]", "- a\n- b", "null"]
)
def test_a_file_without_keys_at_the_top_is_refused(text: str):
    message = refusal(text)
    assert "expected keys and values at the top level" in message
    assert ("found nothing" in message) == (text in ("", "# only a comment\n", "null"))


@pytest.mark.parametrize(
    "text",
    [
        "a: [1",
        "a: b: c",
        "\ta: 1",
        "a: 'open",
        "a: 1\n---\nb: 2",
        "a: \x00",
        "%YAML 9.9\n---\na: 1",
        "{[1]: 2}",
        "<<: 5",
        "a: 2020-13-45",
        "=",
    ],
)
def test_broken_yaml_is_refused(text: str):
    assert refusal(text).startswith("a.yaml: ")


def test_a_syntax_error_is_told_with_line_and_column():
    assert refusal("mgs: 1\nmotion: walk\nwalk: {n_steps: 2").startswith("a.yaml: line 3, column ")


@pytest.mark.parametrize(
    "text",
    [
        "!!int ''",
        "!!bool x",
        "!!timestamp x",
        "!!map [1]",
        "!!set [a]",
        "!!python/name:os.system ''",
    ],
)
def test_tags_are_refused(text: str):
    assert "YAML tags" in refusal(f"mgs: {text}")
    assert "YAML tags" in refusal(text)


def test_a_billion_laughs_are_refused_before_they_fill_memory():
    lines = ["a: &a [lol, lol, lol, lol, lol, lol, lol, lol, lol]"]
    for new, old in zip("bcdefghi", "abcdefgh", strict=True):
        lines.append(f"{new}: &{new} [{', '.join([f'*{old}'] * 9)}]")
    tracemalloc.start()
    try:
        assert "aliases" in refusal("\n".join(lines))
        assert tracemalloc.get_traced_memory()[1] < 10e6  # [bytes]; expanded it would be 3e9
    finally:
        tracemalloc.stop()
    assert "aliases" in refusal("&a [*a]")


@pytest.mark.parametrize("text", ["[" * 100_000, "{a: " * 50_000, "- " * 50_000, "? " * 50_000])
def test_deep_nesting_is_refused_without_recursion(text: str):
    assert f"deeper than {MAX_NESTING} levels" in refusal(text)


@pytest.mark.parametrize("data", [b"\xff\xfe\x00\x01", b"\x89MCAP0\r\n\x00", bytes(range(256)) * 9])
def test_a_binary_file_is_refused(tmp_path: Path, data: bytes):
    path = tmp_path / "gait.yaml"
    path.write_bytes(data)
    with pytest.raises(ConfigError, match=r"gait\.yaml"):
        load_gait(path)


def test_a_huge_file_is_refused_unread(tmp_path: Path):
    path = tmp_path / "gait.yaml"
    with path.open("wb") as stream:
        stream.truncate(50 * MAX_FILE)
    tracemalloc.start()
    try:
        with pytest.raises(ConfigError, match="larger than 1000 kB"):
            load_gait(path)
        assert tracemalloc.get_traced_memory()[1] < 5 * MAX_FILE
    finally:
        tracemalloc.stop()


def test_a_file_with_a_byte_order_mark_and_foreign_line_ends_is_read(tmp_path: Path):
    path = tmp_path / "gait.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + WALK.replace("\n", "\r\n").encode())
    assert load_gait(path).walk.n_steps == 4


@pytest.mark.parametrize(
    "name", ["nowhere", "", ".", "..", "/", "a" * 5000, "a\0b", "../pyproject"]
)
def test_a_gait_that_is_nowhere_is_refused_with_the_command_that_lists_gaits(name: str):
    with pytest.raises(ConfigError, match="mgs gait list"):
        load_gait(name)


def test_a_folder_is_no_gait(tmp_path: Path):
    with pytest.raises(ConfigError, match="no such file"):
        load_gait(tmp_path)


def test_config_errors_are_input_errors_with_exit_code_two():
    error = ConfigError(Path("a.yaml"), ["x: bad", "y: bad"])
    assert isinstance(error, InputError) and isinstance(error, MgsError)
    assert (error.exit_code, error.source, error.problems) == (2, "a.yaml", ["x: bad", "y: bad"])
    assert str(error) == "a.yaml: x: bad\na.yaml: y: bad"


# --- --set ------------------------------------------------------------------------------------


def test_assignments_change_keys_and_make_missing_groups():
    gait = parse_gait(
        WALK, "a.yaml", ("walk.n_steps=30", "ik.gamma_joint=0", " com.weight_jerk = 1e-8")
    )
    assert (gait.walk.n_steps, gait.ik.gamma_joint, gait.com.weight_jerk) == (30, 0.0, 1e-8)


def test_the_last_assignment_wins_and_values_may_hold_equals_signs():
    assert parse_gait(WALK, "a", ("walk.n_steps=3", "walk.n_steps=5")).walk.n_steps == 5
    assert read_assignment("a.b=c=d") == ("a.b", "c=d")


@pytest.mark.parametrize(
    "assignment",
    [
        "",
        "=",
        "=1",
        "walk",
        "walk.n_steps",
        ".n_steps=2",
        "walk.=2",
        "walk..n_steps=2",
        "walk.n_steps.x=2",
        "walk.n_steps=",
        "walk.n_steps=[",
        "walk.n_steps=*a",
        "walk.n_steps=!!int 2",
        "walk.n_steps=3.5",
        "walk.n_step=3",
        "walk=[1]",
        "walk=",
        "mgs=2",
        f"walk.com_height{'.x' * 5000}=1",
        f"walk.n_steps={'[' * 5000}",
    ],
)
def test_a_bad_assignment_is_refused(assignment: str):
    refusal(WALK, assignment)


@pytest.mark.parametrize("text", ["", "5", "[1]", "- walk", "walk: 3", "walk: [1]", "walk: null"])
def test_assignments_to_a_file_without_that_group_are_refused(text: str):
    assert "there is no such group of keys" in refusal(text, "walk.n_steps=3")


# --- anything ---------------------------------------------------------------------------------

WORDS = ["mgs", "motion", "walk", "n_steps", "ik", "solver", "clik", "com", "dt", "left", "robot"]
SCALARS = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=8)
    | st.sampled_from(WORDS)
    | st.dates()
)
TREES = st.recursive(
    SCALARS,
    lambda children: (
        st.lists(children, max_size=4)
        | st.dictionaries(
            st.sampled_from(WORDS) | SCALARS.filter(lambda x: x == x), children, max_size=5
        )
    ),
    max_leaves=25,
)


def parses_or_is_refused(text: str, *assignments: str) -> None:
    try:
        gait = parse_gait(text, "a.yaml", assignments)
    except ConfigError as error:
        assert str(error)
    else:
        assert isinstance(gait, Gait)


@given(st.text(max_size=200))
def test_any_text_is_a_gait_or_a_config_error(text: str):
    parses_or_is_refused(text)


@given(st.text(alphabet="{}[]:,-?&*!|>'\"%@`#=~.0123456789eExo_+<\n\t abn", max_size=60))
def test_any_text_of_yaml_signs_is_a_gait_or_a_config_error(text: str):
    parses_or_is_refused(text)
    parses_or_is_refused(WALK + text)
    parses_or_is_refused(WALK, f"walk.step_length={text}", text)


@given(TREES)
def test_any_tree_is_a_gait_or_a_config_error(tree: object):
    parses_or_is_refused(yaml.safe_dump(tree))


@given(
    st.dictionaries(
        st.sampled_from(sorted({*WalkGait.model_fields, *BalanceGait.model_fields})), TREES
    )
)
def test_any_tree_below_the_known_keys_is_a_gait_or_a_config_error(tree: dict[str, object]):
    parses_or_is_refused(
        yaml.safe_dump({"mgs": 1, "motion": "walk", "walk": {"n_steps": 2}} | tree)
    )


@given(st.binary(max_size=200))
def test_any_bytes_in_a_file_are_a_gait_or_a_config_error(tmp_path_factory, data: bytes):
    path = tmp_path_factory.mktemp("fuzz", numbered=True) / "gait.yaml"
    path.write_bytes(data)
    try:
        load_gait(path)
    except ConfigError as error:
        assert "gait.yaml" in str(error)


@given(st.text(max_size=40), st.text(max_size=10))
def test_any_assignment_is_a_gait_or_a_config_error(text: str, key: str):
    parses_or_is_refused(WALK, text)
    parses_or_is_refused(WALK, f"walk.{key}={text}")
    parses_or_is_refused(WALK, f"{key}.{key}=1")
