"""Tests of mgs generate: output, files, errors, and files after a failure."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from mgs.core.shipped import shipped_folder
from mgs.motion_file import read_motion
from tests.support.commands import SHORT_WALK, files_below, run, run_process
from tests.support.strategies import balance_gait, constant, numbers, sine

MELSON = shipped_folder("robots") / "melson"
STAGES = ("motion_planner", "trajectory_planner", "com_generator", "ik_solver", "write", "total")
UNREACHABLE = ("--set", "walk.step_length=0.3")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Empty working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


# --- what it says -----------------------------------------------------------------------------


def test_json_is_one_object_of_the_agreed_shape(here: Path):
    result = run("generate", *SHORT_WALK, "-o", "walk.mcap", "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    summary = json.loads(result.stdout)
    assert {key: summary[key] for key in ("file", "robot", "gait", "solver")} == {
        "file": "walk.mcap",
        "robot": "melson",
        "gait": "walk_practical",
        "solver": "clik",
    }
    motion = read_motion(here / "walk.mcap")
    assert (summary["samples"], summary["dt"]) == (motion.n_samples, motion.dt)
    assert summary["duration"] == pytest.approx((summary["samples"] - 1) * summary["dt"])
    tracking, seconds = summary["tracking"], summary["seconds"]
    assert set(tracking) == {
        "sole_position",
        "sole_rotation",
        "hand_position",
        "torso_rotation",
        "com",
    }
    assert all(0.0 <= value < 1e-3 for value in tracking.values())
    error = summary["zmp_error"]
    assert set(error) == {"before", "after", "passes"} and error["passes"] in range(4)
    assert 0.0 < error["after"]["mean"] < error["before"]["mean"] < error["before"]["max"] < 0.03
    assert set(seconds) >= set(STAGES)
    assert seconds["total"] >= sum(t for stage, t in seconds.items() if stage != "total")


def test_the_summary_names_file_duration_and_tracking_errors(here: Path):
    result = run("generate", *SHORT_WALK, "-o", "walk.mcap")
    assert (result.exit_code, result.stderr) == (0, "")
    for text in ("walk.mcap", "melson", "3.50 s, 351 samples", "tracking", "from its limit", "ms"):
        assert text in result.stdout
    assert "passes of the dynamic filter" in result.stdout


def test_a_process_prints_json_and_nothing_else(tmp_path: Path):
    done = run_process("generate", *SHORT_WALK, "-o", "walk.mcap", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, b"")
    assert json.loads(done.stdout)["file"] == "walk.mcap"
    assert list(files_below(tmp_path)) == ["walk.mcap"]


def test_the_same_command_gives_the_same_bytes(here: Path):
    for name in ("a.mcap", "b.mcap"):
        assert run("generate", *SHORT_WALK, "-o", name).exit_code == 0
    files = files_below(here)
    assert files["a.mcap"] == files["b.mcap"]


# --- where it writes --------------------------------------------------------------------------


def test_without_an_output_the_file_goes_below_outputs(here: Path):
    assert run("generate", *SHORT_WALK).exit_code == 0
    assert list(files_below(here)) == ["outputs/melson/walk_practical.mcap"]


def test_folders_of_the_output_are_made(here: Path):
    assert run("generate", *SHORT_WALK, "-o", "a/b/walk.mcap").exit_code == 0
    assert list(files_below(here)) == ["a/b/walk.mcap"]


def test_a_file_in_the_way_is_left_as_it_is(here: Path):
    (here / "walk.mcap").write_text("mine")
    result = run("generate", *SHORT_WALK, "-o", "walk.mcap")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "walk.mcap exists; use --force" in result.stderr
    assert files_below(here) == {"walk.mcap": b"mine"}


def test_force_replaces_the_file(here: Path):
    (here / "walk.mcap").write_text("mine")
    assert run("generate", *SHORT_WALK, "-o", "walk.mcap", "--force").exit_code == 0
    assert read_motion(here / "walk.mcap").n_samples == 351
    assert list(files_below(here)) == ["walk.mcap"]


def test_even_force_keeps_the_old_file_when_the_gait_is_infeasible(here: Path):
    (here / "walk.mcap").write_text("mine")
    result = run("generate", *SHORT_WALK, *UNREACHABLE, "-o", "walk.mcap", "--force")
    assert result.exit_code == 1
    assert files_below(here) == {"walk.mcap": b"mine"}


@pytest.mark.parametrize("force", [(), ("--force",)])
def test_a_folder_in_the_way_is_no_output(here: Path, force: tuple[str, ...]):
    (here / "walk.mcap").mkdir()
    result = run("generate", *SHORT_WALK, "-o", "walk.mcap", *force)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "walk.mcap" in result.stderr


@pytest.mark.parametrize(
    "output", ["file/walk.mcap", "/proc/nowhere/walk.mcap", "", "n" * 300, "broken/walk.mcap"]
)
def test_where_nothing_can_be_written_a_message_says_so(here: Path, output: str):
    (here / "file").write_text("mine")
    (here / "broken").symlink_to(here / "gone")
    result = run("generate", *SHORT_WALK, "-o", output)
    if result.exit_code == 0:  # a link to a folder that does not exist: the folder is made
        assert output.startswith("broken") and (here / "gone" / "walk.mcap").is_file()
        return
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.startswith("Error: ")
    assert len(result.stderr.splitlines()) == 1
    assert files_below(here) == {"file": b"mine"}


def test_a_folder_without_write_permission_is_a_message(here: Path, monkeypatch):
    """The error is simulated, because root may write anywhere."""

    def refuse(self: Path, *_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr(Path, "mkdir", refuse)
    result = run("generate", *SHORT_WALK, "-o", "locked/walk.mcap")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr == "Error: locked/walk.mcap: cannot be written: permission denied\n"


def test_a_path_with_bytes_that_are_not_utf8_is_written_and_named(here: Path):
    """Linux allows any bytes in file names; in the motion file invalid bytes are replaced."""
    gait = here / "g\udcff.yaml"
    shutil.copy(shipped_folder("gaits") / "melson" / "walk_practical.yaml", gait)
    assert run("generate", gait, *SHORT_WALK[1:], "-o", "o\udcff.mcap").exit_code == 0
    assert read_motion(here / "o\udcff.mcap").gait_name == "g?"


# --- what it is told --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("assignments", "expected"),
    [
        (["walk.n_steps=4"], {"walk": {"n_steps": 4}}),
        (["ik.gamma_joint=0", "walk.step_length=0.03"], {"ik": {"gamma_joint": 0.0}}),
        (["com.weight_jerk=1e-7"], {"com": {"weight_jerk": 1e-7}}),
        (["walk.first_support=null"], {"walk": {"first_support": None}}),
        (["walk.zmp_offset=[0.005, 0.0]"], {"walk": {"zmp_offset": [0.005, 0.0]}}),
        (["walk.n_steps=2", "walk.n_steps=3"], {"walk": {"n_steps": 3}}),
    ],
)
def test_set_changes_values_of_the_gait(here: Path, assignments, expected):
    options = [word for assignment in assignments for word in ("--set", assignment)]
    assert run("generate", *SHORT_WALK, *options, "-o", "walk.mcap").exit_code == 0
    gait = read_motion(here / "walk.mcap").gait.model_dump()
    for block, values in expected.items():
        assert {key: gait[block][key] for key in values} == values


@pytest.mark.parametrize(
    ("assignment", "part"),
    [
        ("walk.n_steps", "not of the form key.sub=value"),
        ("=3", "not of the form key.sub=value"),
        ("walk.n_steps=three", "walk.n_steps"),
        ("walk.n_steps=2.5", "walk.n_steps"),
        ("walk.n_step=3", "did you mean 'n_steps'?"),
        ("walk.step_length=.nan", "finite number"),
        ("ik.solver=magic", "ik.solver"),
        ("walk.n_steps.more=3", "no such group"),
        ("walk.n_steps=[", "--set walk.n_steps"),
        ("robot=null", "robot: missing"),
    ],
)
def test_a_bad_assignment_is_a_usage_error(here: Path, assignment: str, part: str):
    result = run("generate", "melson/walk_5cm", "--set", assignment)
    assert (result.exit_code, result.stdout) == (2, "")
    assert part in result.stderr
    assert files_below(here) == {}


@pytest.mark.parametrize("name", ["nowhere.yaml", "melson/nothing", "", ".", "a\0b", "n" * 5000])
def test_an_unknown_gait_is_refused_with_the_command_that_lists_gaits(here: Path, name: str):
    result = run("generate", name)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "mgs gait list" in result.stderr
    assert files_below(here) == {}


@pytest.mark.parametrize(
    "text", ["nao", "./nowhere", "null", "123", "[melson]", "a: b", "n" * 150, "ö" * 150, "n" * 500]
)
def test_an_unknown_robot_is_refused(here: Path, text: str):
    result = run("generate", "melson/walk_5cm", "--robot", text)
    assert (result.exit_code, result.stdout) == (2, "")
    assert len(result.stderr.splitlines()) == 1
    assert files_below(here) == {}


@pytest.mark.parametrize("name", ["mine", "123", "true", "a: b", "{x}", "it's"])
def test_a_robot_folder_is_found_whatever_its_name(here: Path, name: str):
    shutil.copytree(MELSON, here / name)
    result = run("generate", *SHORT_WALK, "--robot", name, "-o", "walk.mcap", "--json")
    assert result.exit_code == 0
    assert read_motion(here / "walk.mcap").gait.robot == name
    assert json.loads(result.stdout)["robot"] == "melson"  # the name in its robot.yaml


def test_the_option_robot_takes_precedence_over_the_gait_file(here: Path):
    tree = yaml.safe_load((shipped_folder("gaits") / "melson" / "walk_practical.yaml").read_text())
    for robot in ("nao", None):
        (here / "walk.yaml").write_text(yaml.safe_dump(tree | {"robot": robot}))
        command = ("generate", "walk.yaml", *SHORT_WALK[1:], "-o", "walk.mcap", "--force")
        assert run(*command).exit_code == 2
        assert run(*command, "--robot", "melson").exit_code == 0


def test_the_solver_is_chosen_by_ik(here: Path):
    assert run("generate", *SHORT_WALK, "--ik", "clik", "-o", "walk.mcap").exit_code == 0
    result = run("generate", *SHORT_WALK, "--ik", "magic", "-o", "other.mcap")
    assert result.exit_code == 2
    assert "ik.solver: 'magic' is not installed" in result.stderr
    assert "known: clik, ik1, " in result.stderr
    assert list(files_below(here)) == ["walk.mcap"]


# --- balance motions --------------------------------------------------------------------------


def test_a_balance_motion_is_generated_and_passes_every_static_check(here: Path):
    (here / "sway.yaml").write_text(balance_gait(sine("com_y", 0.02)).to_yaml())
    made = run("generate", "sway.yaml", "--robot", "melson", "-o", "sway.mcap", "--json")
    assert (made.exit_code, made.stderr) == (0, "")
    summary = json.loads(made.stdout)
    assert (summary["samples"], summary["gait"]) == (401, "sway")
    assert summary["zmp_error"] is None
    judged = run("validate", "sway.mcap", "--physics", "none", "--json")
    assert (judged.exit_code, json.loads(judged.stdout)["verdict"]) == (0, "pass")
    assert all(check["ok"] for check in json.loads(judged.stdout)["checks"])
    told = run("info", "sway.mcap")
    assert (told.exit_code, told.stderr) == (0, "")


@pytest.mark.parametrize(
    ("channel", "exit_code", "part"),
    [
        (constant("torso_yaw", 0.1), 2, "ik.solver: clik leaves the torso free"),
        (constant("com_y", 0.3), 1, "use a smaller com_y"),
        (constant("com_x", 3.0), 2, "balance.channels.0.value: input should be less than"),
    ],
)
def test_a_balance_motion_that_cannot_be_made_leaves_a_message_and_no_file(
    here: Path, channel: dict[str, Any], exit_code: int, part: str
):
    tree = yaml.safe_load(balance_gait(constant("com_x", 0.0)).to_yaml())
    tree["balance"]["channels"] = [channel]
    (here / "bad.yaml").write_text(yaml.safe_dump(tree))
    result = run("generate", "bad.yaml", "--robot", "melson", "-o", "bad.mcap")
    assert (result.exit_code, result.stdout) == (exit_code, "")
    assert part in result.stderr
    assert list(files_below(here)) == ["bad.yaml"]


def test_a_hand_of_locked_arms_is_a_usage_error(here: Path):
    (here / "bad.yaml").write_text(balance_gait(constant("left_hand_x", 0.01)).to_yaml())
    result = run("generate", "bad.yaml", "--robot", "coman_legs", "-o", "bad.mcap")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "left_hand: coman_legs cannot move it relative to its torso" in result.stderr


# --- when it fails ----------------------------------------------------------------------------


def test_an_infeasible_gait_is_exit_code_one_with_the_time_and_a_remedy(here: Path):
    result = run("generate", *SHORT_WALK, *UNREACHABLE)
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.startswith("Error: t = ")
    assert "; use a shorter walk.step_length" in result.stderr
    assert list(here.iterdir()) == []


def test_footsteps_that_overlap_are_exit_code_one(here: Path):
    result = run("generate", *SHORT_WALK, "--set", "walk.step_width=0.03")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "overlap" in result.stderr
    assert list(here.iterdir()) == []


PLACES = [
    "mgs.pipeline.stages.plan_motion",
    "mgs.pipeline.stages.plan_trajectories",
    "mgs.pipeline.dynamic_filter.generate_com",
    "mgs.pipeline.dynamic_filter.solve_ik",
    "mgs.pipeline.stages.assemble",
    "mgs.motion_file.write._sample_blocks",
]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(
    ("error", "message"),
    [(KeyboardInterrupt, "Aborted!"), (MemoryError, "Error: not enough memory")],
)
def test_an_interrupted_stage_leaves_no_file(
    here: Path, monkeypatch: pytest.MonkeyPatch, place: str, error: type[BaseException], message
):
    def interrupt(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(place, interrupt)
    result = run("generate", *SHORT_WALK, "-o", "new/walk.mcap")
    assert (result.exit_code, result.stdout) == (1, "")
    assert message in result.stderr
    assert list(here.iterdir()) == []  # no folder, no partial file


def test_a_full_disk_leaves_no_file(here: Path, monkeypatch: pytest.MonkeyPatch):
    def no_space(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("mgs.motion_file.write._sample_blocks", no_space)
    (here / "walk.mcap").write_text("mine")
    result = run("generate", *SHORT_WALK, "-o", "walk.mcap", "--force")
    assert result.exit_code == 1
    assert "walk.mcap: cannot be written: no space left on device" in result.stderr
    assert files_below(here) == {"walk.mcap": b"mine"}


def positive(high: float) -> st.SearchStrategy[float]:
    return st.floats(0.0, high, exclude_min=True)


# key: values that Melson can walk with, and all that a gait file allows
RANGES: dict[str, tuple[st.SearchStrategy[object], st.SearchStrategy[object]]] = {
    "dt": (st.sampled_from([0.005, 0.01, 0.02]), numbers(0.005, 0.1)),
    "walk.n_steps": (st.integers(2, 4), st.just(1)),
    "walk.step_length": (numbers(-0.05, 0.05), numbers(-1.0, 1.0)),
    "walk.lateral": (st.just(0.0), numbers(-1.0, 1.0)),
    "walk.step_yaw": (st.just(0.0), numbers(-1.0, 1.0)),
    "walk.step_width": (st.none(), positive(2.0)),
    "walk.first_support": (st.none(), st.sampled_from(["left", "right"])),
    "walk.lead_in": (numbers(0.8, 1.2), numbers(0.8, 5.0)),
    "walk.double_support": (numbers(0.2, 0.8), positive(1.0)),
    "walk.single_support": (numbers(0.4, 0.8), positive(1.0)),
    "walk.lead_out": (numbers(0.8, 1.2), numbers(0.8, 5.0)),
    "walk.step_height": (numbers(0.01, 0.03), positive(0.5)),
    "walk.com_height": (st.none(), numbers(1e-3, 3.0)),
    "walk.zmp_offset": (st.just([0.0, 0.0]), st.lists(numbers(-1, 1), min_size=2, max_size=2)),
    "com.preview": (st.just(0.8), numbers(0.1, 0.8)),
    "com.generator": (st.just("preview"), st.just("qp")),
    "com.margin": (st.just(0.0), numbers(0.0, 1.0)),
    "com.passes": (st.integers(0, 3), st.integers(0, 50)),
    "com.zmp_tolerance": (st.just(2e-4), positive(1.0)),
    "com.weight_error": (st.just(1.0), positive(1e12)),
    "com.weight_jerk": (st.sampled_from([1e-8, 1e-6]), positive(1e6)),
    "ik.gamma_joint": (numbers(0.0, 1.0), numbers(0.0, 1e3)),
    "ik.gamma_grav": (numbers(0.0, 1.6), numbers(0.0, 1e3)),
    "ik.gamma_grav_ramp": (st.just(0.2), numbers(1e-4, 10.0)),
    "ik.iterations": (st.none(), st.integers(0, 50)),
    "ik.on_limit": (st.sampled_from(["hold", "refuse"]), st.just("record")),
}


@st.composite
def well_formed_gaits(draw: st.DrawFn) -> dict[str, object]:
    """Short walks; up to four values are drawn from the whole range that a gait file allows."""
    extreme = draw(st.sets(st.sampled_from(sorted(RANGES)), max_size=4))
    values = {key: draw(both[key in extreme]) for key, both in RANGES.items()}
    if values["walk.n_steps"] == 1:  # the closing step goes nowhere
        values |= {"walk.step_length": 0.0, "walk.lateral": 0.0, "walk.step_yaw": 0.0}
    tree: dict[str, Any] = {"mgs": 1, "robot": "melson", "motion": "walk"}
    for key, value in values.items():
        group, _, name = key.rpartition(".")
        (tree.setdefault(group, {}) if group else tree)[name] = value
    return tree


def test_any_well_formed_gait_becomes_a_file_or_a_message(here: Path):
    """A warning of NumPy makes the test fail too."""

    @settings(max_examples=60)
    @given(well_formed_gaits())
    def done_or_told(tree: dict[str, object]) -> None:
        (here / "gait.yaml").write_text(yaml.safe_dump(tree))
        result = run("generate", "gait.yaml", "-o", "walk.mcap", "--json")
        assert result.exit_code in (0, 1, 2)
        written = here / "walk.mcap"
        assert written.is_file() == (result.exit_code == 0)
        if result.exit_code == 0:
            assert json.loads(result.stdout)["file"] == "walk.mcap"
            assert result.stderr == ""
            written.unlink()
        else:
            assert result.stdout == ""
            assert result.stderr.startswith("Error: ")
            assert len(result.stderr.splitlines()) <= 3
        assert list(files_below(here)) == ["gait.yaml"]

    done_or_told()


# --- keyframes and pick-ups -------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "exit_code", "part"),
    [
        (
            ("melson/pick_up", "--set", "pick_up.object=[0.5, 0.0, 0.1]"),
            1,
            "mm away; move pick_up.o",
        ),
        (
            ("melson/pick_up", "--set", "pick_up.object=[0.5, 0.0]"),
            2,
            "object: list should",
        ),
        (("melson/pick_up", "--set", "pick_up.width=0.1"), 2, "leave it out or use hand: both"),
        (("melson/pick_up", "--ik", "clik"), 2, "ik.solver: clik cannot follow the posture"),
        (("melson/wave", "--set", "keyframes.keys=[]"), 2, "keyframes.keys: list should have at"),
        (("melson/wave", "--set", "keyframes.rest=2.0"), 2, "use a later time or a shorter rest"),
        (
            ("melson/pick_up", "--set", "pick_up.payload=1", "--set", "pick_up.pause=0"),
            2,
            "payload = 1 kg needs a pause above 0 s",
        ),
        (
            ("melson/wave", "--set", "keyframes.keys=[{time: 2.0}, {time: 1.0}]"),
            2,
            "keys.1.time = 1 s is not after the end of the key before, 2 s",
        ),
        (
            ("melson/wave", "--set", "keyframes.keys=[{time: 2.0, left_hand: [0.4, 0.0, 0.0]}]"),
            1,
            "use smaller displacements in keyframes.keys",
        ),
    ],
)
def test_a_body_motion_that_cannot_be_made_leaves_a_message_and_no_file(
    here: Path, arguments: tuple[str, ...], exit_code: int, part: str
):
    result = run("generate", *arguments, "-o", "bad.mcap")
    assert (result.exit_code, result.stdout) == (exit_code, "")
    assert part in result.stderr
    assert list(files_below(here)) == []


def test_a_pick_up_with_a_payload_comes_back_from_its_file(here: Path):
    payload = ("--set", "pick_up.payload=0.1")
    assert run("generate", "melson/pick_up", *payload, "-o", "a.mcap").exit_code == 0
    assert run("info", "a.mcap").exit_code == 0
    assert run("validate", "a.mcap", "--physics", "none").exit_code == 0


# --- static checks ------------------------------------------------------------------------------

TORN = ("--set", "walk.single_support=0.3", "--set", "walk.double_support=0.1")  # torque, ZMP


def test_failed_static_checks_are_told_and_only_strict_makes_them_an_error(here: Path):
    command = ("generate", *SHORT_WALK, *TORN, "-o", "walk.mcap", "--force")
    told = run(*command)
    strict = run(*command, "--strict")
    judged = run("validate", "walk.mcap", "--physics", "none", "--json")
    failed = [c for c in json.loads(judged.stdout)["checks"] if not c["ok"]]
    assert failed and judged.exit_code == 1
    assert told.exit_code == 0 and strict.exit_code == 1
    for check in failed:
        assert f"FAIL {check['name']} " in told.stdout
    as_json = json.loads(run(*command, "--json").stdout)
    assert as_json["failed_checks"] == failed


def test_a_motion_without_fault_passes_strict(here: Path):
    result = run("generate", *SHORT_WALK, "-o", "walk.mcap", "--strict")
    assert result.exit_code == 0 and "FAIL" not in result.stdout
