"""The long run: `python -m tests.fuzz --inputs 10000 --folder /tmp/fuzz`.

`--format urdf` tries one format only, and may be repeated.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path

from tests.fuzz.run import KINDS, count, row, table

# Parts of all inputs; what foreign parsers and engines see gets the most.
SHARES = {
    **{"gait": 15, "robot": 15, "urdf": 20, "mjcf": 2, "sweep": 12},
    **{"table": 6, "motion file": 20, "query": 12},
}


def main() -> int:
    """Try inputs of every kind in turn and print what happened; 1 if anything was wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--inputs", type=int, default=10_000, help="number of all inputs")
    parser.add_argument("--folder", type=Path, default=Path("fuzz"), help="inputs with problems")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--format", dest="kinds", action="append", choices=list(KINDS))
    given = parser.parse_args()
    kinds = given.kinds or list(KINDS)
    counts = {}
    for kind in kinds:
        begun = time.monotonic()
        n = math.ceil(given.inputs * SHARES[kind] / sum(SHARES[kind] for kind in kinds))
        counts[kind] = count(kind, n, given.folder.resolve(), given.seed)
        print(row(kind, counts[kind]), f"in {time.monotonic() - begun:.0f} s", flush=True)
        print(*(f"  {problem}" for problem in counts[kind].problems), sep="\n", flush=True)
    print(table(counts))
    return int(any(found.problems for found in counts.values()))


if __name__ == "__main__":
    sys.exit(main())
