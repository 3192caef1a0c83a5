"""Files of every format, damaged at random: an error that names the file, never another one."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from mgs.core.errors import InputError, MgsError
from mgs.motion import Motion
from mgs.motion_file.export import export_motion
from mgs.motion_file.formats import FORMATS, RecordedMotion
from tests.support.bus_robots import motion_for
from tests.support.formats import needs_library
from tests.support.shipped import generated

TIMES = 60
RATES = {"locomujoco": 7.0, "op3-action": 125.0}  # [Hz] that differ from 5 Hz
READABLE = [name for name, found in FORMATS.items() if found.readable]


@pytest.fixture(scope="module")
def motion() -> Motion:
    return generated("melson/walk_practical").stages.motion


def damaged(data: bytes, chance: random.Random) -> bytes:
    """Bytes with some of them changed, removed or doubled."""
    out = bytearray(data)
    for _ in range(chance.randint(1, 4)):
        at, n = chance.randrange(len(out) or 1), chance.choice([1, 1, 4, 100])
        match chance.randrange(4):
            case 0:
                out[at : at + n] = chance.randbytes(n)
            case 1:
                del out[at : at + n]
            case 2:
                out[at:at] = out[at : at + n]
            case 3:
                del out[at:]
    return bytes(out)


@pytest.mark.parametrize("fmt", needs_library(READABLE))
def test_a_damaged_file_is_read_or_refused(motion: Motion, fmt: str, tmp_path: Path):
    path = tmp_path / "a"
    export_motion(motion_for(fmt, motion), path, fmt, fps=RATES.get(fmt, 5.0))
    robot = motion_for(fmt, motion).robot
    files = [path] if path.is_file() else [p for p in sorted(path.rglob("*")) if p.is_file()]
    chance = random.Random(fmt)
    refused = 0
    for _ in range(TIMES):
        file = chance.choice(files)
        whole = file.read_bytes()
        # most of the time in the first bytes, where the structure is
        head = chance.choice([200, 2000, len(whole)])
        file.write_bytes(damaged(whole[:head], chance) + whole[head:])
        try:
            assert isinstance(FORMATS[fmt].read(path, robot), RecordedMotion)
        except MgsError as error:
            refused += 1
            assert isinstance(error, InputError)
            assert str(path) in str(error)
        file.write_bytes(whole)
    assert refused > 0


@pytest.mark.parametrize("fmt", needs_library(READABLE))
@pytest.mark.parametrize(
    "content", [b"", b"\x00", b"no", b"PK\x03\x04", b"{}", b"[]", b"\xff\xfe1"]
)
def test_something_else_is_refused(fmt: str, content: bytes, tmp_path: Path):
    path = tmp_path / "a"
    path.write_bytes(content)
    with pytest.raises(InputError, match=str(path)):
        FORMATS[fmt].read(path)


@pytest.mark.parametrize("fmt", needs_library(READABLE))
def test_a_file_that_is_not_there_is_named(fmt: str, tmp_path: Path):
    with pytest.raises(InputError, match="nowhere"):
        FORMATS[fmt].read(tmp_path / "nowhere")
