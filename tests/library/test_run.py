"""Runs: files equal to those of the single command, and no loss after any interruption."""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from distributed import Client, WorkerPlugin

import mgs.library.worker
from mgs.core.errors import ConfigError, MgsError
from mgs.gait import load_gait
from mgs.judge.motion_checks import check_motion
from mgs.library.lock import locked
from mgs.library.manifest import MANIFEST
from mgs.library.points import Plan, plan_sweep
from mgs.library.run import recipe_of, run_batch
from mgs.library.summary import Summary
from mgs.library.worker import make_gait, travel_figures
from mgs.motion_file import read_motion
from mgs.pipeline import Stages, generate, run_stages
from tests.support.commands import run
from tests.support.libraries import LENGTHS, write_sweep

Made = tuple[Path, Summary]


def rows(folder: Path) -> list[dict[str, Any]]:
    """The manifest, read without mgs."""
    with contextlib.closing(sqlite3.connect(folder / MANIFEST)) as connection:
        connection.row_factory = sqlite3.Row
        assert connection.execute("PRAGMA integrity_check").fetchone()[0] == "ok"
        return [dict(row) for row in connection.execute("SELECT * FROM gaits ORDER BY number")]


def hashes(folder: Path) -> dict[str, str]:
    """Of every file of gaits, remains too."""
    return {
        path.name: hashlib.sha256(path.read_bytes()).hexdigest()
        for path in (folder / "gaits").iterdir()
    }


def assert_same_library(found: Path, expected: Path) -> None:
    """Files and rows, but for how long the work took."""
    assert hashes(found) == hashes(expected)
    for a, b in zip(rows(found), rows(expected), strict=True):
        assert a | {"seconds": None} == b | {"seconds": None}


@pytest.fixture
def copy(made: Made, tmp_path: Path) -> Path:
    """A library that may be damaged."""
    return Path(shutil.copytree(made[0], tmp_path / "copy"))


def test_every_gait_has_a_row_and_every_feasible_gait_a_file(made: Made, plan: Plan):
    folder, summary = made
    found = rows(folder)
    assert [row["number"] for row in found] == list(range(len(plan.points)))
    assert [row["walk.step_length"] for row in found] == [x for x in LENGTHS for _ in range(2)]
    for row in found:
        infeasible = row["walk.step_length"] == 0.5
        assert (row["verdict"] == "infeasible") == infeasible
        assert (row["file"] is None) == infeasible
        assert (row["reason"] is not None) == (row["verdict"] != "pass")
    assert found[-1]["reason"] in ("IkError", "JointLimitError")
    assert "t = " in found[-1]["message"]
    assert summary.done == sum(summary.verdicts.values()) == len(found)
    assert hashes(folder) == {Path(r["file"]).name: r["sha256"] for r in found if r["file"]}


def test_a_file_equals_that_of_the_single_command_byte_by_byte(
    made: Made, plan: Plan, tmp_path: Path
):
    """So too is the failure: the command says what the row says."""
    folder, found = made[0], rows(made[0])
    for number in (3, len(found) - 1):
        path = tmp_path / f"{number}.mcap"
        sets = [word for text in plan.assignments(number) for word in ("--set", text)]
        result = run("generate", plan.base, "-o", path, *sets)
        if found[number]["file"]:
            assert path.read_bytes() == (folder / found[number]["file"]).read_bytes()
        else:
            assert result.exit_code == 1
            assert result.stderr == f"Error: {found[number]['message']}\n"


def test_figures_are_those_of_the_file(made: Made):
    for row in rows(made[0])[:4]:
        motion = read_motion(made[0] / row["file"])
        checks = {check.name: check for check in check_motion(motion)}
        assert row["zmp_margin"] == pytest.approx(checks["zmp_margin"].value, abs=1e-12)
        assert row["torque_ratio"] == pytest.approx(
            checks["joint_torque"].value / checks["joint_torque"].limit
        )
        assert (row["verdict"] == "pass") == all(check.ok for check in checks.values())
        assert row["samples"] == motion.n_samples
        assert row["bytes"] == (made[0] / row["file"]).stat().st_size


def test_the_speed_is_that_of_the_steps(melson: Any, walk_5cm: Stages):
    """walk_5cm: one step of 50 mm and the closing one, 2.4 s each, with 1.2 s between them."""
    figures = travel_figures(walk_5cm.motion)
    assert figures["vx"] == pytest.approx(0.05 / 6.0, rel=0.01)
    assert figures["vy"] == pytest.approx(0.0, abs=1e-4)
    assert figures["wz"] == pytest.approx(0.0, abs=1e-6)
    assert figures["distance"] == pytest.approx(0.05, abs=1e-5)


def test_the_mean_velocity_of_an_arc_leads_along_the_arc(melson: Any):
    """The oracle moves a point by the constant velocity in its own frame."""
    motion = run_stages(melson, load_gait("melson/walk_arc"), "arc").motion
    figures = travel_figures(motion)
    vx, vy, wz = (float(figures[key] or 0.0) for key in ("vx", "vy", "wz"))
    single = np.flatnonzero(motion.support)
    t = np.linspace(0.0, motion.dt * (single[-1] - single[0] + 2), 20_000)
    heading = wz * t
    x = np.trapezoid(vx * np.cos(heading) - vy * np.sin(heading), t)
    y = np.trapezoid(vx * np.sin(heading) + vy * np.cos(heading), t)
    assert abs(wz) > 0.05
    assert figures["turn"] == pytest.approx(heading[-1], rel=0.01)
    gone = np.array([figures["distance_x"], figures["distance_y"]], dtype=float)
    assert np.hypot(*(gone - [x, y])) < 0.03 * np.hypot(*gone)


def test_resuming_a_complete_library_makes_nothing(copy: Path, made: Made, plan: Plan):
    """No cluster is asked for, so that none need be there."""
    summary = run_batch(plan, recipe_of(plan), copy, resume=True, address="tcp://127.0.0.1:1")
    assert (summary.kept, summary.done) == (len(plan.points), 0)
    assert_same_library(copy, made[0])


def test_resuming_makes_only_missing_and_damaged_gaits(
    copy: Path, made: Made, plan: Plan, address: str
):
    files = sorted((copy / "gaits").iterdir())
    files[0].unlink()
    files[1].write_bytes(files[1].read_bytes()[:-1])
    content = bytearray(files[2].read_bytes())
    content[len(content) // 2] ^= 1
    files[2].write_bytes(content)
    (copy / "gaits" / ".mgs-0123.part").write_bytes(b"half a file")
    with contextlib.closing(sqlite3.connect(copy / MANIFEST)) as connection, connection:
        connection.execute("DELETE FROM gaits WHERE number IN (5, 11)")
    before = {path.name: path.stat().st_mtime_ns for path in files[3:]}
    summary = run_batch(plan, recipe_of(plan), copy, resume=True, address=address)
    assert (summary.kept, summary.done) == (len(plan.points) - 5, 5)
    assert_same_library(copy, made[0])
    after = {path.name: path.stat().st_mtime_ns for path in sorted((copy / "gaits").iterdir())}
    assert {name for name in before if after[name] != before[name]} == {"000005.mcap"}


def test_a_library_is_not_overwritten(copy: Path, plan: Plan):
    with pytest.raises(MgsError, match="--resume"):
        run_batch(plan, recipe_of(plan), copy)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"axes": {"walk.step_length": [0.01]}}, "gaits, keys, number of gaits differ"),
        ({"filters": ["walk.step_length < 0.02"]}, "gaits, number of gaits differ"),
        ({"base": "melson/walk_practical"}, "base gait, gait name differ"),
    ],
)
def test_a_library_is_not_resumed_with_another_sweep(
    copy: Path, tmp_path: Path, change: dict[str, Any], told: str
):
    other = plan_sweep(write_sweep(tmp_path, **change))
    with pytest.raises(ConfigError) as caught:
        run_batch(other, recipe_of(other), copy, resume=True)
    assert told in str(caught.value)


def test_a_library_is_not_resumed_with_other_engines_or_another_robot(copy: Path, plan: Plan):
    import dataclasses

    recipe = recipe_of(plan)
    texts = {name: (yaml + "# heavier\n", urdf) for name, (yaml, urdf) in recipe.robots.items()}
    for changed, told in (
        (dataclasses.replace(recipe, engines=("mujoco",)), r"\(physics differ\)"),
        (dataclasses.replace(recipe, robots=texts), r"\(robots differ\)"),
    ):
        with pytest.raises(ConfigError, match=told):
            run_batch(plan, changed, copy, resume=True)


def test_two_runs_do_not_share_a_folder(copy: Path, plan: Plan):
    with locked(copy), pytest.raises(MgsError, match=f"process {os.getpid()} on .* is writing"):
        run_batch(plan, recipe_of(plan), copy, resume=True)


def test_a_missing_scheduler_and_a_damaged_manifest_are_refused(
    plan: Plan, tmp_path: Path, monkeypatch: Any
):
    monkeypatch.setattr("mgs.library.cluster.CONNECT_TIMEOUT", 0.5)
    with pytest.raises(MgsError, match="no Dask scheduler answers at tcp://127"):
        run_batch(plan, recipe_of(plan), tmp_path / "a", address="tcp://127.0.0.1:1")
    with pytest.raises(MgsError, match="no Dask scheduler answers at nonsense"):
        run_batch(plan, recipe_of(plan), tmp_path / "b", address="nonsense://x")
    with pytest.raises(MgsError, match=r"no Dask scheduler answers at tls://127.*TLS"):
        run_batch(plan, recipe_of(plan), tmp_path / "b", address="tls://127.0.0.1:1")
    (tmp_path / "c").mkdir()
    (tmp_path / "c" / MANIFEST).write_bytes(b"no database" * 1000)
    with pytest.raises(MgsError, match="no manifest of a gait library"):
        run_batch(plan, recipe_of(plan), tmp_path / "c", resume=True)


def test_a_folder_without_gaits_accepts_another_sweep(plan: Plan, tmp_path: Path, monkeypatch: Any):
    monkeypatch.setattr("mgs.library.cluster.CONNECT_TIMEOUT", 0.5)
    other = plan_sweep(write_sweep(tmp_path, axes={"walk.step_length": [0.01]}))
    for sweep in (plan, other):
        with pytest.raises(MgsError, match="no Dask scheduler"):
            run_batch(sweep, recipe_of(sweep), tmp_path / "lib", address="tcp://127.0.0.1:1")


def test_an_unexpected_error_concerns_its_gait_alone(plan: Plan, monkeypatch: pytest.MonkeyPatch):
    def broken(*_: Any) -> None:
        raise ZeroDivisionError("a mistake")

    monkeypatch.setattr(mgs.library.worker, "generate", broken)
    outcome = make_gait(recipe_of(plan), plan.assignments(0))
    assert outcome.row["verdict"] == "lost"
    assert outcome.row["reason"] == "ZeroDivisionError"
    assert outcome.content is None


def test_a_value_out_of_range_is_infeasible(plan: Plan):
    outcome = make_gait(recipe_of(plan), ("walk.step_length=7",))
    assert outcome.row["verdict"] == "infeasible"
    assert "less than or equal to 1 [m], found 7" in str(outcome.row["message"])


def test_physics_is_part_of_the_verdict(plan: Plan):
    import dataclasses

    recipe = dataclasses.replace(recipe_of(plan), engines=("mujoco",))
    row = make_gait(recipe, plan.assignments(4)).row
    assert (row["verdict"], row["survived"]) == ("pass", 1)
    assert 0.0 < float(row["max_tilt_deg"] or 0.0) < 10.0
    assert '"mujoco_upright"' in str(row["checks"])
    edge = ("com.generator=preview", "com.margin=0", "walk.zmp_offset=[0.0, -0.029]")
    fallen = make_gait(recipe, (*plan.assignments(4), *edge)).row  # 1 mm inside the outer edge
    assert (fallen["verdict"], fallen["survived"]) == ("fail", 0)
    assert "mujoco_upright" in str(fallen["reason"])


class Deadly(WorkerPlugin):
    """Has its worker killed by gaits of one length, each time or, with a file, the first time."""

    name = "deadly"

    def __init__(self, length: float, once: Path | None = None) -> None:
        self.length, self.once = length, once

    def setup(self, worker: object) -> None:
        real = generate

        def deadly(robot: Any, gait: Any, name: str) -> Any:
            if gait.walk.step_length == self.length:
                with contextlib.suppress(FileExistsError):
                    if self.once is not None:
                        self.once.touch(exist_ok=False)
                    os.kill(os.getpid(), signal.SIGKILL)
            return real(robot, gait, name)

        mgs.library.worker.generate = deadly

    def teardown(self, worker: object) -> None:
        mgs.library.worker.generate = generate


@contextlib.contextmanager
def deadly(address: str, plugin: Deadly) -> Iterator[None]:
    with Client(address) as client:
        client.register_plugin(plugin)
        try:
            yield
        finally:
            client.unregister_worker_plugin("deadly")


@pytest.mark.slow
def test_a_gait_that_kills_its_worker_twice_is_lost_and_the_others_are_made(
    plan: Plan, made: Made, address: str, tmp_path: Path
):
    folder = tmp_path / "lib"
    with deadly(address, Deadly(0.02)):
        summary = run_batch(plan, recipe_of(plan), folder, address=address)
    assert summary.reasons["KilledWorker"] == 2
    for row, undisturbed in zip(rows(folder), rows(made[0]), strict=True):
        if row["walk.step_length"] == 0.02:
            assert (row["verdict"], row["reason"]) == ("lost", "KilledWorker")
            assert row["file"] is None
        else:
            assert row["sha256"] == undisturbed["sha256"]
    summary = run_batch(plan, recipe_of(plan), folder, resume=True, address=address)
    assert summary.done == 2  # it says nothing about the gait that its worker died
    assert_same_library(folder, made[0])


def test_gaits_of_a_lost_worker_are_made_again(
    plan: Plan, made: Made, address: str, tmp_path: Path
):
    folder = tmp_path / "lib"
    with deadly(address, Deadly(0.02, once=tmp_path / "killed")):
        summary = run_batch(plan, recipe_of(plan), folder, address=address)
    assert (tmp_path / "killed").exists()
    assert summary.done == len(plan.points)
    assert_same_library(folder, made[0])


def start(sweep: Path, folder: Path, *options: str) -> subprocess.Popen[bytes]:
    """A run as a process."""
    # a shell that starts the tests in the background makes programs ignore Ctrl-C
    heeds = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    script = f"{heeds}; from mgs.cli import main; main(prog_name='mgs')"
    command = [sys.executable, "-c", script, "batch", "run", str(sweep), "-o", str(folder)]
    pipe = subprocess.PIPE
    return subprocess.Popen([*command, "--resume", *options], stdout=pipe, stderr=pipe)


def wait_for(folder: Path, n: int, process: subprocess.Popen[bytes]) -> None:
    """Until there are n files, or the process has ended."""
    while process.poll() is None and len(list((folder / "gaits").glob("*.mcap"))) < n:
        time.sleep(0.005)


@pytest.mark.parametrize("kind", ["link", "pipe", "folder"])
def test_a_lock_that_is_no_file_is_refused(kind: str, tmp_path: Path):
    """A library from somebody else could have the lock point to any file."""
    precious, lock = tmp_path / "precious", tmp_path / ".lock"
    precious.write_text("precious")
    make = {"link": lambda: lock.symlink_to(precious), "pipe": lambda: os.mkfifo(lock)}
    make.get(kind, lock.mkdir)()
    with pytest.raises(MgsError, match="instead of a lock file"), locked(tmp_path):
        pass
    assert precious.read_text() == "precious"


def test_a_killed_run_is_resumed(sweep: Path, plan: Plan, made: Made, address: str, tmp_path: Path):
    folder = tmp_path / "lib"
    for n in (1, 4):
        process = start(sweep, folder, "--dask", address)
        wait_for(folder, n, process)
        process.kill()
        process.communicate()
    assert process.returncode == -signal.SIGKILL
    summary = run_batch(plan, recipe_of(plan), folder, resume=True, address=address)
    assert summary.kept >= 1
    assert_same_library(folder, made[0])


def test_control_c_ends_a_run_within_two_seconds(sweep: Path, tmp_path: Path):
    """The workers of its own end with it."""
    for attempt in range(5):  # on a busy machine a run may end before the signal reaches it
        folder = tmp_path / f"lib{attempt}"
        process = start(sweep, folder, "--workers", "1")
        wait_for(folder, 1, process)
        workers = psutil.Process(process.pid).children(recursive=True)
        begun = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
        if process.returncode != 0:
            break
    waiting = max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))  # processes per processor core
    assert time.monotonic() - begun < 2.0 * waiting
    assert process.returncode == 1
    assert errors.decode() == (
        f"Error: interrupted; all gaits made so far are in {folder}; continue with --resume\n"
    )
    assert 1 <= len(rows(folder)) < 12
    _, alive = psutil.wait_procs(workers, timeout=5.0)
    assert not alive


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_while_workers_start_is_told_in_one_line(
    sent: signal.Signals, sweep: Path, tmp_path: Path
):
    """Dask cannot close a cluster that has not started, and would say so with a traceback.

    Python may warn of semaphores that the workers have not given back.
    """
    folder = tmp_path / "lib"
    process = start(sweep, folder, "--workers", "1")
    while not psutil.Process(process.pid).children():
        time.sleep(0.005)
    process.send_signal(sent)
    _, errors = process.communicate()
    assert process.returncode == 1
    told, *others = errors.decode().splitlines()
    expected = f"Error: interrupted; all gaits made so far are in {folder}; continue with --resume"
    assert told == expected
    assert "Traceback" not in errors.decode()
    assert not others or "leaked semaphore" in others[0]


FULL_DISK = """
mount -t tmpfs -o size={small}k tmpfs {folder} && cd {folder} || exit 77
{run} > out 2> {folder}.message; echo $? > {folder}.code
sqlite3_check() {{ {python} -c "import sqlite3; print(*sqlite3.connect('lib/manifest.sqlite') \
.execute('PRAGMA integrity_check').fetchone())"; }}
sqlite3_check > {folder}.integrity
mount -o remount,size=100m {folder}
{run}; code=$?
cp -r lib {folder}.lib
exit $code
"""


def test_a_full_disk_is_reported_and_the_run_is_resumed_with_more_space(
    sweep: Path, made: Made, address: str, tmp_path: Path
):
    folder = tmp_path / "disk"
    folder.mkdir()
    largest = max(row["bytes"] or 0 for row in rows(made[0]))
    script = "from mgs.cli import main; main(prog_name='mgs')"
    options = f"batch run {sweep} -o lib --resume --dask {address}"
    text = FULL_DISK.format(
        small=3 * largest // 1024 + 200, folder=folder, python=sys.executable,
        run=f'{sys.executable} -c "{script}" {options}',
    )  # fmt: skip
    if shutil.which("unshare") is None:
        pytest.skip("no unshare to mount a small disk with")
    done = subprocess.run(["unshare", "-rm", "sh", "-c", text], capture_output=True, text=True)
    if done.returncode in (1, 77) and not Path(f"{folder}.code").exists():
        pytest.skip(f"no small disk can be mounted here: {done.stderr}")
    assert done.returncode == 0, done.stderr
    assert Path(f"{folder}.code").read_text() == "1\n"
    message = Path(f"{folder}.message").read_text()
    assert "full" in message or "no space left on device" in message
    assert "make room, then continue with --resume" in message
    assert "Traceback" not in message
    assert Path(f"{folder}.integrity").read_text() == "ok\n"
    assert_same_library(Path(f"{folder}.lib"), made[0])


def test_a_worker_uses_one_thread_for_linear_algebra_and_builds_a_robot_once(
    plan: Plan, address: str, made: Made
):
    def told() -> tuple[str | None, int]:
        return os.environ.get("OPENBLAS_NUM_THREADS"), mgs.library.worker._robot.cache_info().misses

    with Client(address) as client:
        found = client.run(told)
    assert len(found) == 2
    assert all(threads == "1" and loaded <= 1 for threads, loaded in found.values())


MORE = {"walk.step_length": {"linspace": [0.0, 0.04, 20]}, "walk.first_support": ["left", "right"]}


@pytest.mark.slow
def test_a_run_killed_ten_times_equals_an_undisturbed_run(address: str, tmp_path: Path):
    """Moments while workers start and while gaits are made and written."""
    sweep = write_sweep(tmp_path, axes=MORE)
    plan, expected, folder = plan_sweep(sweep), tmp_path / "undisturbed", tmp_path / "lib"
    run_batch(plan, recipe_of(plan), expected, address=address)
    generator, progress = np.random.default_rng(0), []
    for _ in range(10):
        there = len(list((folder / "gaits").glob("*.mcap")))
        process = start(sweep, folder, "--workers", "2")
        wait_for(folder, there + int(generator.integers(0, 5)), process)
        time.sleep(float(generator.uniform(0.0, 0.5)))
        process.kill()
        process.communicate()
        assert process.returncode == -signal.SIGKILL
        progress.append(len(list((folder / "gaits").glob("*.mcap"))))
    assert progress[0] < progress[-1] < len(plan.points)
    process = start(sweep, folder, "--workers", "2")
    _, errors = process.communicate()
    assert process.returncode == 0, errors.decode()
    assert_same_library(folder, expected)


def dask_process(kind: str, *options: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *options, "--no-dashboard"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.mark.slow
def test_a_cluster_that_loses_a_worker_makes_every_gait_once(address: str, tmp_path: Path):
    """A scheduler and two workers that know of each other by TCP alone, as on three machines."""
    plan = plan_sweep(write_sweep(tmp_path, axes=MORE))
    expected, folder = tmp_path / "undisturbed", tmp_path / "lib"
    run_batch(plan, recipe_of(plan), expected, address=address)
    card, told = tmp_path / "scheduler.json", list[int]()
    options = ("--scheduler-file", str(card))
    scheduler = dask_process("scheduler", "--host", "127.0.0.1", "--port", "0", *options)
    workers = [dask_process("worker", *options, "--nthreads", "1", "--no-nanny") for _ in range(2)]
    try:
        while not card.exists():
            time.sleep(0.05)
        with Client(scheduler_file=str(card)) as client:
            client.wait_for_workers(2, timeout=60)
            there = client.scheduler.address

        def tell(summary: Summary) -> None:
            told.append(summary.done)
            if summary.done == len(plan.points) // 3:
                workers[0].kill()

        summary = run_batch(plan, recipe_of(plan), folder, address=there, tell=tell)
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()
    assert told == list(range(len(plan.points) + 1))
    assert summary.done == len(plan.points) == sum(summary.verdicts.values())
    assert_same_library(folder, expected)
