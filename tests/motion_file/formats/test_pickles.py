"""Pickles of motions: read by trainers, refused where they could do anything else."""

from __future__ import annotations

import io
import os
import pickle
import pickletools
from collections import OrderedDict
from pathlib import Path
from typing import Any

import joblib
import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mgs.core.errors import MotionFileError
from mgs.motion.link_motion import link_motion
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import FORMATS
from mgs.motion_file.formats.pickle_file import read_pickle, write_pickle
from tests.support.loaders import gmr_pickle, motion_lib_pickle
from tests.support.mujoco_oracle import joint_order, mujoco_model
from tests.support.shipped import generated

GAIT = "coman/walk_arc"
ARRAYS: dict[str, Any] = {
    "float64": np.arange(12.0).reshape(3, 4),
    "float32": np.linspace(0, 1, 7, dtype=np.float32),
    "fortran": np.asfortranarray(np.arange(12.0).reshape(3, 4)),
    "int64": np.arange(5),
    "bool": np.array([True, False]),
    "text": np.array(["left_knee", "b"]),
    "scalar": np.float64(30.0),
    "empty": np.zeros((0, 3)),
}
CONTENTS: dict[str, Any] = {
    **ARRAYS,
    "dictionary": {"walk": {"fps": 30, "dof": np.ones((4, 2)), "names": ["a", "b"], "no": None}},
    "tuple": (1, -2.5, "text", b"bytes", True, [1, [2, [3]]]),
    "ordered": OrderedDict(a=np.arange(3.0)),
}


def same(found: Any, expected: Any) -> bool:
    if isinstance(expected, np.ndarray | np.generic):
        return found.dtype == expected.dtype and np.array_equal(found, expected)
    if isinstance(expected, dict):
        return list(found) == list(expected) and all(same(found[k], expected[k]) for k in expected)
    if isinstance(expected, list | tuple):
        return type(found) is type(expected) and all(map(same, found, expected))
    return bool(found == expected)


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
@pytest.mark.parametrize("name", CONTENTS)
def test_plain_data_and_arrays_are_read(name: str, protocol: int, tmp_path: Path):
    path = tmp_path / "a.pkl"
    path.write_bytes(pickle.dumps(CONTENTS[name], protocol=protocol))
    assert same(read_pickle(path), CONTENTS[name])


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
@pytest.mark.parametrize("name", CONTENTS)
def test_what_joblib_writes_is_read(name: str, protocol: int, tmp_path: Path):
    path = tmp_path / "a.pkl"
    joblib.dump({"first": CONTENTS[name], "then": [np.arange(3.0), 7]}, path, protocol=protocol)
    found = read_pickle(path)
    assert same(found, {"first": CONTENTS[name], "then": [np.arange(3.0), 7]})


@pytest.mark.parametrize("name", CONTENTS)
def test_what_is_written_is_read_by_pickle_and_joblib(name: str, tmp_path: Path):
    path = tmp_path / "a.pkl"
    write_pickle(path, CONTENTS[name])
    assert same(pickle.loads(path.read_bytes()), CONTENTS[name])
    assert same(joblib.load(path), CONTENTS[name])
    assert same(read_pickle(path), CONTENTS[name])


def test_names_of_numpy_are_those_that_every_version_knows(tmp_path: Path):
    """NumPy before 1.26 has no module numpy._core."""
    path = tmp_path / "a.pkl"
    write_pickle(path, list(ARRAYS.values()))
    texts = {str(argument) for _, argument, _ in pickletools.genops(path.read_bytes())}
    assert "numpy.core.multiarray _reconstruct" in texts
    assert not any("_core" in text for text in texts)


class Call:
    """Something whose pickle calls a function when it is read."""

    def __init__(self, function: Any, *arguments: Any) -> None:
        self.function, self.arguments = function, arguments

    def __reduce__(self) -> tuple[Any, ...]:
        return self.function, self.arguments


def marked(folder: Path) -> str:
    return f"open({str(folder / 'run')!r}, 'w').close()"


def attacks(folder: Path) -> dict[str, bytes]:
    code = marked(folder)
    nested = np.empty(1, dtype=object)
    nested[0] = Call(exec, code)
    wrapped = io.BytesIO()
    joblib.dump(nested, wrapped)
    poison = b"cjoblib.numpy_pickle\nNumpyArrayWrapper\n(N}X\x05\x00\x00\x00arrayK\x01stb."
    return {
        "exec": pickle.dumps({"fps": Call(exec, code)}),
        "eval": pickle.dumps(Call(eval, f"exec({code!r})")),
        "system": pickle.dumps([Call(os.system, f"touch {folder / 'run'}")]),
        "getattr": pickle.dumps(Call(getattr, "text", "upper")),
        "numpy.load": pickle.dumps(Call(np.load, "a.npy")),
        "inside an array": pickle.dumps(nested),
        "inside an array of joblib": wrapped.getvalue(),
        "huge array": b"cnumpy\nndarray\n(J\xff\xff\xff\x7f\x85R.",
        "huge array by name": (
            b"cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nJ\xff\xff\xff\x7f\x85C\x01b"
            b"\x87R."
        ),
        "change of a class": poison,
        "persistent": b"Pabc\n.",
        "array of objects": pickle.dumps(np.array([{1: 2}, None], dtype=object)),
        "function": pickle.dumps(len),
        "class": b"cnumpy\nndarray\n.",
        "extension": b"\x82\x01.",
    }


@pytest.mark.parametrize("name", attacks(Path()))
def test_a_pickle_that_is_more_than_data_is_refused_and_runs_nothing(name: str, tmp_path: Path):
    path = tmp_path / "a.pkl"
    path.write_bytes(attacks(tmp_path)[name])
    with pytest.raises(MotionFileError, match="not a pickle of plain data and arrays"):
        read_pickle(path)
    assert [p.name for p in tmp_path.iterdir()] == ["a.pkl"]
    test_what_joblib_writes_is_read("dictionary", 4, tmp_path)  # nothing is left behind in mgs


def test_the_attacks_would_succeed_elsewhere(tmp_path: Path):
    """Or the test above would pass for want of attacks."""
    pickle.loads(attacks(tmp_path)["exec"])
    assert (tmp_path / "run").exists()


@pytest.mark.parametrize("fmt", ["gmr", "motion-lib"])
def test_formats_refuse_them_too(fmt: str, tmp_path: Path):
    path = tmp_path / "a.pkl"
    path.write_bytes(attacks(tmp_path)["exec"])
    with pytest.raises(MotionFileError, match=r"a\.pkl: not a pickle of plain data"):
        FORMATS[fmt].read(path)
    assert not (tmp_path / "run").exists()


def test_a_compressed_file_is_refused_with_a_remedy(tmp_path: Path):
    joblib.dump({"a": 1}, tmp_path / "a.pkl", compress=3)
    with pytest.raises(MotionFileError, match="compress=0"):
        read_pickle(tmp_path / "a.pkl")


@pytest.mark.parametrize("cut", [0, 1, 10, 100, 1000])
def test_a_truncated_file_is_an_error(cut: int, tmp_path: Path):
    path = tmp_path / "a.pkl"
    joblib.dump({"a": np.arange(1000.0)}, path)
    path.write_bytes(path.read_bytes()[:cut])
    with pytest.raises(MotionFileError):
        read_pickle(path)


# --- what trainers compute from a file ---------------------------------------------------------


def test_gmr_has_the_links_where_mujoco_has_them(tmp_path: Path):
    made = generated(GAIT)
    export_motion(made.stages.motion, tmp_path / "a.pkl", "gmr")
    found = gmr_pickle(tmp_path / "a.pkl")
    model = mujoco_model(made.robot)
    data = mujoco.MjData(model)
    assert found.link_names == [model.body(i).name for i in range(1, model.nbody)]
    for k in range(0, len(found.joints), 10):
        data.qpos[:] = [*found.root[k], *found.joints[k]]
        mujoco.mj_kinematics(model, data)
        assert np.abs(data.xpos[1:] - found.position[k]).max() < 1e-9


def test_a_motion_library_computes_the_same_links_from_its_rotation_vectors(tmp_path: Path):
    """A chain of rotations from pose_aa, as PHC does it, ends where Pinocchio ends."""
    made = generated(GAIT)
    exported = export_motion(made.stages.motion, tmp_path / "a.pkl", "motion-lib")
    loaded, entry = motion_lib_pickle(tmp_path / "a.pkl")
    model = mujoco_model(made.robot)
    assert exported.written.joints == joint_order(model)
    links = link_motion(exported.sampled)
    turns: list[Rotation] = []
    places: list[np.ndarray] = []
    for body in range(1, model.nbody):
        turn = Rotation.from_rotvec(entry["pose_aa"][:, body - 1].astype(float))
        place = entry["root_trans_offset"].astype(float)
        if body > 1:
            parent = model.body_parentid[body] - 1
            placed = Rotation.from_quat(np.roll(model.body_quat[body], -1))
            place = places[parent] + turns[parent].apply(model.body_pos[body])
            turn = turns[parent] * placed * turn
        turns.append(turn)
        places.append(place)
    assert np.abs(np.stack(places, axis=1) - links.position).max() < 1e-5
    along = Rotation.from_quat(entry["root_rot"]) * turns[0].inv()
    assert along.magnitude().max() < 1e-6
    assert loaded.fps == 30
    assert entry["contact_mask"].min() == 0.0


def test_a_library_of_several_motions_is_refused(tmp_path: Path):
    write_pickle(tmp_path / "a.pkl", {"a": {}, "b": {}})
    with pytest.raises(MotionFileError, match="holds 2 motions"):
        FORMATS["motion-lib"].read(tmp_path / "a.pkl")
