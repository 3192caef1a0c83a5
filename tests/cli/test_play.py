"""The command mgs play, against simulated servos."""

from __future__ import annotations

import csv
import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from mgs.motion_file import read_motion
from mgs.robot.unit import JointCorrection, UnitSpec, write_unit
from tests.support.commands import SHORT_WALK, run
from tests.support.dynamixel_bus import ROOT, Setting, simulated_bus

SIGNS = {"left_knee_pitch": -1, "right_hip_roll": -1, "waist_yaw": -1}
OFFSETS = {"left_knee_pitch": 0.2, "left_elbow_pitch": -0.1}  # [rad]
RATE = 50  # [Hz], half of that of the motion
COMMON = ("--yes", "--lost-after", 500)  # the computers of tests are busy


@pytest.fixture(scope="module")
def walk(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("play") / "walk.mcap"
    assert run("generate", *SHORT_WALK, "-o", path).exit_code == 0
    return path


def motors_file(folder: Path, walk: Path, model: str) -> Path:
    """Motors of all joints, ids from 1, some of them turned round or off their middle."""
    lines = ["mgs: 1", "motors:"]
    for i, name in enumerate(read_motion(walk).robot.joint_names):
        sign, offset = SIGNS.get(name, 1), OFFSETS.get(name, 0.0)
        lines.append(
            f"  {name}: {{id: {i + 1}, model: {model}, sign: {sign}, zero_offset: {offset}}}"
        )
    path = folder / "motors.yaml"
    path.write_text("\n".join(lines))
    return path


def own_ticks(walk: Path, angles: np.ndarray, per_turn: float, middle: int) -> np.ndarray:
    names = read_motion(walk).robot.joint_names
    columns = []
    for name, q in zip(names, angles.T, strict=True):
        turned = SIGNS.get(name, 1) * q + OFFSETS.get(name, 0.0)
        columns.append(np.rint(middle + turned * per_turn / (2.0 * np.pi)))
    return np.stack(columns, axis=1).astype(int)


@pytest.mark.parametrize(
    ("model", "setting", "per_turn", "middle"),
    [
        ("XM430", Setting(protocol=2, model=1020), 4096, 2048),
        ("AX-12", Setting(protocol=1, model=12), 1024 * 360 / 300, 512),
    ],
)
@pytest.mark.slow_if("XM430")
def test_the_servos_receive_the_plan_and_the_log_shows_it(
    tmp_path, walk, model, setting, per_turn, middle
):
    motion = read_motion(walk)
    n = motion.robot.n
    setting = Setting(**{**vars(setting), "servos": tuple(range(1, n + 1))})
    motors, log = motors_file(tmp_path, walk, model), tmp_path / "log.csv"
    expected = own_ticks(walk, motion.q[:: round(1.0 / (RATE * motion.dt)), 7:], per_turn, middle)
    with simulated_bus(tmp_path, setting) as bus:
        result = run(
            *("play", walk, "--port", bus.port, "--motors", motors, "--goals", "planned", *COMMON),
            *("--rate", RATE, "--log", log, "--json", "--at-end", "off"),
        )
        assert result.exit_code == 0, result.output
        found = json.loads(result.stdout)
        assert found["stopped"] is None
        assert found["torque"] is False
        assert found["approach"]["goals"] > 10
        bus.wait_until_quiet()
        sent = found["motion"]["jitter"]["sent"]
        assert sent + found["motion"]["jitter"]["missed"] >= len(expected)
        for i in range(n):
            values = np.array([w.value for w in bus.goals(i + 1)])[-sent:]
            rows = iter(expected[:, i])  # in their order; deadlines that were missed are left out
            assert all(value in rows for value in values)
            assert values[-1] == expected[-1, i]
            assert bus.torques(i + 1)[-1].value == 0
    with log.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    last = {}
    for row in rows:
        for name in motion.robot.joint_names:
            if cell := row[f"position.{name}"]:
                last[name] = (float(row["motion_time"]), float(cell))
    for i, name in enumerate(motion.robot.joint_names):
        t, angle = last[name]
        assert t == pytest.approx(motion.duration, abs=0.5)
        assert angle == pytest.approx(motion.q[-1, 7 + i], abs=0.05)  # [rad] of the lag of 30 ms


def test_another_rate_sends_points_on_the_same_curves(tmp_path, walk):
    motors = motors_file(tmp_path, walk, "XM430")
    motion = read_motion(walk)
    result = run("play", walk, "--dry-run", "--motors", motors, "--goals", "planned", "--rate", 130,
                 "--json")  # fmt: skip
    found = json.loads(result.stdout)
    ticks = np.array(found["ticks"])
    times = np.arange(len(ticks)) / 130.0
    assert times[-1] == pytest.approx(motion.duration, abs=1.0 / 130.0)
    for i in range(motion.robot.n):  # linear between samples: apart by a dt^2 / 8 at most
        linear = np.interp(times, motion.times, motion.q[:, 7 + i])
        expected = own_ticks(walk, np.tile(linear[:, None], motion.robot.n), 4096, 2048)[:, i]
        assert np.abs(ticks[:, i] - expected).max() <= 2


def test_a_unit_shifts_the_goals(tmp_path, walk):
    motors, robot = motors_file(tmp_path, walk, "XM430"), read_motion(walk).robot
    unit = tmp_path / "unit.yaml"
    joints = {"left_knee_pitch": JointCorrection(zero_offset=0.05)}
    write_unit(UnitSpec(mgs=1, unit="no 7", robot=robot.spec.name, joints=joints), unit)
    common = ("play", walk, "--dry-run", "--motors", motors, "--goals", "planned", "--json")
    plain, told = (json.loads(run(*common, *more).stdout) for more in ((), ("--unit", unit)))
    assert (plain["unit"], told["unit"]) == (None, "no 7")
    shift = np.array(told["ticks"]) - np.array(plain["ticks"])
    knee = robot.joint_names.index("left_knee_pitch")
    assert np.abs(shift[:, knee] - 0.05 * 4096 / (2.0 * np.pi)).max() <= 1.0  # sign -1: more ticks
    assert not np.delete(shift, knee, axis=1).any()


def test_the_commanded_angles_are_the_default_where_servos_are_described(tmp_path, walk):
    motors = motors_file(tmp_path, walk, "XM430")
    result = run("play", walk, "--dry-run", "--motors", motors)
    assert "dry run, nothing is sent" in result.stdout
    assert "commanded joint angles" in result.stdout
    assert "left_knee_pitch" in result.stdout


def test_without_an_approach_a_distant_posture_is_refused(tmp_path, walk):
    motors = motors_file(tmp_path, walk, "XM430")
    with simulated_bus(tmp_path, Setting(servos=tuple(range(1, 20)))) as bus:
        common = ("play", walk, "--port", bus.port, "--motors", motors, "--rate", RATE)
        refused = run(*common, "--no-approach", "--yes")
        assert refused.exit_code == 1
        assert "bring the robot into its first posture or allow an approach" in refused.stderr
        declined = run(*common)  # nobody is there to say yes
        assert declined.exit_code == 1
        assert "the robot goes there in" in declined.stdout
        assert bus.writes() == []


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "--port: name the serial port"),
        (("--port", "/dev/nothing"), "cannot be opened"),
        (("--port", "/dev/nothing", "--protocol", 1), "--protocol: the motors have protocol 2.0"),
    ],
)
def test_wrong_options_are_refused(tmp_path, walk, options, words):
    motors = motors_file(tmp_path, walk, "XM430")
    result = run("play", walk, "--motors", motors, *options)
    assert (result.exit_code, words in result.stderr) == (2, True), result.stderr


def test_a_robot_without_motors_and_motors_of_another_maker_are_refused(tmp_path, walk):
    result = run("play", walk, "--dry-run")
    assert (result.exit_code, "no motor given for" in result.stderr) == (2, True)
    motors = motors_file(tmp_path, walk, "STS3215")
    result = run("play", walk, "--port", "x", "--motors", motors)
    assert (result.exit_code, "Dynamixel servos, and not" in result.stderr) == (2, True)


def test_servos_of_another_series_than_the_motors_say_are_refused(tmp_path, walk):
    """XL-320 in place of XM430, with limits wide enough for the goals."""
    motors, servos = motors_file(tmp_path, walk, "XM430"), tuple(range(1, 20))
    wide = {f"{servo}:8:2": 4095 for servo in servos}
    with simulated_bus(tmp_path, Setting(servos=servos, model=350, registers=wide)) as bus:
        result = run(
            "play", walk, "--port", bus.port, "--motors", motors, "--rate", RATE, "--yes"
        )  # fmt: skip
        assert (result.exit_code, "control table of XL-320" in result.stderr) == (2, True)
        assert bus.writes() == []


@pytest.mark.parametrize("how", ["key", "ctrl-c"])
def test_a_key_or_ctrl_c_stops_within_50_ms(tmp_path, walk, how):
    """The process has a terminal of its own; the servos' log says when they were told to hold."""
    motors = motors_file(tmp_path, walk, "XM430")
    with simulated_bus(tmp_path, Setting(servos=tuple(range(1, 20)))) as bus:
        master, slave = pty.openpty()
        command = ["play", str(walk), "--port", bus.port, "--motors", str(motors), "--json"]
        command += [*map(str, COMMON), "--approach", "5", "--on-stop", "off"]
        command += ["--rate", str(RATE)]
        with subprocess.Popen(
            [sys.executable, "-m", "mgs", *command],
            stdin=slave, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT,
        ) as process:  # fmt: skip
            try:
                deadline = time.monotonic() + 60.0
                while len(bus.goals(1)) < 40:
                    assert process.poll() is None, process.communicate()
                    assert time.monotonic() < deadline
                    time.sleep(0.02)
                wish = time.monotonic()
                if how == "key":
                    os.write(master, b" ")
                else:
                    process.send_signal(signal.SIGINT)
                out, _ = process.communicate(timeout=30)
            finally:
                process.kill()
                os.close(slave)
                os.close(master)
        bus.wait_until_quiet()
        found = json.loads(out)
        assert process.returncode == 1
        assert found["stopped"] == ("a key was pressed" if how == "key" else "Ctrl-C")
        assert found["motion"] is None  # it was stopped on the way to the first posture
        for servo in range(1, 20):
            off = [w.time for w in bus.torques(servo) if w.value == 0]
            assert len(off) == 3
            assert 0.0 < off[0] - wish < 0.05
