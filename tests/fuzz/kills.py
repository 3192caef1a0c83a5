"""Commands that are killed at random moments: `python -m tests.fuzz.kills --kills 100`.

Each command is started as a process, and SIGKILL, SIGTERM or SIGINT is sent to it alone. Two
seconds later none of its processes may be left. Every file has to be complete; after SIGTERM and
SIGINT nothing half-written may be left; a batch that is resumed gives the library of a run that
nobody disturbed.
"""

from __future__ import annotations

import argparse
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

import psutil

from mgs.core.errors import MgsError
from mgs.library.manifest import MANIFEST, reading
from mgs.motion_file import read_motion

MARK = "MGS_KILL_TEST"
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
GRACE = 2.0  # [s] in which all processes have to end
SWEEP = "mgs: 1\nbase: melson/bow\naxes: {dt: [0.1, 0.05, 0.04, 0.025, 0.02, 0.0125]}\n"
COMMANDS: dict[str, tuple[list[str], float]] = {  # arguments, and about how long they take [s]
    "generate": (["generate", "melson/walk_5cm", "-o", "new/a.mcap"], 3.0),
    "batch": (["batch", "run", "sweep.yaml", "-o", "library", "--workers", "2"], 12.0),
    "validate": (
        ["validate", "walk.mcap", "--physics", "mujoco", "--monte-carlo", "50", "--workers", "2"],
        12.0,
    ),
    "envelope": (
        ["envelope", "melson", "-o", "env", "--workers", "2", "--physics", "mujoco"],
        15.0,
    ),
    "tune": (
        [
            "tune",
            "melson/walk_practical",
            "--objective",
            "speed",
            "-o",
            "new/b.yaml",
            "--trials",
            "6",
            "--workers",
            "2",
            "--physics",
            "mujoco",
        ],
        15.0,
    ),
    "library export": (["library", "export", "whole", "--format", "csv", "-o", "new/t.csv"], 1.0),
}


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
    )


def problem_after(name: str, sent: signal.Signals, delay: float, folder: Path) -> str:
    """What is wrong after a command was killed after some time; empty if nothing is."""
    token = uuid.uuid4().hex
    process = start(COMMANDS[name][0], folder, token)
    time.sleep(delay)
    process.send_signal(sent)
    deadline = time.monotonic() + GRACE
    while marked(token) and time.monotonic() < deadline:
        process.poll()
        time.sleep(0.05)
    left = marked(token)
    named = ", ".join(" ".join(other.cmdline())[-60:] for other in left)
    until = time.monotonic() + 10.0
    while marked(token) and time.monotonic() < until:
        time.sleep(0.1)
    late = time.monotonic() - until + 10.0 + GRACE
    for other in marked(token):
        other.kill()
    _, err = process.communicate(timeout=60)
    if left:
        return f"{len(left)} processes left until {late:.1f} s: {named}"
    if b"Traceback" in err:
        return f"traceback: {err.decode(errors='replace')[-300:]}"
    if sent is not signal.SIGKILL and process.returncode not in (0, 1, -sent, -signal.SIGINT):
        return f"exit code {process.returncode}"
    return damage(name, folder, sent is signal.SIGKILL)


def damage(name: str, folder: Path, was_killed: bool) -> str:
    """What is wrong with the files; empty if nothing is."""
    for path in folder.rglob("*.mcap"):
        try:
            read_motion(path)
        except MgsError as error:
            return str(error)
    if not was_killed:
        if any(folder.rglob("*.part")):
            return "a part of a file left"
        if (folder / "new").exists() and not any((folder / "new").iterdir()):
            return "an empty folder left"
    if name == "batch":
        return resumed(folder)
    return ""


def resumed(folder: Path) -> str:
    """What is wrong with a library after it was continued; empty if nothing is."""
    more = ["--resume"] if (folder / "library" / MANIFEST).exists() else []
    result = subprocess.run(
        [sys.executable, "-m", "mgs", *COMMANDS["batch"][0], *more],
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
    base.mkdir(parents=True, exist_ok=True)
    (base / "sweep.yaml").write_text(SWEEP)
    batch = ["batch", "run", "sweep.yaml", "-o", "whole", "--workers", "2"]
    walk = ["generate", "melson/walk_practical", "-o", "walk.mcap", "--set", "walk.n_steps=2"]
    for arguments in (batch, walk):
        subprocess.run([sys.executable, "-m", "mgs", *arguments], cwd=base, check=False)
    tried: Counter[tuple[str, str]] = Counter()
    problems = []
    for number in range(given.kills):
        name = list(COMMANDS)[number % len(COMMANDS)]
        sent = SIGNALS[number // len(COMMANDS) % len(SIGNALS)]
        folder = given.folder.resolve() / "now"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(base, folder)
        delay = rng.uniform(0.05, 1.2) * COMMANDS[name][1]
        tried[name, sent.name] += 1
        if problem := problem_after(name, sent, delay, folder):
            problems.append(f"{name}, {sent.name} after {delay:.2f} s: {problem}")
            print(problems[-1], flush=True)
    print("| command |", " | ".join(sent.name for sent in SIGNALS), "|")
    print("| --- |", " | ".join("---" for _ in SIGNALS), "|")
    for name in COMMANDS:
        print(f"| {name} |", " | ".join(str(tried[name, s.name]) for s in SIGNALS), "|")
    print(f"{len(problems)} problems in {given.kills} kills")
    return int(bool(problems))


if __name__ == "__main__":
    sys.exit(main())
