"""The front door: its names, what they accept, and that it does what the command line does."""

from __future__ import annotations

import ast
import dataclasses
import importlib
import inspect
import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mgs
from mgs.core import errors
from mgs.core.former_paths import FORMER_PATHS
from mgs.core.plugins import COM_GENERATORS, IK_SOLVERS
from mgs.core.shipped import shipped_folder
from mgs.sim import available_engines
from tests.support.commands import SHORT_WALK, files_below, run

ROOT = Path(__file__).parent.parent
PACKAGE = Path(mgs.__file__).parent
ROOMS = sorted(path.parent.name for path in PACKAGE.glob("*/__init__.py"))
WALK = SHORT_WALK[0]
SETTINGS: dict[str, Any] = {
    key: json.loads(value)
    for key, value in (text.split("=") for text in SHORT_WALK[1:] if text != "--set")
}
needs_mujoco = pytest.mark.skipif("mujoco" not in available_engines(), reason="needs MuJoCo")


@pytest.fixture(scope="module")
def walk() -> mgs.Motion:
    """A short walk."""
    return mgs.generate("melson", WALK, **SETTINGS)


def in_a_fresh_interpreter(code: str, *options: str) -> str:
    """What a program prints that has imported nothing yet."""
    command = [sys.executable, *options, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return done.stdout


def same(a: mgs.Motion, b: mgs.Motion) -> bool:
    """Whether two motions agree in every array, bit for bit, and in every other field."""
    for name, value in vars(a).items():
        other = getattr(b, name)
        if name == "robot":
            equal = (value.urdf, value.yaml) == (other.urdf, other.yaml)
        elif isinstance(value, np.ndarray):
            equal = value.dtype == other.dtype and np.array_equal(value, other)
        else:
            equal = value == other
        if not equal:
            return False
    return True


# --- the names --------------------------------------------------------------------------------


def declared() -> dict[str, str]:
    """Where type checkers find each name: the imports below `if TYPE_CHECKING`."""
    tree = ast.parse((PACKAGE / "__init__.py").read_text())
    (block,) = (
        node
        for node in tree.body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    )
    assert all(isinstance(node, ast.ImportFrom) for node in block.body)
    return {
        alias.asname or "": f"{node.module}.{alias.name}"
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


def test_type_checkers_and_the_interpreter_find_the_same_names_at_the_same_places():
    places = declared()
    assert sorted(places) == mgs.__all__ == [name for name in dir(mgs) if name != "__version__"]
    for name, place in places.items():
        module, _, attribute = place.rpartition(".")
        assert getattr(mgs, name) is getattr(importlib.import_module(module), attribute)
        assert vars(mgs)[name] is getattr(mgs, name), "looked up once only"


def test_the_promised_functions_are_there_and_documented():
    functions = {
        *("generate", "load_robot", "load_gait", "read_motion", "write_motion"),
        *("validate", "replay", "plot", "export", "list_robots", "list_gaits"),
    }
    assert functions < set(mgs.__all__)
    for name in functions:
        assert inspect.getdoc(getattr(mgs, name))


def test_every_error_of_ours_is_at_the_front_door():
    ours = {
        name
        for name, value in vars(errors).items()
        if isinstance(value, type) and issubclass(value, errors.MgsError)
    }
    assert ours <= set(mgs.__all__)


def test_an_import_of_everything_gives_every_name():
    code = "from mgs import *; import mgs; print(all(n in globals() for n in mgs.__all__))"
    assert in_a_fresh_interpreter(code) == "True\n"


def test_a_name_that_does_not_exist_is_an_attribute_error():
    with pytest.raises(AttributeError, match="'mgs' has no attribute 'walk'"):
        _ = mgs.walk
    assert not hasattr(mgs, "__wrapped__") and not hasattr(mgs, "_room")
    with pytest.raises(ImportError):
        importlib.import_module("mgs.walk")


def test_no_name_hides_a_room_or_a_former_path():
    """Importing a submodule sets it as an attribute of its package, in the place of the name."""
    modules = {*ROOMS, *(path.partition(".")[2] for path in FORMER_PATHS)}
    assert not modules & set(mgs.__all__)


def test_importing_mgs_imports_nothing_that_takes_time():
    code = "import sys; before = set(sys.modules); import mgs; print(*set(sys.modules) - before)"
    loaded = set(in_a_fresh_interpreter(code, "-S").split())  # without site, which imports a lot
    assert {name for name in loaded if name.startswith("mgs")} == {
        *("mgs", "mgs.core", "mgs.core.former_paths")
    }
    assert not {name.partition(".")[0] for name in loaded} - set(sys.stdlib_module_names) - {"mgs"}
    assert len(loaded) < 80  # NumPy alone imports more


def test_a_name_imports_only_what_it_needs():
    heavy = {"numpy", "pinocchio", "scipy", "matplotlib", "mcap", "mujoco", "pybullet", "click"}
    cases = {"ConfigError": set(), "load_gait": {"numpy"}, "load_robot": {"numpy", "pinocchio"}}
    for name, allowed in cases.items():
        loaded = in_a_fresh_interpreter(f"import sys, mgs; mgs.{name}; print(*sys.modules)")
        assert heavy & set(loaded.split()) <= allowed, name


def test_rooms_are_attributes_without_an_import_of_their_own():
    code = f"import mgs; print(*(getattr(mgs, room).__name__ for room in {ROOMS}))"
    assert in_a_fresh_interpreter(code).split() == [f"mgs.{room}" for room in ROOMS]


def test_the_folder_of_the_package_shows_its_rooms():
    entries = {path.name for path in PACKAGE.iterdir() if path.name != "__pycache__"}
    assert len(entries - {"__init__.py", "py.typed"}) <= 18


# --- former paths, and paths that texts name --------------------------------------------------


@pytest.mark.parametrize("former", FORMER_PATHS)
def test_a_module_that_has_moved_is_the_same_module_under_its_former_path(former: str):
    assert importlib.import_module(former) is importlib.import_module(FORMER_PATHS[former])
    assert not (PACKAGE / f"{former.partition('.')[2]}.py").exists()


def test_former_paths_give_the_same_classes_whichever_way_comes_first():
    code = (
        "from mgs.errors import ConfigError as a; import mgs; "
        "from mgs.core.errors import ConfigError as b; import mgs.errors; "
        "print(a is b is mgs.ConfigError is mgs.errors.ConfigError)"
    )
    assert in_a_fresh_interpreter(code) == "True\n"
    code = "import mgs; print(mgs.verdict.Verdict is mgs.Verdict, mgs.checks.check_motion.__name__)"
    assert in_a_fresh_interpreter(code) == "True check_motion\n"


def named_in_texts() -> list[str]:
    """Every Python path below mgs that README, docs and notebook name."""
    texts = [ROOT / "README.md", *ROOT.glob("docs/*.md"), *ROOT.glob("robots/*/README.md")]
    texts += ROOT.glob("notebooks/*.ipynb")
    paths: set[str] = set()
    for file in texts:
        text = file.read_text()
        paths |= set(re.findall(r"(?<![\w./-])mgs(?:\.[A-Za-z_]\w*)+", text))
        for module, names in re.findall(r"from (mgs[\w.]*) import \(?([\w, ]+)", text):
            paths |= {f"{module}.{name.strip()}" for name in names.split(",") if name.strip()}
    return sorted(paths - {IK_SOLVERS.group, COM_GENERATORS.group})


# named by the README of version 0.1.0
PATHS_OF_OLD = [
    *("mgs.checks", "mgs.errors", "mgs.gait", "mgs.gait.load_gait", "mgs.library.GaitLibrary"),
    *("mgs.motion", "mgs.motion_file", "mgs.pipeline", "mgs.pipeline.generate", "mgs.robot"),
    *("mgs.robot.load_robot", "mgs.sim", "mgs.verdict"),
]


@pytest.mark.parametrize("path", sorted({*named_in_texts(), *PATHS_OF_OLD}))
def test_every_path_that_a_text_names_can_be_imported(path: str):
    parts = path.split(".")
    found: Any = importlib.import_module("mgs")
    for i, part in enumerate(parts[1:], start=2):
        try:
            found = importlib.import_module(".".join(parts[:i]))
        except ModuleNotFoundError:
            found = getattr(found, part)
    assert found is not None


@needs_mujoco
def test_the_python_example_of_the_readme_runs(tmp_path: Path):
    (example,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    done = subprocess.run(
        [sys.executable, "-c", example], capture_output=True, text=True, timeout=60, cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert re.search(r"^<Motion .*>$\n^<Verdict .*: pass", done.stdout, re.MULTILINE)
    assert list(files_below(tmp_path)) == ["walk.mcap"]


# --- python -m mgs ----------------------------------------------------------------------------


def test_the_package_runs_as_a_module_and_calls_itself_mgs():
    command = [sys.executable, "-m", "mgs"]
    version = subprocess.run([*command, "--version"], capture_output=True, text=True, timeout=60)
    assert version.stdout == f"mgs, version {mgs.__version__}\n"
    wrong = subprocess.run([*command, "walk"], capture_output=True, text=True, timeout=60)
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr.startswith("Usage: mgs ")


# --- generate ---------------------------------------------------------------------------------

ONE_OF_A_KIND: dict[str, dict[str, Any]] = {
    WALK: SETTINGS,
    "walk": {"robot": "coman_legs", "walk.n_steps": 2},
    "melson/kick": {},
    "melson/pick_up": {"pick_up.payload": 0.05},
    "melson/bow": {},
    "coman_legs/squat": {},
    "melson/walk_kick_walk": {"com.passes": 0},
}


def test_there_is_one_gait_of_every_kind_to_compare():
    kinds = {mgs.load_gait(name).motion for name in ONE_OF_A_KIND}
    assert kinds == {mgs.load_gait(name).motion for name in mgs.list_gaits()}


@pytest.mark.parametrize("gait", ONE_OF_A_KIND)
def test_generate_gives_the_motion_that_the_command_writes(gait: str, tmp_path: Path):
    settings = dict(ONE_OF_A_KIND[gait])
    options = [f"--set={key}={value}" for key, value in settings.items() if key != "robot"]
    if robot := settings.pop("robot", None):
        options += ["--robot", robot]
    assert run("generate", gait, *options, "-o", tmp_path / "a.mcap").exit_code == 0
    motion = mgs.generate(robot, gait, **settings)
    assert same(mgs.read_motion(tmp_path / "a.mcap"), motion)
    written = mgs.write_motion(motion, tmp_path / "b.mcap")
    assert written.read_bytes() == (tmp_path / "a.mcap").read_bytes()


@pytest.mark.parametrize("robot", ["name", "folder", "file", "object", "none"])
@pytest.mark.parametrize("gait", ["name", "path", "text", "object"])
def test_robots_and_gaits_are_accepted_as_names_paths_and_objects(
    robot: str, gait: str, walk: mgs.Motion
):
    folder, file = shipped_folder("robots") / "melson", shipped_folder("gaits") / f"{WALK}.yaml"
    robots: dict[str, Any] = {
        "name": "melson",
        "folder": folder,
        "file": str(folder / "robot.yaml"),
        "object": mgs.load_robot("melson"),
        "none": None,
    }
    gaits: dict[str, Any] = {
        "name": WALK,
        "path": file,
        "text": str(file),
        "object": mgs.load_gait(WALK),
    }
    motion = mgs.generate(robots[robot], gaits[gait], **SETTINGS)
    assert np.array_equal(motion.q, walk.q) and np.array_equal(motion.torque, walk.torque)
    assert motion.gait.robot == (str(robots[robot]) if robot in ("folder", "file") else "melson")


def test_a_robot_is_taken_instead_of_the_one_that_the_gait_names():
    coman = mgs.load_robot("coman")
    settings = {"walk.n_steps": 2, "walk.step_length": 0.03}
    motions = [mgs.generate(robot, "melson/walk_5cm", **settings) for robot in ("coman", coman)]
    assert same(*motions)
    assert motions[0].robot.spec.name == motions[0].gait.robot == "coman"


def test_progress_grows_and_stays_below_the_work_in_all():
    """The dynamic filter may need fewer passes than it is allowed."""
    calls: list[tuple[int, int]] = []
    mgs.generate("melson", WALK, progress=lambda *call: calls.append(call), **SETTINGS)
    done, total = zip(*calls, strict=True)
    assert len(set(total)) == 1 and done[0] > 0 and done[-1] <= total[0]
    assert list(done) == sorted(set(done))


def test_a_gait_for_any_robot_needs_one():
    with pytest.raises(mgs.ConfigError, match=r"walk: robot: missing; .*mgs\.generate"):
        mgs.generate(gait="walk")


def test_errors_name_the_gait_as_it_was_given():
    with pytest.raises(mgs.ConfigError, match=r"walk_5cm\.yaml: walk\.n_step: unknown key"):
        mgs.generate("melson", "melson/walk_5cm", walk__n_step=3)
    with pytest.raises(mgs.ConfigError, match=r"^walk gait: walk\.n_steps: .* found 'many'"):
        mgs.generate("melson", mgs.load_gait("melson/walk_5cm"), walk__n_steps="many")
    with pytest.raises(mgs.ConfigError, match="shipped: coman"):
        mgs.generate("nobody", "melson/walk_5cm")
    with pytest.raises(mgs.InfeasibleGaitError):
        mgs.generate("melson", "melson/walk_5cm", walk__step_length=0.3)


# --- wrong types ------------------------------------------------------------------------------

WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "robot": (
        lambda: mgs.generate(5, WALK),
        "the robot should be a Robot, the name of a shipped robot or a folder; found an int: 5",
    ),
    "swapped": (
        lambda: mgs.generate(mgs.load_gait(WALK), "melson"),
        "the robot should be a Robot, .*; found a WalkGait",
    ),
    "gait": (
        lambda: mgs.generate("melson", ["walk"]),
        "the gait should be a Gait, .* found a list",
    ),
    "no gait": (lambda: mgs.generate("melson"), r"a gait is needed: mgs\.generate\(robot, gait\)"),
    "load_robot": (lambda: mgs.load_robot(None), "the robot should be .*; found None"),
    "load_gait": (lambda: mgs.load_gait(b"walk"), "the gait should be .*; found a bytes"),
    "read": (lambda: mgs.read_motion(3), "should be a Motion or the path of a motion file; .* 3"),
    "write": (lambda: mgs.write_motion("a", "b"), "written should be a Motion; found a str: 'a'"),
    "validate": (lambda: mgs.validate({}), "the motion should be .*; found a dict"),
    "replay": (lambda: mgs.replay(mgs.load_robot("melson")), "the motion .*; found a Robot"),
    "plot": (lambda: mgs.plot(None), "the motion should be .*; found None"),
    "export": (lambda: mgs.export(1.0, "a.csv"), "the motion should be .*; found a float"),
    "path": (lambda: mgs.export("a.mcap", None), "the path should be .* found None"),
    "physics": (lambda: mgs.validate("a.mcap", physics=1), "physics should be names .* an int: 1"),
    "names": (lambda: mgs.plot("a.mcap", 1), "names should be one or more of above, .* an int: 1"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_type_is_answered_with_what_is_accepted(case: str):
    call, sentence = WRONG[case]
    with pytest.raises(TypeError, match=sentence):
        call()


# --- motion files -----------------------------------------------------------------------------


def test_what_is_written_is_read_back_and_motions_pass_through(walk: mgs.Motion, tmp_path: Path):
    path = mgs.write_motion(walk, str(tmp_path / "a" / "walk.mcap"))
    assert path == tmp_path / "a" / "walk.mcap"
    assert same(mgs.read_motion(path), walk) and same(mgs.read_motion(str(path)), walk)
    assert mgs.read_motion(walk) is walk
    with pytest.raises(mgs.OutputExistsError):
        mgs.write_motion(walk, path)
    assert mgs.write_motion(walk, path, force=True) == path


def test_a_change_of_any_array_is_seen_by_the_comparison(walk: mgs.Motion):
    """Guards the oracle of the tests above."""
    for name, value in vars(walk).items():
        if isinstance(value, np.ndarray):
            changed = value.copy()
            changed.flat[-1] += 1
            assert not same(dataclasses.replace(walk, **{name: changed}), walk)


@pytest.fixture(scope="module")
def long_walk() -> mgs.Motion:
    """A walk with two steps that can be repeated."""
    return mgs.generate("melson", WALK, com__passes=0, walk__n_steps=8)


@pytest.mark.parametrize("cycle", [False, True])
@pytest.mark.parametrize("fmt", ["csv", "npz"])
def test_export_writes_what_the_command_writes(
    long_walk: mgs.Motion, tmp_path: Path, fmt: str, cycle: bool
):
    file = mgs.write_motion(long_walk, tmp_path / "walk.mcap")
    options = [f"--format={fmt}", *(["--cycle"] if cycle else [])]
    assert run("export", file, *options, "-o", tmp_path / "command").exit_code == 0
    expected = (tmp_path / "command").read_bytes()
    by_suffix = mgs.export(long_walk, tmp_path / f"a.{fmt}", cycle=cycle)
    assert by_suffix.read_bytes() == expected
    by_format = mgs.export(str(file), str(tmp_path / "b"), fmt, cycle=cycle)
    assert by_format.read_bytes() == expected


def test_export_refuses_unknown_formats_and_existing_files(walk: mgs.Motion, tmp_path: Path):
    with pytest.raises(mgs.ConfigError, match=r"walk.xml does not end with \.csv or"):
        mgs.export(walk, tmp_path / "walk.xml")
    with pytest.raises(mgs.ConfigError, match=r"format: 'xml' is unknown; known: csv, npz, "):
        mgs.export(walk, tmp_path / "walk.xml", "xml")
    mgs.export(walk, tmp_path / "walk.csv")
    with pytest.raises(mgs.OutputExistsError):
        mgs.export(walk, tmp_path / "walk.csv")
    assert list(files_below(tmp_path)) == ["walk.csv"]


# --- replay -----------------------------------------------------------------------------------


def figures(replay: mgs.Replay | dict[str, Any]) -> dict[str, Any]:
    """All figures of a replay but the time that it took and what is said of the machine."""
    told = json.loads(json.dumps(replay if isinstance(replay, dict) else replay.to_json()))
    del told["wall_seconds"]
    for of_the_command in ("engines_missing", "json_version"):
        told.pop(of_the_command, None)
    return told


@needs_mujoco
def test_replay_measures_what_the_command_measures(walk: mgs.Motion, tmp_path: Path):
    file = mgs.write_motion(walk, tmp_path / "walk.mcap")
    command = json.loads(run("replay", file, "--engine", "mujoco", "--json").stdout)
    assert figures(mgs.replay(walk, "mujoco")) == figures(command)
    assert figures(mgs.replay(str(file), "mujoco")) == figures(command)


@pytest.mark.skipif(not available_engines(), reason="needs an engine")
def test_replay_takes_the_first_engine_that_is_installed(walk: mgs.Motion):
    assert mgs.replay(walk).engine == available_engines()[0]
