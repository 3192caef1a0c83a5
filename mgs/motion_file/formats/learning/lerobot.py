"""lerobot: data set of LeRobot, version 3.0, with one episode.

    meta/info.json             codebase_version, fps, features with the names of the joints, paths
    meta/stats.json            minimum, maximum, mean, deviation and quantiles of each feature
    meta/tasks.parquet         the one task, named after the gait
    meta/episodes/chunk-000/file-000.parquet   the one episode: length, place, statistics
    data/chunk-000/file-000.parquet            one row per frame

Columns of a frame: `action` and `observation.state` (J,) joint angles [rad] in single precision,
`timestamp` [s], `frame_index`, `episode_index`, `index`, `task_index`. Joints stand depth first,
with names. The base is not in the data.

`lerobot-replay` sends `action` at the rate of the data set without a lead-in and without a stop, so
bring the robot to the first posture before, and choose a motion that ends at rest. Writing and
reading need pyarrow (pip install 'mgs[parquet]').
"""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from mgs.core.arrays import Array
from mgs.core.errors import ConfigError
from mgs.core.input_files import read_bytes, read_text
from mgs.core.limits import MAX_RECORDING
from mgs.motion.sampled import SampledMotion
from mgs.motion_file.formats.format import Options, Written, chosen_joints
from mgs.motion_file.formats.recorded import (
    Reading,
    RecordedMotion,
    as_float32,
    decoding,
)
from mgs.robot import Robot

VERSION = "v3.0"
FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
FIRST = FILE.format(chunk_index=0, file_index=0)
QUANTILES = (1, 10, 50, 90, 99)  # [percent]
ACTION, STATE = "action", "observation.state"
INDEXES = ("frame_index", "episode_index", "index", "task_index")


def write(sampled: SampledMotion, path: Path, options: Options) -> Written:
    """Write the data set."""
    import pyarrow as pa

    if abs(sampled.fps - round(sampled.fps)) > 1e-9:
        raise ConfigError("fps", f"{sampled.fps:.10g} Hz is no integer, as this format needs")
    names, index = chosen_joints(sampled.robot, options, "depth-first")
    angles = as_float32(sampled.joints[:, index])
    n = sampled.n_frames
    zeros = np.zeros(n, dtype=np.int64)
    frames: dict[str, Any] = {
        ACTION: angles,
        STATE: angles,
        "timestamp": as_float32(sampled.times),
        "frame_index": np.arange(n),
        "episode_index": zeros,
        "index": np.arange(n),
        "task_index": zeros,
    }
    stats = {name: _statistics(values) for name, values in frames.items()}
    _write_json(path / "meta/info.json", _info(sampled, names))
    _write_json(path / "meta/stats.json", stats)
    task = sampled.motion.gait_name
    _write_table(path / "meta/tasks.parquet", _tasks(task))
    _write_table(path / "meta/episodes" / FIRST, _episode(task, n, stats))
    columns = {name: _column(values) for name, values in frames.items()}
    _write_table(path / "data" / FIRST, pa.table(columns))
    return Written(names)


def _info(sampled: SampledMotion, names: tuple[str, ...]) -> dict[str, Any]:
    joints = {"dtype": "float32", "shape": [len(names)], "names": list(names)}
    single = {"shape": [1], "names": None}
    return {
        "codebase_version": VERSION,
        "robot_type": sampled.robot.spec.name,
        "total_episodes": 1,
        "total_frames": sampled.n_frames,
        "total_tasks": 1,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": round(sampled.fps),
        "splits": {"train": "0:1"},
        "data_path": f"data/{FILE}",
        "video_path": None,
        "features": {
            ACTION: joints,
            STATE: joints,
            "timestamp": {"dtype": "float32", **single},
            **{name: {"dtype": "int64", **single} for name in INDEXES},
        },
    }


def _statistics(values: Any) -> dict[str, list[float]]:
    """Statistics of one feature (T,) or (T, J)."""
    table = np.asarray(values, dtype=np.float64).reshape(len(values), -1)
    found = {
        "min": table.min(axis=0),
        "max": table.max(axis=0),
        "mean": table.mean(axis=0),
        "std": table.std(axis=0),
        "count": np.array([len(table)]),
    }
    found |= {f"q{q:02d}": np.percentile(table, q, axis=0) for q in QUANTILES}
    return {name: value.tolist() for name, value in found.items()}


def _column(values: Any) -> Any:
    """Column of numbers, or of lists of one length."""
    import pyarrow as pa

    if values.ndim == 1:
        return pa.array(values)
    return pa.FixedSizeListArray.from_arrays(pa.array(values.reshape(-1)), values.shape[1])


def _tasks(task: str) -> Any:
    """Table of tasks as pandas would write it: the text is the index of the row."""
    import pyarrow as pa

    index = "__index_level_0__"
    kind = {"pandas_type": "int64", "numpy_type": "int64", "metadata": None}
    text = {"pandas_type": "unicode", "numpy_type": "object", "metadata": None}
    columns = [
        {"name": "task_index", "field_name": "task_index", **kind},
        {"name": None, "field_name": index, **text},
    ]
    meta = {"index_columns": [index], "column_indexes": [], "columns": columns}
    table = pa.table({"task_index": pa.array([0], pa.int64()), index: [task]})
    return table.replace_schema_metadata({"pandas": json.dumps(meta, allow_nan=False)})


def _episode(task: str, n: int, stats: dict[str, dict[str, list[float]]]) -> Any:
    """Table of episodes."""
    import pyarrow as pa

    row: dict[str, Any] = {
        "episode_index": 0,
        "tasks": [task],
        "length": n,
        "data/chunk_index": 0,
        "data/file_index": 0,
        "dataset_from_index": 0,
        "dataset_to_index": n,
        "meta/episodes/chunk_index": 0,
        "meta/episodes/file_index": 0,
    }
    for name, values in stats.items():
        row |= {f"stats/{name}/{what}": value for what, value in values.items()}
    return pa.table({name: [value] for name, value in row.items()})


def _write_json(path: Path, content: object) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=4, allow_nan=False) + "\n", encoding="utf-8")


def _write_table(path: Path, table: Any) -> None:
    import pyarrow.parquet as pq

    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, path, compression="snappy")


def read(path: Path, robot: Robot | None = None) -> RecordedMotion:
    """Motion of the data set: the actions of its first episode."""
    del robot  # the data set names its joints
    reading = Reading(path)
    text = read_text(path / "meta/info.json", kind="the description of a data set")
    try:
        info = json.loads(text)
        feature = info["features"][ACTION]
        version, rate = info["codebase_version"], info["fps"]
        names = feature.get("names")
    except (ValueError, RecursionError, KeyError, TypeError, AttributeError) as error:
        raise reading.error(f"meta/info.json: no data set with actions: {error!r}") from error
    if version != VERSION:
        raise reading.error(f"meta/info.json: version {version!r}; {VERSION} is read")
    if isinstance(names, dict) and len(names) == 1:  # some recorders group the names
        names = next(iter(names.values()))
    joint_names = None if names is None else reading.names("names of the actions", names)
    joints, notes = _actions(reading, path / "data" / FIRST)
    width = None if joint_names is None else len(joint_names)
    return RecordedMotion(
        layout="lerobot",
        fps=reading.fps(rate),
        joint_names=joint_names,
        order=None,
        joints=reading.array(ACTION, joints, None, width),
        notes=notes,
    )


def _actions(reading: Reading, path: Path) -> tuple[Array, tuple[str, ...]]:
    """Actions (T, J) of the first episode of a file, and what to say of it."""
    import pyarrow.parquet as pq

    stream = io.BytesIO(read_bytes(path, MAX_RECORDING, "a recorded motion"))
    with decoding(path, "a Parquet file of actions"):
        file = pq.ParquetFile(stream)
        groups = (file.metadata.row_group(k) for k in range(file.metadata.num_row_groups))
        if sum(group.total_byte_size for group in groups) > MAX_RECORDING:
            raise reading.error(f"larger than {MAX_RECORDING // 1_000_000} MB unpacked")
        table = file.read(columns=[ACTION, "episode_index"])
        actions = np.array(table.column(ACTION).to_pylist(), dtype=np.float64)
        episodes = table.column("episode_index").to_numpy()
    if not len(actions):
        raise reading.error("no frames")
    several = len(np.unique(episodes)) > 1
    notes = ("the first of several episodes",) if several else ()
    return actions[episodes == episodes[0]], notes
