"""Mutations of one good motion: each must fail exactly its own check, and the unstable must fall.

Every mutation goes through a motion file and the command line, as a user's bad motion would.
"""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from mgs.cli import main
from mgs.com_generator import ComTrajectory, generate_com
from mgs.core.constants import FLOATING_BASE_NQ
from mgs.core.contact import Side, Support
from mgs.core.errors import IkError
from mgs.core.geometry import bump, quat_multiply, quintic
from mgs.gait import WalkGait, load_gait
from mgs.ik_solver import solve_ik
from mgs.judge.motion_checks import check_motion
from mgs.motion import Motion
from mgs.motion.dynamics import analyse
from mgs.motion_file import write_motion
from mgs.motion_planner import WalkPlan, plan_motion
from mgs.pipeline import assemble
from mgs.robot import Robot, build_robot, load_robot
from mgs.sim import available_engines
from mgs.trajectory_planner import TaskTrajectory, plan_trajectories

GAIT = load_gait(
    "melson/walk_practical", ("walk.n_steps=3", "walk.lead_in=1.8", "walk.lead_out=1.8")
)
assert isinstance(GAIT, WalkGait)


@dataclasses.dataclass(frozen=True)
class Draft:
    """Products of the stages, open to mutation between them."""

    robot: Robot
    gait: WalkGait
    plan: WalkPlan
    tasks: TaskTrajectory
    com: ComTrajectory

    def finish(
        self, tasks: TaskTrajectory | None = None, com: ComTrajectory | None = None
    ) -> Motion:
        tasks, com = tasks or self.tasks, com or self.com
        joints = solve_ik(self.robot, tasks, com, self.gait.ik)
        return assemble(self.robot, self.gait, "bad", self.plan, tasks, com, joints)


def draft(plan_change: Callable[[WalkPlan], WalkPlan] = lambda plan: plan) -> Draft:
    robot = load_robot("melson")
    plan = plan_change(plan_motion(robot, GAIT))
    tasks = plan_trajectories(plan)
    return Draft(robot, GAIT, plan, tasks, generate_com(robot, tasks, GAIT.com))


@pytest.fixture(scope="module")
def good() -> Motion:
    return draft().finish()


def failed(motion: Motion) -> set[str]:
    return {check.name for check in check_motion(motion) if not check.ok}


def with_robot(motion: Motion, yaml: tuple[str, str] = ("", ""), urdf: str | None = None) -> Motion:
    """The motion for a robot whose robot.yaml has one text replaced, or whose URDF is another."""
    text = motion.robot.yaml.replace(*yaml) if yaml[0] else motion.robot.yaml
    assert not yaml[0] or text != motion.robot.yaml
    robot = build_robot(text, urdf or motion.robot.urdf, "mutated")
    return dataclasses.replace(motion, robot=robot)


def limit_changed(urdf: str, joint: str, attribute: str, value: float) -> str:
    pattern = rf'(<joint name="{joint}".*?<limit[^>]*?{attribute}=")[^"]*'
    changed, count = re.subn(pattern, rf"\g<1>{value}", urdf, count=1, flags=re.DOTALL)
    assert count == 1
    return changed


def com_off() -> Motion:
    """CoM reference 65 mm too far back after the last step, and the joints follow it."""
    d = draft()
    position = d.com.position.copy()
    k = np.arange(len(position))
    position[:, 0] -= 0.065 * quintic((k - len(k) + 150) / 100)
    return d.finish(com=dataclasses.replace(d.com, position=position))


def com_not_met(good: Motion) -> Motion:
    """CoM reference 5 mm off, and the joints do not follow it."""
    return dataclasses.replace(good, com_ref=good.com_ref + np.array([0.005, 0.0, 0.0]))


def step_too_long(good: Motion) -> Motion:
    """The swing sole is asked 0.2 m farther than the leg went."""
    soles_ref = good.soles_ref.copy()
    swing = good.support == Support.LEFT
    soles_ref[swing, Side.RIGHT, 0] += 0.2 * bump(np.linspace(0.0, 1.0, swing.sum()))
    return dataclasses.replace(good, soles_ref=soles_ref)


def spacing_wrong(good: Motion) -> Motion:
    """The left sole is asked 8 mm farther out than it stands."""
    return dataclasses.replace(
        good, soles_ref=good.soles_ref + np.array([[0.0, 0.008, 0, 0, 0, 0, 0], [0.0] * 7])
    )


def limit_left(good: Motion) -> Motion:
    """The knee goes where its mechanism does not."""
    return with_robot(good, urdf=limit_changed(good.robot.urdf, "left_knee_pitch", "upper", 0.9))


def too_fast(good: Motion) -> Motion:
    """The right knee may turn at 1 rad/s only."""
    return with_robot(
        good, urdf=limit_changed(good.robot.urdf, "right_knee_pitch", "velocity", 1.0)
    )


def self_collision() -> Motion:
    """The hands are kept 3 cm lower and farther in, in the hips."""

    def inward(plan: WalkPlan) -> WalkPlan:
        offset = np.array([[0.0, -0.03, -0.03], [0.0, 0.03, -0.03]])
        return dataclasses.replace(plan, hand_offsets=plan.hand_offsets + offset)

    return draft(inward).finish()


def sliding() -> Motion:
    """The sole that does not carry the IK slides 10 mm outward and back in double support."""
    d = draft()
    soles = d.tasks.soles.copy()
    rest = slice(20, 160)  # both soles are down
    other = Side(d.tasks.root[0]).other
    soles[rest, other, 1] += other.sign * 0.01 * bump(np.linspace(0.0, 1.0, 140))
    return d.finish(tasks=dataclasses.replace(d.tasks, soles=soles))


def below_ground() -> Motion:
    """The swing sole goes 5 mm under the floor."""
    return draft(lambda plan: dataclasses.replace(plan, step_height=-0.005)).finish()


def torso_turned(good: Motion) -> Motion:
    """The torso is asked to pitch by 0.03 rad and back, and the joints do not follow."""
    half = 0.015 * bump(np.linspace(0.0, 1.0, good.n_samples))
    turn = np.stack([0.0 * half, np.sin(half), 0.0 * half, np.cos(half)], axis=1)
    return dataclasses.replace(good, torso_ref=quat_multiply(turn, good.torso_ref))


def weak_servo(good: Motion) -> Motion:
    """A quarter of the stall torque."""
    return with_robot(good, yaml=("stall_torque: 2.8", "stall_torque: 0.7"))


def twisting(good: Motion) -> Motion:
    """The trunk twists to and fro on one sole, as everything is asked to do."""
    k = np.flatnonzero(good.support == Support.RIGHT)
    q = good.q.copy()
    twist = bump(np.linspace(0.0, 1.0, len(k))) * np.sin(
        2 * np.pi * good.dt * 8.0 * np.arange(len(k))
    )
    q[k, FLOATING_BASE_NQ + good.robot.joint_names.index("waist_yaw")] += 0.05 * twist
    body = analyse(good.robot, q, good.dt, np.full(good.n_samples, 0.5))
    return dataclasses.replace(
        good,
        q=q,
        com_ref=body.com,
        hands_ref=body.hands[..., :3],
        torso_ref=body.torso[:, 3:],
    )


STATIC = {
    "com_off": ({"zmp_margin"}, lambda good: com_off()),
    "com_not_met": ({"com_position"}, com_not_met),
    "step_too_long": ({"sole_position"}, step_too_long),
    "spacing_wrong": ({"sole_position"}, spacing_wrong),
    "twisting": ({"yaw_friction"}, twisting),
    "limit_left": ({"joint_position"}, limit_left),
    "too_fast": ({"joint_speed"}, too_fast),
    "self_collision": ({"self_collision"}, lambda good: self_collision()),
    "sliding": ({"sole_still"}, lambda good: sliding()),
    "torso_turned": ({"torso_rotation"}, torso_turned),
    "below_ground": ({"sole_ground"}, lambda good: below_ground()),
    # a weak servo is too weak at its peak and for a while
    "weak_servo": ({"joint_torque", "joint_torque_rms"}, weak_servo),
}


def test_the_motion_they_are_made_of_passes_every_static_check(good: Motion) -> None:
    assert failed(good) == set()


@pytest.mark.parametrize("name", STATIC)
def test_a_bad_motion_fails_exactly_its_own_check(name: str, good: Motion, tmp_path: Path) -> None:
    expected, mutate = STATIC[name]
    path = tmp_path / f"{name}.mcap"
    write_motion(mutate(good), path)
    result = CliRunner().invoke(main, ["validate", str(path), "--physics", "none", "--json"])
    content = json.loads(result.stdout)
    assert {check["name"] for check in content["checks"] if not check["ok"]} == expected
    assert (result.exit_code, content["verdict"]) == (1, "fail")


@pytest.mark.parametrize("servo", ["ideal", "model"])
@pytest.mark.parametrize("engine", available_engines())
@pytest.mark.parametrize("name", ["com_off", "weak_servo"])
@pytest.mark.slow_if("pybullet")
def test_a_motion_that_falls_is_reported_as_fallen(
    name: str, engine: str, servo: str, good: Motion, tmp_path: Path
) -> None:
    path = tmp_path / f"{name}.mcap"
    write_motion(STATIC[name][1](good), path)
    options = ["--physics", engine, "--servo", servo, "--json"]
    result = CliRunner().invoke(main, ["validate", str(path), *options])
    content = json.loads(result.stdout)
    assert content["replays"][0]["fell"] is True
    assert f"{engine}_upright" in {c["name"] for c in content["checks"] if not c["ok"]}
    assert (result.exit_code, content["verdict"]) == (1, "fail")
    options = ["--engine", engine, "--servo", servo]
    replayed = CliRunner().invoke(main, ["replay", str(path), *options])
    assert replayed.exit_code == 1
    assert "FELL" in replayed.stdout


@pytest.mark.slow_if("pybullet")
@pytest.mark.parametrize("servo", ["ideal", "model"])
@pytest.mark.parametrize("engine", available_engines())
def test_the_motion_they_are_made_of_stays_up(
    engine: str, servo: str, good: Motion, tmp_path: Path
) -> None:
    path = tmp_path / "good.mcap"
    write_motion(good, path)
    options = ["--physics", engine, "--servo", servo, "--json"]
    result = CliRunner().invoke(main, ["validate", str(path), *options])
    assert (result.exit_code, json.loads(result.stdout)["verdict"]) == (0, "pass")


def test_a_step_too_long_for_the_leg_ends_in_an_error_and_no_file(tmp_path: Path) -> None:
    path = tmp_path / "long.mcap"
    arguments = [
        "generate",
        "melson/walk_practical",
        "-o",
        str(path),
        "--set",
        "walk.step_length=0.3",
    ]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 1
    assert re.search(
        r"t = \d+\.\d+ s: .* off, .* allowed; .*shorter walk\.step_length", result.stderr
    )
    assert list(tmp_path.iterdir()) == []


def test_an_ik_error_carries_time_task_and_distance() -> None:
    with pytest.raises(IkError) as caught:
        draft_gait = load_gait("melson/walk_practical", ("walk.step_length=0.3",))
        robot = load_robot("melson")
        tasks = plan_trajectories(plan_motion(robot, draft_gait))
        solve_ik(robot, tasks, generate_com(robot, tasks, draft_gait.com), draft_gait.ik)
    assert 0.0 < caught.value.t < 10.0
    assert caught.value.residual > caught.value.tolerance
