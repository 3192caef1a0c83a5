"""Motions of whole libraries in other formats: files, tables, resuming and errors."""

from __future__ import annotations

import csv
import dataclasses
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mgs.core.errors import ConfigError, MgsError, OutputExistsError
from mgs.library import export_motions as module
from mgs.library.export_motions import Conversion, asked_velocities, export_motions
from mgs.library.points import plan_sweep
from mgs.library.query import query
from mgs.library.run import recipe_of, run_batch
from mgs.library.velocity import velocity_of
from mgs.motion_file import read_motion
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import Options
from tests.support.commands import files_below
from tests.support.libraries import write_sweep

Made = tuple[Path, object]


def written(made: Made) -> dict[int, str]:
    """Motion files of the library by the number of the gait."""
    rows = query(made[0], "file is not None", ["number", "file"]).rows
    return {int(str(number)): str(file) for number, file in rows}


def test_every_file_is_that_of_a_single_export(made: Made, tmp_path: Path):
    out = tmp_path / "out"
    told: list[tuple[int, int]] = []
    summary = export_motions(
        made[0], out, Conversion("npz"), progress=lambda done, total: told.append((done, total))
    )
    files = written(made)
    assert (summary.written, summary.kept, summary.failed) == (len(files), 0, {})
    assert summary.is_whole and told[-1] == (len(files), len(files))
    names = {f"{number:06d}.npz" for number in files}
    assert {p.name for p in out.iterdir()} == names | {"export.json", "index.csv"}
    for number, file in files.items():
        export_motion(read_motion(made[0] / file), tmp_path / "one.npz", "npz", force=True)
        assert (out / f"{number:06d}.npz").read_bytes() == (tmp_path / "one.npz").read_bytes()


def test_the_table_has_the_measured_and_the_steps_velocity(made: Made, tmp_path: Path):
    export_motions(made[0], tmp_path / "out", Conversion("csv"))
    with (tmp_path / "out/index.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    files = written(made)
    assert [int(row["number"]) for row in rows] == sorted(files)
    for row in rows:
        motion: Any = read_motion(made[0] / files[int(row["number"])])
        found = [float(row[f"step_{name}"]) for name in ("vx", "vy", "wz")]
        assert found == list(velocity_of(motion.gait.walk))
        measured = query(made[0], f"number == {row['number']}", ["vx", "verdict"]).rows[0]
        assert (float(row["vx"]), row["verdict"]) == measured


def test_gaits_that_could_not_be_made_have_a_velocity_too(made: Made):
    """Which a grid needs, so that what is missing in it is noticed."""
    asked, files = asked_velocities(made[0]), written(made)
    assert set(files) < set(asked)
    assert len(asked) == len(query(made[0]).rows)


def test_an_export_continues_with_the_same_choices_only(made: Made, tmp_path: Path):
    out, chosen = tmp_path / "out", Conversion("csv")
    export_motions(made[0], out, chosen)
    whole = files_below(out)
    with pytest.raises(OutputExistsError, match="--resume"):
        export_motions(made[0], out, chosen)
    assert files_below(out) == whole
    gone = sorted(out.glob("0*.csv"))[1]
    gone.unlink()
    (out / "index.csv").unlink()
    kept = sorted(out.glob("0*.csv"))[0]
    kept.write_text("it is not looked at again")
    summary = export_motions(made[0], out, chosen, resume=True)
    assert (summary.written, summary.kept) == (1, len(written(made)) - 1)
    again = files_below(out)
    assert again.pop(kept.name) != whole.pop(kept.name)
    assert again == whole
    for other in (
        dataclasses.replace(chosen, fps=50.0),
        Conversion("npz"),
        dataclasses.replace(chosen, options=Options(joints=("waist_yaw",))),
        dataclasses.replace(chosen, feed_forward=True),
    ):
        with pytest.raises(ConfigError, match="was exported with other choices"):
            export_motions(made[0], out, other, resume=True)
    with pytest.raises(ConfigError, match=r"\(where differ\)"):
        export_motions(made[0], out, chosen, "number > 3", resume=True)
    with pytest.raises(ConfigError, match=r"holds no export\.json"):
        export_motions(made[0], tmp_path / "none", chosen, resume=True)


def test_a_killed_export_leaves_whole_files_only(
    made: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    out, chosen, count = tmp_path / "out", Conversion("csv"), [0]

    def killed(*arguments: Any, **more: Any) -> Any:
        count[0] += 1
        if count[0] == 3:
            raise KeyboardInterrupt
        return export_motion(*arguments, **more)

    monkeypatch.setattr(module, "export_motion", killed)
    with pytest.raises(KeyboardInterrupt):
        export_motions(made[0], out, chosen)
    monkeypatch.undo()
    assert len(list(out.glob("0*.csv"))) == 2 and not list(out.glob(".*"))
    export_motions(made[0], out, chosen, resume=True)
    export_motions(made[0], tmp_path / "other", chosen)
    assert files_below(out) == files_below(tmp_path / "other")


def test_a_motion_that_cannot_be_written_spoils_no_other(made: Made, tmp_path: Path):
    library = tmp_path / "library"
    shutil.copytree(made[0], library)
    files = written(made)
    damaged = sorted(files)[0]
    (library / files[damaged]).write_bytes(b"damaged")
    summary = export_motions(library, tmp_path / "out", Conversion("csv"))
    assert list(summary.failed) == [damaged]
    assert "missing or damaged; make it again with mgs batch run" in summary.failed[damaged]
    assert summary.written == len(files) - 1 and not summary.is_whole
    summary = export_motions(library, tmp_path / "cycles", Conversion("csv", cycle=True))
    assert len(summary.failed) == len(files)  # walks of two steps have no cycle
    summary = export_motions(library, tmp_path / "ticks", Conversion("dynamixel"))
    assert all("no motor given" in text for n, text in summary.failed.items() if n != damaged)


def test_nothing_is_written_for_a_condition_that_no_gait_meets(made: Made, tmp_path: Path):
    with pytest.raises(MgsError, match="no gait with a motion file meets the condition"):
        export_motions(made[0], tmp_path / "out", Conversion("csv"), "number > 1000")
    with pytest.raises(ConfigError, match="is unknown"):
        export_motions(made[0], tmp_path / "out", Conversion("flac"))
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def by_velocity(tmp_path_factory: pytest.TempPathFactory, address: str) -> Path:
    """Library of 2 x 1 x 2 velocities, of which one is too fast for any leg."""
    folder = tmp_path_factory.mktemp("velocities")
    axes = {"vx": [0.0, 0.02], "wz": [0.0, 0.1]}
    plan = plan_sweep(write_sweep(folder, axes=axes))
    run_batch(plan, recipe_of(plan), folder / "library", address=address)
    return folder / "library"


def test_a_grid_has_a_file_for_every_velocity(by_velocity: Path, tmp_path: Path):
    summary = export_motions(by_velocity, tmp_path / "out", Conversion("npz"), grid=True)
    assert summary.grid == (2, 1, 2) and summary.is_whole
    grid = json.loads((tmp_path / "out/grid.json").read_text())
    assert (grid["vx"], grid["vy"], grid["wz"]) == ([0.0, 0.02], [0.0], [0.0, 0.1])
    names = {p.name for p in (tmp_path / "out").glob("0*.npz")}
    assert {name for plane in grid["files"] for row in plane for name in row} == names
    motion: Any = read_motion(by_velocity / "gaits" / grid["files"][1][0][1].replace("npz", "mcap"))
    assert velocity_of(motion.gait.walk) == pytest.approx((0.02, 0.0, 0.1), abs=1e-9)


def test_the_measured_velocity_is_that_of_the_sweep_but_for_the_closing_step(by_velocity: Path):
    """Two steps, the second of which closes: one step forward from lift-off to touch-down."""
    rows = query(by_velocity, "file is not None", ["number", "file", "vx", "wz"]).rows
    asked = asked_velocities(by_velocity)
    for number, file, vx, wz in rows:
        motion: Any = read_motion(by_velocity / str(file))
        walk, wanted = motion.gait.walk, asked[int(str(number))]
        span = 2.0 * walk.single_support + walk.double_support + motion.dt
        part = (walk.single_support + walk.double_support) / span
        assert float(str(vx)) == pytest.approx(part * wanted[0], abs=2e-4)
        assert float(str(wz)) == pytest.approx(part * wanted[2], abs=2e-4)


def test_what_a_grid_lacks_is_counted(made: Made, by_velocity: Path, tmp_path: Path):
    """The step of 0.5 m that no leg reaches, and steps that two gaits have."""
    chosen = Conversion("csv")
    summary = export_motions(by_velocity, tmp_path / "a", chosen, "number != 2", grid=True)
    assert summary.missing == [asked_velocities(by_velocity)[2]] and not summary.is_whole
    summary = export_motions(made[0], tmp_path / "b", chosen, grid=True)
    assert len(summary.missing) == 1 and len(summary.double) == 5
    assert not np.isclose(summary.missing[0][0], 0.0)
