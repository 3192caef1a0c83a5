"""What matters about a motion file in a few lines, for mgs info; `--json` has everything."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

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


def info_lines(content: Mapping[str, Any]) -> Iterator[str]:
    """Lines on the content of a file as `mgs.motion_file.read_info` gives it."""
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
    yield "all details: --json; verdict: mgs validate"


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
