"""Tests of mgs.plot and figures in a notebook: PNGs without pyplot, files as by `mgs plot`."""

from __future__ import annotations

import base64
import dataclasses
import io
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.text import Text
from PIL import Image

from mgs.core.errors import ConfigError, OutputExistsError
from mgs.motion import Motion
from mgs.motion_file import write_motion
from mgs.pipeline import Stages
from mgs.report import MOTION_PLOTS, picture_strip, plot, write_picture
from tests.support.commands import files_below, run


@pytest.fixture(scope="module")
def motion(walk_5cm: Stages) -> Motion:
    return walk_5cm.motion


def pixels(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))


def test_figures_are_saved_as_the_command_writes_them(motion: Motion, tmp_path: Path):
    file = write_motion(motion, tmp_path / "walk.mcap")
    assert run("plot", file, "-o", tmp_path / "command").exit_code == 0
    paths = plot(file).save(tmp_path / "ours")
    assert [path.stem for path in paths] == list(MOTION_PLOTS)
    assert files_below(tmp_path / "ours") == files_below(tmp_path / "command")
    with pytest.raises(OutputExistsError):
        plot(motion, "above").save(tmp_path / "ours")


def test_single_plots_are_selected_by_name(motion: Motion):
    assert list(plot(motion, "above")) == ["above"]
    assert list(plot(motion, ["joint_torques", "balance"])) == ["joint_torques", "balance"]
    with pytest.raises(ConfigError, match=r"names: 'below' is not a plot; use above, balance"):
        plot(motion, "below")


def test_every_plot_has_a_title_with_gait_robot_and_verdict(motion: Motion):
    wrong = dataclasses.replace(motion, q=motion.q.copy())
    wrong.q[50, -1] = motion.robot.upper[-1] + 0.1
    for shown, verdict in ((motion, "static checks pass"), (wrong, "fails joint_position, ")):
        for name, figure in plot(shown).items():
            figure.draw_without_rendering()
            (title,) = (
                t for t in figure.findobj(Text) if t.get_text().startswith(f"{motion.gait_name} of")
            )
            assert f"{motion.gait_name} of melson, 12.0 s: {verdict}" in title.get_text().replace(
                "\n", " "
            )
            left, low, right, high = title.get_window_extent().extents
            assert left >= 0.0 and right <= figure.bbox.width and high <= figure.bbox.height
            others = [*figure.texts, *(t for legend in figure.legends for t in legend.get_texts())]
            others += [
                t for axes in figure.axes for t in axes.get_children() if isinstance(t, Text)
            ]
            for other in others:
                box = other.get_window_extent().extents
                beside = box[0] >= right or box[2] <= left or box[1] >= high or box[3] <= low
                assert beside or other is title, (name, other.get_text())


def test_the_html_contains_every_figure(motion: Motion):
    figures = plot(motion, ["above", "balance"])
    assert repr(figures) == "<Figures: above, balance>"
    images = re.findall(
        r'<img alt="(\w+)" src="data:image/png;base64,([\w+/=]+)"/>', figures._repr_html_()
    )
    assert [name for name, _ in images] == ["above", "balance"]
    for name, data in images:
        shown = plot(motion, name)[name]._repr_png_()  # drawn anew: the layout moves with each time
        assert np.array_equal(pixels(base64.b64decode(data)), pixels(shown))
        assert pixels(shown).std() > 10.0  # no empty page


def test_the_picture_of_a_motion_is_its_picture_strip(motion: Motion, tmp_path: Path):
    expected = write_picture(motion, tmp_path / "strip.png").read_bytes()
    assert motion._repr_png_() == expected
    strip = picture_strip(motion)
    width, height = strip.get_size_inches() * strip.dpi
    assert pixels(expected).shape[:2] == (int(height), int(width))  # matplotlib cuts off fractions


def test_without_matplotlib_a_notebook_shows_the_repr_of_a_motion():
    code = (
        "import sys, mgs; sys.modules['matplotlib'] = None; "
        "print(mgs.generate('melson', 'melson/bow')._repr_png_())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout) == (0, "None\n"), done.stderr


def test_displaying_figures_neither_imports_pyplot_nor_selects_a_backend(tmp_path: Path):
    code = (
        "import sys, mgs; m = mgs.generate('melson', 'melson/bow'); m._repr_png_(); "
        "mgs.plot(m)._repr_html_(); print('matplotlib.pyplot' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=120
    )
    assert (done.returncode, done.stdout) == (0, "False\n"), done.stderr
