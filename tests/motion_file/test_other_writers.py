"""Motion files that another program has written again are read as those that mgs wrote.

The other program is the writer of the mcap library, which shares no code with ours.
"""

from __future__ import annotations

import contextlib
import io
import itertools
import random
import struct
import sys
import tracemalloc
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import lz4.frame
import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Chunk, DataEnd, Footer, Message, MessageIndex
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, IndexType

from mgs.core.errors import MotionFileError
from mgs.core.limits import MAX_RECORD
from mgs.motion_file import motion_bytes, read_info, read_motion
from mgs.robot import load_robot
from tests.support.crooked import crooked_robot
from tests.support.motion_files import ARRAYS, SIDED, assert_same, random_motion
from tests.support.rewriting import LEAST, Order, rewritten

MOTION = random_motion(crooked_robot(1), 7)
CONTENT = motion_bytes(MOTION)
MAGIC = b"\x89MCAP0\r\n"
DATA_END = 13  # [bytes]
FOOTER_AND_MAGIC = 37  # [bytes]
KINDS = ("data", "summary", "chunk", "attachment")  # of checksums


def backwards(messages: list[Message]) -> list[Message]:
    return messages[::-1]


def by_topic(messages: list[Message]) -> list[Message]:
    return sorted(messages, key=lambda m: m.channel_id)


def by_time(messages: list[Message]) -> list[Message]:
    return sorted(messages, key=lambda m: m.log_time)


def shuffled(messages: list[Message]) -> list[Message]:
    return random.Random(0).sample(messages, len(messages))


ORDERS: list[Order] = [list, backwards, by_topic, by_time, shuffled]
VARIANTS: dict[str, dict[str, Any]] = {
    "by default": {},
    "in one chunk": {"chunk_size": 1 << 30},
    "in a chunk for each message": {"chunk_size": 1},
    "without chunks": {"use_chunking": False},
    "without chunks and all that may be left out": {"use_chunking": False, **LEAST},
    "compressed by lz4": {"compression": CompressionType.LZ4},
    "uncompressed": {"compression": CompressionType.NONE},
    "without checksums": {"enable_crcs": False},
    "with a checksum of the data": {"enable_data_crcs": True},
    "with a checksum of the data, under our name": {"enable_data_crcs": True, "library": "mgs 9"},
    "under our name without statistics": {"enable_data_crcs": True, "use_statistics": False},
    "under our name without message indexes": {
        "enable_data_crcs": True,
        "index_types": IndexType.ALL ^ IndexType.MESSAGE,
    },
    "under our name without chunks": {"enable_data_crcs": True, "use_chunking": False},
    "without a summary": LEAST,
    "without an index of the metadata": {"index_types": IndexType.CHUNK | IndexType.MESSAGE},
    "with metadata and attachments at the end": {"extras_last": True},
    "in another order": {"order": shuffled, "chunk_size": 5000},
    "topic by topic": {"order": by_topic, "chunk_size": 5000},
}


@contextlib.contextmanager
def traced() -> Iterator[Callable[[], int]]:
    """A function that tells the most memory taken since [bytes]."""
    tracemalloc.start()
    try:
        yield lambda: tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def stored(content: bytes, folder: Path) -> Path:
    path = folder / "a.mcap"
    path.write_bytes(content)
    return path


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_rewritten_file_holds_the_same_motion_bit_for_bit(variant: str, tmp_path: Path) -> None:
    path = stored(rewritten(CONTENT, **VARIANTS[variant]), tmp_path)
    assert_same(read_motion(path), MOTION)


@pytest.mark.parametrize("variant", VARIANTS)
def test_read_info_describes_a_rewritten_file_like_the_original(
    variant: str, tmp_path: Path
) -> None:
    ours = read_info(stored(CONTENT, tmp_path))
    found = read_info(stored(rewritten(CONTENT, **VARIANTS[variant]), tmp_path))
    assert found["metadata"] == ours["metadata"]
    assert found["attachments"] == ours["attachments"]
    assert found["duration"] == ours["duration"]
    assert sorted(map(str, found["topics"])) == sorted(map(str, ours["topics"]))


@given(
    order=st.sampled_from(ORDERS),
    library=st.sampled_from([None, "another program"]),
    extras_last=st.booleans(),
    chunk_size=st.sampled_from([1, 2000, 50_000, 1 << 20]),
    compression=st.sampled_from(CompressionType),
    index_types=st.sets(st.sampled_from(list(IndexType.ALL))),
    flags=st.fixed_dictionaries(
        {
            name: st.booleans()
            for name in (
                *("repeat_channels", "repeat_schemas", "use_chunking", "use_statistics"),
                *("use_summary_offsets", "enable_crcs", "enable_data_crcs"),
            )
        }
    ),
)
def test_any_options_of_the_writer_give_a_file_that_is_read(
    tmp_path_factory: pytest.TempPathFactory,
    index_types: set[IndexType],
    flags: dict[str, bool],
    **options: Any,
) -> None:
    indexes = IndexType.NONE
    for kind in index_types:
        indexes |= kind
    content = rewritten(CONTENT, index_types=indexes, **options, **flags)
    assert_same(read_motion(stored(content, tmp_path_factory.mktemp("any"))), MOTION)


def with_chunks(change: Callable[[Chunk], None]) -> bytes:
    """The file with its chunks changed, without summary and checksum of the data."""
    builder = RecordBuilder()
    for record in StreamReader(io.BytesIO(CONTENT), emit_chunks=True).records:
        if isinstance(record, DataEnd):
            break
        if isinstance(record, Chunk):
            change(record)
        if not isinstance(record, MessageIndex):
            record.write(builder)
    DataEnd(0).write(builder)
    Footer(0, 0, 0).write(builder)
    return MAGIC + builder.end() + MAGIC


def test_chunks_that_do_not_declare_their_size_in_the_frame_are_read(tmp_path: Path) -> None:
    """A program that compresses as it goes does not know the size when the frame begins."""
    compressions = itertools.cycle(["zstd", "lz4"])

    def as_stream(chunk: Chunk) -> None:
        data = zstandard.decompress(chunk.data)
        chunk.compression = next(compressions)
        if chunk.compression == "zstd":
            chunk.data = zstandard.ZstdCompressor(write_content_size=False).compress(data)
        else:
            chunk.data = lz4.frame.compress(data, store_size=False)

    assert_same(read_motion(stored(with_chunks(as_stream), tmp_path)), MOTION)


# checksums


def ends(content: bytes) -> tuple[int, int]:
    """Offset of the record that ends the data section, and of the footer."""
    (start,) = struct.unpack_from("<Q", content, len(content) - 28)
    footer = len(content) - FOOTER_AND_MAGIC
    return (start or footer) - DATA_END, footer


def offsets_of_records(content: bytes) -> Iterator[int]:
    """Offsets of the records before the end of the data section."""
    offset = len(MAGIC)
    while offset < ends(content)[0]:
        yield offset
        offset += 9 + struct.unpack_from("<Q", content, offset + 1)[0]


def places_of_checksums(content: bytes) -> dict[str, list[int]]:
    """Offsets of every kind of checksum in a file."""
    places = {"data": [ends(content)[0] + 9], "summary": [len(content) - 12]}
    places |= {"chunk": [], "attachment": []}
    for offset in offsets_of_records(content):
        opcode, length = struct.unpack_from("<BQ", content, offset)
        if opcode == Opcode.CHUNK:
            places["chunk"].append(offset + 9 + 24)
        elif opcode == Opcode.ATTACHMENT:
            places["attachment"].append(offset + 9 + length - 4)
    return places


def with_checksums(content: bytes, change: Callable[[bytes], bytes], *kinds: str) -> bytes:
    """The content with all checksums of some kinds changed."""
    changed = bytearray(content)
    for kind in kinds:
        for at in places_of_checksums(content)[kind]:
            changed[at : at + 4] = change(changed[at : at + 4])
    return bytes(changed)


def unavailable(checksum: bytes) -> bytes:
    return bytes(4)


def wrong(checksum: bytes) -> bytes:
    return bytes(checksum[:3]) + bytes([checksum[3] ^ 0xFF])


def test_checksums_of_0_are_not_compared(tmp_path: Path) -> None:
    """The MCAP specification: "A value of 0 indicates that CRC validation should not be done"."""
    assert all(places_of_checksums(CONTENT).values())
    for kinds in (KINDS, ["data"], ["summary"], ["data", "chunk"], ["data", "attachment"]):
        content = with_checksums(CONTENT, unavailable, *kinds)
        assert content != CONTENT
        assert_same(read_motion(stored(content, tmp_path)), MOTION)


@pytest.mark.parametrize("kind", ["summary", "chunk", "attachment"])
def test_every_other_checksum_holds_where_that_of_the_data_is_missing(
    kind: str, tmp_path: Path
) -> None:
    content = with_checksums(with_checksums(CONTENT, unavailable, "data"), wrong, kind)
    assert "checksum" in refused(stored(content, tmp_path))


REWRITTEN = ["by default", "without chunks", "with a checksum of the data", "compressed by lz4"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("variant", REWRITTEN)
def test_a_wrong_checksum_in_a_rewritten_file_is_refused(
    kind: str, variant: str, tmp_path: Path
) -> None:
    content = rewritten(CONTENT, **VARIANTS[variant])
    changed = with_checksums(content, wrong, kind)
    if changed == content:
        assert (kind, variant) == ("chunk", "without chunks")
        return
    assert "checksum" in refused(stored(changed, tmp_path))


# damage


DAMAGED = [*REWRITTEN, "without checksums", "without chunks and all that may be left out"]
SOURCES = {name: rewritten(CONTENT, **VARIANTS[name]) for name in DAMAGED}


def refused(path: Path) -> str:
    """Message of the error that reading the motion raises."""
    with pytest.raises(MotionFileError, match=path.name) as caught:
        read_motion(path)
    return str(caught.value)


@given(source=st.sampled_from(DAMAGED), data=st.data())
def test_a_rewritten_file_cut_anywhere_is_refused(
    source: str, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    content = SOURCES[source]
    size = data.draw(st.integers(0, len(content) - 1))
    message = refused(stored(content[:size], tmp_path_factory.mktemp("cut")))
    assert "not an MCAP file" in message or "truncated" in message


@given(source=st.sampled_from(DAMAGED), data=st.data())
def test_a_damaged_rewritten_file_gives_a_motion_or_is_refused(
    source: str, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Where the writer computed no checksum, damage to a number cannot be seen."""
    content = bytearray(SOURCES[source])
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(content) - 1))
        length = data.draw(st.sampled_from([0, 1, 1, 4, 8, 100]))
        content[at : at + length] = data.draw(st.binary(min_size=0, max_size=9))
    path = stored(bytes(content), tmp_path_factory.mktemp("damaged"))
    for read in (read_motion, read_info):
        with contextlib.suppress(MotionFileError):
            read(path)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (lambda messages: messages[:-1], "has 6 messages, not 7"),
        (lambda messages: [*messages, messages[-1]], "has 8 messages, not 7"),
    ],
)
def test_a_missing_or_repeated_message_is_refused(
    change: Order, problem: str, tmp_path: Path
) -> None:
    content = rewritten(CONTENT, order=lambda messages: change(by_topic(messages)))
    assert problem in refused(stored(content, tmp_path))


@pytest.mark.parametrize("chunked", [True, False])
def test_two_messages_at_one_time_are_refused(chunked: bool, tmp_path: Path) -> None:
    def doubled(messages: list[Message]) -> list[Message]:
        """The last sample of the last topic once more, in place of the one before it."""
        *rest, _, last = by_topic(messages)
        return [*rest, last, last]

    content = rewritten(CONTENT, order=doubled, use_chunking=chunked)
    assert "not in step with dt" in refused(stored(content, tmp_path))


def test_a_chunk_compressed_in_an_unknown_way_is_refused(tmp_path: Path) -> None:
    content = with_chunks(lambda chunk: setattr(chunk, "compression", "brotli"))
    assert "'brotli'" in refused(stored(content, tmp_path))


def test_a_missing_lz4_package_is_named_with_its_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = stored(rewritten(CONTENT, **VARIANTS["compressed by lz4"]), tmp_path)
    monkeypatch.setitem(sys.modules, "lz4", None)
    monkeypatch.setitem(sys.modules, "lz4.frame", None)
    assert "pip install lz4" in refused(path)


# memory


BOMB = 1 << 26  # [bytes] of zeros behind every chunk


@pytest.mark.parametrize(
    ("compression", "pack"),
    [
        ("zstd", zstandard.compress),
        ("zstd", zstandard.ZstdCompressor(write_content_size=False).compress),
        ("lz4", lz4.frame.compress),
        ("lz4", lambda data: lz4.frame.compress(data, store_size=False)),
    ],
)
@pytest.mark.parametrize("declared", [1000, MAX_RECORD + 1, 1 << 62])
def test_a_chunk_larger_than_it_declares_or_than_fits_takes_no_memory(
    compression: str, pack: Callable[[bytes], bytes], declared: int, tmp_path: Path
) -> None:
    packed = pack(bytes(BOMB))

    def change(chunk: Chunk) -> None:
        chunk.compression, chunk.data, chunk.uncompressed_size = compression, packed, declared

    path = stored(with_chunks(change), tmp_path)
    with traced() as peak:
        refused(path)
    assert peak() < 8e6  # [bytes]; a few of the packed chunk


@pytest.mark.parametrize("length", [1 << 40, (1 << 64) - 1])
def test_a_record_longer_than_the_file_takes_no_memory(length: int, tmp_path: Path) -> None:
    content = bytearray(SOURCES["without chunks and all that may be left out"])
    opcodes = set()
    for offset in offsets_of_records(bytes(content)):
        if content[offset] in opcodes:
            continue
        opcodes.add(content[offset])
        changed = bytearray(content)
        struct.pack_into("<Q", changed, offset + 1, length)
        path = stored(bytes(changed), tmp_path)
        with traced() as peak:
            refused(path)
        assert peak() < 8e6  # [bytes]
    assert opcodes >= {Opcode.HEADER, Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE}
    assert opcodes >= {Opcode.ATTACHMENT, Opcode.METADATA}


@pytest.mark.slow_if("topic by topic", "by default")
@pytest.mark.parametrize("variant", ["without chunks", "topic by topic", "by default"])
def test_reading_a_rewritten_file_takes_little_more_memory_than_its_motion(
    variant: str, tmp_path: Path
) -> None:
    motion = random_motion(load_robot("melson"), 3000)
    content = rewritten(motion_bytes(motion), **VARIANTS[variant])
    assert len(content) > 6e6
    path = stored(content, tmp_path)
    del content
    read_motion(path)  # caches are filled
    with traced() as peak:
        found = read_motion(path)
    own = sum(getattr(found, name).nbytes for name in (*ARRAYS, *SIDED))
    assert peak() < 2 * own + 10e6  # [bytes]; chunks of 1 MB, the trajectory message of 1 MB
