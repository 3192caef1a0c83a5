"""In how many random replays each shipped walk stays up.

    python benchmarks/survival.py [--gaits NAME ...] [--engines NAME ...] [--servos NAME ...]
                                  [--draws 200] [--record FILE] [-o FILE]

Every walk and sequence of Melson and COMAN is replayed in `lab` conditions (docs/robustness.md)
with ideal servos and with those of robot.yaml. Draws are those of `mgs validate --monte-carlo` with
seed 0. The record file holds one character for each draw, by gait and motion: what was drawn once
is not drawn again, unless the motion has changed. The page is written anew after every ten draws,
so that it can be interrupted at any time.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from records import prefix_of, read_record, write_record
from servo_sweep import is_swept, made

from mgs.core.atomic_files import replace_file
from mgs.gait import list_gaits, load_gait
from mgs.judge.monte_carlo import LEAST_RATE, Task, replay_draw, wilson
from mgs.motion import Motion
from mgs.sim import EngineName, ServoName, available_engines
from mgs.sim.conditions import RANGES
from mgs.sim.prepare import prepare
from mgs.sim.settings import DEFAULTS, settings_of_draws

RANGE, SEED, DRAWS, AT_ONCE = "lab", 0, 200, 10
SERVOS: tuple[ServoName, ...] = ("ideal", "model")
Record = dict[str, str]  # "+" or "-" for each draw

HEAD = f"""# Walks under random conditions

`python benchmarks/survival.py` writes this page: how many of {DRAWS} draws each shipped walk of
Melson and COMAN survives in `{RANGE}` conditions (docs/robustness.md), with ideal servos and with
the modelled ones of robot.yaml (feed-forward). Seed {SEED}; in parentheses the 95 % interval of
Wilson. Where fewer draws have been made, their number stands behind the one that survives. A walk
passes a column with {LEAST_RATE:.0%} of the draws.
"""


def main() -> None:
    """Draw what is not in the record, and write the page."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--gaits", nargs="*", help="names; default: all that this page is about")
    parser.add_argument("--engines", nargs="*", help="names; default: all that are installed")
    parser.add_argument("--servos", nargs="*", default=list(SERVOS), help="ideal, model")
    parser.add_argument("--draws", type=int, default=DRAWS, help="number of draws")
    parser.add_argument("--record", type=Path, default=Path("benchmarks/survival.json"))
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/survival.md"))
    arguments = parser.parse_args()
    every = [name for name in list_gaits() if is_drawn(name)]
    path: Path = arguments.record
    known, record = read_record(path)
    motions = {name: made(name) for name in every}
    rows = [(name, prefix_of(name, motion, known)) for name, motion in motions.items()]
    for engine in arguments.engines or list(reversed(available_engines())):
        for name, prefix in rows:
            for servo in arguments.servos:
                if name not in (arguments.gaits or every):
                    continue
                while len(record.get(key(prefix, engine, servo), "")) < arguments.draws:
                    draw_some(record, prefix, motions[name], engine, servo)
                    write_record(path, known, record)
                    replace_file(arguments.output, page(rows, record).encode())
                print(name, engine, servo, told(record, prefix, engine, servo), flush=True)
    replace_file(arguments.output, page(rows, record).encode())


def is_drawn(name: str) -> bool:
    """Whether a shipped gait is one that this page is about."""
    return is_swept(name) and load_gait(name).motion != "kick"


def draw_some(
    record: Record, prefix: str, motion: Motion, engine: EngineName, servo: ServoName
) -> None:
    """Add the next draws of one motion to the record."""
    settings = settings_of_draws(engine, servo, DEFAULTS[engine])
    task = Task(prepare(motion, engine, settings, servo), RANGES[RANGE], SEED)
    done = record.get(key(prefix, engine, servo), "")
    for number in range(len(done), len(done) + AT_ONCE):
        done += "+" if replay_draw(task, number).survived else "-"
    record[key(prefix, engine, servo)] = done


def key(prefix: str, engine: str, servo: str) -> str:
    """Name of a series of draws in the record."""
    return f"{prefix} {engine} {servo} {RANGE} {SEED}"


def told(record: Record, prefix: str, engine: str, servo: str) -> str:
    """Cell of the table: draws that survive, their number if it is not the usual one, interval."""
    draws = record.get(key(prefix, engine, servo), "")
    if not draws:
        return "not drawn"
    number = "" if len(draws) == DRAWS else f" of {len(draws)}"
    low, high = wilson(draws.count("+"), len(draws))
    return f"{draws.count('+')}{number} ({low:.2f} to {high:.2f})"


def page(rows: list[tuple[str, str]], record: Record) -> str:
    """The whole page."""
    columns = [(engine, servo) for engine in available_engines() for servo in SERVOS]
    titles = [f"{engine}, {servo}" for engine, servo in columns]
    table = [f"| walk | {' | '.join(titles)} |", f"| --- |{' ---: |' * len(titles)}"]
    for name, prefix in rows:
        cells = [told(record, prefix, *column) for column in columns]
        table.append(f"| {name} | {' | '.join(cells)} |")
    series = [record.get(key(prefix, *column), "") for _, prefix in rows for column in columns]
    passed = sum(draws.count("+") >= LEAST_RATE * len(draws) for draws in series if draws)
    made_ = sum(bool(draws) for draws in series)
    count = f"{passed} of the {made_} series of draws made so far pass, of {len(series)} in all.\n"
    return "\n".join([HEAD, count, *table, ""])


if __name__ == "__main__":
    main()
