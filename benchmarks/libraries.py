"""How fast libraries are made, as ratios within one run.

python benchmarks/libraries.py                 60 gaits each, about five minutes
python benchmarks/libraries.py --gaits 200 --physics none

Gaits per second of the batch with one worker and with two, of the same work in a plain loop, with
and without physics. Efficiency is the rate of two workers over twice that of one; overhead is the
time of a gait in the batch with one worker over that in the loop, less 1. Start-up of workers is
not counted: the clock starts when they are ready, and every worker makes a gait beforehand.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path

import yaml

from mgs.batch.points import Plan, plan_sweep
from mgs.batch.quiet import silence

silence()

from mgs.batch.run import recipe_of, run_batch  # noqa: E402
from mgs.batch.worker import Recipe, make_gait  # noqa: E402
from mgs.sim import available_engines  # noqa: E402


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--gaits", type=int, default=60, metavar="N", help="default 60")
    parser.add_argument("--repeats", type=int, default=1, metavar="N", help="default 1; the best")
    parser.add_argument("--physics", choices=["none", "both"], default="both", help="default both")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    kinds: dict[str, tuple[str, ...]] = {"generation and checks": ()}
    if arguments.physics == "both":
        kinds |= {f"and {engine}": (engine,) for engine in available_engines()}
    figures = {}
    for label, engines in kinds.items():
        n = arguments.gaits if not engines else max(8, arguments.gaits // 6)
        figures[label] = measure(n, engines, arguments.repeats)
    print(json.dumps(figures, indent=2) if arguments.json else table(figures))


def measure(n: int, engines: tuple[str, ...], repeats: int) -> dict[str, float]:
    """Rates [gaits/s], efficiency and overhead."""
    with tempfile.TemporaryDirectory() as folder:
        plan = plan_of(Path(folder), n)
        recipe = recipe_of(plan, engines)  # type: ignore[arg-type]
        make_gait(recipe, plan.assignments(0))
        loop, one, two = 0.0, 0.0, 0.0
        for i in range(repeats):  # in turn, so that a busy machine is busy for all
            loop = max(loop, loop_rate(plan, recipe, Path(folder)))
            one = max(one, batch_rate(plan, recipe, Path(folder) / f"one{i}", 1))
            two = max(two, batch_rate(plan, recipe, Path(folder) / f"two{i}", 2))
    return {
        "gaits": n,
        "loop": loop,
        "one_worker": one,
        "two_workers": two,
        "efficiency": two / (2.0 * one),
        "overhead": loop / one - 1.0,
    }


def plan_of(folder: Path, n: int) -> Plan:
    """Walks of two steps and 12 s, each a little longer."""
    path = folder / "sweep.yaml"
    axes = {"walk.step_length": {"linspace": [0.01, 0.05, n]}}
    path.write_text(yaml.safe_dump({"mgs": 1, "base": "melson/walk_5cm", "axes": axes}))
    return plan_sweep(path)


def loop_rate(plan: Plan, recipe: Recipe, folder: Path) -> float:
    """The same work, files written too, without Dask and manifest."""
    start = time.perf_counter()
    for number in range(len(plan.points)):
        outcome = make_gait(recipe, plan.assignments(number))
        assert outcome.content is not None
        (folder / "one.mcap").write_bytes(outcome.content)
    return len(plan.points) / (time.perf_counter() - start)


def batch_rate(plan: Plan, recipe: Recipe, folder: Path, workers: int) -> float:
    """From the first gaits of all workers to the last gait."""
    times: list[float] = []
    run_batch(
        plan, recipe, folder, workers=workers, tell=lambda _: times.append(time.perf_counter())
    )
    warm = 2 * workers  # the first of each worker finds modules unloaded
    return (len(times) - 1 - warm) / (times[-1] - times[warm])


def table(figures: dict[str, dict[str, float]]) -> str:
    """Markdown."""
    lines = [
        "| gaits/s | loop | 1 worker | 2 workers | efficiency | overhead |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for label, f in figures.items():
        rates = " | ".join(f"{f[key]:.2f}" for key in ("loop", "one_worker", "two_workers"))
        share = f"{f['efficiency']:.2f} | {100.0 * f['overhead']:.1f} %"
        lines.append(f"| {label} | {rates} | {share} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
