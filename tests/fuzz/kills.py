"""Commands that are killed at random moments: `python -m tests.fuzz.kills --kills 100`.

Each command runs once undisturbed, which tells how long it takes and what it writes. Then it is
started again and again, and SIGKILL, SIGTERM or SIGINT is sent to its process alone, at a moment
within that time. Two seconds later none of its processes may be left; where more processes want to
run than there are processor cores, as many times longer. Every file has to be complete; after
SIGTERM and SIGINT nothing half-written may be left. A batch that is resumed gives the library of
a run that nobody disturbed.

Right endings after a signal are exit code 1 and 0 (the work was done before) and death by the
signal that was sent, or by SIGINT after SIGTERM, which mgs treats as Ctrl-C: that is how programs
of Unix end that were interrupted, and a shell tells it as 130 or 143.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import uuid
from collections import Counter
from pathlib import Path
from subprocess import TimeoutExpired

import psutil

from mgs.core.errors import MgsError
from mgs.library.manifest import MANIFEST, reading
from mgs.motion_file import read_motion
from mgs.search.tune.journal import open_journal

MARK = "MGS_KILL_TEST"
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
LONGEST = 15.0  # [s] after which no command is killed; a search for an envelope takes minutes
GRACE = 2.0  # [s] in which all processes have to end
SWEEP = "mgs: 1\nbase: melson/bow\naxes: {dt: [0.1, 0.05, 0.04, 0.025, 0.02, 0.0125]}\n"
COMMANDS: dict[str, list[str]] = {
    "generate": ["generate", "melson/walk_5cm", "-o", "new/a.mcap"],
    "batch": ["batch", "run", "sweep.yaml", "-o", "library", "--workers", "2"],
    "validate": ["validate", "walk.mcap", "--physics", "mujoco", "--monte-carlo", "50",
                 "--workers", "2"],
    "envelope": ["envelope", "melson", "-o", "env", "--workers", "2", "--physics", "mujoco"],
    "tune": ["tune", "melson/walk_practical", "--objective", "speed", "-o", "new/b.yaml",
             "--trials", "6", "--final-draws", "0", "--workers", "2", "--physics", "mujoco"],
    "library export": ["library", "export", "whole", "--format", "csv", "-o", "new/t.csv"],
}  # fmt: skip
SAME = ("new/a.mcap", "new/t.csv")  # files that are the same in every run


def marked(token: str) -> list[psutil.Process]:
    """All processes that a command has started, itself included."""
    found = []
    for process in psutil.process_iter():
        try:
            if process.environ().get(MARK) == token and process.status() != psutil.STATUS_ZOMBIE:
                found.append(process)
        except (psutil.NoSuchProcess, psutil.AccessDenied):
            continue
    return found


def start(arguments: list[str], folder: Path, token: str) -> subprocess.Popen[bytes]:
    """Start a command in a session of its own, its output in a pipe as a caller would read it."""
    return subprocess.Popen(
        [sys.executable, "-m", "mgs", *arguments],
        cwd=folder,
        env={**os.environ, MARK: token},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        preexec_fn=_heed_signals,
    )


def _heed_signals() -> None:
    """Undo what a shell does to programs in the background: they ignore SIGINT."""
    for number in SIGNALS[1:]:
        signal.signal(number, signal.SIG_DFL)


def problem_after(
    name: str, sent: signal.Signals, delay: float, folder: Path, base: Path
) -> tuple[str, float]:
    """What is wrong after a command was killed after a delay [s], and how long it took to end [s].

    The first is empty if nothing is wrong.
    """
    token = uuid.uuid4().hex
    process = start(COMMANDS[name], folder, token)
    time.sleep(delay)
    process.send_signal(sent)
    begun = time.monotonic()
    grace = GRACE * max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))
    while (left := marked(token)) and time.monotonic() < begun + max(grace, 20.0):
        process.poll()
        time.sleep(0.05)
    took = time.monotonic() - begun
    named = ", ".join(" ".join(other.cmdline())[-60:] for other in left if other.is_running())
    for other in left:
        other.kill()
    _, err = process.communicate(timeout=60)
    if took > grace:
        return f"processes left after {took:.1f} s, {grace:.1f} s allowed: {named}", took
    if b"Traceback" in err:
        return f"traceback: {err.decode(errors='replace')[-300:]}", took
    if sent is not signal.SIGKILL and process.returncode not in (0, 1, -sent, -signal.SIGINT):
        return f"exit code {process.returncode}", took
    return damage(name, folder, base, sent is signal.SIGKILL), took


def damage(name: str, folder: Path, base: Path, was_killed: bool) -> str:
    """What is wrong with the files; empty if nothing is."""
    for path in folder.rglob("*.mcap"):
        try:
            read_motion(path)
        except MgsError as error:
            return str(error)
    for same in SAME:
        if (folder / same).exists() and (folder / same).read_bytes() != (base / same).read_bytes():
            return f"{same} differs from that of a run that was not disturbed"
    for path in folder.rglob("*.json"):
        json.loads(path.read_text())
    if not was_killed:
        if any(folder.rglob("*.part")):
            return "a part of a file left"
        if (folder / "new").exists() and not any((folder / "new").iterdir()):
            return "an empty folder left"
    if (journal := folder / "new" / "b.journal").exists():
        with open_journal(journal) as opened:  # raises an error if it cannot be continued
            opened.append_logs([])
    if name == "batch":
        return resumed(folder)
    return ""


def resumed(folder: Path) -> str:
    """What is wrong with a library after it was continued; empty if nothing is."""
    more = ["--resume"] if (folder / "library" / MANIFEST).exists() else []
    result = subprocess.run(
        [sys.executable, "-m", "mgs", *COMMANDS["batch"], *more],
        cwd=folder, capture_output=True, check=False,
    )  # fmt: skip
    if result.returncode:
        return f"resume: {result.stderr.decode(errors='replace')[-300:]}"
    return "" if content(folder / "library") == content(folder / "whole") else "another library"


def content(folder: Path) -> tuple[object, ...]:
    """Everything in a library that does not depend on the time that it took."""
    with reading(folder) as manifest:
        rows = manifest.states()
    files = [(p.name, p.read_bytes()) for p in sorted((folder / "gaits").iterdir())]
    return rows, files


def main() -> int:
    """Kill commands and print what was found; 1 if anything was wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--folder", type=Path, default=Path("kills"))
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    rng, base = random.Random(given.seed), given.folder.resolve() / "base"
    shutil.rmtree(base, ignore_errors=True)
    base.mkdir(parents=True)
    (base / "sweep.yaml").write_text(SWEEP)
    batch = ["batch", "run", "sweep.yaml", "-o", "whole", "--workers", "2"]
    walk = ["generate", "melson/walk_practical", "-o", "walk.mcap", "--set", "walk.n_steps=2"]
    for arguments in (batch, walk):
        subprocess.run([sys.executable, "-m", "mgs", *arguments], cwd=base, check=True)
    whole = given.folder.resolve() / "undisturbed"
    shutil.rmtree(whole, ignore_errors=True)
    shutil.copytree(base, whole)
    seconds = {name: _seconds(arguments, whole) for name, arguments in COMMANDS.items()}
    print(
        "undisturbed [s]:", {name: round(value, 1) for name, value in seconds.items()}, flush=True
    )
    tried: Counter[tuple[str, str]] = Counter()
    problems, longest = [], dict.fromkeys(COMMANDS, 0.0)
    for number in range(given.kills):
        name = list(COMMANDS)[number % len(COMMANDS)]
        sent = SIGNALS[number // len(COMMANDS) % len(SIGNALS)]
        folder = given.folder.resolve() / "now"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(base, folder)
        delay = rng.uniform(0.02, 1.1) * seconds[name]
        tried[name, sent.name] += 1
        problem, took = problem_after(name, sent, delay, folder, whole)
        longest[name] = max(longest[name], took)
        if problem:
            problems.append(f"{name}, {sent.name} after {delay:.2f} s: {problem}")
            print(problems[-1], flush=True)
    print("| command |", " | ".join(sent.name for sent in SIGNALS), "| longest end [s] |")
    print("| --- |", " | ".join("---" for _ in SIGNALS), "| --- |")
    for name in COMMANDS:
        counts = " | ".join(str(tried[name, sent.name]) for sent in SIGNALS)
        print(f"| {name} | {counts} | {longest[name]:.1f} |")
    load = os.getloadavg()[0] / (os.cpu_count() or 1)
    print(
        f"{len(problems)} problems in {given.kills} kills; {load:.1f} processes per core at the end"
    )
    return int(bool(problems))


def _seconds(arguments: list[str], folder: Path) -> float:
    """How long a command takes, or LONGEST if that is longer [s]."""
    begun = time.monotonic()
    with start(arguments, folder, "undisturbed") as process, contextlib.suppress(TimeoutExpired):
        try:
            process.communicate(timeout=LONGEST)
        finally:
            process.kill()
    return time.monotonic() - begun


if __name__ == "__main__":
    sys.exit(main())
