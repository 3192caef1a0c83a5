"""Which motion a recorded result is of, whatever machine has planned it.

Two machines plan the same motion with different last digits. Therefore a motion is known again by
the means and mean squares of its joint angles, within a tolerance.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.atomic_files import replace_file
from mgs.motion import Motion

TOLERANCE = 1e-6  # of means [m, rad] and of mean squares
Motions = dict[str, list[float]]  # figures of each motion, by the beginning of its keys


def prefix_of(name: str, motion: Motion, motions: Motions) -> str:
    """Beginning of the keys of a motion; one that is new is added to the motions."""
    figures = figures_of(motion)
    for prefix, known in motions.items():
        same_gait = prefix.rpartition(" ")[0] == name and len(known) == len(figures)
        if same_gait and np.allclose(known, figures, rtol=0.0, atol=TOLERANCE):
            return prefix
    prefix = f"{name} {hashlib.sha256(motion.q.tobytes()).hexdigest()[:12]}"
    motions[prefix] = [round(figure, 9) for figure in figures]
    return prefix


def figures_of(motion: Motion) -> list[float]:
    """Number of samples, means and mean squares of q."""
    q = motion.q
    return [float(len(q)), *q.mean(axis=0).tolist(), *np.square(q).mean(axis=0).tolist()]


def read_record(path: Path) -> tuple[Motions, dict[str, Any]]:
    """Motions and results of a record; both are empty if the file is missing."""
    content = json.loads(path.read_text()) if path.is_file() else {"motions": {}, "results": {}}
    return content["motions"], content["results"]


def write_record(path: Path, motions: Motions, results: dict[str, Any]) -> None:
    """Replace a record, one line for each motion and each result, in alphabetical order."""
    blocks = []
    for title, block in (("motions", motions), ("results", results)):
        lines = (f"{json.dumps(key)}: {json.dumps(block[key])}" for key in sorted(block))
        blocks.append(f'"{title}": {{\n' + ",\n".join(lines) + "\n}")
    replace_file(path, ("{\n" + ",\n".join(blocks) + "\n}\n").encode())
