"""What an MCAP file holds and where, by a walk over its records from the first to the last.

For files that another program wrote or rewrote: without summary, index or statistics, with or
without chunks, in any order. The walk goes from record to record and passes over the messages;
chunks are then unpacked, checked and counted one at a time, so that memory does not grow with the
file. Nothing is taken from the summary, which only repeats what stands before it.
"""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial

import mcap.records
from mcap.opcode import Opcode
from mcap.records import Attachment, AttachmentIndex, Channel, Metadata, MetadataIndex, Schema

from mgs.motion_file.mcap_chunk import Chunk, chunk_of_records, refuse_expansion, unpack, walk
from mgs.motion_file.mcap_contents import Contents, Place
from mgs.motion_file.mcap_layout import BLOCK, HEAD, MAGIC, MESSAGE_HEAD, RECORD_HEAD
from mgs.motion_file.mcap_records import (
    NO_CHECKSUM,
    NOT_OURS,
    RecordFile,
    UnreadableFileError,
    decoded,
)


@dataclass
class Run:
    """Consecutive messages outside chunks."""

    start: int
    end: int
    channels: set[int]


@dataclass
class Scan:
    """What a walk over the records of a file has found so far."""

    file: RecordFile
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    counts: Counter[int] = field(default_factory=Counter)
    attachments: dict[str, AttachmentIndex] = field(default_factory=dict)
    metadata: dict[str, MetadataIndex] = field(default_factory=dict)
    runs: list[Run] = field(default_factory=list)
    chunks: list[int] = field(default_factory=list)  # offsets
    unpacked: int = 0  # size of the chunks so far [bytes]

    def add_record(self, opcode: int, offset: int, end: int, head: bytes) -> None:
        """Take in a record outside chunks; `head` begins with its first bytes."""
        if opcode == Opcode.MESSAGE:
            self._add_message(MESSAGE_HEAD.unpack(head)[2], offset, end)
        elif opcode == Opcode.CHUNK:
            self.chunks.append(offset)
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            self._add_topic(opcode, self.file.content_at(offset, Opcode(opcode)))
        elif opcode == Opcode.ATTACHMENT:
            self._add_attachment(offset, end)
        elif opcode == Opcode.METADATA:
            name = self.file.record_at(offset, Opcode.METADATA, Metadata.read).name
            self.metadata[name] = MetadataIndex(offset, end - offset, name)

    def add_chunk(self, offset: int) -> Place:
        """Take in what is in a chunk; returns where its messages are."""
        chunk = self.file.record_at(offset, Opcode.CHUNK, mcap.records.Chunk.read)
        self.unpacked += chunk.uncompressed_size
        refuse_expansion(self.unpacked, self.file.size)
        data = unpack(chunk)
        for opcode, start, end in walk(data):
            if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                self._add_topic(opcode, data[start + RECORD_HEAD.size : end])
        found = {i: len(entries) for i, entries in chunk_of_records(data).entries.items()}
        self.counts.update(found)
        return Place(frozenset(found), partial(_load_chunk, self.file, offset))

    def _add_message(self, channel: int, offset: int, end: int) -> None:
        self.counts[channel] += 1
        last = self.runs[-1] if self.runs else None
        if last is None or last.end != offset or end - last.start > BLOCK:
            self.runs.append(Run(offset, end, {channel}))
        else:
            last.end = end
            last.channels.add(channel)

    def _add_topic(self, opcode: int, content: bytes) -> None:
        """Take in a schema or a channel; other programs repeat them."""
        if opcode == Opcode.SCHEMA:
            schema = decoded(content, Schema.read)
            self.schemas[schema.id] = schema
        else:
            channel = decoded(content, Channel.read)
            self.channels[channel.id] = channel

    def _add_attachment(self, offset: int, end: int) -> None:
        content = self.file.content_at(offset, Opcode.ATTACHMENT)
        crc = int.from_bytes(content[-4:], "little")
        if crc not in (NO_CHECKSUM, zlib.crc32(content[:-4])):
            raise UnreadableFileError(
                "the checksum of an attachment does not match; the file is damaged"
            )
        found = decoded(content, Attachment.read)
        self.attachments[found.name] = AttachmentIndex(
            offset=offset,
            length=end - offset,
            log_time=found.log_time,
            create_time=found.create_time,
            data_size=len(found.data),
            name=found.name,
            media_type=found.media_type,
        )


def contents_by_scan(file: RecordFile, required_metadata: str | None) -> Contents:
    """Contents of a file that may lack summary, index, statistics and checksums.

    Args:
        file: the file.
        required_metadata: name of a metadata record without which no chunk is unpacked, so that a
            large recording of something else is refused at once; None: none is required.

    Raises:
        UnreadableFileError: the file is damaged, or has no such metadata record.
    """
    scan = Scan(file)
    for opcode, offset, end, head in _records(file):
        scan.add_record(opcode, offset, end, head)
    if required_metadata is not None and required_metadata not in scan.metadata:
        raise UnreadableFileError(NOT_OURS)
    places = [Place(frozenset(run.channels), partial(_load_run, file, run)) for run in scan.runs]
    places += [scan.add_chunk(offset) for offset in scan.chunks]
    return Contents(
        schemas=scan.schemas,
        channels=scan.channels,
        counts=dict(scan.counts),
        attachments=scan.attachments,
        metadata=scan.metadata,
        places=places,
        in_order=False,
    )


def _records(file: RecordFile) -> Iterator[tuple[int, int, int, bytes]]:
    """Opcode, offset, end and first bytes of each record of the data section."""
    offset = len(MAGIC)
    while offset < file.data_end:
        head = file.bytes_at(offset, HEAD)  # at least this much follows: the end of the file
        opcode, length = RECORD_HEAD.unpack_from(head)
        end = offset + RECORD_HEAD.size + length
        if end > file.data_end:
            raise UnreadableFileError("a record reaches beyond the data section")
        yield opcode, offset, end, head
        offset = end


def _load_run(file: RecordFile, run: Run) -> Chunk:
    return chunk_of_records(file.bytes_at(run.start, run.end - run.start))


def _load_chunk(file: RecordFile, offset: int) -> Chunk:
    return chunk_of_records(unpack(file.record_at(offset, Opcode.CHUNK, mcap.records.Chunk.read)))
