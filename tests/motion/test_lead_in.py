"""The way to the first frame of an exported motion."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from click.testing import CliRunner
from numpy.testing import assert_allclose
from scipy.interpolate import CubicHermiteSpline

from mgs.cli import main
from mgs.core.errors import ConfigError
from mgs.gait import load_gait
from mgs.motion import Motion
from mgs.motion.commanded import commanded
from mgs.motion.lead_in import with_lead_in
from mgs.motion.sampled import sample
from mgs.motion_file import write_motion
from mgs.motion_file.export import export
from mgs.pipeline import run_stages
from mgs.robot import load_robot
from mgs.robot.start_posture import start_posture
from mgs.robot.unit import load_unit

MELSON = load_robot("melson")


@pytest.fixture(scope="module")
def motion() -> Motion:
    return run_stages(MELSON, load_gait("melson/bow")).motion


@pytest.mark.parametrize("fps", [None, 30.0])
def test_joints_go_from_rest_in_the_posture_to_the_first_frame(motion: Motion, fps: float | None):
    start = start_posture(MELSON, "zero")
    plain = sample(motion, fps)
    led = with_lead_in(plain, 2.0, start)
    n = led.n_frames - plain.n_frames
    assert n == np.ceil(2.0 / plain.interval)
    assert_allclose(led.joints[0], start)
    assert_allclose(led.q[n:], plain.q)
    assert not led.v[0].any() and not led.joint_acceleration[0].any()
    # positions, velocities and accelerations are those of one curve
    curve = CubicHermiteSpline(led.times[: n + 1], led.joints[: n + 1], led.joint_velocity[: n + 1])
    second = curve(led.times[1:n], 2)
    assert_allclose(led.joint_acceleration[1:n], second, atol=0.02 * np.abs(second).max())
    assert np.all(
        np.diff(led.joints[: n + 1] - start, axis=0) * (plain.joints[0] - start) >= -1e-12
    )


def test_the_left_sole_stands_still_on_the_way(motion: Motion):
    led = with_lead_in(sample(motion), 2.0, start_posture(MELSON, "zero"))
    data = MELSON.model.createData()
    for q in led.q[::20]:
        pin.framesForwardKinematics(MELSON.model, data, q)
        sole = data.oMf[MELSON.sole_frames[0]].translation
        assert_allclose(sole, motion.soles_ref[0, 0, :3], atol=1e-4)


def test_commands_of_one_robot_begin_with_the_command_for_the_posture(
    motion: Motion, tmp_path: Path
):
    file = tmp_path / "unit.yaml"
    file.write_text(
        "mgs: 1\nunit: seven\nrobot: melson\n"
        "joints:\n  left_knee_pitch: {zero_offset: 0.05, sign: -1}\n"
    )
    unit = load_unit(file, MELSON)
    frames, start = commanded(sample(motion), unit), MELSON.posture
    led = with_lead_in(frames, 1.0, start, unit.command_for(start))
    knee = MELSON.joint_names.index("left_knee_pitch")
    assert led.joints[0, knee] == pytest.approx(-(start[knee] - 0.05))
    assert led.plan is not None and led.plan.n_frames == led.n_frames
    assert_allclose(led.plan.joints[0], start)


def test_a_way_that_is_too_fast_is_refused_with_the_time_that_suffices(motion: Motion):
    start = start_posture(MELSON, "zero")
    with pytest.raises(
        ConfigError, match=r"0\.1 s is too short: \w+ would exceed .* use at least"
    ) as e:
        with_lead_in(sample(motion), 0.1, start)
    least = float(str(e.value).rpartition("at least ")[2].split()[0])
    led = with_lead_in(sample(motion), least + 0.01, start)
    steps = np.abs(np.diff(led.joints, axis=0)) / motion.dt
    assert np.all(steps.max(axis=0) <= MELSON.speed_limit)


def test_export_with_a_posture_from_a_file(motion: Motion, tmp_path: Path):
    posture = tmp_path / "posture.yaml"
    posture.write_text("left_elbow_pitch: -0.4\n")
    path = export(motion, tmp_path / "a.csv", lead_in=1.5, lead_in_from=posture)
    table = np.genfromtxt(path, delimiter=",", names=True)
    name = "positionleft_elbow_pitch"
    assert table[name][0] == pytest.approx(-0.4)
    assert len(table) == motion.n_samples + round(1.5 / motion.dt)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "left_elbow: 0.1",
            "left_elbow: melson has no such joint; did you mean 'left_elbow_pitch'?",
        ),
        ("left_elbow_pitch: 9", "left_elbow_pitch: 9 rad is outside the joint's range"),
        ("left_elbow_pitch: bent", "left_elbow_pitch: 'bent' is not a number"),
        ("[1, 2]", "is not a list of angles by name"),
        (None, "posture.yaml"),
    ],
)
def test_wrong_postures_are_told_at_the_terminal(
    text: str | None, words: str, motion: Motion, tmp_path: Path
):
    file, posture = tmp_path / "bow.mcap", tmp_path / "posture.yaml"
    write_motion(motion, file)
    if text is not None:
        posture.write_text(text)
    done = CliRunner().invoke(
        main, ["export", str(file), "--lead-in", "2", "--lead-in-from", str(posture)]
    )
    assert done.exit_code == 2 and words in done.output
    assert not (tmp_path / "bow.csv").exists()
