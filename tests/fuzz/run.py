"""Trying of inputs: each is written into an empty folder, its command run in a child process."""

from __future__ import annotations

import json
import shutil
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings

from tests.fuzz.case import Case, write
from tests.fuzz.child import Ending, run_in_child
from tests.fuzz.inputs import KINDS, cases
from tests.fuzz.robots import dropped


@dataclass
class Count:
    """What happened to the inputs of one kind."""

    codes: Counter[int] = field(default_factory=Counter)  # how often each exit code
    problems: list[str] = field(default_factory=list)
    seconds: float = 0.0  # longest CPU time [s]
    memory: int = 0  # largest memory [bytes]


def tried(case: Case, folder: Path) -> tuple[Ending, str]:
    """How a case ends, and what is wrong with that; empty if nothing is."""
    shutil.rmtree(folder, ignore_errors=True)
    work = folder / "work"
    work.mkdir(parents=True)
    write(case, work)
    before = set(work.rglob("*"))
    ending = run_in_child(case.command, work)
    problem = ending.problem
    left = {path.relative_to(work).as_posix() for path in work.rglob("*") if path not in before}
    if not problem and left and (ending.code == 2 or any(".part" in name for name in left)):
        problem = f"left {', '.join(sorted(left)[:3])}"
    if not problem and "--json" in case.command and ending.stdout and not _is_json(ending.stdout):
        problem = "no valid JSON"
    if not problem and case.kind in ("urdf", "mjcf") and ending.code == 1:
        problem = "exit code 1 from a malformed robot"
    if not problem and case.kind in ("urdf", "robot") and ending.code == 0:
        problem = dropped(case, ending.stdout, work)
    return ending, problem


def _is_json(text: bytes) -> bool:
    def refuse(constant: str) -> None:
        raise ValueError(constant)

    try:
        json.loads(text, parse_constant=refuse)
    except ValueError:
        return False
    return True


def count(kind: str, n: int, folder: Path, first: int = 0) -> Count:
    """Try n inputs of a kind; inputs with a problem are kept in `folder`."""
    found = Count()

    @seed(first)
    @settings(
        max_examples=n,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(cases(kind))
    def try_one(case: Case) -> None:
        ending, problem = tried(case, folder / "now")
        found.codes[ending.code] += 1
        found.seconds = max(found.seconds, ending.seconds)
        found.memory = max(found.memory, ending.memory)
        if problem:
            kept = folder / f"{kind.replace(' ', '_')}_{len(found.problems)}"
            shutil.copytree(folder / "now", kept, dirs_exist_ok=True)
            (kept / "command").write_text(repr(case.command))
            found.problems.append(f"{kept}: {problem}")

    try_one()
    return found


def table(counts: dict[str, Count]) -> str:
    """Counts of all kinds as a table in Markdown."""
    lines = [
        "| format | inputs | exit code 0 | 1 | 2 | problems | longest [s] | most memory [MB] |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
        *(row(kind, found) for kind, found in counts.items()),
    ]
    return "\n".join(lines)


def row(kind: str, found: Count) -> str:
    """Counts of a kind as a row of the table."""
    codes = " | ".join(str(found.codes[code]) for code in (0, 1, 2))
    return (
        f"| {kind} | {found.codes.total()} | {codes} | {len(found.problems)} | "
        f"{found.seconds:.1f} | {found.memory / 1e6:.0f} |"
    )


__all__ = ["KINDS", "Count", "count", "row", "table", "tried"]
