"""Queries: conditions, tables, and the nearest gait, compared with a search through all gaits."""

from __future__ import annotations

import csv
import io
import json
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mgs.core.errors import ConfigError, InputError, MgsError
from mgs.library import GaitLibrary
from mgs.library.manifest import COLUMNS, MANIFEST, writing
from mgs.library.query import query, report, to_csv, to_parquet

N = 10_000
IDENTITY = {
    "number of gaits": str(N + 2),
    "keys": json.dumps(["walk.step_length"]),
    "physics": "none",
    "mgs version": "0",
}


@pytest.fixture(scope="module")
def velocities() -> np.ndarray:
    low, high = np.array([[-0.1, -0.05, -0.5], [0.3, 0.05, 0.5]])
    return np.random.default_rng(0).uniform(low, high, (N, 3))


@pytest.fixture(scope="module")
def folder(velocities: np.ndarray, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """10,000 gaits of random velocities, one that fails and one that is infeasible; no files."""
    path = tmp_path_factory.mktemp("library")
    with writing(path, IDENTITY, ("walk.step_length",)) as manifest:
        manifest.connection.execute("BEGIN")
        for number, (vx, vy, wz) in enumerate(velocities.tolist()):
            row = {"number": number, "verdict": "pass", "file": f"gaits/{number}.mcap"}
            row |= {"vx": vx, "vy": vy, "wz": wz, "speed": float(np.hypot(vx, vy))}
            manifest.keep(row | {"robot": "melson", "walk.step_length": 0.01 * (number % 3)})
        still = {"vx": 0.0, "vy": 0.0, "wz": 0.0, "file": "gaits/x.mcap"}
        manifest.keep({"number": N, "verdict": "fail", "reason": "rest", "sha256": "", **still})
        manifest.keep({"number": N + 1, "verdict": "infeasible", "reason": "IkError"})
        manifest.connection.execute("COMMIT")
    return path


@pytest.fixture(scope="module")
def library(folder: Path) -> GaitLibrary:
    return GaitLibrary(folder)


speeds = st.floats(-1.0, 1.0)


@given(speeds, speeds, speeds)
def test_nearest_finds_the_gait_at_the_smallest_distance(
    library: GaitLibrary, velocities: np.ndarray, vx: float, vy: float, wz: float
):
    """1 rad/s counts as much as 0.1 m/s."""
    off = (velocities - [vx, vy, wz]) * [1.0, 1.0, 0.1]
    found = library.nearest(vx=vx, vy=vy, wz=wz)
    distances = np.linalg.norm(off, axis=1)
    assert distances[found.number] == pytest.approx(distances.min(), abs=1e-12)
    assert (found.vx, found.vy, found.wz) == tuple(velocities[found.number])


def test_a_found_gait_has_its_file_and_figures(library: GaitLibrary, folder: Path):
    found = library.nearest(vx=0.1)
    assert found.file == folder / f"gaits/{found.number}.mcap"
    assert found.figures["robot"] == "melson"
    assert len(library) == N  # neither the failed nor the infeasible one


def test_looking_up_takes_less_than_a_millisecond(library: GaitLibrary, velocities: np.ndarray):
    """The median of many, so that a busy machine does not matter."""
    taken = []
    for vx, vy, wz in velocities[:500].tolist():
        start = time.perf_counter()
        library.nearest(vx=vx, vy=vy, wz=wz)
        taken.append(time.perf_counter() - start)
    assert np.median(taken) < 1e-3


def test_a_condition_restricts_the_gaits_that_are_considered(folder: Path, velocities: np.ndarray):
    library = GaitLibrary(folder, where="verdict == 'pass' and speed < 0.05")
    assert len(library) == int((np.hypot(*velocities[:, :2].T) < 0.05).sum())
    assert library.nearest(vx=9.0).figures["speed"] < 0.05
    with pytest.raises(MgsError, match="no gait of this library"):
        GaitLibrary(folder, where="speed > 99")
    with pytest.raises(ConfigError, match="did you mean 'speed'"):
        GaitLibrary(folder, where="sped > 99")


def test_bad_velocities_and_missing_libraries_are_refused(library: GaitLibrary, tmp_path: Path):
    with pytest.raises(ConfigError, match="not finite"):
        library.nearest(vx=float("nan"))
    with pytest.raises(InputError, match="no gait library"):
        GaitLibrary(tmp_path)
    (tmp_path / MANIFEST).write_text("nothing")
    with pytest.raises(InputError, match="no manifest"):
        GaitLibrary(tmp_path)


def test_a_library_without_write_permission_is_read(folder: Path):
    """A finished manifest is one plain file; oracle: what is in the folder."""
    assert [path.name for path in folder.iterdir()] == [MANIFEST]
    GaitLibrary(folder).nearest()
    assert [path.name for path in folder.iterdir()] == [MANIFEST]


def test_rows_are_filtered_sorted_and_limited(folder: Path, velocities: np.ndarray):
    where = "vx > 0.2 and walk.step_length == 0.02"
    table = query(folder, where, ["number", "vx"], order="vx", reverse=True, limit=5)
    wanted = [k for k in np.argsort(-velocities[:, 0]) if k % 3 == 2][:5]
    assert table.columns == ("number", "vx")
    assert [row[0] for row in table.rows] == wanted
    with pytest.raises(ConfigError, match="--columns: no column 'x'"):
        query(folder, columns=["x"])
    with pytest.raises(ConfigError, match="--order: no column 'x'"):
        query(folder, order="x")


def test_csv_reads_back_exactly(folder: Path, velocities: np.ndarray):
    table = query(folder, columns=["number", "vx", "reason"])
    lines = list(csv.DictReader(io.StringIO(to_csv(table).decode())))
    assert len(lines) == N + 2
    assert [float(line["vx"]) for line in lines[:N]] == velocities[:, 0].tolist()
    assert lines[N + 1] == {"number": str(N + 1), "vx": "", "reason": "IkError"}


def test_parquet_reads_back_with_types(folder: Path, velocities: np.ndarray):
    parquet = pytest.importorskip("pyarrow.parquet")
    found = parquet.read_table(io.BytesIO(to_parquet(query(folder))))
    assert found.num_rows == N + 2
    assert found["vx"].to_pylist()[:N] == velocities[:, 0].tolist()
    assert found["number"].to_pylist() == list(range(N + 2))
    assert found["reason"].to_pylist()[-1] == "IkError"


def test_a_missing_pyarrow_is_reported_with_the_remedy(
    folder: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(MgsError, match=r"pip install 'mgs\[parquet\]'"):
        to_parquet(query(folder, limit=1))


def test_the_report_counts_gaits_and_finds_missing_files(folder: Path):
    found = report(folder)
    assert found["verdicts"] == {"pass": N, "fail": 1, "infeasible": 1}
    assert found["reasons"] == {"rest": 1, "IkError": 1}
    assert len(found["damaged_files"]) == N + 1
    shares = {
        s["value"]: (s["gaits"], s["pass"]) for s in found["passes_by_value"]["walk.step_length"]
    }
    assert shares[0.0] == (3334, 3334)
    assert shares[None] == (2, 0)


def test_every_column_is_explained():
    text = (Path(__file__).parents[2] / "docs" / "libraries.md").read_text()
    for name in COLUMNS:
        assert f"`{name}`" in text, name
