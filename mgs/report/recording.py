"""Files of what happens in a replay: topics, moving pictures and a picture, by the ending."""

from __future__ import annotations

from pathlib import Path

from mgs.core.atomic_files import refuse_taken
from mgs.core.errors import ConfigError
from mgs.core.progress import Progress
from mgs.motion import Motion
from mgs.sim import Replay
from mgs.sim.record import as_motion, write_recorded

ENDINGS = (".mcap", ".gif", ".mp4", ".png")


def check_record(path: Path, force: bool) -> None:
    """Refuse a file that cannot be written, before the replay takes its time.

    Raises:
        ConfigError: the ending of the name is not known.
        MgsError: ffmpeg, which makes MP4 files, is not installed.
        OutputExistsError: the file exists and `force` is False.
    """
    if path.suffix not in ENDINGS:
        raise ConfigError("--record", f"{path}: the name should end in {', '.join(ENDINGS)}")
    refuse_taken(path, force)
    if path.suffix in (".gif", ".mp4"):
        from mgs.report.animation import check_output

        check_output(path, force)


def write_record(
    motion: Motion,
    replay: Replay,
    path: Path,
    *,
    force: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Write the file; see `check_record` for the errors."""
    check_record(path, force)
    if path.suffix == ".mcap":
        return write_recorded(motion, replay.trace, path, force=force)
    fate = f"falls at {replay.fall_time:.2f} s" if replay.fell else "stays up"
    title = f"{motion.gait_name} in {replay.engine}"
    shown = as_motion(motion, replay.trace, title)
    if path.suffix == ".png":
        from mgs.report.picture import write_picture

        return write_picture(shown, path, force=force, verdict=fate)
    from mgs.report.animation import animate

    return animate(shown, path, title=f"{title}, {fate}", force=force, progress=progress)
