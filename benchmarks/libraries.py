"""Speed of making gait libraries, as ratios within one run.

python benchmarks/libraries.py                 8 repeats of 10 gaits, about fifteen minutes
python benchmarks/libraries.py --physics none  without replays, two and a half minutes

Measures gaits per second of the batch with one worker and with two workers, and of the same work in
a plain loop, with and without physics. Efficiency is the rate of two workers divided by twice the
rate of one worker. Overhead is the time from gait to gait with one worker divided by that of the
work itself, minus 1. The last figure is the additional time of the work as compared with the loop.
All values are medians over several repeats of the median gait. The start of workers is not counted:
the clock starts when they are ready and every worker has made a gait.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import sqlite3
import statistics
import tempfile
import time
from pathlib import Path

import yaml

from mgs.library.points import Plan, plan_sweep
from mgs.library.quiet import silence

silence()

from mgs.library.manifest import MANIFEST  # noqa: E402
from mgs.library.run import recipe_of, run_batch  # noqa: E402
from mgs.library.worker import Recipe, make_gait  # noqa: E402
from mgs.sim import available_engines  # noqa: E402


def main() -> None:
    """Measure the rates and print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--gaits", type=int, default=10, metavar="N", help="gaits per repeat; default 10"
    )
    parser.add_argument(
        "--repeats", type=int, default=8, metavar="N", help="number of repeats; default 8"
    )
    parser.add_argument(
        "--physics",
        choices=["none", "both"],
        default="both",
        help="physics engines, or none; default both",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    kinds: dict[str, tuple[str, ...]] = {"generation and checks": ()}
    if arguments.physics == "both":
        kinds |= {f"and {engine}": (engine,) for engine in available_engines()}
    figures = {}
    for label, engines in kinds.items():
        n = arguments.gaits if not engines else max(8, arguments.gaits // 2)
        figures[label] = measure(n, engines, arguments.repeats)
    print(json.dumps(figures, indent=2) if arguments.json else table(figures))


def measure(n: int, engines: tuple[str, ...], repeats: int) -> dict[str, float]:
    """Measure rates [gaits/s], efficiency and overhead."""
    with tempfile.TemporaryDirectory() as folder:
        plan = plan_of(Path(folder), n)
        recipe = recipe_of(plan, engines)  # type: ignore[arg-type]
        make_gait(recipe, plan.assignments(0))
        times: list[tuple[float, float, float, float]] = []  # times of one gait in each repeat
        for i in range(repeats):  # alternately, because the speed of the machine varies with time
            loop = statistics.median(loop_times(plan, recipe, Path(folder)))
            one, work = batch_times(plan, recipe, Path(folder) / f"one{i}", 1)
            two, _ = batch_times(plan, recipe, Path(folder) / f"two{i}", 2)
            times.append((loop, one, two, work))
    loop, one, two, _ = (statistics.median(column) for column in zip(*times, strict=True))
    return {
        "gaits": n,
        "loop": 1.0 / loop,
        "one_worker": 1.0 / one,
        "two_workers": 1.0 / two,
        "efficiency": statistics.median(one / (2.0 * two) for _, one, two, _ in times),
        "overhead": statistics.median(one / work for _, one, _, work in times) - 1.0,
        "slower_work": statistics.median(work / loop for loop, _, _, work in times) - 1.0,
    }


def plan_of(folder: Path, n: int) -> Plan:
    """Plan of walks of two steps and 12 s with increasing step length."""
    path = folder / "sweep.yaml"
    axes = {"walk.step_length": {"linspace": [0.01, 0.05, n]}}
    path.write_text(yaml.safe_dump({"mgs": 1, "base": "melson/walk_5cm", "axes": axes}))
    return plan_sweep(path)


def loop_times(plan: Plan, recipe: Recipe, folder: Path) -> list[float]:
    """Time of each gait [s] by the same work, including its file, without Dask and manifest."""
    times = []
    for number in range(len(plan.points)):
        start = time.perf_counter()
        outcome = make_gait(recipe, plan.assignments(number))
        assert outcome.content is not None
        (folder / "one.mcap").write_bytes(outcome.content)
        times.append(time.perf_counter() - start)
    return times


def batch_times(plan: Plan, recipe: Recipe, folder: Path, workers: int) -> tuple[float, float]:
    """Median time [s] from gait to gait divided by the number of workers, and median work time."""
    kept: list[float] = []
    run_batch(
        plan, recipe, folder, workers=workers, tell=lambda _: kept.append(time.perf_counter())
    )
    warm = 2 * workers  # the first gait of each worker includes imports
    pairs = zip(kept[warm:], kept[warm + workers :], strict=False)
    between = [(after - before) / workers for before, after in pairs]
    with contextlib.closing(sqlite3.connect(folder / MANIFEST)) as manifest:
        in_work = [row[0] for row in manifest.execute("select seconds from gaits order by number")]
    return statistics.median(between), statistics.median(in_work[warm:])


def table(figures: dict[str, dict[str, float]]) -> str:
    """Markdown table of the results."""
    lines = [
        "| gaits/s | loop | 1 worker | 2 workers | efficiency | overhead | work slower by |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for label, f in figures.items():
        rates = " | ".join(f"{f[key]:.2f}" for key in ("loop", "one_worker", "two_workers"))
        share = (
            f"{f['efficiency']:.2f} | {100 * f['overhead']:.1f} % | {100 * f['slower_work']:.1f} %"
        )
        lines.append(f"| {label} | {rates} | {share} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
