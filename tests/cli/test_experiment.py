"""Tests of mgs experiment: claims as JSON or text; a claim that fails is not an error."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mgs.experiments import Claim
from tests.support.commands import files_below, run, run_process

KEYS = {"id", "claim", "figure", "holds", "note"}
HOLDS = Claim("first", "one is one", "1.000", True, values={"one": 1.0})
FAILS = Claim("second", "one is two", 1.0, False, note="it is not")
OTHER = Claim("third", "robots like it", "unknown", "not applicable")


def play(monkeypatch: pytest.MonkeyPatch, claims: list[Claim]) -> None:
    """Replace the experiment by one with these claims and one figure."""

    def found(name: str, folder: Path | None, progress: object) -> list[Claim]:
        assert name == "melson"
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "figure.png").write_bytes(b"")
        return claims

    monkeypatch.setattr("mgs.experiments.run", found)


@pytest.mark.parametrize("claims", [[HOLDS, OTHER], [HOLDS, FAILS], [OTHER]])
def test_claims_as_json(monkeypatch, tmp_path: Path, claims: list[Claim]):
    play(monkeypatch, claims)
    monkeypatch.chdir(tmp_path)
    result = run("experiment", "melson", "--json", "--no-figures")
    assert (result.exit_code, result.stderr) == (0, "")
    printed = json.loads(result.stdout)
    assert printed["experiment"] == "melson"
    assert [claim["holds"] for claim in printed["claims"]] == [claim.holds for claim in claims]
    assert all(set(claim) >= KEYS for claim in printed["claims"])
    assert files_below(tmp_path) == {}


def test_claims_in_words(monkeypatch):
    play(monkeypatch, [HOLDS, FAILS, OTHER])
    result = run("experiment", "melson", "--no-figures")
    assert (result.exit_code, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    assert [line.split()[0] for line in lines] == ["holds", "FAILS", "it", "n/a"]


@pytest.mark.parametrize(
    ("options", "folder"), [((), "outputs/experiments/melson"), (("-o", "figures"), "figures")]
)
def test_figures_are_written_to_the_given_folder(monkeypatch, tmp_path: Path, options, folder: str):
    play(monkeypatch, [HOLDS])
    monkeypatch.chdir(tmp_path)
    result = run("experiment", "melson", *options)
    assert result.exit_code == 0
    assert list(files_below(tmp_path)) == [f"{folder}/figure.png"]
    assert result.stdout.splitlines()[-1] == f"figures in {folder}"


def test_a_real_experiment_prints_json_and_nothing_else(tmp_path: Path):
    done = run_process("experiment", "preview", "--json", "--no-figures", cwd=tmp_path)
    printed = json.loads(done.stdout)
    assert (printed["experiment"], done.returncode) == ("preview", 0)
    assert all(set(claim) >= KEYS for claim in printed["claims"])
    assert done.stderr == b""
    assert files_below(tmp_path) == {}


def test_the_generator_of_a_gait_is_analysed(tmp_path: Path):
    folder = tmp_path / "figures"
    result = run("experiment", "preview", "--gait", "melson/s1", "-o", folder)
    assert result.exit_code == 0
    assert result.stdout.count("pole: ") == 4 and "step response of the ZMP" in result.stdout
    assert set(files_below(folder)) == {"design.png"}
    told = json.loads(run("experiment", "preview", "--gait", "melson/walk_practical",
                          "--no-figures", "--json").stdout)  # fmt: skip
    assert told["generator"] == "qp" and told["poles"] == [] and told["gain_gap"] is None


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("melson", "--gait", "coman/walk"), "--gait needs the experiment preview"),
        (("preview", "--robot", "coman"), "--robot needs --gait"),
        (("preview", "--gait", "coman/walk", "--sensitivity"), "exclude each other"),
        (("preview", "--gait", "melson/bow"), "no generator of a CoM motion"),
        (("preview", "--gait", "nowhere"), "no such file"),
    ],
)
def test_a_gait_that_cannot_be_analysed_is_bad_input(arguments: tuple[str, ...], complaint: str):
    result = run("experiment", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert complaint in result.stderr
