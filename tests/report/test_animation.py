"""Moving pictures and strips, and the commands that write them."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mgs.core.errors import ConfigError, MgsError, OutputExistsError
from mgs.motion import Motion
from mgs.report.animation import animate
from mgs.report.picture import VIEW, _strip_layout, picture_strip, pose_samples, title_line
from mgs.report.robot_drawing import box_corners
from tests.report.page.conftest import walk
from tests.support.commands import run
from tests.support.shipped import generated

__all__ = ["walk"]  # fixture


@pytest.fixture(autouse=True)
def few_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Five frames per second, so that the tests take less time."""
    monkeypatch.setattr("mgs.report.animation.RATE", {".gif": 5.0, ".mp4": 5.0})


@pytest.fixture(scope="module")
def file(walk: Motion, tmp_path_factory: pytest.TempPathFactory) -> Path:
    from mgs.motion_file import write_motion

    return write_motion(walk, tmp_path_factory.mktemp("walk") / "walk.mcap")


def test_a_moving_picture_runs_in_real_time_and_moves(walk: Motion, tmp_path: Path):
    with Image.open(animate(walk, tmp_path / "walk.gif", title="a walk")) as picture:
        n = picture.n_frames
        assert (n - 1) * picture.info["duration"] == pytest.approx(
            1000 * walk.duration, abs=200
        )  # a frame
        assert picture.info["loop"] == 0
        frames = []
        for k in (0, n // 2):
            picture.seek(k)
            frames.append(np.asarray(picture.convert("RGB"), dtype=np.int16))
    assert len(np.unique(frames[0].reshape(-1, 3), axis=0)) > 10
    assert (np.abs(frames[1] - frames[0]).max(axis=2) > 30).mean() > 0.02


def test_a_moving_picture_overwrites_nothing_and_has_a_known_ending(walk: Motion, tmp_path: Path):
    (tmp_path / "walk.gif").write_text("mine")
    with pytest.raises(OutputExistsError):
        animate(walk, tmp_path / "walk.gif")
    with pytest.raises(ConfigError, match=r"\.gif or \.mp4"):
        animate(walk, tmp_path / "walk.avi")


def test_without_ffmpeg_no_mp4_is_promised(
    walk: Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(MgsError, match=r"ffmpeg, .* write a \.gif, or install .*mgs\[mp4\]"):
        animate(walk, tmp_path / "walk.mp4")


@pytest.mark.parametrize("command", ["plot", "replay"])
def test_an_mp4_runs_in_real_time(command: str, file: Path, walk: Motion, tmp_path: Path):
    """As another program counts: the one that imageio-ffmpeg brings."""
    counter = pytest.importorskip("imageio_ffmpeg", reason="imageio-ffmpeg is not installed")
    path = tmp_path / "walk.mp4"
    options = {"plot": ("--animate", path), "replay": ("--engine", "mujoco", "--record", path)}
    assert run(command, file, *options[command]).exit_code == 0
    frames, seconds = counter.count_frames_and_secs(str(path))
    tail = {"plot": 0.0, "replay": 1.0}[command]  # [s] for which the last posture is held
    assert seconds == pytest.approx(walk.duration + tail, abs=0.4)  # two frames
    assert frames == pytest.approx(5.0 * seconds, abs=1)


@pytest.mark.parametrize("name", ["melson/get_up", "melson/wave", "melson/walk_practical"])
def test_no_pose_of_a_strip_is_cut_off_or_covers_another_one_that_lies(name: str):
    motion = generated(name).stages.motion
    samples = pose_samples(motion, 8)
    places, (left, right), (bottom, top) = _strip_layout(motion, samples)
    last = -np.inf
    for place, sample in zip(places, samples, strict=True):
        points = motion.soles[sample, :, :3] if motion.gait.is_balanced else motion.com[[sample]]
        middle = VIEW.project(points.mean(axis=0) * [1.0, 1.0, 0.0])
        corners = VIEW.project(box_corners(motion.robot, motion.q[sample]).reshape(-1, 3)) - middle
        assert left <= corners[:, 0].min() + place and corners[:, 0].max() + place <= right
        assert bottom <= corners[:, 1].min() and corners[:, 1].max() <= top
        if not motion.gait.is_balanced:
            assert corners[:, 0].min() + place > last
        last = corners[:, 0].max() + place


def test_a_motion_on_the_spot_shows_its_joints():
    strip, _, joints = picture_strip(generated("melson/wave").stages.motion, verdict="good").axes
    assert strip.get_title(loc="left") == "melson/wave of melson, 7.0 s: good"
    assert len(joints.get_lines()) == 6
    assert any("shoulder" in str(line.get_label()) for line in joints.get_lines())


def test_plot_writes_strip_and_moving_picture(file: Path, walk: Motion, tmp_path: Path):
    strip, moving = tmp_path / "strip.png", tmp_path / "walk.gif"
    result = run("plot", file, "--strip", strip, "--animate", moving)
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.splitlines() == [str(strip), str(moving)]
    assert not file.with_suffix("").exists()  # no other plot
    assert run("plot", file, "--strip", strip).exit_code == 1
    assert run("plot", file, "--strip", tmp_path / "a.jpg").exit_code == 2
    assert title_line(walk) == f"short walk of melson, {walk.duration:.1f} s"


def test_replay_records_by_the_ending_of_the_file(file: Path, tmp_path: Path):
    picture = tmp_path / "replay.png"
    assert run("replay", file, "--engine", "mujoco", "--record", picture).exit_code == 0
    with Image.open(picture) as drawn:
        assert drawn.size[0] > 800
    assert run("replay", file, "--engine", "mujoco", "--record", picture).exit_code == 1
    assert run("replay", file, "--record", tmp_path / "a.txt").exit_code == 2
