"""mgs.validate: what it judges, in which engines, what it refuses; and how a verdict looks."""

from __future__ import annotations

import dataclasses
import json
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.errors import ConfigError, MotionFileError, SimulationError
from mgs.judge.motion_checks import Check, check_motion
from mgs.judge.validate import validate
from mgs.judge.verdict import Verdict
from mgs.motion import Motion
from mgs.motion_file import write_motion
from mgs.pipeline.request import generate
from mgs.sim import available_engines, replay
from tests.support.commands import run

SETTINGS: dict[str, Any] = {
    "com.preview": 0.8, "walk.lead_in": 0.8, "walk.lead_out": 0.8, "walk.n_steps": 2
}  # fmt: skip
needs_mujoco = pytest.mark.skipif("mujoco" not in available_engines(), reason="needs MuJoCo")


@pytest.fixture(scope="module")
def walk() -> Motion:
    return generate("melson", "melson/walk_practical", **SETTINGS)


@pytest.fixture(scope="module")
def bent(walk: Motion) -> Motion:
    """The walk with its first joint beyond its range."""
    q = walk.q.copy()
    q[:, FLOATING_BASE_NQ] = walk.robot.upper[0] + 0.1
    return dataclasses.replace(walk, q=q)


def told(verdict: dict[str, Any]) -> dict[str, Any]:
    """A verdict as JSON, without the name of the motion and the time that replays took."""
    plain = json.loads(json.dumps(verdict))
    del plain["file"]
    for only_of_the_command in ("json_version", "engines_missing"):
        plain.pop(only_of_the_command, None)
    for figures in plain["replays"]:
        del figures["wall_seconds"]
    return plain


def without_physics(motion: Motion) -> Verdict:
    return validate(motion, physics="none")


@needs_mujoco
@pytest.mark.parametrize(
    ("options", "arguments"),
    [
        (("--physics", "none"), {"physics": "none"}),
        (("--physics", "mujoco"), {"physics": ["mujoco"]}),
        (("--physics", "mujoco", "--servo", "model"), {"physics": "mujoco", "servo": "model"}),
        (
            ("--physics", "mujoco", "--servo", "ideal,pd", "--sag", "2"),
            {"physics": "mujoco", "servo": ["ideal", "pd"], "sag_deg": 2.0},
        ),
        (
            ("--physics", "mujoco", "--servo", "ideal", "--sample", "3"),
            {"physics": "mujoco", "servo": "ideal", "sample": 3},
        ),
        (
            ("--physics", "mujoco", "--monte-carlo", "2", "--ranges", "lab", "--seed", "5"),
            {"physics": "mujoco", "monte_carlo": 2, "ranges": "lab", "seed": 5},
        ),
    ],
)
@pytest.mark.slow_if("arguments1", "arguments5")
def test_the_verdict_is_that_of_the_command(
    walk: Motion, tmp_path: Path, options: tuple[str, ...], arguments: dict[str, Any]
):
    file = write_motion(walk, tmp_path / "walk.mcap")
    command = json.loads(run("validate", file, *options, "--json").stdout)
    of_file, of_motion = validate(file, **arguments), validate(walk, **arguments)
    assert told(of_file.to_dict()) == told(of_motion.to_dict()) == told(command)
    assert (command["file"], of_file.file, of_motion.file) == (
        *(str(file), str(file)),
        "walk_practical",
    )


@pytest.mark.slow
def test_without_a_word_every_engine_that_is_installed_replays_the_motion(walk: Motion):
    engines = available_engines()
    assert engines
    replays = [(found.servo, found.engine) for found in validate(walk).replays]
    assert replays == [(servo, engine) for servo in ("ideal", "pd") for engine in engines]


@needs_mujoco
def test_a_verdict_holds_the_checks_and_replays_that_were_made(walk: Motion):
    verdict = validate(walk, physics="mujoco")
    alone = replay(walk, "mujoco")
    assert verdict.checks[: len(check_motion(walk))] == tuple(check_motion(walk))
    assert np.array_equal(verdict.replays[0].trace.q, alone.trace.q)


@pytest.mark.parametrize("physics", ["none", [], ()])
def test_without_physics_there_are_static_checks_alone(walk: Motion, physics: Any):
    verdict = validate(walk, physics=physics)
    assert verdict.replays == () and verdict.checks == tuple(check_motion(walk))


def test_progress_names_each_step(walk: Motion):
    calls: list[tuple[str, int, int]] = []
    engines = available_engines()[-1:]
    servos = ("ideal", "pd")
    tell = lambda *call: calls.append(call)  # noqa: E731
    validate(walk, physics=engines, servo=servos, monte_carlo=1, progress=tell)
    steps = list(dict.fromkeys(step for step, _, _ in calls))
    assert steps == [
        "static checks",
        *(f"{engines[0]}, {kind} servos" for kind in servos),
        f"{engines[0]}, 1 random replays",
    ]
    assert all(0 <= done <= total for _, done, total in calls)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"physics": "bullet"}, "physics: 'bullet' is not a list of physics engines; use pybullet"),
        ({"physics": ["mujoco", "mujoco"]}, "physics: 'mujoco, mujoco' is not a list"),
        ({"physics": ""}, "physics: '' is not a list"),
        ({"servo": "perfect"}, "servo: 'perfect' is unknown; use ideal"),
        ({"servo": []}, "servo: '' is unknown; use ideal"),
        ({"servo": "ideal", "sag_deg": 2.0}, "sag_deg: only PD servos have it"),
        ({"servo": "pd", "sag_deg": 0.0}, "sag_deg: 0 is outside the range 0.01 to 90 deg"),
        (
            {"servo": "ideal", "feed_forward": True},
            "feed_forward: ideal servos have no position error",
        ),
        ({"ranges": "huge"}, "ranges: 'huge' is unknown; use wide or lab"),
        ({"monte_carlo": 0}, "monte_carlo: should be a whole number, at least 1; found 0"),
        ({"monte_carlo": 1.5}, "monte_carlo: should be a whole number"),
        ({"workers": 0}, "workers: should be a whole number, at least 1; found 0"),
        ({"seed": -1}, "seed: should be a whole number, at least 0; found -1"),
        ({"sample": "a"}, "sample: should be a whole number, at least 0; found 'a'"),
    ],
)
def test_a_wrong_value_is_refused_before_any_work(arguments: dict[str, Any], message: str):
    """The motion file that does not exist would be the next to be complained of."""
    with pytest.raises(ConfigError, match=message):
        validate("nowhere.mcap", **arguments)


def test_a_motion_file_that_is_not_there_is_named():
    with pytest.raises(MotionFileError, match=r"nowhere\.mcap"):
        validate("nowhere.mcap", physics="none")


def test_where_no_engine_is_installed_physics_has_to_be_declined(walk: Motion, monkeypatch):
    monkeypatch.setattr("mgs.sim.choice.available_engines", lambda: ())
    with pytest.raises(SimulationError, match="install mujoco or pybullet"):
        validate(walk)
    assert without_physics(walk).passed


# --- how a verdict looks ----------------------------------------------------------------------


class Table(HTMLParser):
    """Rows of cells of a table, entities resolved, and its caption."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.caption, self.open, self.bold = "", list[str](), list[bool]()
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
            self.bold.append("font-weight: bold" in (dict(attrs).get("style") or ""))
        elif tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1] == "caption":
            self.caption += data
        else:
            assert self.open[-1] in ("td", "th")
            self.rows[-1][-1] += data


def test_a_verdict_names_what_fails(walk: Motion, bent: Motion):
    good, bad = without_physics(walk), without_physics(bent)
    assert good.passed and good.failed == ()
    assert repr(good) == f"<Verdict on walk_practical: pass, {len(good.checks)} checks, no physics>"
    assert bad.failed == tuple(check.name for check in bad.checks if not check.ok)
    assert "joint_position" in bad.failed
    assert f"fail: {', '.join(bad.failed)}; {len(bad.failed)} of" in repr(bad)


def test_the_table_of_a_verdict_has_a_row_for_each_check(bent: Motion):
    verdict = without_physics(bent)
    table = Table(verdict._repr_html_())
    head, *rows = table.rows
    assert table.open == [] and len(head) == 7
    assert [row[1] for row in rows] == [check.name for check in verdict.checks]
    assert table.bold[1:] == [not check.ok for check in verdict.checks]
    assert [row[0] == "✓" for row in rows] == [check.ok for check in verdict.checks]
    for row, check in zip(rows, verdict.checks, strict=True):
        assert float(row[2]) == pytest.approx(check.value, rel=1e-3)
        assert float(row[3]) == pytest.approx(check.limit, rel=1e-3)
        assert (row[4], row[6]) == (check.unit, check.where)
    assert table.caption == f"{verdict.file}: {repr(verdict).partition(': ')[2].removesuffix('>')}"


def test_names_that_look_like_html_stay_text():
    check = Check("<b>", True, 1.0, 2.0, "a & b", None, "<script>")
    table = Table(Verdict("<i>.mcap", (check,), ())._repr_html_())
    assert table.caption.startswith("<i>.mcap: ")
    assert table.rows[1] == ["✓", "<b>", "1", "2", "a & b", "", "<script>"]
