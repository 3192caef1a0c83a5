"""One command in a process of its own, made by fork from this one, which has all imports."""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
import pkgutil
import resource
import signal
import sys
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import mgs.core.limits

# What a valid input may ask for; of an invalid one nobody knows. Set before the limit is imported.
mgs.core.limits.MAX_SAMPLES = 2000

import mgs.cli  # noqa: E402

# Modules that commands import late, and that would be imported again and again by the children.
LATE = (
    *("scipy.optimize", "scipy.sparse.linalg", "scipy.interpolate", "daqp", "mujoco", "yaml"),
    *("matplotlib.figure", "matplotlib.backends.backend_agg", "PIL.PngImagePlugin", "distributed"),
)
MOST_SECONDS = 20.0  # [s] of CPU time
MOST_MEMORY = 1_000_000_000  # [bytes]


@dataclass(frozen=True)
class Ending:
    """How a command ended."""

    code: int  # exit code; negative: the signal that ended it
    stdout: bytes
    stderr: bytes
    seconds: float  # CPU time [s]
    memory: int  # largest memory [bytes]

    @property
    def problem(self) -> str:
        """What is wrong with this ending; empty if nothing is."""
        if self.code < 0:
            return f"ended by {signal.Signals(-self.code).name}"
        if self.code not in (0, 1, 2):
            return f"exit code {self.code}"
        if b"Traceback" in self.stderr + self.stdout:
            return "traceback"
        if b"unforeseen error" in self.stderr:
            return "unforeseen error"
        if b"\x1b" in self.stderr + self.stdout:
            return "escape sequence"
        if self.seconds > MOST_SECONDS:
            return f"{self.seconds:.0f} s"
        return f"{self.memory / 1e6:.0f} MB" if self.memory > MOST_MEMORY else ""


@cache
def import_all() -> None:
    """Import all of mgs and what it imports late, and keep the garbage collector off it."""
    for module in pkgutil.walk_packages(mgs.__path__, "mgs."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    for name in LATE:
        with contextlib.suppress(ImportError):  # an extra that is not installed
            importlib.import_module(name)
    gc.collect()
    gc.freeze()  # a collection of a child would copy all pages


def run_in_child(arguments: Sequence[str], folder: Path) -> Ending:
    """Run a command of mgs in a folder, in a child of this process."""
    import_all()
    out, err = folder.parent / "stdout", folder.parent / "stderr"
    pid = os.fork()
    if pid == 0:
        _run(arguments, folder, out, err)
    _, status, usage = os.wait4(pid, 0)
    code = os.waitstatus_to_exitcode(status)
    return Ending(
        code=code,
        stdout=out.read_bytes(),
        stderr=err.read_bytes(),
        seconds=usage.ru_utime + usage.ru_stime,
        memory=usage.ru_maxrss * 1024,
    )


def _run(arguments: Sequence[str], folder: Path, out: Path, err: Path) -> None:
    """Become the command; does not return."""
    code = 70
    try:
        os.setsid()
        os.chdir(folder)
        for path, number in ((os.devnull, 0), (out, 1), (err, 2)):
            opened = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC)
            os.dup2(opened, number)
        seconds = int(MOST_SECONDS) + 5
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(120)  # for what waits without working
        sys.stdout = os.fdopen(1, "w", encoding="utf-8")
        sys.stderr = os.fdopen(2, "w", encoding="utf-8")
        try:
            mgs.cli.main(list(arguments), prog_name="mgs")
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else int(ended.code is not None)
        except BaseException:
            traceback.print_exc()
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError):
                stream.flush()
    finally:
        os._exit(code)
