"""Figures of joints found again in logs that were made with them, by a law written here."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
import pytest

import mgs
from mgs.core.errors import ConfigError, LogError
from mgs.judge.logged.comparison import Comparison, compare_log, unit_spec
from mgs.judge.logged.load import loads
from mgs.motion import Motion
from mgs.motion.goals import goals_along
from mgs.motion_file.joint_log import JointLog
from mgs.robot.servos import servos_of
from mgs.robot.unit import unit_of

TICK = 2.0 * np.pi / 4096  # [rad]


@pytest.fixture(scope="module")
def squat() -> Motion:
    return mgs.generate(gait="melson/squat")


@dataclass(frozen=True)
class Truth:
    offset: np.ndarray  # (n,) [rad]
    backlash: np.ndarray  # (n,) [rad]
    stiffness: np.ndarray  # (n,) [N m/rad]
    delay: np.ndarray  # (n,) [s]


def truth(motion: Motion, seed: int) -> Truth:
    rng, n = np.random.default_rng(seed), motion.robot.n
    return Truth(
        offset=np.radians(rng.uniform(-1.5, 1.5, n)),
        backlash=np.radians(rng.uniform(0.3, 1.0, n)),
        stiffness=servos_of(motion.robot).stiffness * rng.uniform(0.8, 1.25, n),
        delay=0.03 + rng.uniform(0.0, 0.02, n),
    )


def logged(
    motion: Motion, true: Truth, rate: float, start: float, rest: float = 0.7, seed: int = 3
) -> JointLog:
    """Angles of joints at irregular times, in ticks of an encoder, with noise and gaps."""
    rng, robot = np.random.default_rng(seed), motion.robot
    servos, v = servos_of(robot), motion.v[:, 6:]
    load = motion.torque + servos.damping * v + servos.friction_under_load(v, motion.torque)
    goal = goals_along(motion).position
    # the play, told in words of its own: all of it beyond one hundredth of the stall torque
    play = np.where(
        np.abs(motion.torque) > 0.01 * robot.torque_limit,
        np.sign(motion.torque),
        100.0 * motion.torque / robot.torque_limit,
    )
    goes_to = goal + true.offset - load / true.stiffness - 0.5 * true.backlash * play
    times = np.arange(-rest, motion.duration + rest, 1.0 / rate)
    times = times + rng.uniform(-0.2, 0.2, len(times)) / rate
    columns = []
    for j in range(robot.n):
        y = np.interp(times - true.delay[j], motion.times, goes_to[:, j])
        columns.append(np.rint((y + rng.normal(0.0, 5e-4, len(y))) / TICK) * TICK)
    position = np.stack(columns, axis=1)
    position[rng.random(position.shape) < 0.05] = np.nan
    return JointLog("a test", robot.joint_names, times + start, position, None)


def test_delay_zero_play_and_stiffness_are_found_again(squat):
    true = truth(squat, 1)
    found = compare_log(squat, logged(squat, true, 90.0, 0.0), start=0.0)
    learned = 0
    for j, joint in enumerate(found.joints):
        if joint.fit.delay is not None and np.ptp(squat.q[:, 7 + j]) > np.radians(10.0):
            assert joint.fit.delay == pytest.approx(true.delay[j], abs=0.002)
        assert joint.fit.sign == 1
        if joint.stiffness is None or not joint.fit.knows_backlash:
            continue
        learned += 1
        assert joint.stiffness == pytest.approx(true.stiffness[j], rel=0.05)
        assert joint.fit.backlash == pytest.approx(true.backlash[j], abs=np.radians(0.1))
        assert joint.fit.zero_offset == pytest.approx(true.offset[j], abs=np.radians(0.05))
    assert learned >= 2  # the knees carry most
    assert np.degrees(found.rms(found.after)) < 0.2 * np.degrees(found.rms(found.before))


@pytest.mark.parametrize(("start", "rate"), [(12.345, 100.0), (-3.21, 31.7), (1.7e9, 250.0)])
def test_the_start_and_the_rate_of_the_log_may_be_any(squat, start, rate):
    true = truth(squat, 2)
    found = compare_log(squat, logged(squat, true, rate, start))
    assert found.found is not None
    seen = [joint for joint in found.joints if joint.fit.delay is not None]
    # the delay that all have in common is in the start
    common = float(np.median([true.delay[squat.robot.joint_names.index(j.name)] for j in seen]))
    assert found.start - start == pytest.approx(common, abs=0.004)
    for joint in seen:
        j = squat.robot.joint_names.index(joint.name)
        if np.ptp(squat.q[:, 7 + j]) > np.radians(10.0):
            expected = true.delay[j] - common
            assert joint.fit.delay == pytest.approx(expected, abs=0.004)


def test_the_corrections_bring_the_joints_to_the_plan(squat):
    """The unit's own law, solved for the command, against the law that made the log."""
    true = truth(squat, 4)
    found = compare_log(squat, logged(squat, true, 100.0, 5.0))
    unit = unit_of(unit_spec(found, squat, "no 7", "a test"), squat.robot)
    told = goals_along(squat, None, None, unit).position
    plain = goals_along(squat).position
    robot, servos, v = squat.robot, servos_of(squat.robot), squat.v[:, 6:]
    load = squat.torque + servos.damping * v + servos.friction_under_load(v, squat.torque)
    play = np.clip(100.0 * squat.torque / robot.torque_limit, -1.0, 1.0)

    def error(goal: np.ndarray) -> float:
        goes_to = goal + true.offset - load / true.stiffness - 0.5 * true.backlash * play
        return float(np.sqrt(np.mean((goes_to - squat.q[:, 7:]) ** 2)))

    assert error(told) < 0.15 * error(plain)


def test_a_joint_that_turns_the_other_way_is_told(squat):
    log = logged(squat, truth(squat, 5), 100.0, 2.0)
    j = squat.robot.joint_names.index("left_knee_pitch")
    position = log.position.copy()
    position[:, j] *= -1.0
    found = compare_log(squat, dataclasses.replace(log, position=position))
    assert [joint.name for joint in found.joints if joint.fit.sign < 0] == ["left_knee_pitch"]
    assert unit_spec(found, squat, "x", "").joints["left_knee_pitch"].sign == -1


def test_joints_that_do_not_give_way_are_rigid_and_not_as_described(squat):
    """Servos that reach their goals whatever they carry; the zeros are still found."""
    true = truth(squat, 11)
    stiff = dataclasses.replace(true, stiffness=1e9 * true.stiffness, backlash=0.0 * true.backlash)
    found = compare_log(squat, logged(squat, stiff, 100.0, 0.0), start=0.0)
    spec = unit_spec(found, squat, "rigid", "")
    for name in ("left_knee_pitch", "right_knee_pitch"):  # which carry most
        j = squat.robot.joint_names.index(name)
        joint = next(joint for joint in found.joints if joint.name == name)
        assert joint.fit.zero_offset == pytest.approx(true.offset[j], abs=np.radians(0.1))
        assert spec.joints[name].stiffness > 20.0 * servos_of(squat.robot).stiffness[j]
        assert joint.to_dict()["stiffness_error"] is None


def test_joints_that_are_missing_or_unknown_are_told(squat):
    log = logged(squat, truth(squat, 6), 100.0, 0.0)
    names = ("a_jaw", *log.names[1:])
    position = log.position.copy()
    position[:, 2] = np.nan
    found = compare_log(squat, dataclasses.replace(log, names=names, position=position))
    assert found.unknown == ("a_jaw",)
    assert found.without_log == (log.names[0], log.names[2])
    strangers = tuple(f"joint_{i}" for i in range(len(names)))
    with pytest.raises(ConfigError, match="has no joint of melson"):
        compare_log(squat, dataclasses.replace(log, names=strangers))


def cut(log: JointLog, first: float, last: float) -> JointLog:
    rows = (log.times >= first) & (log.times < last)
    return dataclasses.replace(log, times=log.times[rows], position=log.position[rows])


def test_logs_that_say_too_little_are_refused_with_the_reason(squat):
    true = truth(squat, 7)
    log = logged(squat, true, 100.0, 0.0)
    rest = dataclasses.replace(log, position=np.tile(log.position[:1], (len(log.times), 1)))
    rng = np.random.default_rng(0)
    noise = np.cumsum(rng.normal(0.0, 0.02, log.position.shape), axis=0)
    cases = [
        (cut(log, 1.0, 1.6), "too short"),
        (logged(squat, true, 4.0, 0.0), "too coarse"),
        (rest, "hardly moves"),
        (dataclasses.replace(log, position=noise), "does not show this motion"),
        (dataclasses.replace(log, position=np.degrees(log.position)), "add --degrees"),
    ]
    for poor, words in cases:
        with pytest.raises(LogError) as caught:
            compare_log(squat, poor)
        assert words in str(caught.value), words


def test_a_part_of_a_periodic_motion_is_ambiguous_and_the_whole_is_not():
    walk = mgs.generate(gait="melson/walk_5cm", walk__n_steps=10)
    true = truth(walk, 8)
    log = logged(walk, true, 100.0, 20.0)
    found: Comparison = compare_log(walk, log)
    assert found.start == pytest.approx(20.0, abs=0.06)
    middle = 20.0 + 0.5 * walk.duration
    with pytest.raises(LogError, match=r"the motion fits the log from .* and from .* give --start"):
        compare_log(walk, cut(log, middle - 0.75, middle + 0.75))
    given = compare_log(walk, cut(log, middle - 0.75, middle + 0.75), start=20.0)
    assert given.found is None
    delays = [joint.fit.delay for joint in given.joints if joint.fit.delay is not None]
    assert np.median(delays) == pytest.approx(0.04, abs=0.01)


def test_goals_that_were_others_are_refused(squat):
    log = logged(squat, truth(squat, 9), 100.0, 0.0)
    told = np.stack(
        [
            np.interp(log.times, squat.times, goals)
            for goals in goals_along(squat, None, "planned").position.T
        ],
        axis=1,
    )
    own = dataclasses.replace(log, command=told, is_motion_time=True)
    assert compare_log(squat, own, kind="planned").found is None
    other = dataclasses.replace(own, command=told + 0.1)
    with pytest.raises(LogError, match="give --goals and --unit"):
        compare_log(squat, other, kind="planned")


def test_corrections_of_corrected_goals_are_refused(squat):
    found = compare_log(squat, logged(squat, truth(squat, 10), 100.0, 0.0))
    spec = unit_spec(found, squat, "no 7", "")
    again = compare_log(
        squat, logged(squat, truth(squat, 10), 100.0, 0.0), unit=unit_of(spec, squat.robot)
    )
    with pytest.raises(LogError, match="corrected for 'no 7' already"):
        unit_spec(again, squat, "no 8", "")


def test_a_robot_that_is_hung_up_carries_its_limbs_alone(squat):
    """Torques of gravity on a still posture: the derivative of the potential energy by a joint."""
    import pinocchio as pin

    robot = squat.robot
    still = dataclasses.replace(
        squat, q=squat.q[:1].repeat(3, axis=0), v=np.zeros_like(squat.v[:3])
    )
    torque, _ = loads(still, hung=True)
    data, step = robot.model.createData(), 1e-6

    def energy(q: np.ndarray) -> float:
        return float(pin.computePotentialEnergy(robot.model, data, q))

    for j in range(robot.n):
        up, down = squat.q[0].copy(), squat.q[0].copy()
        up[7 + j] += step
        down[7 + j] -= step
        expected = (energy(up) - energy(down)) / (2.0 * step)
        assert torque[1, j] == pytest.approx(expected, abs=1e-6)
    standing, _ = loads(squat, hung=False)
    knee = robot.joint_names.index("left_knee_pitch")
    assert np.abs(standing[:, knee]).max() > 2.0 * np.abs(torque[:, knee]).max()
