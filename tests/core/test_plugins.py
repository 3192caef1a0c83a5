"""A solver and a generator of another package, from the guide to the verdict."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

import mgs
from mgs.core.errors import ConfigError, MgsError
from mgs.core.plugins import COM_GENERATORS, IK_SOLVERS, Origin, Registry
from mgs.gait import load_gait
from mgs.ik_solver import JointTrajectory
from mgs.ik_solver.solve import solve_ik
from mgs.motion_file import read_motion
from mgs.pipeline import Stages, run_stages
from mgs.robot import Robot

PACKAGE = Path(__file__).parents[1] / "support" / "example_package"
GUIDE = Path(mgs.__file__).parents[1] / "docs" / "plug-ins.md"
SHORT = ("walk.n_steps=2", "walk.single_support=1.0", "walk.double_support=0.6")


@pytest.fixture
def installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The example package on the import path, as an installation would leave it."""
    monkeypatch.syspath_prepend(str(PACKAGE))


def mgs_with_package(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join([str(PACKAGE.parents[2]), str(PACKAGE)])
    code = "from mgs.cli import main; main(prog_name='mgs')"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        cwd=cwd,
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=300,
    )


@pytest.mark.parametrize("registry", [IK_SOLVERS, COM_GENERATORS], ids=lambda r: r.key)
def test_every_name_of_mgs_has_a_class_that_makes_itself_from_a_gait(registry: Registry):
    for name in registry.own:
        assert callable(registry.load(name).from_parameters)
        assert registry.origin(name) == Origin(name, "mgs", mgs.__version__)


def test_the_code_in_the_guide_is_the_module_that_the_tests_run():
    (block,) = re.findall(r"```python\n(.*?)```", GUIDE.read_text(), flags=re.DOTALL)
    assert (PACKAGE / "mgs_example.py").read_text().endswith("\n\n" + block)


def test_entry_points_in_the_guide_are_those_of_the_package():
    (block,) = re.findall(r"```toml\n(.*?)```", GUIDE.read_text(), flags=re.DOTALL)
    registered = (PACKAGE / "mgs_example-0.3.0.dist-info" / "entry_points.txt").read_text()
    names = re.compile(r"^([\w-]+) = \"?(mgs_example:\w+)\"?$", flags=re.MULTILINE)
    assert names.findall(block) == names.findall(registered)


def test_a_walk_by_solver_and_generator_of_another_package_passes_the_verdict(tmp_path: Path):
    """Through the command line, as people use it: generate, validate, info."""
    made = mgs_with_package(
        "generate", "melson/walk_5cm", "--ik", "newton", "--set", "com.generator=cart-table",
        "--set", "ik.parameters.updates=3", "-o", "walk.mcap", "--json", cwd=tmp_path,
    )  # fmt: skip
    assert made.returncode == 0, made.stderr
    told = json.loads(made.stdout)
    assert told["solver"] == "newton"
    assert told["zmp_error"]["passes"] > 0  # the dynamic filter worked with it
    judged = mgs_with_package(
        "validate", "walk.mcap", "--physics", "mujoco", "--json", cwd=tmp_path
    )
    assert judged.returncode == 0, judged.stdout
    assert json.loads(judged.stdout)["verdict"] == "pass"
    info = json.loads(mgs_with_package("info", "walk.mcap", "--json", cwd=tmp_path).stdout)
    solver = info["metadata"]["solver"]
    assert (solver["solver"], solver["package"], solver["version"]) == (
        "newton", "mgs-example", "0.3.0",
    )  # fmt: skip
    assert solver["com_generator"] == {
        "name": "cart-table", "package": "mgs-example", "version": "0.3.0",
    }  # fmt: skip
    assert solver["parameters"] == {"updates": 3}
    motion = read_motion(tmp_path / "walk.mcap")  # in this process the package is not installed
    assert motion.provenance.solver == Origin("newton", "mgs-example", "0.3.0")


def test_two_solvers_meet_the_same_tasks(installed: None, melson: Robot):
    """The example's joint angles put soles, hands and CoM where the closed-loop IK puts them."""
    name, short = "melson/walk_5cm", (*SHORT, "com.passes=0")  # the same CoM reference for both
    ours = run_stages(melson, load_gait(name, short)).motion
    theirs = run_stages(melson, load_gait(name, (*short, "ik.solver=newton"))).motion
    assert np.abs(ours.soles - theirs.soles).max() < 1e-4
    assert np.abs(ours.com - theirs.com).max() < 2e-4


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("ik.solver=newtn", "did you mean 'newton'"),
        ("com.generator=cart_table", "did you mean 'cart-table'"),
        ("ik.parameters={updates: 0}", "ik.parameters: updates: input should be greater than"),
        ("ik.parameters={update: 2}", "newton has no parameter 'update'; known: updates"),
        ("com.parameters={x: 1}", "qp has no parameters of its own"),
    ],
)
def test_a_wrong_name_or_parameter_is_refused(installed: None, setting: str, message: str):
    with pytest.raises(ConfigError, match=message):
        load_gait("melson/walk_5cm", ("ik.solver=newton", setting))


def test_defaults_of_own_parameters_are_written_out(installed: None):
    gait = load_gait("melson/walk_5cm", ("ik.solver=newton",))
    assert yaml.safe_load(gait.to_yaml())["ik"]["parameters"] == {"updates": 4}


def test_a_package_that_cannot_be_imported_is_named(tmp_path: Path, monkeypatch):
    folder = tmp_path / "broken-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: broken\nVersion: 1.0\n")
    (folder / "entry_points.txt").write_text("[mgs.ik_solvers]\nbroken = broken:Solver\n")
    (tmp_path / "broken.py").write_text("raise RuntimeError('half installed')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(MgsError, match=r"ik\.solver broken: broken:Solver .*half installed"):
        load_gait("melson/walk_5cm", ("ik.solver=broken",))


@pytest.mark.parametrize("angles", [np.zeros((3, 2)), np.full((1201, 19), np.nan)])
def test_malformed_joint_angles_are_refused(
    installed: None, melson: Robot, walk_5cm: Stages, monkeypatch, angles: np.ndarray
):
    gait = load_gait("melson/walk_5cm", ("ik.solver=newton",))
    solver = IK_SOLVERS.load("newton")
    monkeypatch.setattr(solver, "solve", lambda *_: JointTrajectory(angles))
    with pytest.raises(MgsError, match=r"ik\.solver newton: joint angles have shape"):
        solve_ik(melson, walk_5cm.tasks, walk_5cm.com, gait.ik)
