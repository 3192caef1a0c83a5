"""Which shipped motions stay up and arrive on servos that nobody modelled: docs/servo_sweep.md.

    python benchmarks/servo_sweep.py [--gaits NAME ...] [--engines NAME ...] [--required]
                                     [--record FILE] [-o FILE]

Every walk, kick, stair and sequence of Melson and COMAN is replayed in both engines: with plain PD
servos told the planned angles, at several sags and frictions, and with the servos of robot.yaml
told feed-forward commands for a stiffness that is wrong. Outcomes are kept in a record file by
gait, motion, physics step and case: what was replayed once is not replayed again, unless the motion
or the step of the engine has changed. What is required of a robust motion is replayed first. The
record is written after each replay and the page anew after each motion, with a dot for what has not
been replayed, so that it can be interrupted at any time.
"""

from __future__ import annotations

import argparse
import itertools
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from records import prefix_of, read_record, write_record

from mgs.core.atomic_files import replace_file
from mgs.gait import list_gaits, load_gait
from mgs.judge.servo_cases import Case
from mgs.judge.servo_sweep import sweep_servos
from mgs.judge.verdict import replay_checks
from mgs.motion import Motion
from mgs.pipeline import generate
from mgs.robot import load_robot
from mgs.sim import DEFAULTS, EngineName, available_engines, replay

ROBOTS, KINDS = ("melson", "coman"), ("walk", "kick", "sequence")
SAGS_DEG = (0.5, 1.0, 2.0, 4.0, 8.0)
REQUIRED_SAGS_DEG = SAGS_DEG[:3]
FRICTIONS = (0.7, 1.0, 1.3)
WRONG_STIFFNESS = (0.7, 1.4)  # that feed-forward is computed for, relative to robot.yaml's servos
Replayed = Case | float  # PD servos, or the robot's own with a wrong stiffness
PD_CASES = tuple(Case(None, mu, sag) for sag, mu in itertools.product(SAGS_DEG, FRICTIONS))
REQUIRED: tuple[Replayed, ...] = (
    *(case for case in PD_CASES if case.sag_deg in REQUIRED_SAGS_DEG), *WRONG_STIFFNESS
)  # fmt: skip
OTHERS: tuple[Replayed, ...] = tuple(case for case in PD_CASES if case not in REQUIRED)
Record = dict[str, list[str]]  # failed checks by case

HEAD = """# Motions on plain PD servos

`python benchmarks/servo_sweep.py` writes this page. Every walk, kick, stair and sequence that
ships for Melson and COMAN is replayed in both engines with plain PD servos
([how they are simulated](simulation.md)): sag is their position error at stall torque, they are
told the planned angles without feed-forward, and the damping time is 10 ms. Three marks stand for
three coefficients of friction, 0.7, 1.0 and 1.3:

- `+` the motion stays up and meets the tolerances of the verdict,
- `o` it stays up and misses a tolerance (position, yaw, time at the torque limit, or the ball),
- `-` it falls,
- `.` it has not been replayed.

The last columns are replays with the servos of robot.yaml, at friction 1.0, told feed-forward
commands for a stiffness 0.7 and 1.4 times theirs. A motion counts as robust when it passes in both
engines at sags of 0.5, 1 and 2 deg with all three frictions, and with both of these commands; it
counts as open while none of these replays fails and some have not been made.
"""


def main() -> None:
    """Replay what is not in the record, and write the page."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--gaits", nargs="*", help="names; default: all that this page is about")
    parser.add_argument("--engines", nargs="*", help="names; default: all that are installed")
    parser.add_argument("--required", action="store_true", help="leave out sags of 4 and 8 deg")
    parser.add_argument("--record", type=Path, default=Path("benchmarks/servo_sweep.json"))
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/servo_sweep.md"))
    arguments = parser.parse_args()
    every = [name for name in list_gaits() if is_swept(name)]
    path: Path = arguments.record
    known, record = read_record(path)
    motions = {name: made(name) for name in every}
    rows = [(name, prefix_of(name, motion, known)) for name, motion in motions.items()]
    chosen = [(name, prefix) for name, prefix in rows if name in (arguments.gaits or every)]
    for cases in (REQUIRED,) if arguments.required else (REQUIRED, OTHERS):
        for engine in arguments.engines or reversed(available_engines()):  # the faster one first
            for name, prefix in chosen:
                for _ in completed(record, prefix, motions[name], engine, cases):
                    write_record(path, known, record)
                replace_file(arguments.output, page(rows, record).encode())
                print(name, engine, *cells(prefix, engine, record), sep=" | ", flush=True)
    replace_file(arguments.output, page(rows, record).encode())


def made(name: str) -> Motion:
    """The motion of a shipped gait."""
    gait = load_gait(name)
    return generate(load_robot(str(gait.robot)), gait, name).motion


def is_swept(name: str) -> bool:
    """Whether a shipped gait is one of a robot that this page is about and of a kind that moves."""
    gait = load_gait(name)
    return gait.robot in ROBOTS and gait.motion in KINDS


def completed(
    record: Record, prefix: str, motion: Motion, engine: EngineName, cases: Sequence[Replayed]
) -> Iterator[None]:
    """Add to the record what is missing of one motion in one engine, one replay after another."""
    for case in cases:
        if (name := key(prefix, engine, case)) in record:
            continue
        if isinstance(case, Case):
            (outcome,) = sweep_servos(motion, engine, cases=(case,)).outcomes
            record[name] = list(outcome.failed)
        else:
            result = replay(motion, engine, servo="model", assumed_stiffness=case)
            failed = [c.name.removeprefix(f"{engine}_") for c in replay_checks(result) if not c.ok]
            record[name] = failed
        yield


def key(prefix: str, engine: EngineName, case: Replayed) -> str:
    """Name of one replay in the record."""
    place = f"{prefix} {engine} {1e3 * DEFAULTS[engine].dt:g}ms"
    if isinstance(case, Case):
        return f"{place} pd {case.sag_deg:g} {case.friction:g}"
    return f"{place} model {case:g}"


def mark(failed: list[str] | None) -> str:
    """One character for the outcome of one replay; None: it has not been made."""
    if failed is None:
        return "."
    if not failed:
        return "+"
    return "-" if {"upright", "diverged"} & set(failed) else "o"


def cells(prefix: str, engine: EngineName, record: Record) -> list[str]:
    """Outcomes of one motion in one engine, by sag and by wrong stiffness."""

    def marked(case: Replayed) -> str:
        return mark(record.get(key(prefix, engine, case)))

    by_sag = [[marked(Case(None, mu, sag)) for mu in FRICTIONS] for sag in SAGS_DEG]
    return [*map(" ".join, by_sag), *map(marked, WRONG_STIFFNESS)]


def robustness(prefix: str, record: Record) -> str:
    """Whether a motion passes all that is required: yes, no, or open."""
    outcomes = [
        record.get(key(prefix, engine, case)) for engine in available_engines() for case in REQUIRED
    ]
    if any(outcomes):
        return "no"
    return "open" if None in outcomes else "yes"


def line(name: str, prefix: str, record: Record) -> str:
    """Lines of the table about one motion, one for each engine."""
    robust = robustness(prefix, record)
    lines = []
    for engine in available_engines():
        marks = " | ".join(f"`{cell}`" for cell in cells(prefix, engine, record))
        lines.append(f"| {name} | {engine} | {marks} | {robust} |")
        name, robust = "", ""
    return "\n".join(lines)


def page(rows: Sequence[tuple[str, str]], record: Record) -> str:
    """The whole page."""
    columns = [
        "motion", "engine", *(f"sag {sag:g} deg" for sag in SAGS_DEG),
        *(f"own servos, {factor:g}" for factor in WRONG_STIFFNESS), "robust",
    ]  # fmt: skip
    told = [robustness(prefix, record) for _, prefix in rows]
    table = [
        f"| {' | '.join(columns)} |",
        f"|{' --- |' * len(columns)}",
        *(line(name, prefix, record) for name, prefix in rows),
    ]
    count = (
        f"Robust: {told.count('yes')} of {len(rows)}; not robust: {told.count('no')}; "
        f"open: {told.count('open')}.\n"
    )
    return "\n".join([HEAD, count, *table, "", *failures(rows, record), ""])


def failures(rows: Sequence[tuple[str, str]], record: Record) -> list[str]:
    """What fails of all that is required, by motion and engine."""
    lines = ["## Required checks that fail", "", "| motion | engine | checks |"]
    lines.append("| --- | --- | --- |")
    for name, prefix in rows:
        for engine in available_engines():
            outcomes = [record.get(key(prefix, engine, case)) for case in REQUIRED]
            failed = Counter(check for checks in outcomes for check in checks or ())
            if failed:
                told = ", ".join(f"{check} ({n} of {len(outcomes)})" for check, n in failed.items())
                lines.append(f"| {name} | {engine} | {told} |")
    return lines


if __name__ == "__main__":
    main()
