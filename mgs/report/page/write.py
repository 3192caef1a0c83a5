"""Pages of motion files, as written by `mgs report`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mgs
from mgs.core.atomic_files import refuse_taken, replace_file
from mgs.core.errors import ConfigError
from mgs.core.progress import StepProgress, progress_of_step
from mgs.judge.motion_checks import check_motion
from mgs.judge.verdict import Verdict, judge
from mgs.motion import Motion
from mgs.motion_file import read_motion
from mgs.report.page.html import page_html
from mgs.report.page.motion_data import (
    MOST_SAMPLES,
    facts,
    ground_data,
    kept_samples,
    motion_arrays,
    provenance_text,
    robot_tree,
)
from mgs.report.page.replay_data import replay_data
from mgs.report.page.shapes import robot_shapes
from mgs.report.page.verdict_data import verdict_data
from mgs.sim import ServoName, choose_engines, replay

# Of a longer motion collisions are looked for at every k-th sample, k a prime number, so that in a
# walk, whose steps are alike, the instants of the steps differ.
MOST_COLLISION_SAMPLES = 10_000
PRIMES = (1, 2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47)
MOST_MOTIONS = 6  # largest number of motions side by side; browsers limit the number of 3D views


@dataclass(frozen=True)
class PageOptions:
    """What a page shows beside the motions themselves."""

    engines: tuple[str, ...] = ()  # of the replays; none: static checks alone
    servo: ServoName = "ideal"  # kind of servos in the replays
    meshes: Path | None = None  # folder with the meshes that a URDF names


DEFAULT = PageOptions()


def write_page(
    motions: Sequence[Motion | Path],
    output: Path,
    options: PageOptions = DEFAULT,
    *,
    force: bool = False,
    progress: StepProgress | None = None,
) -> list[Verdict]:
    """Write one page that shows a motion, or several motions side by side with one clock.

    Args:
        motions: motions, or paths of motion files.
        output: HTML file to write.
        options: replays and meshes.
        force: replace an existing file.
        progress: called with the name of a step, and work done and work in all of this step.

    Returns:
        The verdicts on the motions, in their order.

    Raises:
        ConfigError: there are too many motions, or the folder of meshes does not exist.
        MotionFileError: a motion file is missing or damaged.
        OutputExistsError: the file exists and `force` is False.
        SimulationError: an engine is missing or diverged.
    """
    if not 1 <= len(motions) <= MOST_MOTIONS:
        raise ConfigError(
            "mgs report", f"{len(motions)} motions; 1 to {MOST_MOTIONS} fit on a page"
        )
    if options.meshes is not None and not options.meshes.is_dir():
        raise ConfigError("--meshes", f"{options.meshes} is not a folder")
    refuse_taken(output, force)
    most = MOST_SAMPLES // len(motions)
    shown = [motion_content(motion, options, most, progress) for motion in motions]
    contents = [content for content, _ in shown]
    title = " | ".join(f"{content['gait']} of {content['robot']}" for content in contents)
    data = {"kind": "motions", "mgs": mgs.__version__, "title": title, "motions": contents}
    replace_file(output, page_html(title, data).encode())
    return [verdict for _, verdict in shown]


def motion_content(
    motion: Motion | Path,
    options: PageOptions = DEFAULT,
    most: int = MOST_SAMPLES,
    progress: StepProgress | None = None,
) -> tuple[dict[str, Any], Verdict]:
    """Everything that a page shows of a motion, and the verdict on it."""
    file = motion.name if isinstance(motion, Path) else ""
    motion = read_motion(motion)
    step = collision_step(motion.n_samples)
    checks = check_motion(motion, progress_of_step(progress, "static checks"), step)
    replays = [
        replay(motion, engine, progress=progress_of_step(progress, engine), servo=options.servo)
        for engine in choose_engines(options.engines or "none", "--replay")
    ]
    verdict = judge(file or motion.gait_name, checks, replays)
    shapes = robot_shapes(motion.robot, options.meshes)
    kept = kept_samples(motion.n_samples, most)
    notes = list(shapes.notes)
    if step > 1:
        notes.append(
            f"collisions were looked for at every {step}th sample only; mgs validate checks all "
            "of them"
        )
    if len(kept) < motion.n_samples:
        notes.append(
            f"{len(kept)} of {motion.n_samples} samples are shown; speeds, torques, power and "
            "margins are the worst ones of the stretches between them"
        )
    content = {
        "file": file,
        "gait": motion.gait_name,
        "robot": motion.robot.spec.name,
        "duration": motion.duration,
        "mass": motion.robot.mass,
        "height": float(motion.com[:, 2].max()),
        "notes": notes,
        "facts": facts(motion),
        "verdict": verdict_data(verdict),
        "tree": robot_tree(motion.robot),
        "shapes": shapes.items,
        "meshes": shapes.meshes,
        "ground": ground_data(motion),
        "arrays": motion_arrays(motion, kept),
        "replays": [replay_data(motion, replay, most) for replay in verdict.replays],
        "provenance": provenance_text(motion),
        "gait_yaml": motion.gait.to_yaml(),
    }
    return content, verdict


def collision_step(n_samples: int) -> int:
    """Number of samples from one at which collisions are looked for to the next one."""
    wanted = n_samples / MOST_COLLISION_SAMPLES
    return next((prime for prime in PRIMES if prime >= wanted), PRIMES[-1])
