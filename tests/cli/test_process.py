"""Tests of the settings of a command's process, each in a new interpreter."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

THREADS = "OPENBLAS_NUM_THREADS"


@pytest.mark.parametrize(("given", "expected"), [(None, "1"), ("3", "3")])
def test_a_command_uses_one_thread_for_linear_algebra_unless_told_otherwise(
    given: str | None, expected: str
):
    script = """
import os
from mgs.cli import main
try:
    main(["robot", "list"], prog_name="mgs")
except SystemExit:
    print("THREADS", os.environ["OPENBLAS_NUM_THREADS"])
"""
    environment = {key: value for key, value in os.environ.items() if key != THREADS}
    environment |= {} if given is None else {THREADS: given}
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env=environment
    )
    assert done.stdout.split()[-2:] == ["THREADS", expected]


def test_nothing_is_searched_for_garbage_when_a_command_ends():
    """The handler is registered first, therefore called last."""
    script = """
import atexit, gc
atexit.register(lambda: print("OBJECTS", len(gc.get_objects()), gc.get_freeze_count()))
from mgs.cli import main
main(["robot", "list"], prog_name="mgs")
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    searched, frozen = (int(word) for word in done.stdout.split()[-2:])
    assert searched < 100 < frozen


def test_importing_the_command_line_changes_no_setting():
    script = "import gc, os; before = gc.get_threshold(), dict(os.environ); import mgs.cli; "
    script += "assert before == (gc.get_threshold(), dict(os.environ))"
    subprocess.run([sys.executable, "-c", script], check=True)


def test_a_walk_imports_only_what_it_uses(tmp_path: Path):
    script = f"""
import sys
from pathlib import Path
from mgs.cli import main
main(["generate", "melson/s1", "-o", {str(tmp_path / "walk.mcap")!r}], standalone_mode=False)
print("LOADED", *sys.modules)
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    loaded = set(done.stdout.split("LOADED")[1].split())
    assert {"mgs.motion_planner.walk", "mgs.ik_solver.clik", "mgs.motion_file.write"} <= loaded
    unused = {"scipy", "control", "matplotlib", "mujoco", "pybullet", "piqp", "distributed"}
    unused |= {"mgs.motion_file.read", "mgs.pipeline.sequence", "mgs.com_generator.qp"}
    unused |= {f"mgs.motion_planner.{kind}" for kind in ("kick", "pick_up", "keyframes", "balance")}
    unused |= {f"mgs.ik_solver.{name}" for name in ("hard_soft", "prioritized", "whole_motion")}
    assert not loaded & unused
