"""The long run: `python -m tests.fuzz --inputs 10000 --folder /tmp/fuzz`."""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path

from tests.fuzz.run import KINDS, count, table

# Parts of all inputs; formats whose commands take seconds get fewer.
SHARES = {
    **{"gait": 10, "robot": 6, "urdf": 1, "sweep": 25},
    **{"table": 18, "motion file": 15, "query": 25},
}


def main() -> int:
    """Try inputs of every kind in turn and print what happened; 1 if anything was wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--inputs", type=int, default=10_000, help="number of all inputs")
    parser.add_argument("--folder", type=Path, default=Path("fuzz"), help="inputs with problems")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), choices=list(KINDS))
    given = parser.parse_args()
    counts = {}
    for kind in given.kinds:
        begun = time.monotonic()
        n = math.ceil(given.inputs * SHARES[kind] / sum(SHARES[kind] for kind in given.kinds))
        counts[kind] = count(kind, n, given.folder.resolve(), given.seed)
        told = [f"{kind}: {time.monotonic() - begun:.0f} s", *counts[kind].problems]
        print(*told, sep="\n  ", flush=True)
    print(table(counts))
    return int(any(found.problems for found in counts.values()))


if __name__ == "__main__":
    sys.exit(main())
