"""Moving pictures of shipped gaits and of robots of others, for the pages of the site.

    python website/moving_pictures.py                      all of them
    python website/moving_pictures.py melson/kick          some of them
    python website/moving_pictures.py walk@robots/talos    of a robot folder

Writes docs/gallery/ROBOT-GAIT.gif. Small pictures at a low rate, so that a page with many of them
stays light: each has less than 300 kB.
"""

from __future__ import annotations

import io
import itertools
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageSequence

from mgs import generate
from mgs.core.atomic_files import replace_file
from mgs.report.animation import animate

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "gallery"
PICTURES = (
    "melson/walk_to_pose",
    "melson/walk_sideways",
    "melson/walk_rolling",
    "melson/kick",
    "melson/pick_up",
    "melson/get_up",
    "melson/obstacle",
    "coman/stairs",
    "melson/turn_in_place",
    "coman/wave",
    "coman_legs/squat_stretched",
)
WIDTH, COLOURS = 300, 24  # [px]
EVERY = (2, 3, 4)  # frame of the animation that is kept; later ones for long motions
MOST_BYTES = 300_000


def small(path: Path, every: int) -> bytes:
    """Every second, third... frame of a GIF at a small size, with the same duration."""
    frames, duration = [], 0
    with Image.open(path) as picture:
        duration = every * int(picture.info["duration"])
        for page in itertools.islice(ImageSequence.Iterator(picture), 0, None, every):
            frame = page.convert("RGB")
            size = (WIDTH, round(WIDTH * frame.height / frame.width))
            frames.append(frame.resize(size, Image.Resampling.LANCZOS))
    palette = frames[0].quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    first, *others = (f.quantize(palette=palette, dither=Image.Dither.NONE) for f in frames)
    stream = io.BytesIO()
    first.save(
        stream, "gif", save_all=True, append_images=others, duration=duration, loop=0,
        optimize=True, disposal=1,
    )  # fmt: skip
    return stream.getvalue()


def main(names: list[str]) -> None:
    """Write the pictures of some gaits, or of all."""
    for name in names or PICTURES:
        gait, _, robot = name.partition("@")
        motion = generate(robot or None, gait)
        title = f"{motion.robot.spec.name}, {gait}" if robot else gait
        with tempfile.TemporaryDirectory() as folder:
            whole = animate(motion, Path(folder) / "motion.gif", title=title)
            content = next(
                (c for every in EVERY if len(c := small(whole, every)) <= MOST_BYTES), b""
            )
        path = FOLDER / f"{(title if robot else gait).replace('/', '-').replace(', ', '-')}.gif"
        if not content:
            raise SystemExit(
                f"{path}: more than {MOST_BYTES} bytes even with every {EVERY[-1]}th frame"
            )
        replace_file(path, content)
        print(path.name, len(content))


if __name__ == "__main__":
    main(sys.argv[1:])
