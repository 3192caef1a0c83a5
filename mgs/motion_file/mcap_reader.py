"""Reading MCAP files in which all messages of a topic and a time span are one array.

The counterpart of `mcap_writer`. Nothing is interpreted before the checksums over the data section
and the summary hold; what is then still wrong was written wrong, and is refused as well.
"""

from __future__ import annotations

import io
import os
import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, BinaryIO, TypeVar

import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)
from mcap.stream_reader import StreamReader
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from mgs.motion_file.cdr import Bytes
from mgs.motion_file.mcap_writer import (
    CHUNK_HEAD,
    HEAD,
    INDEX_HEAD,
    MAGIC,
    MESSAGE,
    RECORD_HEAD,
    Times,
    crc_of,
)

R = TypeVar("R", bound=McapRecord)

MAX_CHUNK = 1 << 28  # [bytes] uncompressed; ours with samples are far below
DATA_END = struct.Struct("<BQI")
FOOTER = struct.Struct("<BQQQI")


class DamagedFileError(ValueError):
    """A file is not MCAP, incomplete, or contradicts itself."""


class ChunkReader:
    """An MCAP file of profile ros2 whose summary has been read and whose checksums hold."""

    def __init__(self, stream: BinaryIO) -> None:
        """Read all but messages and attachments; raises DamagedFileError and others on nonsense."""
        self.stream = stream
        self.size = stream.seek(0, os.SEEK_END)
        self.summary_start = self._check_ends()
        records = self._read_summary()
        self.schemas = {r.id: r for r in records if isinstance(r, Schema)}
        self.channels = {r.topic: r for r in records if isinstance(r, Channel)}
        self.chunks = [r for r in records if isinstance(r, ChunkIndex)]
        self.attachments = {r.name: r for r in records if isinstance(r, AttachmentIndex)}
        self.metadata = {r.name: r for r in records if isinstance(r, MetadataIndex)}
        self.counts = next(
            (r.channel_message_counts for r in records if isinstance(r, Statistics)), {}
        )
        self.header = self._record(len(MAGIC), self.size, Opcode.HEADER, Header.read)

    def check_data(self) -> None:
        """Compare the checksum of the data section; raises DamagedFileError."""
        end = self.summary_start - DATA_END.size
        opcode, length, crc = DATA_END.unpack(self._bytes(end, DATA_END.size))
        if (opcode, length) != (Opcode.DATA_END, 4):
            raise DamagedFileError("the summary does not follow the data")
        if crc == 0:
            raise DamagedFileError("the data have no checksum; another program rewrote the file")
        if crc_of(self.stream, 0, end) != crc:
            raise DamagedFileError("the checksum of the data does not match; the file is damaged")

    def count(self, topic: str) -> int:
        """Number of messages of a topic."""
        return self.counts.get(self.channels[topic].id, 0)

    def kind(self, topic: str) -> str:
        """Message type of a topic, as ROS writes it."""
        return self.schemas[self.channels[topic].schema_id].name

    def read_metadata(self, name: str) -> dict[str, str]:
        """Content of a metadata record."""
        index = self.metadata[name]
        record: Metadata = self._record(index.offset, index.length, Opcode.METADATA, Metadata.read)
        return record.metadata

    def read_attachment(self, name: str) -> bytes:
        """Content of an attachment."""
        index = self.attachments[name]
        record: Attachment = self._record(
            index.offset, index.length, Opcode.ATTACHMENT, Attachment.read
        )
        return record.data

    def read_chunk(self, index: ChunkIndex) -> Chunk:
        """Messages of one chunk."""
        head = CHUNK_HEAD.unpack(self._bytes(index.chunk_start_offset, CHUNK_HEAD.size))
        _, _, _, _, size, crc, _, compression, _ = head
        start = index.chunk_start_offset + CHUNK_HEAD.size
        packed = self._bytes(start, index.compressed_size)
        if (
            compression != b"zstd"
            or size > MAX_CHUNK
            or size != zstandard.frame_content_size(packed)
        ):
            raise DamagedFileError("a chunk is not compressed as expected")
        data = zstandard.ZstdDecompressor().decompress(packed)
        if zlib.crc32(data) != crc:
            raise DamagedFileError("the checksum of a chunk does not match")
        offsets = index.message_index_offsets
        entries = {channel: self._index_entries(at, channel) for channel, at in offsets.items()}
        return Chunk(np.frombuffer(data, dtype=np.uint8), entries)

    def _check_ends(self) -> int:
        """Check magic bytes and the checksum of the summary; returns its place."""
        tail_size = FOOTER.size + len(MAGIC)
        if self.size < tail_size or self._bytes(0, len(MAGIC)) != MAGIC:
            raise DamagedFileError("not an MCAP file")
        tail = self._bytes(self.size - tail_size, tail_size)
        opcode, _, start, _, crc = FOOTER.unpack(tail[: FOOTER.size])
        if tail[FOOTER.size :] != MAGIC or opcode != Opcode.FOOTER:
            raise DamagedFileError("the end is missing; the file is truncated")
        if not len(MAGIC) + DATA_END.size <= start <= self.size - tail_size:
            raise DamagedFileError("it has no summary; mgs did not write it")
        if crc == 0:
            raise DamagedFileError("the summary has no checksum; mgs did not write it")
        if crc_of(self.stream, start, self.size - len(MAGIC) - 4) != crc:
            raise DamagedFileError("the checksum of the summary does not match")
        return int(start)

    def _read_summary(self) -> list[McapRecord]:
        summary = self._bytes(self.summary_start, self.size - self.summary_start)
        return list(StreamReader(io.BytesIO(summary), skip_magic=True).records)

    def _index_entries(self, offset: int, channel: int) -> NDArray[np.uint64]:
        """Times and offsets (N, 2) of a channel's messages in a chunk."""
        opcode, _, found, size = INDEX_HEAD.unpack(self._bytes(offset, INDEX_HEAD.size))
        if (opcode, found) != (Opcode.MESSAGE_INDEX, channel):
            raise DamagedFileError("a message index is not where it should be")
        entries = self._bytes(offset + INDEX_HEAD.size, size)
        return np.frombuffer(entries, dtype="<u8").reshape(-1, 2)

    def _record(
        self, offset: int, length: int, opcode: Opcode, read: Callable[[ReadDataStream], R]
    ) -> R:
        found, size = RECORD_HEAD.unpack(self._bytes(offset, RECORD_HEAD.size))
        if found != opcode or size > length:
            raise DamagedFileError(f"there is no {opcode.name.lower()} where there should be one")
        return read(ReadDataStream(io.BytesIO(self._bytes(offset + RECORD_HEAD.size, size))))

    def _bytes(self, offset: int, size: int) -> bytes:
        if offset + size > self.size:
            raise DamagedFileError("a record reaches beyond the end")
        self.stream.seek(offset)
        return self.stream.read(size)


@dataclass(frozen=True)
class Chunk:
    """Messages of a time span: the uncompressed records, and where each channel's are."""

    data: Bytes
    entries: dict[int, NDArray[np.uint64]]  # times and offsets (N, 2) by channel

    def times(self, channel: int) -> Times:
        """Log times (N,) of a channel's messages [ns]."""
        return self.entries[channel][:, 0] if channel in self.entries else np.empty(0, np.uint64)

    def sizes(self, channel: int) -> NDArray[np.int64]:
        """Lengths (N,) of the data of a channel's messages [bytes]."""
        heads = self._windows(channel, HEAD, slice(None)).view(MESSAGE)[:, 0]
        return heads["length"].astype(np.int64) - (HEAD - RECORD_HEAD.size)

    def messages(self, channel: int, size: int, select: Any = slice(None)) -> Bytes:
        """Data (N, size) of those messages of a channel that are selected; a copy.

        Raises:
            DamagedFileError: a message has another length, or its head differs from the index.
        """
        rows = self._windows(channel, HEAD + size, select)
        head = rows[:, :HEAD].view(MESSAGE)[:, 0]
        times = self.times(channel)[select]
        if not (
            np.all(head["opcode"] == Opcode.MESSAGE)
            and np.all(head["length"] == HEAD - RECORD_HEAD.size + size)
            and np.all(head["channel"] == channel)
            and np.array_equal(head["log_time"], times)
            and np.array_equal(head["publish_time"], times)
        ):
            raise DamagedFileError("a message does not fit its topic and index")
        return rows[:, HEAD:]

    def _windows(self, channel: int, length: int, select: Any) -> Bytes:
        """Copies (N, length) of the bytes from each message's offset on."""
        offsets = self.entries[channel][select, 1]
        if len(offsets) and int(offsets.max()) + length > len(self.data):
            raise DamagedFileError("a message reaches beyond its chunk")
        rows: Bytes = sliding_window_view(self.data, length)[offsets.astype(np.intp)]
        return rows
