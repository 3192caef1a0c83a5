"""Tests of mgs tune: files, messages and exit codes; walks are judged by a formula."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mgs.gait import WalkGait, load_gait
from mgs.search.tune import compare, study
from mgs.search.tune.evaluate import STAGES, Found
from mgs.search.tune.space import steady_speed
from tests.search.tune.support import by_formula
from tests.support.commands import run

pytest.importorskip("optuna")
pytest.importorskip("mujoco")
WALK = ("tune", "melson/walk_practical", "--objective", "robust", "--physics", "mujoco")
FEW = ("--trials", "5", "--final-draws", "0")
FIXED = {
    "walk.n_steps": 3,
    "walk.single_support": 0.5,
    "walk.double_support": 0.5,
    "walk.com_height": 0.26,
    "walk.swing_profile": "minimum_jerk",
    "walk.step_width": 0.095,
    "walk.zmp_offset": [0.0, 0.0],
    "walk.zmp_travel": 0.0,
    "walk.arm_swing": 0.0,
    "com.margin": 0.02,
    "com.weight_jerk": 1e-4,
    "ik.gamma_joint": 0.35,
    "ik.gamma_grav": 0.0,
    "walk.lead_in": 1.8,  # rests, in which the knee bears less
    "walk.lead_out": 1.8,
}
PINNED = tuple(text for key, value in FIXED.items() for text in ("--pin", f"{key}={value}"))


@pytest.fixture(autouse=True)
def _formula(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "evaluate", by_formula)
    monkeypatch.setattr(compare, "_failed", lambda *_: [])  # what replays would say


def test_the_best_walk_is_written_with_a_page_and_a_picture(tmp_path: Path):
    path = tmp_path / "new" / "tuned.yaml"
    result = run(*WALK, *FEW, *PINNED, "-o", path, "--speed", "0.05", "--json")
    told = json.loads(result.stdout)
    assert result.exit_code == 0, told["after"]
    assert set(told) == {
        "json_version",
        "file", "objective", "robot", "trials", "seconds", "best", "importance", "before", "after",
    }  # fmt: skip
    gait = load_gait(path)
    assert isinstance(gait, WalkGait)
    assert gait.walk.n_steps == 3
    assert steady_speed(gait) == pytest.approx(0.05, rel=1e-3)
    assert told["after"]["figures"]["speed"] == pytest.approx(0.05, rel=1e-2)
    text = path.read_text()
    assert "# before: " in text
    page = path.with_suffix(".md").read_text()
    for words in ("## Before and after", "cost of transport", "`walk.landing`", "tuned.png"):
        assert words in page
    assert path.with_suffix(".png").read_bytes().startswith(b"\x89PNG")
    again = run(*WALK, *FEW, "-o", path)
    assert again.exit_code == 1
    assert "use --force" in again.output
    assert path.read_text() == text
    assert run("generate", path, "-o", tmp_path / "walk.mcap").exit_code == 0


def test_an_interrupted_search_is_continued_on_request_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    calls = []

    def cut_off(*arguments: object) -> Found:
        calls.append(arguments)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return Found(-3.5, STAGES[1], "joint_speed")

    monkeypatch.setattr(study, "evaluate", cut_off)
    path = tmp_path / "tuned.yaml"
    cut = run(*WALK, *FEW, "-o", path)
    assert cut.exit_code == 1
    assert "interrupted after 2 walks" in cut.output
    assert path.with_suffix(".journal").exists()
    assert not path.exists()
    again = run(*WALK, *FEW, "-o", path)
    assert again.exit_code == 1
    assert "--resume continues" in again.output
    other = run(*WALK, *FEW, "-o", path, "--resume", "--seed", "1")
    assert other.exit_code == 2
    rest = run(*WALK, *FEW, "-o", path, "--resume")
    assert rest.exit_code == 1
    assert "none of 5 walks passes; no gait file was written" in rest.output
    assert "5 failed at checks, most of them: joint_speed" in rest.output
    assert not path.exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("tune", "melson/kick", "--objective", "robust"), "only a walk"),
        ((*WALK, "--physics", "none"), "needs replays"),
        ((*WALK, "--pin", "walk.nothing=1"), "no such key"),
        ((*WALK, "--resume"), "does not exist"),
        (("tune", "melson/walk_practical"), "--objective"),
        (("tune", "melson/walk_practical", "--objective", "speed", "--speed", "1"), "--speed"),
    ],
)
def test_wrong_usage_exits_with_code_2_before_any_work(
    arguments: tuple[str, ...], words: str, tmp_path: Path
):
    result = run(*arguments, "-o", tmp_path / "x.yaml")
    assert result.exit_code == 2
    assert words in result.output
    assert list(tmp_path.iterdir()) == []


def test_nothing_but_a_regular_file_is_replaced_and_that_is_told_before_any_work(tmp_path: Path):
    path, precious = tmp_path / "x.yaml", tmp_path / "precious"
    precious.write_text("precious")
    for name in ("x.yaml", "x.md", "x.png", "x.journal"):
        link = tmp_path / name
        link.symlink_to(precious)
        result = run(*WALK, *FEW, "-o", path, "--force")
        assert result.exit_code == 1
        assert f"{name}: a link, which is never replaced" in result.output
        link.unlink()
    assert [file.name for file in tmp_path.iterdir()] == ["precious"]
    assert precious.read_text() == "precious"


def test_force_keeps_the_old_journal_if_the_new_search_cannot_begin(tmp_path: Path):
    journal = tmp_path / "x.journal"
    journal.write_text("precious")
    result = run(*WALK, *FEW, "-o", tmp_path / "x.yaml", "--force", "--pin", "walk.nothing=1")
    assert result.exit_code == 2
    assert journal.read_text() == "precious"


def test_the_gait_has_another_name_than_the_files_beside_it(tmp_path: Path):
    for ending in ("md", "png", "journal"):
        result = run(*WALK, *FEW, "-o", tmp_path / f"x.{ending}")
        assert result.exit_code == 2
        assert "use the ending .yaml" in result.output
    assert not list(tmp_path.iterdir())
