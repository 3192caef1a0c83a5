"""The notebook runs from its first cell to its last one and shows what the library computes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nbformat
import pytest
from ipykernel.kernelspec import write_kernel_spec
from nbclient import NotebookClient

import mgs
from mgs.sim import available_engines

NOTEBOOK = Path(__file__).parent.parent / "notebooks" / "first_walk.ipynb"
KERNEL = "the-interpreter-of-the-tests"
TIMEOUT = 60  # [s] for each cell


def read() -> Any:
    return nbformat.read(NOTEBOOK, as_version=4)


@pytest.fixture(scope="module")
def executed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Cells by their id after a run in an empty folder, with the interpreter of the tests."""
    folder = tmp_path_factory.mktemp("notebook")
    write_kernel_spec(folder / "kernels" / KERNEL)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("JUPYTER_PATH", str(folder))
        for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR"):
            patch.setenv(name, str(folder / name.lower()))
        notebook = read()
        work = folder / "work"
        work.mkdir()
        resources = {"metadata": {"path": str(work)}}
        client = NotebookClient(notebook, timeout=TIMEOUT, kernel_name=KERNEL, resources=resources)
        client.execute()
    cells = {cell.id: cell for cell in notebook.cells}
    return cells | {"files": sorted(path.name for path in work.iterdir())}


def shown(cell: Any) -> dict[str, str]:
    """What the last expression of a cell shows, by media type."""
    (output,) = (output for output in cell.outputs if output.output_type == "execute_result")
    return output.data


def printed(cell: Any) -> str:
    return "".join(o.text for o in cell.outputs if o.output_type == "stream" and o.name == "stdout")


def test_the_notebook_is_committed_without_outputs_and_uses_no_magic():
    notebook = read()
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert code and all(cell.outputs == [] and cell.execution_count is None for cell in code)
    assert not any(line.startswith(("%", "!")) for c in code for line in c.source.splitlines())
    assert "matplotlib" not in "".join(cell.source for cell in code)


@pytest.mark.skipif("mujoco" not in available_engines(), reason="needs MuJoCo")
def test_the_notebook_runs_and_shows_what_the_library_computes(executed: dict[str, Any]):
    motion = mgs.generate("melson", "melson/walk_practical")
    assert shown(executed["robot"])["text/plain"] == repr(motion.robot)
    assert shown(executed["gait"])["text/html"] == motion.gait._repr_html_()
    assert shown(executed["motion"])["text/plain"] == repr(motion)
    first, second, third = printed(executed["arrays"]).splitlines()
    assert (first, third) == (repr(motion), str(motion.robot.joint_names))
    assert second == f"{motion.q.shape} {motion.zmp.shape}"
    assert printed(executed["replay"]).splitlines()[1].startswith("True ")
    assert "joint_position" in shown(executed["verdict"])["text/html"]
    settings = {"walk__n_steps": 4, "walk__step_length": 0.03}
    shorter = mgs.generate("melson", "melson/walk_practical", **settings)
    assert shown(executed["change"])["text/plain"] == repr(shorter)
    assert shorter.n_samples < motion.n_samples
    assert "step_lenght: unknown key; did you mean 'step_length'?" in printed(executed["error"])
    assert shown(executed["file"])["text/plain"] in ("True", "np.True_")
    assert executed["files"] == ["walk.csv", "walk.mcap"]


@pytest.mark.skipif("mujoco" not in available_engines(), reason="needs MuJoCo")
def test_motions_and_figures_show_themselves_as_pictures(executed: dict[str, Any]):
    for cell in ("motion", "change", "sequence", "above", "joints"):
        png = shown(executed[cell])["image/png"]
        assert png.startswith("iVBORw0KGgo"), "the beginning of every PNG in base 64"
        assert len(png) > 20_000
    sequence = shown(executed["sequence"])["text/plain"]
    assert sequence.startswith("<Motion walk_kick_walk of melson: sequence, ")
