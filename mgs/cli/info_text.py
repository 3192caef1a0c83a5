"""What matters about a motion file in a few lines, for mgs info; `--json` has everything."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from mgs.cli.verdict_text import line, yaw_words
from mgs.judge.motion_checks import Check

BLOCKS = {"ik": "faraji", "prioritized": "prioritized", "trajectory": "trajectory"}
HIDDEN = (
    "solver",
    "package",
    "version",
    "parameters",
    "com_generator",
    "zmp_error",
    "parts",
    "refined",
)


def info_lines(content: Mapping[str, Any], checks: Sequence[Check] | None = None) -> Iterator[str]:
    """Lines on the content of a file.

    Args:
        content: as `mgs.motion_file.read_info` gives it.
        checks: the static checks of the motion; None: they were not asked for.
    """
    known = content["metadata"]
    made = known.get("solver")
    made = made if isinstance(made, Mapping) else {}
    yield f"file: {content['file']}"
    yield f"size: {content['bytes'] / 1e6:.2f} MB, written by {content['library']}"
    for name in ("robot", "gait", "mass"):
        if name in known:
            yield f"{name}: {_number(known[name])}{' kg' if name == 'mass' else ''}"
    yield f"duration: {_number(content['duration'])} s"
    for name in ("samples", "dt"):
        if name in known:
            yield f"{name}: {_number(known[name])}{' s' if name == 'dt' else ''}"
    footsteps, scene = known.get("footsteps") or [], known.get("scene") or {}
    yield f"steps: {max(len(footsteps) - 2, 0)}"
    for name in ("boxes", "balls"):
        if isinstance(scene, Mapping) and scene.get(name):
            yield f"{name}: {len(scene[name])}"
    yield from _making(made)
    yield "topics:"
    for topic in content["topics"]:
        yield "  " + ", ".join(str(part) for part in topic.values())
    yield "attachments:"
    for entry in content["attachments"]:
        yield "  " + ", ".join(str(part) for part in entry.values())
    yield from _verdict(checks)
    yield "all details: --json"


def _verdict(checks: Sequence[Check] | None) -> Iterator[str]:
    if checks is None:
        yield "verdict: not in the file; --check makes the static checks, mgs validate all of them"
        return
    failed = [check for check in checks if not check.ok]
    yield f"verdict: {'FAILS' if failed else 'passes'} the static checks; physics: mgs validate"
    for check in failed:
        yield f"  {line(check)}"
    if (yaw := yaw_words(checks)) is not None:
        yield f"yaw: {yaw}"


def _making(made: Mapping[str, Any]) -> Iterator[str]:
    """Solver with the settings that it uses, CoM generator, and what the dynamic filter left."""
    if not made:
        return
    solver = str(made.get("solver"))
    yield f"solver: {solver} of {made.get('package')} {made.get('version')}"
    settings = {k: v for k, v in made.items() if k not in HIDDEN and not isinstance(v, Mapping)}
    block = next((made.get(b) for start, b in BLOCKS.items() if solver.startswith(start)), None)
    settings |= block if isinstance(block, Mapping) else {}
    for key, value in settings.items():
        if value is not None:
            yield f"  {key}: {_number(value)}"
    generator = made.get("com_generator")
    if isinstance(generator, Mapping):
        yield f"CoM generator: {generator.get('name')} of {generator.get('package')}"
    error = made.get("zmp_error")
    if isinstance(error, Mapping):
        told = [error.get(name) for name in ("before", "after")]
        worst = [e.get("max") for e in told if isinstance(e, Mapping)]
        figures = [f"{1e3 * value:.2f} mm" for value in worst if isinstance(value, float)]
        if len(figures) == len(told):
            before, after = figures
            passes = error.get("passes")
            yield f"ZMP against its plan: {after} at most; {before} before {passes} corrections"
    if isinstance(made.get("parts"), list):
        yield f"parts: {len(made['parts'])}"


def _number(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
