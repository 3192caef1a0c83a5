"""Conditions: their meaning, compared with Python, and the refusal of everything else."""

from __future__ import annotations

import sqlite3

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.errors import ConfigError
from mgs.library.condition import compile_condition

FIGURES = {"speed": 0.25, "n": 3, "walk.step_length": 0.05, "survived": 1, "robot": "melson"}


def holds(text: str, figures: dict[str, float | str | None] | None = None) -> bool:
    """What SQLite makes of the compiled condition."""
    figures = figures or dict(FIGURES)
    sql, parameters = compile_condition(text, list(figures), "--where")
    columns = ", ".join(f'? AS "{name}"' for name in figures)
    with sqlite3.connect(":memory:") as connection:
        query = f"SELECT {sql} FROM (SELECT {columns})"
        (value,) = connection.execute(query, (*parameters, *figures.values())).fetchone()
    connection.close()
    return bool(value)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("speed > 0.1 and survived", True),
        ("speed > 0.1 and not survived", False),
        ("walk.step_length / n < 0.02", True),
        ("1 / 2 > 0.4", True),  # in SQL 1 / 2 is 0
        ("0.1 < speed <= 0.25 < 1", True),
        ("robot == 'melson' or speed > 9", True),
        ("robot in ['coman', 'talos']", False),
        ("n not in (1, 2)", True),
        ("abs(-speed) == speed", True),
        ("survived is None", False),
        ("speed / 0 > 1", False),
        ("True", True),
    ],
)
def test_conditions_have_the_expected_truth_values(text: str, expected: bool):
    assert holds(text) is expected


def test_comparisons_with_missing_values_are_not_true():
    figures = {"survived": None, "speed": 0.2}
    assert not holds("survived", figures)
    assert not holds("not survived", figures)
    assert holds("survived is None", figures)


numbers = st.sampled_from(["speed", "n", "0.5", "2", "-3", "survived"])
terms = st.recursive(
    numbers,
    lambda inner: st.builds("({} {} {})".format, inner, st.sampled_from("+-*"), inner),
    max_leaves=5,
)
comparisons = st.builds(
    "({} {} {})".format, terms, st.sampled_from(["<", "<=", ">", ">=", "==", "!="]), terms
)
conditions = st.recursive(
    comparisons,
    lambda inner: st.one_of(
        st.builds("({} {} {})".format, inner, st.sampled_from(["and", "or"]), inner),
        st.builds("(not {})".format, inner),
    ),
    max_leaves=6,
)


@given(conditions)
def test_python_evaluates_conditions_to_the_same_result(text: str):
    """The oracle is Python's own eval, on a text made here."""
    names = {key: value for key, value in FIGURES.items() if "." not in key}
    assert holds(text) == bool(eval(text, {"__builtins__": {}}, names))


@pytest.mark.parametrize(
    "text",
    [
        *("", "speed >", "speed = 0.1", "speed; n", "import os", "lambda: 1", "[speed]"),
        *("__import__('os').system('true')", "open('x')", "speed.real()", "abs(speed, n)"),
        *("abs(speed)(n)", "n ** 99", "f'{speed}'", "n if n else n", "speed > 1j", "n[0]"),
        *("'a' in robot", "n in survived", "b'x' == robot", "99999999999999999999 > n"),
        *("(" * 300 + "n" + ")" * 300, "-" * 1500 + "n", "n" * 3000, "n\0", "(n := 2)", "~n"),
    ],
)
def test_expressions_outside_the_grammar_are_refused(text: str):
    with pytest.raises(ConfigError, match="--where"):
        compile_condition(text, list(FIGURES), "--where")


@given(st.text(max_size=60))
def test_any_text_compiles_or_raises_a_config_error(text: str):
    try:
        compile_condition(text, list(FIGURES), "--where")
    except ConfigError as error:
        assert error.source == "--where"


def test_sqlite_accepts_the_deepest_allowed_nesting():
    for depth in range(1, 100):
        text = "(not (n < " * depth + "1" + "))" * depth
        try:
            holds(text)
        except ConfigError:
            break
    else:
        pytest.fail("no limit")
    assert depth > 8


def test_an_unknown_name_is_reported_with_all_known_names():
    with pytest.raises(ConfigError) as caught:
        compile_condition("sped > 1", list(FIGURES), "--where")
    told = str(caught.value)
    assert "no column 'sped'" in told
    assert "did you mean 'speed'?" in told
    assert all(name in told for name in FIGURES)


def test_names_are_quoted_and_strings_are_parameters():
    name = 'odd"name'
    sql, parameters = compile_condition("robot == 'x\\' OR 1=1 --'", ["robot", name], "--where")
    assert sql == '(("robot" = ?))'
    assert parameters == ["x' OR 1=1 --"]
