"""Inputs that go wrong, one for each kind: a short message with exit code 2, quickly, and no file.

The files in tests/data/hostile were drawn for this purpose; what else is needed is made here.
"""

from __future__ import annotations

import json
import os
import socket
import threading
from pathlib import Path

import pytest
from mcap.records import Attachment, Metadata

import mgs.cli
from mgs.core.limits import MAX_CHAIN, MAX_CROWD, MAX_FILE, MAX_LINKS, MAX_SHAPES
from mgs.core.shipped import shipped_folder
from mgs.motion_file import motion_bytes
from mgs.pipeline.request import generate
from tests.support.commands import files_below, run
from tests.support.rewriting import rewritten

CASES = Path(__file__).parents[1] / "data" / "hostile"
ANSWERS = {  # what the message has to name
    "goal_far.yaml": "1.3e+08 samples; at most 2e+06 allowed",
    "goal_small.yaml": "use a nearer goal or a larger walk.step_length",
    "goal_tiny.yaml": "use a nearer goal or a larger walk.step_length",
    "kick_long.yaml": "use shorter durations in kick or a larger dt",
    "octal.yaml": "n_steps: '010' begins with a zero and is octal for some programs; write 10",
    "seq_escape.yaml": "leads out of the folder of the file that names it",
    "sexa.yaml": "n_steps: '1:30' is a number to the base of 60 for some programs",
    "sweep_csv_cr.yaml": "save it with the line ends of Unix or Windows",
    "sweep_integers.yaml": "axes.walk.n_steps: integers: from 1 to 1000000000 are more than",
    "sweep_linspace_nan.yaml": "axes.walk.step_length: linspace: from 1e+308 to -1e+308 is",
    "sweep_nul.yaml": r"axes.'walk.goal.\x00': contains control characters",
    "sweep_overflow.yaml": "filters: cannot be evaluated: integer overflow",
    "sweep_samples.yaml": "use fewer keys or at most 250000 gaits",
    "sweep_surrogate.yaml": r"'\ud800' contains half of a character",
    "yaml_anchor.yaml": "YAML aliases (*name) are not allowed",
}


def refusal(*arguments: object) -> str:
    """Message of a command that refuses its input."""
    result = run(*arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert len(result.stderr) < 1000
    return result.stderr


def test_every_case_has_its_answer():
    assert set(ANSWERS) == {path.name for path in CASES.glob("*.yaml")}


@pytest.mark.parametrize("name", ANSWERS)
def test_a_hostile_file_gets_its_answer(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    command = ("batch", "plan") if name.startswith("sweep_") else ("generate",)
    assert ANSWERS[name] in refusal(*command, CASES / name)
    assert files_below(tmp_path) == {}


def robot_folder(folder: Path, urdf: str) -> Path:
    """Robot folder with melson's robot.yaml and another URDF."""
    folder.mkdir()
    (folder / "robot.urdf").write_text(urdf)
    (folder / "robot.yaml").write_bytes(
        (shipped_folder("robots") / "melson/robot.yaml").read_bytes()
    )
    return folder


def melson_with(text: str) -> str:
    """URDF of melson with more at its end."""
    urdf = (shipped_folder("robots") / "melson/robot.urdf").read_text()
    return urdf.replace("</robot>", f"{text}</robot>")


def chain(n: int) -> str:
    """Links in a row, each fixed to the one before."""
    links = "".join(f'<link name="c{i}"/>' for i in range(n))
    joints = "".join(
        f'<joint name="cj{i}" type="fixed"><parent link="c{i - 1}"/><child link="c{i}"/></joint>'
        for i in range(1, n)
    )
    return f"{links}{joints}"


@pytest.mark.parametrize("n", [MAX_CHAIN + 2, 1000, 10_000, 20_000])
def test_a_long_chain_of_links_reaches_no_native_parser(n: int, tmp_path: Path) -> None:
    """Such a chain overflows the stack of a parser that descends it by recursion."""
    robot = robot_folder(tmp_path / "r", f'<robot name="r">{chain(n)}</robot>')
    known = f"at most {MAX_LINKS} are allowed" if n > MAX_LINKS else "too long a chain"
    for command in (
        ("robot", "check", robot),
        ("robot", "show", robot),
        ("generate", "melson/walk_5cm", "--robot", robot, "-o", tmp_path / "a.mcap"),
        ("robot", "init", robot / "robot.urdf", "-o", tmp_path / "new"),
    ):
        assert known in refusal(*command)
    assert not (tmp_path / "new").exists()
    assert not (tmp_path / "a.mcap").exists()


def test_a_long_chain_in_a_motion_file_reaches_no_native_parser(tmp_path: Path) -> None:
    def change(record: object) -> None:
        if isinstance(record, Attachment) and record.name == "robot.urdf":
            record.data = melson_with(chain(900)).encode()

    path = tmp_path / "a.mcap"
    motion = motion_bytes(generate("melson", "melson/bow", dt=0.1))
    path.write_bytes(rewritten(motion, change=change))
    assert "too long a chain" in refusal("validate", path, "--physics", "none")


@pytest.mark.parametrize(
    ("urdf", "message"),
    [
        ("<a>" * 3000 + "</a>" * 3000, "nested too deeply"),
        ('<!DOCTYPE robot [<!ENTITY a "b">]><robot name="r"/>', "it declares a document type"),
        (
            melson_with(
                '<link name="s">'
                + '<collision><geometry><sphere radius="0.01"/></geometry></collision>'
                * (MAX_SHAPES + 1)
                + "</link>"
            ),
            f"at most {MAX_SHAPES} are allowed",
        ),
        (
            melson_with(
                '<link name="a"/><joint name="b" type="fixed"><parent link="torso"/>'
                '<child link="a"/></joint><joint name="c" type="fixed"><parent link="torso"/>'
                '<child link="a"/></joint>'
            ),
            "link 'a' is the child of two joints",
        ),
        (
            melson_with(
                '<link name="a"><collision><geometry><sphere radius="0"/></geometry></collision>'
                "</link>"
            ),
            "sphere radius = '0' has to be above 0",
        ),
    ],
)
def test_a_urdf_that_no_parser_should_see_is_refused(
    urdf: str, message: str, tmp_path: Path
) -> None:
    assert message in refusal("robot", "show", robot_folder(tmp_path / "r", urdf))


@pytest.mark.parametrize("name", ["/dev/zero", "pipe"])
def test_a_device_or_a_pipe_is_no_input(name: str, tmp_path: Path) -> None:
    """It would never end, or never begin."""
    os.mkfifo(tmp_path / "pipe")
    path = tmp_path / name
    for command in (
        ("generate", path),
        ("robot", "init", path, "-o", tmp_path / "new"),
        ("batch", "plan", path),
        ("info", path),
        ("validate", path),
    ):
        assert "not a regular file" in refusal(*command) or "no such file" in refusal(*command)


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    with path.open("wb") as stream:
        stream.truncate(MAX_FILE + 1)
    assert f"larger than {MAX_FILE // 1000} kB" in refusal("generate", path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("walk:\n\tn_steps: 3\n", "YAML is indented with spaces, not with tabs"),
        ("walk: {n_steps: 3_0}\n", "n_steps: '3_0' is a number for some programs"),
        ("walk: {n_steps: 0b11}\n", "n_steps: '0b11' is a number for some programs"),
        ("walk: {n_steps: 4, zmp_offset: [00, 1]}\n", "'00' begins with a zero"),
        ("walk: {n_steps: 3.5}\n", "walk.n_steps: input should be a valid integer"),
    ],
)
def test_yaml_that_can_mean_two_things_is_refused(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text(f"mgs: 1\nmotion: walk\n{text}")
    assert message in refusal("generate", path, "--robot", "melson")


def test_escape_sequences_of_a_file_do_not_reach_the_terminal(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text('mgs: 1\nrobot: "\\e]0;owned\\a"\nmotion: walk\nwalk: {n_steps: 3}\n')
    message = refusal("generate", path)
    assert "\x1b" not in message
    assert r"\x1b]0;owned\x07" in message


def test_every_command_prints_through_the_function_that_escapes() -> None:
    folder = Path(mgs.cli.__file__).parent
    users = {path.name for path in folder.rglob("*.py") if "click.echo(" in path.read_text()}
    assert users == {"common.py"}


def test_debug_shows_where_an_error_arose(tmp_path: Path) -> None:
    assert "Traceback" not in run("generate", tmp_path / "no.yaml").stderr
    assert "Traceback" in run("--debug", "generate", tmp_path / "no.yaml").stderr


def test_force_replaces_regular_files_only(tmp_path: Path) -> None:
    """Not the target of a link, which may be anywhere, nor a device."""
    target, link = tmp_path / "precious", tmp_path / "a.csv"
    target.write_text("precious")
    link.symlink_to(target)
    motion = tmp_path / "a.mcap"
    assert run("generate", "melson/bow", "-o", motion).exit_code == 0
    for path in (link, Path("/dev/null")):
        result = run("export", motion, "-o", path, "--force")
        assert result.exit_code == 1
        assert "never replaced" in result.stderr
    assert target.read_text() == "precious"
    assert link.is_symlink()


def test_motion_files_without_a_manifest_are_not_replaced(tmp_path: Path) -> None:
    sweep, library = tmp_path / "s.yaml", tmp_path / "library"
    sweep.write_text("mgs: 1\nbase: melson/bow\naxes: {dt: [0.02]}\n")
    (library / "gaits").mkdir(parents=True)
    (library / "gaits" / "000000.mcap").write_text("precious")
    for more in ((), ("--resume",)):
        result = run("batch", "run", sweep, "-o", library, "--workers", 1, *more)
        assert result.exit_code == 1
        assert "would be replaced" in result.stderr
    assert files_below(library) == {"gaits/000000.mcap": b"precious"}


def test_a_port_that_never_answers_does_not_hang_a_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mgs.library.cluster.CONNECT_TIMEOUT", 0.5)
    sweep = tmp_path / "s.yaml"
    sweep.write_text("mgs: 1\nbase: melson/bow\naxes: {dt: [0.02]}\n")
    with socket.create_server(("127.0.0.1", 0)) as server:
        taken: list[socket.socket] = []
        waiting = threading.Thread(target=lambda: taken.append(server.accept()[0]), daemon=True)
        waiting.start()
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        result = run("batch", "run", sweep, "-o", tmp_path / "library", "--dask", address)
        waiting.join()
        for connection in taken:
            connection.close()
    assert result.exit_code == 1
    assert "no Dask scheduler answers" in result.stderr
    assert not (tmp_path / "library").exists()


def test_boxes_that_engines_need_too_long_for_are_refused(tmp_path: Path) -> None:
    """Also in a motion file that a program of others has written."""
    gait, path = tmp_path / "a.yaml", tmp_path / "a.mcap"
    box = "{x: 0.3, length: 0.01, width: 0.5, height: 0.005}"
    crowd = ", ".join([box] * (MAX_CROWD + 1))
    gait.write_text(
        f"mgs: 1\nrobot: melson\nmotion: walk\nwalk: {{n_steps: 2, boxes: [{crowd}]}}\n"
    )
    assert f"walk.boxes: more than {MAX_CROWD} boxes touch one square" in refusal("generate", gait)
    boxes = [{"x": 0.0, "y": 0.0, "yaw": 0.0, "length": 0.5, "width": 0.5, "height": 5e-4}] * 100

    def change(record: object) -> None:
        if isinstance(record, Metadata):
            record.metadata |= {"scene": json.dumps({"boxes": boxes, "balls": []})}

    path.write_bytes(
        rewritten(motion_bytes(generate("melson", "melson/bow", dt=0.1)), change=change)
    )
    for command in (("validate", path), ("report", path), ("replay", path)):
        assert f"more than {MAX_CROWD} boxes touch one square" in refusal(*command)
