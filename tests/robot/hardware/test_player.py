"""Streaming to simulated servos; the oracle is what the servos say that they were told."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mgs.core.errors import ConfigError, HardwareError
from mgs.robot.hardware.bus import Bus
from mgs.robot.hardware.line import Line, look_at, positions
from mgs.robot.hardware.player import (
    Played,
    approach_path,
    refuse_outside,
    stream,
    take_hold,
    torque_off,
)
from mgs.robot.hardware.watch import StopAt
from tests.support.dynamixel_bus import Setting, SimulatedBus, simulated_bus

RATE = 100.0  # [Hz]
PATIENT = StopAt(most_late=5.0, lost_after=100)  # the computers of tests are busy
SERIES = {
    "X": Setting(protocol=2, model=1020),
    "XL-320": Setting(protocol=2, model=350),
    "MX-28": Setting(protocol=1, model=29),
}


@contextmanager
def playing(folder: Path, setting: Setting) -> Iterator[tuple[SimulatedBus, Bus, Line]]:
    """A simulated line, a bus that is open, and servos that have torque."""
    with (
        simulated_bus(folder, setting) as simulated,
        Bus(simulated.port, 1_000_000, setting.protocol) as bus,
    ):
        line = look_at(bus, setting.servos)
        take_hold(bus, line)
        yield simulated, bus, line


def waves(line: Line, seconds: float, rate: float = RATE) -> np.ndarray:
    """Goals that differ from row to row and from servo to servo, around the middle."""
    t = np.arange(round(seconds * rate)) / rate
    middle = (line.lower + line.upper + 1) // 2
    phase = np.arange(len(line.servos))
    wave = np.sin(2.0 * np.pi * 0.7 * t[:, None] + phase) - np.sin(phase)
    return middle + np.rint(150.0 * wave).astype(np.int64)


def told(simulated: SimulatedBus, servo: int, since: float) -> tuple[np.ndarray, np.ndarray]:
    simulated.wait_until_quiet()
    writes = [w for w in simulated.goals(servo) if w.time >= since]
    return np.array([w.time for w in writes]), np.array([w.value for w in writes])


def rows_of(goals: np.ndarray, column: int, values: np.ndarray) -> np.ndarray:
    """Rows of the plan that the values are, each later than the one before; fails if not."""
    rows, row = [], -1
    for value in values:
        row = next(k for k in range(row + 1, len(goals)) if goals[k, column] == value)
        rows.append(row)
    return np.array(rows)


@pytest.mark.parametrize("series", SERIES)
def test_servos_are_told_the_plan_at_the_rate_asked_for(tmp_path, series):
    with playing(tmp_path, SERIES[series]) as (simulated, bus, line):
        goals = waves(line, 2.0)
        began = time.monotonic()
        played = stream(bus, line, goals, RATE, stop_at=PATIENT)
        assert played.stopped is None
        sent = played.jitter.sent
        assert sent + played.jitter.missed >= len(goals)
        for column, servo in enumerate(line.servos):
            times, values = told(simulated, servo, began)
            assert len(values) == sent
            rows = rows_of(goals, column, values)
            assert rows[-1] == len(goals) - 1
            # each goal at its own time on the clock: later by its delay, never by a sum of delays
            late = times - (played.start + rows / RATE)
            assert late.min() > 0.0
            assert np.median(late) < 0.05  # [s]; 0.6 s if delays of 3 ms added up
    assert 0.0 <= played.jitter.mean <= played.jitter.p99 <= played.jitter.worst


@pytest.mark.parametrize("series", ["X", "MX-28"])
@pytest.mark.slow_if("X")
def test_lost_and_damaged_packets_neither_stop_nor_distort_the_motion(tmp_path, series):
    setting = replace(SERIES[series], servos=tuple(range(1, 21)), lose=0.05, corrupt=0.01)
    with playing(tmp_path, setting) as (simulated, bus, line):
        goals = waves(line, 3.0)
        began = time.monotonic()
        played = stream(bus, line, goals, RATE, stop_at=PATIENT)
        assert played.stopped is None
        arrived = 0
        for column, servo in enumerate(line.servos):
            _, values = told(simulated, servo, began)
            rows_of(goals, column, values)
            arrived += len(values)
        expected = 0.94 * played.jitter.sent * len(line.servos)
        assert arrived == pytest.approx(expected, rel=0.05)
        assert sum(played.missed.values()) > 0
        last = {h.servo: h.position for h in played.heard}
        assert set(last) == set(line.servos)  # all were heard, those behind lost answers too


@pytest.mark.parametrize("series", ["X", "MX-28"])
def test_a_servo_that_falls_silent_stops_the_motion(tmp_path, series):
    setting = replace(SERIES[series], servos=(1, 2, 3, 4, 5), silent={"3": 1.0}, lose=0.05)
    with playing(tmp_path, setting) as (simulated, bus, line):
        goals = waves(line, 20.0)
        played = stream(bus, line, goals, RATE, stop_at=StopAt(most_late=5.0, lost_after=40))
        assert played.stop_kind == "lost"
        assert "servo 3 has not answered 40 times in a row" in str(played.stopped)
        assert played.jitter.sent < len(goals) // 2
        assert played.stop_seconds < 0.05
        _, values = told(simulated, 1, played.start)
        assert values[-1] == values[-2]  # told again to hold


@pytest.mark.parametrize("series", ["X", "MX-28", "XL-320"])
def test_an_overloaded_servo_stops_the_motion_and_is_named(tmp_path, series):
    setting = replace(SERIES[series], overload={"2": 0.5})
    with playing(tmp_path, setting) as (_, bus, line):
        played = stream(bus, line, waves(line, 20.0), RATE, stop_at=PATIENT)
        assert played.stop_kind == "error"
        assert played.stopped == "servo 2 reports an error: overload"


@pytest.mark.parametrize(("series", "register"), [("X", 65036), ("MX-28", 1024 + 500)])
def test_a_load_above_the_limit_stops_the_motion(tmp_path, series, register):
    """The registers say -500: as a two's complement, and with the direction in bit 10."""
    setting = replace(SERIES[series], load={"3": register})
    with playing(tmp_path, setting) as (_, bus, line):
        free = stream(bus, line, waves(line, 0.5), RATE, stop_at=PATIENT)
        assert free.stopped is None
        most = replace(PATIENT, max_load=499)
        played = stream(bus, line, waves(line, 20.0), RATE, stop_at=most)
        assert played.stopped == "servo 3 has a load of -500, more than 499"


@pytest.mark.parametrize("rate", [10.0, 100.0])
@pytest.mark.parametrize("off", [False, True], ids=["hold", "off"])
def test_servos_stop_within_50_ms_of_the_wish(tmp_path, off, rate):
    """The wish comes at a time that player and rate do not know; the servos' own log is asked."""
    asked: list[float] = []
    with playing(tmp_path, SERIES["X"]) as (simulated, bus, line):
        wish = time.monotonic() + 1.0373

        def stop() -> str | None:
            return "key" if time.monotonic() >= wish else None

        goals = waves(line, 20.0, rate)
        played = stream(bus, line, goals, rate, stop=stop, stop_at=PATIENT, off_when_stopped=off)
        assert played.stopped == "key"
        simulated.wait_until_quiet()
        for servo in line.servos:
            writes = simulated.torques(servo) if off else simulated.goals(servo)
            after = [w for w in writes if w.time > wish]
            assert len(after) >= 3
            asked.append(after[0].time - wish)
            assert {w.value for w in after} == ({0} if off else {simulated.goals(servo)[-1].value})
    assert max(asked) < 0.05


def test_torque_comes_on_without_a_jump(tmp_path):
    setting = replace(SERIES["X"], start={"1": 1500, "2": 2600, "3": 2050}, lose=0.05, corrupt=0.01)
    with (
        simulated_bus(tmp_path, setting) as simulated,
        Bus(simulated.port, 1_000_000, 2) as bus,
    ):
        line = look_at(bus, setting.servos)
        assert simulated.writes() == []  # looking changes nothing
        take_hold(bus, line)
        assert positions(bus, line).tolist() == [1500, 2600, 2050]
        first = {}
        for write in simulated.writes():
            first.setdefault((write.servo, write.address), write)
        for servo, start in zip((1, 2, 3), (1500, 2600, 2050), strict=True):
            assert first[servo, 116].value == start
            assert first[servo, 116].time < first[servo, 64].time
        torque_off(bus, line)
        simulated.wait_until_quiet()
        assert simulated.torques(1)[-1].value == 0


def test_the_approach_keeps_its_speed_and_ends_where_it_should():
    present, first = np.array([100, 2000, 700]), np.array([1100, 1900, 700])
    speed = np.array([400.0, 400.0, 400.0])  # [ticks/s]
    path = approach_path(present, first, speed, RATE)
    assert path[-1].tolist() == first.tolist()
    steps = np.diff(np.vstack([present, path]), axis=0) * RATE
    assert np.abs(steps).max() == pytest.approx(400.0, abs=RATE)  # one tick a period
    assert (np.abs(steps[[0, -1]]) <= RATE).all()
    assert len(path) / RATE == pytest.approx(1.875 * 1000 / 400, abs=0.02)


def test_servos_that_cannot_follow_are_refused(tmp_path):
    cases = {
        "does not answer": replace(SERIES["X"], servos=(1, 2)),
        "operating mode 1": replace(SERIES["X"], registers={"3:11:1": 1}),
        "hardware error (overload)": replace(SERIES["X"], registers={"2:70:1": 0x20}),
        "turns as a wheel": replace(SERIES["MX-28"], registers={"1:8:2": 0}),
        "Status Return Level": replace(SERIES["X"], status_level=0),
    }
    for words, setting in cases.items():
        with (
            simulated_bus(tmp_path, setting) as simulated,
            Bus(simulated.port, 1_000_000, setting.protocol) as bus,
            pytest.raises(HardwareError) as caught,
        ):
            look_at(bus, (1, 2, 3))
        assert words in str(caught.value), words


def test_goals_outside_the_limits_of_a_servo_are_refused(tmp_path):
    setting = replace(SERIES["X"], registers={"2:48:4": 2100})
    with playing(tmp_path, setting) as (_, bus, line):
        refuse_outside(np.full((3, 3), 2100), line)
        with pytest.raises(HardwareError, match=r"servo 2 go from 2048 to 2101 ticks"):
            refuse_outside(np.array([[2048] * 3, [2101] * 3]), line)
        assert bus.read(2, line.table.upper) == 2100


def test_a_speed_limit_in_a_servo_is_told(tmp_path):
    setting = replace(SERIES["X"], registers={"2:112:4": 30})
    with playing(tmp_path, setting) as (_, _, line):
        assert len(line.warnings) == 1
        assert "servo 2 limits its speed (value 30 at address 112)" in line.warnings[0]


def test_a_rate_that_leaves_no_time_for_answers_is_refused(tmp_path):
    """As with the latency timer of an adapter at its factory setting of 16 ms."""
    setting = replace(SERIES["X"], return_delay=0.016)
    with playing(tmp_path, setting) as (_, bus, line), pytest.raises(HardwareError) as caught:
        stream(bus, line, waves(line, 1.0), RATE)
    assert "latency timer of the USB adapter" in str(caught.value)
    assert "lower --rate to 2" in str(caught.value)


def test_a_port_that_is_not_there_is_a_wrong_option(tmp_path):
    with pytest.raises(ConfigError, match=r"--port: .*cannot be opened"):
        Bus(str(tmp_path / "ttyUSB9"), 1_000_000, 2)
    with pytest.raises(ConfigError, match=r"--baud: 12345 is no speed"):
        Bus(str(tmp_path / "ttyUSB9"), 12345, 2)


def test_a_port_that_goes_away_ends_the_motion(tmp_path):
    with playing(tmp_path, SERIES["X"]) as (simulated, bus, line):
        began = time.monotonic()

        def unplugged() -> None:
            if time.monotonic() > began + 0.5:
                simulated.process.kill()

        played: Played = stream(bus, line, waves(line, 20.0), RATE, stop=unplugged, stop_at=PATIENT)
    assert played.stop_kind in ("port", "lost")  # the device is gone, or nobody answers on it
