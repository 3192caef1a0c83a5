from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import pytest

from mgs.core.errors import MgsError, OutputExistsError
from mgs.report.canvas import DPI, Figure, Format, new_figure, save_figures


def a_figure() -> Figure:
    figure = new_figure(4.0, 3.0)
    axes = figure.subplots()
    axes.plot([0.0, 1.0, 2.0], [1.0, 0.0, 2.0], label="a line")
    axes.legend()
    return figure


@pytest.mark.parametrize("fmt", ["png", "svg"])
def test_the_same_figure_gives_the_same_bytes(tmp_path: Path, fmt: Format) -> None:
    first = save_figures({"a": a_figure()}, tmp_path / "first", fmt)[0]
    second = save_figures({"a": a_figure()}, tmp_path / "second", fmt)[0]
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.parametrize("few_colours", [False, True])
def test_a_png_has_the_size_of_its_figure(tmp_path: Path, few_colours: bool) -> None:
    path = save_figures({"a": a_figure()}, tmp_path, few_colours=few_colours)[0]
    image = matplotlib.image.imread(io.BytesIO(path.read_bytes()), format="png")
    assert image.shape[:2] == (3 * DPI, 4 * DPI)
    assert image[..., :3].std() > 0.05  # not a blank page


def test_nothing_is_written_if_one_file_exists(tmp_path: Path) -> None:
    (tmp_path / "b.png").write_text("mine")
    figures = {"a": a_figure(), "b": a_figure()}
    with pytest.raises(OutputExistsError, match=r"b\.png"):
        save_figures(figures, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["b.png"]
    save_figures(figures, tmp_path, force=True)
    assert (tmp_path / "b.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.png", "b.png"]


def test_a_folder_that_cannot_be_created_is_an_mgs_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(MgsError, match="cannot be written"):
        save_figures({"a": a_figure()}, tmp_path / "file" / "folder")


def test_a_failed_write_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", refuse)
    with pytest.raises(MgsError, match="no space left"):
        save_figures({"a": a_figure()}, tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("module", "absent"),
    [
        ("mgs.report", "matplotlib.pyplot"),  # it would hold global state
        ("mgs.experiments", "matplotlib"),  # it would slow every command down
        ("mgs.experiments", "control"),
    ],
)
def test_imports_exclude_slow_or_stateful_modules(module: str, absent: str) -> None:
    code = f"import {module}, sys; sys.exit({absent!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
