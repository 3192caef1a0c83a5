"""Moving pictures of a robot: GIF by Pillow, or MP4 by the program ffmpeg.

The program is the one on the path, or else the one in the package imageio-ffmpeg.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from mgs.core.arrays import Array
from mgs.core.atomic_files import part_of, refuse_taken, replace_file
from mgs.core.contact import Side
from mgs.core.errors import ConfigError, MgsError
from mgs.core.progress import Progress
from mgs.motion import Motion
from mgs.report.canvas import FAINT, GREEN, INK, PURPLE, SIDE_COLOURS, TICK, style_axes
from mgs.report.ground import footstep_corners
from mgs.report.robot_drawing import box_corners, draw_robot, view_from
from mgs.report.scenery import NEARBY, draw_scene

VIEW = view_from(-58.0, 14.0)
FORMATS = (".gif", ".mp4")
RATE = {".gif": 12.5, ".mp4": 25.0}  # frames per second; a GIF counts in hundredths of a second
MOST_FRAMES = 2000
WIDTH, DPI = 5.0, 90  # [inch], dots per inch
COLOURS = 64  # of a GIF


def animate(
    motion: Motion,
    output: Path,
    *,
    title: str = "",
    force: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Write a moving picture of a motion in real time, seen from the front right.

    Args:
        motion: the motion; its footsteps, CoM and ZMP are drawn.
        output: file to write, with the ending .gif or .mp4.
        title: text above the picture.
        force: replace an existing file.
        progress: called with frames done and frames in all.

    Raises:
        ConfigError: the ending of the file is not known, or the motion is too long.
        MgsError: ffmpeg, which makes MP4 files, is not installed or fails.
        OutputExistsError: the file exists and `force` is False.
    """
    rate = check_output(output, force)
    step = 1.0 / (rate * motion.dt)
    samples = np.unique(np.arange(0, motion.n_samples - 1 + step, step).round().astype(np.intp))
    samples = samples[samples < motion.n_samples]
    if len(samples) > MOST_FRAMES:
        raise ConfigError(
            output, f"would have {len(samples)} frames, at most {MOST_FRAMES} are possible; write "
            "a page instead by mgs report"
        )  # fmt: skip
    frames = _frames(motion, samples, title, progress)
    if output.suffix == ".gif":
        replace_file(output, _gif(frames, rate))
    else:
        _mp4(frames, rate, output)
    return output


def check_output(output: Path, force: bool) -> float:
    """Frames per second of a file that can be written; see `animate` for the errors."""
    if output.suffix not in FORMATS:
        raise ConfigError(output, f"the name of a moving picture ends in {' or '.join(FORMATS)}")
    if output.suffix == ".mp4" and _ffmpeg() is None:
        raise MgsError(
            f"{output}: ffmpeg, which makes MP4 files, is not installed; write a .gif, or install "
            "ffmpeg, or the package imageio-ffmpeg by pip install 'mgs[mp4]'"
        )
    refuse_taken(output, force)
    return RATE[output.suffix]


def _frames(
    motion: Motion, samples: NDArray[np.intp], title: str, progress: Progress | None
) -> Iterator[Image.Image]:
    q, unit = motion.q, float(motion.com[:, 2].max())
    reach = np.array([_extent(motion, q[k]) for k in samples[:: max(1, len(samples) // 40)]])
    low, high = reach[:, 0].min(axis=0), reach[:, 1].max(axis=0)
    low, high = low - 0.25 * unit, high + 0.2 * unit
    half = max(0.5 * (high[0] - low[0]), 1.6 * unit)
    size = (WIDTH, WIDTH * float(high[1] - low[1]) / (2.0 * half) + 0.3)
    for done, k in enumerate(samples):
        figure = Figure(figsize=size, dpi=DPI, facecolor="white")
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0 - 0.3 / size[1]))
        middle = VIEW.project(_place(q[k]))[0]
        axes.set(xlim=(middle - half, middle + half), ylim=(low[1], high[1]))
        _draw(axes, motion, int(k))
        text = f"{title}   {k * motion.dt:.1f} s".strip()
        figure.text(0.02, 1.0 - 0.15 / size[1], text, fontsize=TICK, color=INK, va="center")
        stream = io.BytesIO()
        figure.savefig(stream, format="png")
        if progress is not None:
            progress(done + 1, len(samples))
        yield Image.open(stream).convert("RGB")


def _place(q: Array) -> Array:
    """Point (3,) on the ground below the base."""
    return np.array([q[0], q[1], 0.0])


def _extent(motion: Motion, q: Array) -> Array:
    """Least and largest picture coordinates (2, 2) of the robot, x relative to its place [m]."""
    points = VIEW.project(box_corners(motion.robot, q).reshape(-1, 3))
    points[:, 0] -= VIEW.project(_place(q))[0]
    return np.array([points.min(axis=0), points.max(axis=0)])


def _draw(axes: Axes, motion: Motion, sample: int) -> None:
    q = motion.q[sample]
    style_axes(axes)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_axis_off()
    for side in Side:
        for corners in footstep_corners(motion)[side]:
            outline = VIEW.project(np.column_stack([corners, np.zeros(4)]))
            axes.fill(*outline.T, facecolor=(SIDE_COLOURS[side], 0.15), edgecolor=FAINT, lw=0.5)
    radius = 8.0 * NEARBY * float(motion.com[:, 2].max())
    draw_scene(axes, motion.scene, VIEW, _place(q), radius, np.zeros(2), sample * motion.dt)
    draw_robot(axes, motion.robot, q, VIEW)
    if not motion.gait.is_balanced:
        return
    for point, colour in (
        (motion.com[sample], PURPLE),
        (np.append(motion.zmp[sample], 0.0), GREEN),
    ):
        axes.plot(*VIEW.project(point), marker="o", color=colour, markeredgecolor="white", zorder=5)


def _gif(frames: Iterator[Image.Image], rate: float) -> bytes:
    """GIF that repeats for ever; all frames share the palette of the first one."""
    pictures = list(frames)
    palette = pictures[0].quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    first, *others = (p.quantize(palette=palette, dither=Image.Dither.NONE) for p in pictures)
    stream = io.BytesIO()
    first.save(
        stream, "gif", save_all=True, append_images=others, duration=round(1000 / rate), loop=0,
        optimize=True, disposal=1,
    )  # fmt: skip
    return stream.getvalue()


def _ffmpeg() -> str | None:
    """Path of the program ffmpeg; None where there is none."""
    found = shutil.which("ffmpeg")
    if found is None and importlib.util.find_spec("imageio_ffmpeg") is not None:
        import imageio_ffmpeg

        with contextlib.suppress(RuntimeError):  # a package without a program for this machine
            found = str(imageio_ffmpeg.get_ffmpeg_exe())
    return found


def _mp4(frames: Iterator[Image.Image], rate: float, output: Path) -> None:
    output.parent.mkdir(parents=True, exist_ok=True)
    program = _ffmpeg()
    assert program is not None  # check_output has looked
    part = part_of(output)
    command = [
        program, "-loglevel", "error", "-y", "-f", "image2pipe", "-framerate", f"{rate:g}",
        "-i", "-", "-pix_fmt", "yuv420p", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-f", "mp4",
        str(part),
    ]  # fmt: skip
    try:
        with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            assert process.stdin is not None and process.stderr is not None
            for frame in frames:
                frame.save(process.stdin, "bmp")
            process.stdin.close()
            told = process.stderr.read().decode(errors="replace").strip()
        if process.returncode:
            raise MgsError(f"{output}: ffmpeg fails: {told}")
        part.replace(output)
    finally:
        part.unlink(missing_ok=True)
