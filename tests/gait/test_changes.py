"""Settings in Python: three spellings of the changes that --set makes, of files and of gaits."""

from __future__ import annotations

import html
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.errors import ConfigError
from mgs.gait import BalanceGait, SequenceGait, WalkGait, list_gaits, load_gait, parse_gait
from mgs.gait.changes import changes_of

GAIT = "melson/walk_5cm"
ASSIGNMENTS = ("walk.n_steps=6", "walk.step_length=0.04", "ik.solver=ik4", "dt=0.02")
SPELLINGS: dict[str, dict[str, Any]] = {
    "dots": {"walk.n_steps": 6, "walk.step_length": 0.04, "ik.solver": "ik4", "dt": 0.02},
    "underscores": {
        "walk__n_steps": 6, "walk__step_length": 0.04, "ik__solver": "ik4", "dt": 0.02
    },
    "dictionaries": {
        "walk": {"n_steps": 6, "step_length": 0.04}, "ik": {"solver": "ik4"}, "dt": 0.02
    },
    "NumPy": {
        "walk": {"n_steps": np.int64(6), "step_length": np.float64(0.04)},
        "ik__solver": np.str_("ik4"),
        "dt": np.array(0.02),
    },
}  # fmt: skip


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_every_spelling_does_what_set_does_on_the_command_line(spelling: str):
    expected = load_gait(GAIT, ASSIGNMENTS)
    assert isinstance(expected, WalkGait) and expected.walk.n_steps == 6
    assert load_gait(GAIT, **SPELLINGS[spelling]) == expected
    assert load_gait(load_gait(GAIT), **SPELLINGS[spelling]) == expected
    assert load_gait(load_gait(GAIT), ASSIGNMENTS) == expected


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
        lambda inner: st.lists(inner) | st.tuples(inner),
    ),
    st.lists(st.from_regex("[a-z]([a-z_]*[a-z])?", fullmatch=True), min_size=1, max_size=4),
)
def test_a_change_holds_the_value_that_was_given(value: object, parts: list[str]):
    """Dots, underscores and nested dictionaries are one key."""
    parts = [part.replace("__", "_") for part in parts]
    nested: Any = value
    for part in reversed(parts[1:]):
        nested = {part: nested}
    found = [
        changes_of((), {key: given})
        for key, given in [
            (".".join(parts), value),
            ("__".join(parts), value),
            (parts[0], nested),
        ]
    ]
    assert found[0] == found[1] == found[2]
    (change,) = found[0]
    assert (change.key, change.block) == (".".join(parts), parts[0])
    assert change.value == plain(value)


def plain(value: Any) -> Any:
    return [plain(entry) for entry in value] if isinstance(value, list | tuple) else value


def test_a_dictionary_leaves_the_other_keys_of_its_block():
    before, after = load_gait(GAIT), load_gait(GAIT, walk={"n_steps": 6})
    assert isinstance(before, WalkGait) and isinstance(after, WalkGait)
    assert after.walk == before.walk.model_copy(update={"n_steps": 6})
    assert after.com == before.com and after.ik == before.ik


def test_lists_and_tuples_replace_lists():
    channels = [{"task": "com_z", "wave": "constant", "value": -0.01}]
    gaits = [load_gait("melson/sway", balance__channels=kind(channels)) for kind in (list, tuple)]
    assert gaits[0] == gaits[1]
    assert isinstance(gaits[0], BalanceGait)
    assert [channel.task for channel in gaits[0].balance.channels] == ["com_z"]


def test_settings_come_after_assignments():
    assert load_gait(GAIT, ("walk.n_steps=3",), walk__n_steps=7).walk.n_steps == 7


def test_settings_of_a_sequence_are_for_its_parts_as_on_the_command_line():
    name = "melson/walk_kick_walk"
    expected = load_gait(name, ("com.passes=1", "sequence.transition=2", "dt=0.02"))
    assert isinstance(expected, SequenceGait)
    assert {part.gait.com.passes for part in expected.sequence.parts} == {1}
    settings: dict[str, Any] = {"com": {"passes": 1}, "sequence__transition": 2, "dt": 0.02}
    assert load_gait(name, **settings) == expected
    assert load_gait(load_gait(name), **settings) == expected


@pytest.mark.parametrize("name", list_gaits())
def test_a_gait_without_changes_is_itself_and_a_change_to_what_it_is_gives_an_equal_one(name: str):
    gait = load_gait(name)
    assert load_gait(gait) is gait
    again = load_gait(gait, dt=gait.dt)
    assert again is not gait and again == gait


def test_a_path_below_a_value_is_refused_by_its_name():
    with pytest.raises(ConfigError, match=r"^settings: 'dt\.fine': "):
        load_gait(GAIT, dt={"fine": 1})
    with pytest.raises(ConfigError, match=r"^settings: 'walk\.' is not of the form"):
        load_gait(GAIT, walk__=1)
    with pytest.raises(ConfigError, match=r"^--set: 'dt\.fine': "):
        load_gait(GAIT, ("dt.fine=1",))


def test_an_object_that_no_file_could_hold_is_refused_with_its_key():
    with pytest.raises(ConfigError, match=r"walk\.n_steps: .*valid integer, found <object"):
        load_gait(GAIT, walk__n_steps=object())


# --- how a gait shows itself ------------------------------------------------------------------


@pytest.mark.parametrize("name", list_gaits())
def test_the_repr_is_one_short_line_and_the_page_is_the_whole_file(name: str):
    gait = load_gait(name)
    assert repr(gait) == str(gait) and len(repr(gait)) < 250 and "\n" not in repr(gait)
    assert repr(gait).startswith(f"<{type(gait).__name__} for {gait.robot or 'any robot'}: ")
    page = gait._repr_html_()
    assert page.startswith("<pre>") and page.endswith("</pre>")
    assert parse_gait(html.unescape(page[5:-6]), "page") == gait


def test_the_repr_shows_what_differs_from_the_defaults():
    gait = load_gait("walk", walk__n_steps=3, ik__gamma_joint=0.125)
    inner = repr(gait).partition(": ")[2].removesuffix(">")
    assert yaml.safe_load(f"{{{inner}}}") == {
        "walk": {"n_steps": 3, "sizes": "robot"},
        "ik": {"gamma_joint": 0.125, "gamma_grav": 0.8},  # the file's solver is the default one
    }


def test_characters_of_html_are_escaped(tmp_path: Path):
    file = tmp_path / "a.yaml"
    file.write_text("{mgs: 1, robot: '<b>&', motion: walk, walk: {n_steps: 2}}")
    assert "&lt;b&gt;&amp;" in load_gait(file)._repr_html_()
