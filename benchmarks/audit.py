"""What `mgs audit` finds, and how fast: 16 kinds of seeded defects, false alarms, times.

python benchmarks/audit.py                     50 defects of each kind and 500 clean motions
python benchmarks/audit.py --each 5 --clean 50 a quick look
python benchmarks/audit.py --json              output as one JSON object

Clean motions come from gaits on which no threshold was set; `--first` takes those on which they
were. Prints Markdown tables; half an hour on one core.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
from clean_motions import FIRST, HELD_OUT, clean
from seeded_defects import DEFECTS
from tables import table

from mgs.judge.audit import KINDS, Finding, GivenMotion, audit

NEAR = 0.2  # [s] between a seeded defect and its finding


def main() -> None:
    """Seed defects, count what is found, and print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--each", type=int, default=50, metavar="N", help="defects of each kind")
    parser.add_argument("--clean", type=int, default=500, metavar="N", help="clean motions")
    parser.add_argument("--seed", type=int, default=2, metavar="N", help="of random numbers")
    parser.add_argument("--first", action="store_true", help="gaits that thresholds were set on")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    gaits = FIRST if arguments.first else HELD_OUT
    rng = np.random.default_rng(arguments.seed)
    motions = clean(rng, gaits)
    figures = {
        "gaits": "first" if arguments.first else "held out",
        "clean": alarms(motions, arguments.clean),
        "defects": {kind: found(kind, motions, rng, arguments.each) for kind in DEFECTS},
    }
    print(json.dumps(figures, indent=2) if arguments.json else report(figures))


def alarms(motions: Iterator[GivenMotion], n: int) -> dict[str, Any]:
    """False alarms on n clean motions, and how many times faster than real time the audit is."""
    told: Counter[str] = Counter()
    alarmed, ratios = 0, []
    for _, motion in zip(range(n), motions, strict=False):
        _ = motion.robot.geometry  # loaded once for a robot, not for a motion
        started = time.process_time()
        result = audit(motion)
        ratios.append(result.duration / (time.process_time() - started))
        alarmed += not result.clean
        told.update(result.kinds)
    low, middle = np.quantile(ratios, [0.0, 0.5]).tolist()
    return {"n": n, "alarmed": alarmed, "kinds": dict(told), "slowest": low, "median": middle}


def found(
    kind: str, motions: Iterator[GivenMotion], rng: np.random.Generator, n: int
) -> dict[str, Any]:
    """How many of n seeded defects are found as what and when they are."""
    hits, others = 0, Counter[str]()
    for _ in range(n):
        seeded = None
        while seeded is None:
            seeded = DEFECTS[kind](next(motions), rng)
        motion, when = seeded
        result = audit(motion)
        hits += any(_is_it(finding, kind, when) for finding in result.findings)
        others.update(set(result.kinds) - {kind})
    return {"n": n, "found": hits, "others": dict(others.most_common(3))}


def _is_it(finding: Finding, kind: str, when: float | None) -> bool:
    if finding.kind != kind:
        return False
    return when is None or finding.start - NEAR <= when <= finding.end + NEAR


def report(figures: dict[str, Any]) -> str:
    """Markdown tables."""
    clean_ = figures["clean"]
    rows = [
        [
            f"`{kind}`", KINDS[kind], f"{seen['found']} of {seen['n']}",
            ", ".join(f"{other} {count}" for other, count in seen["others"].items()),
        ]
        for kind, seen in figures["defects"].items()
    ]  # fmt: skip
    total = sum(seen["n"] for seen in figures["defects"].values())
    hits = sum(seen["found"] for seen in figures["defects"].values())
    kinds = ", ".join(f"{kind} {count}" for kind, count in clean_["kinds"].items()) or "none"
    return "\n\n".join(
        [
            f"Gaits: {figures['gaits']}. Found: {hits} of {total} defects "
            f"({100.0 * hits / max(total, 1):.1f} %). False alarms: {clean_['alarmed']} of "
            f"{clean_['n']} clean motions ({kinds}). Speed on one core: {clean_['median']:.0f} "
            f"times real time (median), {clean_['slowest']:.0f} times (slowest motion).",
            table(["kind", "what it means", "found", "other findings on the same motions"], rows),
        ]
    )


if __name__ == "__main__":
    main()
