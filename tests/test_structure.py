"""What may import what: the stages one way only, heavy libraries in one place each."""

from __future__ import annotations

import ast
import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

import mgs

PACKAGE = Path(mgs.__file__).parent
ARCHITECTURE = (PACKAGE.parent / "docs" / "architecture.md").read_text()
ROW = re.compile(r"^\| `(\w+)` \| .+ \|(.*)\|$", re.MULTILINE)
ARROW = re.compile(r"^\s*(\w+)(?:\(\[.+?\]\))? -->(?:\|[^|]+\|)? (\w+)", re.MULTILINE)
# What the document says: which rooms each one imports from; a room imports from rooms above it.
DOCUMENTED = {room: set(re.findall(r"`(\w+)`", row)) for room, row in ROW.findall(ARCHITECTURE)}
ORDER = list(DOCUMENTED)
FIGURE = ARCHITECTURE.partition("```mermaid")[2].partition("```")[0]
MOST_ENTRIES = 18
MOST_LINES = 350  # of a module
MOST_LINES_OF_A_FUNCTION = 70  # without its docstring
STAGES = ["motion_planner", "trajectory_planner", "com_generator", "ik_solver"]
# Libraries that one place only knows, wherever in the file the import stands.
OWNERS = {
    "lz4": {"motion_file"},
    "mcap": {"motion_file"},
    "zstandard": {"motion_file"},
    "matplotlib": {"report"},
    "mujoco": {"sim", "robot"},  # physics, and its compiler of robots
    "pybullet": {"sim"},
    "yaml": {"core", "gait"},
    "pydantic": {"core", "gait", "robot", "library", "motion_file"},
    "click": {"cli"},
    "dask": {"library", "cli"},
    "distributed": {"library"},
    "sqlite3": {"library"},
    "pyarrow": {"library", "motion_file"},
    "torch": {"motion_file"},
    "pickle": {"judge", "motion_file"},
    "optuna": {"search"},
    "dynamixel_sdk": {"robot"},
    "rosbags": {"motion_file"},
}
HEAVY = ["control", "matplotlib", "mujoco", "pybullet", "pinocchio", "scipy", "mcap", "distributed"]
FILES = sorted(PACKAGE.rglob("*.py"))


def place(path: Path) -> str:
    """Top-level module or package of mgs that a file belongs to; the package itself is ''."""
    first = path.relative_to(PACKAGE).parts[0]
    return "" if first == "__init__.py" else first.removesuffix(".py")


def module_name(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(path: Path, lazy: bool = True, typing: bool = True) -> set[str]:
    """Modules that a file imports; those inside functions, or for type checkers, as asked."""
    tree = ast.parse(path.read_text())
    found: set[str] = set()
    pending: list[ast.AST] = [tree]
    while pending:
        node = pending.pop()
        if not typing and isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            assert node.module is not None
            found |= {f"{node.module}.{alias.name}" for alias in node.names} | {node.module}
        if lazy or not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            pending += ast.iter_child_nodes(node)
    return found


def n_lines(node: ast.stmt) -> int:
    return (node.end_lineno or node.lineno) - node.lineno + 1


def neighbours(path: Path) -> set[str]:
    """Other places of mgs that a file imports from."""
    inner = {name.split(".")[1] for name in imports(path) if name.startswith("mgs.")}
    return {name for name in inner if not name.startswith("__")} - {place(path)}


@pytest.mark.parametrize("path", FILES, ids=module_name)
def test_a_module_imports_only_from_above_itself(path: Path):
    if not place(path):  # the front door, which is open to what is behind it when it is asked
        at_once = {name for name in imports(path, typing=False) if name.startswith("mgs.")}
        assert at_once == {"mgs.core.former_paths", "mgs.core.former_paths.FormerPaths"}
        return
    above = ORDER[: ORDER.index(place(path))]
    assert neighbours(path) <= set(above)


@pytest.mark.parametrize("path", FILES, ids=module_name)
def test_no_room_is_entered_through_the_front_door(path: Path):
    """Or everything could import everything: of `mgs` itself rooms take the version alone."""
    taken = {name for name in imports(path) if name.startswith("mgs.") and name.count(".") == 1}
    tree = ast.parse(path.read_text())
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "mgs":
            taken.add(f"mgs.{node.attr}")
    assert taken <= {"mgs.__version__", *(f"mgs.{room}" for room in ORDER)}


def test_modules_that_import_by_name_are_known():
    """Such an import escapes the order of rooms, so whoever needs one is listed here."""
    users = {module_name(path) for path in FILES if "import_module(" in path.read_text()}
    assert users == {
        "mgs",  # the names of the front door
        "mgs.cli.lazy_group",  # its own commands
        "mgs.core.former_paths",
        "mgs.core.plugins",  # solvers and generators, those of mgs among them
        "mgs.experiments",  # one of its own studies
        "mgs.motion_file.formats.format",  # the module of a format
        "mgs.motion.motion",  # its picture in a notebook
    }


def test_every_room_is_documented_in_its_place():
    """The table of docs/architecture.md lists what the folder lists, and no more fits in it."""
    hidden = {"__init__.py", "__pycache__", "py.typed"}
    entries = [path for path in PACKAGE.iterdir() if path.name not in hidden]
    assert sorted(path.stem for path in entries) == sorted(ORDER)
    assert len(entries) <= MOST_ENTRIES


@pytest.mark.parametrize("room", ORDER)
def test_a_room_imports_from_the_rooms_that_the_document_names(room: str):
    found = {name for path in FILES if place(path) == room for name in neighbours(path)}
    assert found == DOCUMENTED[room], "docs/architecture.md, table of rooms, last column"


def test_every_arrow_of_the_figure_between_rooms_is_an_import():
    arrows = ARROW.findall(FIGURE)
    assert len(arrows) == FIGURE.count("-->")
    between = [(source, user) for source, user in arrows if {source, user} <= set(ORDER)]
    assert [(a, b) for a, b in between if a not in DOCUMENTED[b]] == []
    drawn = {room for arrow in between for room in arrow}
    assert drawn == set(ORDER) - {"core", "motion", "__main__"}


def test_the_code_of_clik_is_two_links_from_the_readme():
    root, link = PACKAGE.parent, re.compile(r"\]\(([\w./-]+)\)")
    assert "docs/architecture.md" in link.findall((root / "README.md").read_text())
    assert "../mgs/ik_solver/clik.py" in link.findall(ARCHITECTURE)


@pytest.mark.parametrize("path", FILES, ids=module_name)
def test_a_module_fits_on_a_few_pages_and_a_function_on_one(path: Path):
    text = path.read_text()
    assert len(text.splitlines()) <= MOST_LINES
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            length = n_lines(node) - (n_lines(node.body[0]) if ast.get_docstring(node) else 0)
            assert length <= MOST_LINES_OF_A_FUNCTION, node.name


def test_the_stages_follow_one_another():
    assert [name for name in ORDER if name in STAGES] == STAGES
    for name in STAGES:
        assert (PACKAGE / name / "__init__.py").is_file()


def test_modules_do_not_import_one_another_in_a_circle():
    """At import time; what a function imports when called is not counted."""
    names = {module_name(path) for path in FILES}
    waits = {module_name(path): imports(path, lazy=False) & names for path in FILES}
    for name in names:  # a package's door imports its rooms; a room does not wait for the door
        waits[name] = {other for other in waits[name] if not name.startswith(f"{other}.")} - {name}
    while ready := {name for name, others in waits.items() if not others & waits.keys()}:
        for name in ready:
            del waits[name]
    assert not waits, f"these wait for one another: {sorted(waits)}"


@pytest.mark.parametrize("library", OWNERS)
def test_a_heavy_or_dangerous_library_is_known_in_one_place(library: str):
    users = {
        place(path)
        for path in FILES
        if any(name.split(".")[0] == library for name in imports(path))
    }
    assert users <= OWNERS[library]


def test_only_gaits_robots_batches_and_motions_of_others_are_read_from_yaml():
    readers = {place(path) for path in FILES if "mgs.core.yaml_text.parse_yaml" in imports(path)}
    assert readers <= {"core", "gait", "robot", "library", "motion_file"}


@pytest.mark.parametrize("name", ["mgs", "mgs.cli"])
def test_importing_the_command_line_loads_no_heavy_library(name: str):
    """In a fresh interpreter, so that `mgs --help` is instant."""
    code = f"import sys, {name}; print(*{{m.split('.')[0] for m in sys.modules}} & set({HEAVY}))"
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=PACKAGE.parent, capture_output=True, text=True, timeout=60
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == []


def test_importing_the_planners_loads_no_scipy():
    """Few motions need it, and it takes as long to import as the rest of the planners."""
    planners = [path for path in FILES if place(path) in ("motion_planner", "trajectory_planner")]
    names = ", ".join(module_name(path) for path in planners)
    code = f"import sys, {names}; print(*{{m.split('.')[0] for m in sys.modules}})"
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=PACKAGE.parent, capture_output=True, text=True, timeout=60
    )
    assert run.returncode == 0, run.stderr
    assert "scipy" not in run.stdout.split()


def test_importing_the_pipeline_loads_neither_engines_nor_plots():
    code = "import sys, mgs.pipeline; print(*{m.split('.')[0] for m in sys.modules})"
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=PACKAGE.parent, capture_output=True, text=True, timeout=60
    )
    assert run.returncode == 0, run.stderr
    loaded = set(run.stdout.split())
    assert not loaded & {"control", "matplotlib", "mujoco", "pybullet", "mcap", "click"}


@pytest.mark.parametrize("path", FILES, ids=module_name)
def test_every_module_says_what_it_is_for(path: Path):
    text = path.read_text()
    assert not text or ast.get_docstring(ast.parse(text))


@pytest.mark.parametrize("stage", [*STAGES, "motion_file", "report"])
def test_every_name_that_a_package_exports_exists(stage: str):
    package = importlib.import_module(f"mgs.{stage}")
    for name in package.__all__:
        assert hasattr(package, name)
