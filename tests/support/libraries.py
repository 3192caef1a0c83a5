"""A sweep of short gaits, a cluster that all tests share, and a library that it made."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
import yaml

from mgs.gait import load_gait
from mgs.library.points import Plan, plan_sweep
from tests.support.commands import SHORT_WALK

if TYPE_CHECKING:
    from mgs.library.summary import Summary

SHORT = tuple(word for word in SHORT_WALK[1:] if word != "--set")
LENGTHS = [0.0, 0.01, 0.02, 0.03, 0.04, 0.5]  # the last one is farther than the legs reach
AXES = {"walk.step_length": LENGTHS, "walk.first_support": ["left", "right"]}


def write_sweep(folder: Path, **content: object) -> Path:
    """A sweep and its base gait, a walk of 181 samples."""
    base = load_gait(SHORT_WALK[0], (*SHORT, "dt=0.02"))
    (folder / "short.yaml").write_text(base.to_yaml())
    path = folder / "sweep.yaml"
    content = {"mgs": 1, "base": "short.yaml", "axes": AXES} | content
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    return path


@pytest.fixture(scope="session")
def sweep(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_sweep(tmp_path_factory.mktemp("sweep"))


@pytest.fixture(scope="session")
def plan(sweep: Path) -> Plan:
    return plan_sweep(sweep)


@pytest.fixture(scope="session")
def address() -> Iterator[str]:
    """Scheduler of a cluster of two processes, which knows no gait yet."""
    import dask
    from distributed import LocalCluster

    from mgs.library.cluster import OWN_CLUSTER

    with (
        dask.config.set(OWN_CLUSTER),
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as cluster,
    ):
        yield cluster.scheduler_address


@pytest.fixture(scope="session")
def made(
    plan: Plan, address: str, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, Summary]:
    """The library of the sweep, made without a disturbance."""
    from mgs.library.run import recipe_of, run_batch

    folder = tmp_path_factory.mktemp("library") / "lib"
    return folder, run_batch(plan, recipe_of(plan), folder, address=address)
