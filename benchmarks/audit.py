"""What `mgs audit` finds, and how fast: 16 kinds of seeded defects, false alarms, times.

python benchmarks/audit.py                     50 defects of each kind and 500 clean motions
python benchmarks/audit.py --each 5 --clean 50 a quick look
python benchmarks/audit.py --log FILE          a run that continues where an earlier one was stopped
python benchmarks/audit.py --json              output as one JSON object

Clean motions come from gaits on which no threshold was set; `--first` takes those on which they
were. Each trial has random numbers of its own, from the seed, the kind of defect and its number, so
that a miss can be repeated alone and a log may be continued. Prints Markdown tables; ten minutes
on one core. Set OPENBLAS_NUM_THREADS=1: the matrices are too small for several threads.
"""

from __future__ import annotations

import argparse
import functools
import json
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from clean_motions import FIRST, HELD_OUT, clean
from seeded_defects import DEFECTS
from tables import table
from trials import Log

from mgs.judge.audit import KINDS, Finding, audit

NEAR = 0.2  # [s] between a seeded defect and its finding


def main() -> None:
    """Seed defects, count what is found, and print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--each", type=int, default=50, metavar="N", help="defects of each kind")
    parser.add_argument("--clean", type=int, default=500, metavar="N", help="clean motions")
    parser.add_argument("--seed", type=int, default=2, metavar="N", help="of random numbers")
    parser.add_argument("--first", action="store_true", help="gaits that thresholds were set on")
    parser.add_argument("--log", type=Path, metavar="FILE", help="of trials that are made already")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    gaits = FIRST if arguments.first else HELD_OUT
    log = Log(arguments.log, {"seed": arguments.seed, "first": arguments.first})
    calm = [
        log.trial("clean", n, [arguments.seed, 0, n], functools.partial(alarm, gaits))
        for n in range(arguments.clean)
    ]
    seeded = {
        kind: [
            log.trial(kind, n, [arguments.seed, i, n], functools.partial(found, kind, gaits))
            for n in range(arguments.each)
        ]
        for i, kind in enumerate(DEFECTS, start=1)
    }
    figures = {
        "gaits": "first" if arguments.first else "held out",
        "clean": alarms(calm),
        "defects": {kind: hits(trials) for kind, trials in seeded.items()},
    }
    print(json.dumps(figures, indent=2, allow_nan=False) if arguments.json else report(figures))


def alarm(gaits: tuple[str, ...], rng: np.random.Generator) -> dict[str, Any]:
    """What the audit finds in a clean motion, and how many times faster than real time it is."""
    motion = next(clean(rng, gaits))
    _ = motion.robot.geometry  # loaded once for a robot, not for a motion
    started = time.process_time()
    result = audit(motion)
    seconds = time.process_time() - started
    return {"told": sorted(result.kinds), "duration": result.duration, "seconds": seconds}


def found(kind: str, gaits: tuple[str, ...], rng: np.random.Generator) -> dict[str, Any]:
    """Whether a seeded defect is found as what and when it is, and what else is."""
    motions, seeded = clean(rng, gaits), None
    while seeded is None:
        seeded = DEFECTS[kind](next(motions), rng)
    motion, when = seeded
    result = audit(motion)
    hit = any(_is_it(finding, kind, when) for finding in result.findings)
    return {"hit": hit, "told": sorted(set(result.kinds) - {kind})}


def alarms(trials: list[dict[str, Any]]) -> dict[str, Any]:
    """False alarms on clean motions, and how many times faster than real time the audit is."""
    kinds = Counter(kind for one in trials for kind in one["told"])
    ratios = [one["duration"] / one["seconds"] for one in trials]
    return {
        "n": len(trials),
        "alarmed": [one["number"] for one in trials if one["told"]],
        "kinds": dict(kinds),
        "slowest": min(ratios),
        "median": float(np.median(ratios)),
        "all": sum(one["duration"] for one in trials) / sum(one["seconds"] for one in trials),
    }


def hits(trials: list[dict[str, Any]]) -> dict[str, Any]:
    """How many seeded defects are found, numbers of those that are not, and other findings."""
    others = Counter(kind for one in trials for kind in one["told"])
    missed = [one["number"] for one in trials if not one["hit"]]
    found_ = len(trials) - len(missed)
    return {
        "n": len(trials), "found": found_, "missed": missed, "others": dict(others.most_common(3))
    }  # fmt: skip


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
    hit = sum(seen["found"] for seen in figures["defects"].values())
    missed = "; ".join(
        f"`{kind}` {', '.join(map(str, seen['missed']))}"
        for kind, seen in figures["defects"].items()
        if seen["missed"]
    )
    kinds = ", ".join(f"{kind} {count}" for kind, count in clean_["kinds"].items()) or "none"
    return "\n\n".join(
        [
            f"Gaits: {figures['gaits']}. Found: {hit} of {total} defects "
            f"({100.0 * hit / max(total, 1):.1f} %). Missed, by number: {missed or 'none'}. "
            f"False alarms: {len(clean_['alarmed'])} of {clean_['n']} clean motions ({kinds}). "
            f"Speed on one core: {clean_['all']:.0f} times real time (all together), "
            f"{clean_['median']:.0f} times (median), {clean_['slowest']:.0f} times (slowest).",
            table(["kind", "what it means", "found", "other findings on the same motions"], rows),
        ]
    )


if __name__ == "__main__":
    main()
