"""One version: what mgs/__init__.py states is what everything else says."""

from __future__ import annotations

import importlib.metadata
import io
import json
import re
from pathlib import Path

import mcap.reader
import pytest
import yaml
from hatchling.metadata.core import ProjectMetadata
from hatchling.plugin.manager import PluginManager
from mcap.records import Header
from mcap.stream_reader import StreamReader

import mgs
from mgs.motion_file import motion_bytes
from mgs.robot import load_robot
from tests.support.commands import run
from tests.support.motion_files import random_motion

ROOT = Path(mgs.__file__).parent.parent


def test_a_built_package_has_the_version_of_the_source() -> None:
    """The oracle is the build backend that pyproject.toml names."""
    project = ProjectMetadata(str(ROOT), PluginManager())
    assert project.version == mgs.__version__
    assert "version" not in project.core.config


def test_the_installed_package_has_the_version_of_the_source() -> None:
    package = importlib.metadata.distribution("mgs")
    installed_from = json.loads(package.read_text("direct_url.json") or "{}").get("url")
    if installed_from != ROOT.as_uri():
        pytest.skip(f"the package mgs is installed from {installed_from}, not from {ROOT}")
    assert package.version == mgs.__version__, "install it again: python -m pip install -e ."


def test_the_command_prints_the_version_of_the_source() -> None:
    assert run("--version").stdout.split()[-1] == mgs.__version__


def test_a_motion_file_names_the_version_that_wrote_it() -> None:
    content = motion_bytes(random_motion(load_robot("melson"), 3))
    (header,) = (r for r in StreamReader(io.BytesIO(content)).records if isinstance(r, Header))
    (metadata,) = mcap.reader.make_reader(io.BytesIO(content)).iter_metadata()
    assert header.library == f"mgs {mgs.__version__}"
    assert metadata.metadata["mgs_version"] == mgs.__version__


def test_the_citation_names_the_version_of_the_source() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert citation["version"] == mgs.__version__


def test_the_changelog_describes_the_release_that_the_source_leads_to() -> None:
    """The newest section is that of the coming release while the version is one of development."""
    headings = re.findall(r"^## \[(.+?)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    release, _, development = mgs.__version__.partition(".dev")
    assert headings[0] == ("Unreleased" if development else release)
