"""Writing MCAP files in which all messages of a topic and a span of time are one array.

Format: MCAP specification (mcap.dev/spec). `Writer.add_message` of the mcap library takes some
microseconds per message, longer than the computation of the motion. So only the rare records are
encoded by `mcap.records`; Message and MessageIndex records have fixed layouts and are arrays here.

The checksums of the data section and of the summary cover every byte.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import BinaryIO

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from numpy.typing import NDArray

from mgs.motion_file.cdr import Bytes, full_name, schema_text
from mgs.motion_file.mcap_layout import (
    CHUNK_HEAD,
    HEAD,
    INDEX_HEAD,
    MAGIC,
    MESSAGE,
    RECORD_HEAD,
    Times,
    crc_of,
)

COMPRESSION_LEVEL = 1  # zstd; joint angles hardly compress: level 3 saves 1 %, level 5 saves 2 %

# ROS 2 quality of service in the form of rosbag2, as numbers since ROS 2 Humble reads no names. {}
# is 1 for transient-local (late subscribers receive the message) or 2 for volatile.
QOS = """\
- history: 1
  depth: 10
  reliability: 1
  durability: {}
  deadline: {{sec: 9223372036, nsec: 854775807}}
  lifespan: {{sec: 9223372036, nsec: 854775807}}
  liveliness: 1
  liveliness_lease_duration: {{sec: 9223372036, nsec: 854775807}}
  avoid_ros_namespace_conventions: false
"""


@dataclass(frozen=True)
class Block:
    """Consecutive messages of one channel in a chunk."""

    channel: int
    times: Times  # (N,) [ns]
    offsets: NDArray[np.uint64]  # (N,) offsets of the messages in the block [bytes]
    size: int  # [bytes]
    parts: Iterable[Bytes]  # records, in pieces of any length


def message_rows(channel: int, times: Times, size: int) -> Bytes:
    """Records (N, HEAD + size) of N messages; their data, rows[:, HEAD:], is not yet filled in."""
    rows = np.empty((len(times), HEAD + size), dtype=np.uint8)
    head = rows[:, :HEAD].view(MESSAGE)[:, 0]
    head["opcode"], head["length"] = Opcode.MESSAGE, HEAD - RECORD_HEAD.size + size
    head["channel"], head["sequence"] = channel, 0
    head["log_time"] = head["publish_time"] = times
    return rows


def block_of_rows(channel: int, times: Times, rows: Bytes) -> Block:
    """Block of complete records (N, length), all of the same length."""
    offsets = np.arange(len(rows), dtype=np.uint64) * np.uint64(rows.shape[1])
    return Block(channel, times, offsets, rows.size, [rows.reshape(-1)])


def block_of_message(channel: int, time: int, size: int, parts: Iterable[Bytes]) -> Block:
    """Block of one message, given in pieces so that it is never in memory as a whole."""
    times = np.array([time], dtype=np.uint64)
    head = message_rows(channel, times, 0)
    head.view(MESSAGE)["length"] += np.uint64(size)

    def pieces() -> Iterator[Bytes]:
        yield head.reshape(-1)
        yield from parts

    return Block(channel, times, np.zeros(1, dtype=np.uint64), HEAD + size, pieces())


@dataclass
class ChunkWriter:
    """Writer of one MCAP file of profile ros2 to a stream that can be read and rewound."""

    stream: BinaryIO
    library: str
    schemas: dict[str, Schema] = field(default_factory=dict)
    channels: list[Channel] = field(default_factory=list)
    attachments: list[AttachmentIndex] = field(default_factory=list)
    metadata: list[MetadataIndex] = field(default_factory=list)
    chunks: list[ChunkIndex] = field(default_factory=list)
    counts: Counter[int] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        self.stream.write(MAGIC)
        self._put(Header("ros2", self.library))

    def add_channel(self, topic: str, kind: str, *, once: bool) -> int:
        """Register a topic of a message type and return its channel number.

        Args:
            topic: name with a leading slash.
            kind: message type such as `std_msgs/String`.
            once: the topic has a single message, which late subscribers receive too.
        """
        if kind not in self.schemas:
            text = schema_text(kind).encode()
            schema = Schema(
                id=len(self.schemas) + 1, name=full_name(kind), encoding="ros2msg", data=text
            )
            self.schemas[kind] = schema
            self._put(schema)
        channel = Channel(
            id=len(self.channels) + 1,
            topic=topic,
            message_encoding="cdr",
            metadata={"offered_qos_profiles": QOS.format(1 if once else 2)},
            schema_id=self.schemas[kind].id,
        )
        self.channels.append(channel)
        self._put(channel)
        return channel.id

    def add_metadata(self, name: str, values: dict[str, str]) -> None:
        """Write a metadata record."""
        offset, length = self._put(Metadata(name, values))
        self.metadata.append(MetadataIndex(offset, length, name))

    def add_attachment(self, name: str, media_type: str, data: bytes, time: int) -> None:
        """Write an attachment with log time `time` [ns] and without a time of creation."""
        offset, length = self._put(Attachment(0, time, name, media_type, data))
        self.attachments.append(
            AttachmentIndex(offset, length, time, 0, len(data), name, media_type)
        )

    def add_chunk(self, blocks: Sequence[Block]) -> None:
        """Write a chunk of at least one message and its message indexes."""
        start = self.stream.tell()
        self.stream.seek(CHUNK_HEAD.size, os.SEEK_CUR)  # the head is written at the end
        size = sum(block.size for block in blocks)
        crc = self._compress(blocks, size)
        index_start = self.stream.tell()
        first = int(min(block.times.min() for block in blocks))
        last = int(max(block.times.max() for block in blocks))
        length, packed = index_start - start, index_start - start - CHUNK_HEAD.size
        rest = length - RECORD_HEAD.size
        self.stream.seek(start)
        self.stream.write(
            CHUNK_HEAD.pack(Opcode.CHUNK, rest, first, last, size, crc, 4, b"zstd", packed)
        )
        self.stream.seek(index_start)
        offsets = self._put_indexes(blocks)
        index_length = self.stream.tell() - index_start
        self.chunks.append(
            ChunkIndex(
                chunk_start_offset=start,
                chunk_length=length,
                message_start_time=first,
                message_end_time=last,
                message_index_offsets=offsets,
                message_index_length=index_length,
                compression="zstd",
                compressed_size=packed,
                uncompressed_size=size,
            )
        )

    def finish(self) -> None:
        """Write the end of the data section, the summary and the footer."""
        self._put(DataEnd(crc_of(self.stream, 0, self.stream.tell())))
        builder, start = RecordBuilder(), self.stream.tell()
        offsets = []
        for opcode, records in self._summary().items():
            offset = builder.count
            for record in records:
                record.write(builder)
            offsets.append(SummaryOffset(opcode, start + offset, builder.count - offset))
        offsets_start = start + builder.count
        for summary_offset in offsets:
            summary_offset.write(builder)
        Footer(start, offsets_start, 0).write(builder)
        summary = _content(builder)[:-4]  # the checksum takes the place of the 0
        self.stream.write(summary + struct.pack("<I", zlib.crc32(summary)) + MAGIC)

    def _put(self, record: McapRecord) -> tuple[int, int]:
        """Write a record; return its offset and length [bytes]."""
        builder, offset = RecordBuilder(), self.stream.tell()
        record.write(builder)
        data = _content(builder)
        self.stream.write(data)
        return offset, len(data)

    def _compress(self, blocks: Sequence[Block], size: int) -> int:
        """Write the content of a chunk piece by piece; return its checksum."""
        crc = 0
        packer = zstandard.ZstdCompressor(level=COMPRESSION_LEVEL).compressobj(size=size)
        for block in blocks:
            for part in block.parts:
                crc = zlib.crc32(part.data, crc)
                self.stream.write(packer.compress(part.data))
        self.stream.write(packer.flush())
        return crc

    def _put_indexes(self, blocks: Sequence[Block]) -> dict[int, int]:
        """Write the message indexes of a chunk; return their offsets by channel."""
        places, base = {}, 0
        for block in blocks:
            places[block.channel] = self.stream.tell()
            pairs = np.stack([block.times, block.offsets + np.uint64(base)], axis=1)
            self.stream.write(
                INDEX_HEAD.pack(Opcode.MESSAGE_INDEX, 6 + pairs.nbytes, block.channel, pairs.nbytes)
            )
            self.stream.write(pairs.astype("<u8").tobytes())
            self.counts[block.channel] += len(pairs)
            base += block.size
        return places

    def _summary(self) -> dict[Opcode, Sequence[McapRecord]]:
        statistics = Statistics(
            attachment_count=len(self.attachments),
            channel_count=len(self.channels),
            channel_message_counts=dict(self.counts),
            chunk_count=len(self.chunks),
            message_count=self.counts.total(),
            message_end_time=max(chunk.message_end_time for chunk in self.chunks),
            message_start_time=min(chunk.message_start_time for chunk in self.chunks),
            metadata_count=len(self.metadata),
            schema_count=len(self.schemas),
        )
        return {
            Opcode.SCHEMA: list(self.schemas.values()),
            Opcode.CHANNEL: self.channels,
            Opcode.STATISTICS: [statistics],
            Opcode.CHUNK_INDEX: self.chunks,
            Opcode.ATTACHMENT_INDEX: self.attachments,
            Opcode.METADATA_INDEX: self.metadata,
        }


def _content(builder: RecordBuilder) -> bytes:
    content: bytes = builder.end()  # type: ignore[no-untyped-call]
    return content
