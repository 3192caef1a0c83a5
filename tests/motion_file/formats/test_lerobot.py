"""A data set of LeRobot, read by pyarrow and JSON as LeRobot 0.4 reads it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from mgs.core.errors import ConfigError, MotionFileError
from mgs.motion import Motion
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import FORMATS
from tests.support.shipped import generated


@pytest.fixture(scope="module")
def motion() -> Motion:
    return generated("melson/walk_practical").stages.motion


@pytest.fixture(scope="module")
def folder(motion: Motion, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("data") / "set"
    export_motion(motion, path, "lerobot")
    return path


def test_features_describe_the_columns(motion: Motion, folder: Path):
    info = json.loads((folder / "meta/info.json").read_text())
    assert info["codebase_version"] == "v3.0"
    data = pq.read_table(folder / info["data_path"].format(chunk_index=0, file_index=0))
    assert set(data.column_names) == set(info["features"])
    for name, feature in info["features"].items():
        kind = data.schema.field(name).type
        if feature["shape"] == [1]:
            assert str(kind) == feature["dtype"].replace("float32", "float")
        else:
            assert kind == pa.list_(pa.float32(), feature["shape"][0])
            assert feature["names"] == info["features"]["action"]["names"]
    assert data.num_rows == info["total_frames"]
    assert sorted(info["features"]["action"]["names"]) == sorted(motion.robot.joint_names)


def test_frames_are_numbered_and_timed(folder: Path):
    data = pq.read_table(folder / "data/chunk-000/file-000.parquet")
    n = data.num_rows
    assert data.column("index").to_pylist() == list(range(n))
    assert data.column("frame_index").to_pylist() == list(range(n))
    assert np.allclose(data.column("timestamp").to_numpy(), np.arange(n) / 50.0, rtol=0, atol=1e-6)
    assert set(data.column("task_index").to_pylist()) == {0}


def test_the_episode_and_the_task_are_where_lerobot_looks(folder: Path):
    n = pq.read_table(folder / "data/chunk-000/file-000.parquet").num_rows
    episodes = pq.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert len(episodes) == 1
    assert (episodes[0]["dataset_from_index"], episodes[0]["dataset_to_index"]) == (0, n)
    assert episodes[0]["length"] == n
    tasks = pq.read_table(folder / "meta/tasks.parquet")
    pandas = json.loads(tasks.schema.metadata[b"pandas"])
    assert tasks.column(pandas["index_columns"][0]).to_pylist() == episodes[0]["tasks"]


def test_statistics_are_those_of_the_columns(folder: Path):
    stats = json.loads((folder / "meta/stats.json").read_text())
    actions = np.array(
        pq.read_table(folder / "data/chunk-000/file-000.parquet").column("action").to_pylist()
    )
    found = stats["action"]
    assert np.allclose(found["mean"], actions.mean(axis=0), rtol=0, atol=1e-9)
    assert np.allclose(found["std"], actions.std(axis=0), rtol=0, atol=1e-9)
    assert np.allclose(found["q90"], np.quantile(actions, 0.9, axis=0), rtol=0, atol=1e-9)
    assert found["count"] == [len(actions)]


def test_a_rate_that_is_no_integer_is_refused(motion: Motion, tmp_path: Path):
    with pytest.raises(ConfigError, match="no integer"):
        export_motion(motion, tmp_path / "a", "lerobot", fps=29.97)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"features": {"action": 1}}'])
def test_a_damaged_description_is_named(text: str, folder: Path, tmp_path: Path):
    (tmp_path / "meta").mkdir()
    (tmp_path / "meta/info.json").write_text(text)
    with pytest.raises(MotionFileError, match=r"meta/info\.json"):
        FORMATS["lerobot"].read(tmp_path)


def test_another_version_is_refused(folder: Path, tmp_path: Path):
    (tmp_path / "meta").mkdir()
    info = json.loads((folder / "meta/info.json").read_text()) | {"codebase_version": "v2.1"}
    (tmp_path / "meta/info.json").write_text(json.dumps(info))
    with pytest.raises(MotionFileError, match=r"version 'v2\.1'; v3\.0 is read"):
        FORMATS["lerobot"].read(tmp_path)
