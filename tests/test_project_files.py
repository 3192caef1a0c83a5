"""The files around the code agree with the code and with one another."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
import yaml
from hatchling.metadata.core import ProjectMetadata
from hatchling.plugin.manager import PluginManager

import mgs

ROOT = Path(mgs.__file__).parent.parent
TEXTS = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md"))]
METADATA = ProjectMetadata(str(ROOT), PluginManager()).core.config


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_every_link_inside_the_project_leads_somewhere(path: Path) -> None:
    targets = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", path.read_text())
    inside = [target for target in targets if "://" not in target]
    assert [target for target in inside if not (path.parent / target).exists()] == []


def test_every_file_and_test_that_the_guide_for_contributors_names_exists() -> None:
    named = re.findall(r"`((?:mgs|tests|docs|gaits)/[\w/.]*)(?:::(\w+))?`", guide())
    assert len(named) > 20
    for path, test in named:
        if "NAME" not in path:
            assert (ROOT / path).exists(), path
        if test:
            assert test in functions(ROOT / path), f"{path} has no {test}"


def guide() -> str:
    return (ROOT / "CONTRIBUTING.md").read_text()


def functions(path: Path) -> set[str]:
    tree = ast.parse(path.read_text())
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


def test_the_page_on_packages_has_a_row_for_each_dependency() -> None:
    page = (ROOT / "docs/packages.md").read_text()
    rows = re.findall(r"^\| `([\w-]+)`[^|]*\|", page, re.MULTILINE)
    dependencies = [re.split(r"[<>=;! ]", line)[0] for line in METADATA["dependencies"]]
    assert sorted(rows, key=str.lower) == sorted(dependencies, key=str.lower)


def test_every_target_of_make_that_the_guides_name_exists() -> None:
    makefile = (ROOT / "Makefile").read_text()
    targets = set(re.findall(r"^([\w-]+):", makefile, re.MULTILINE))
    named = set(re.findall(r"(?:^    |`)make ([\w-]+)", guide(), re.MULTILINE))
    named |= set(re.findall(r"(?:^    |`)make ([\w-]+)", (ROOT / "README.md").read_text(), re.M))
    assert {"test", "lint", "demo"} <= named <= targets


def test_the_workflow_tests_every_supported_python_and_nothing_else() -> None:
    """The versions are those of the classifiers; what runs is `make test`, as on any machine."""
    (job,) = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text())["jobs"].values()
    supported = [
        label.rpartition(" ")[2]
        for label in METADATA["classifiers"]
        if re.search(r"Python :: \d\.\d+$", label)
    ]
    assert job["strategy"]["matrix"]["python-version"] == supported
    assert [step["run"] for step in job["steps"] if "run" in step] == ["make test PYTHON=python"]
    lowest, beyond = re.findall(r"\d\.(\d+)", METADATA["requires-python"])
    assert supported == [f"3.{minor}" for minor in range(int(lowest), int(beyond))]


def test_the_hook_before_a_commit_runs_what_make_lint_runs() -> None:
    (repository,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"]
    (hook,) = repository["hooks"]
    assert (repository["repo"], hook["entry"], hook["language"]) == ("local", "make lint", "system")
    assert hook["always_run"] and not hook["pass_filenames"]


def test_the_citation_has_what_its_format_requires_and_what_the_package_states() -> None:
    """Citation File Format 1.2.0: message, title, authors and version of the format."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert citation["cff-version"] == "1.2.0"
    assert citation["message"] and citation["title"]
    assert citation["authors"] == METADATA["authors"]
    assert citation["license"] == METADATA["license"]


def test_the_changelog_has_the_form_of_keep_a_changelog() -> None:
    """Newest first; a version and its date, then the kinds of change that the form knows."""
    text = (ROOT / "CHANGELOG.md").read_text()
    (first, *released) = re.findall(r"^## (.+)$", text, re.MULTILINE)
    assert first == "[Unreleased]" or released
    for heading in released:
        assert re.fullmatch(r"\[\d+\.\d+\.\d+\] - \d{4}-\d{2}-\d{2}", heading)
    versions = [tuple(map(int, re.findall(r"\d+", heading)[:3])) for heading in released]
    assert versions == sorted(versions, reverse=True)
    kinds = set(re.findall(r"^### (.+)$", text, re.MULTILINE))
    assert kinds <= {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
