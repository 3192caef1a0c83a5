"""What an MCAP file holds and where, by the summary at its end."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import mcap.records
import numpy as np
from mcap.opcode import Opcode
from mcap.records import (
    AttachmentIndex,
    Channel,
    ChunkIndex,
    McapRecord,
    MetadataIndex,
    Schema,
    Statistics,
)
from mcap.stream_reader import StreamReader
from numpy.typing import NDArray

from mgs.core.limits import MAX_SUMMARY
from mgs.motion_file.mcap_chunk import Chunk, refuse_expansion, unpack
from mgs.motion_file.mcap_layout import INDEX_HEAD
from mgs.motion_file.mcap_records import RecordFile, UnreadableFileError

BYTES_PER_INDEX_ENTRY = 16


@dataclass(frozen=True)
class Place:
    """Messages that stand together in a file."""

    channels: frozenset[int]  # that have messages here
    load: Callable[[], Chunk]


@dataclass(frozen=True)
class Contents:
    """Everything in a file but its messages, and where these are."""

    schemas: dict[int, Schema]
    channels: dict[int, Channel]
    counts: dict[int, int]  # messages by channel
    attachments: dict[str, AttachmentIndex]
    metadata: dict[str, MetadataIndex]
    places: list[Place]
    in_order: bool  # the messages of each channel follow one another in time


def contents_of_summary(file: RecordFile) -> Contents | None:
    """Contents by the summary; None where it says less than that of a file that mgs wrote.

    Raises:
        UnreadableFileError: the summary speaks of more messages than the file can hold.
    """
    if file.summary_start is None or not file.has_checksums:
        return None
    records = _records_of_summary(file, file.summary_start)
    chunks = [r for r in records if isinstance(r, ChunkIndex)]
    if len({c.chunk_start_offset for c in chunks}) < len(chunks):
        raise UnreadableFileError("the index names a chunk twice")
    refuse_expansion(sum(c.uncompressed_size for c in chunks), file.size)
    contents = Contents(
        schemas={r.id: r for r in records if isinstance(r, Schema)},
        channels={r.id: r for r in records if isinstance(r, Channel)},
        counts=next((r.channel_message_counts for r in records if isinstance(r, Statistics)), {}),
        attachments={r.name: r for r in records if isinstance(r, AttachmentIndex)},
        metadata={r.name: r for r in records if isinstance(r, MetadataIndex)},
        places=[
            Place(frozenset(c.message_index_offsets), partial(_load_indexed, file, c))
            for c in chunks
        ],
        in_order=True,
    )
    if not _is_complete(contents, records, chunks):
        return None
    n_messages = sum(contents.counts.values())
    if n_messages * BYTES_PER_INDEX_ENTRY > file.size:
        raise UnreadableFileError(f"too small a file for {n_messages} messages")
    return contents


def _records_of_summary(file: RecordFile, start: int) -> list[McapRecord]:
    if file.size - start > MAX_SUMMARY:
        raise UnreadableFileError(f"its index is larger than {MAX_SUMMARY} bytes")
    summary = file.bytes_at(start, file.size - start)
    # a chunk has no business there; if there is one, it must not be unpacked
    return list(StreamReader(io.BytesIO(summary), skip_magic=True, emit_chunks=True).records)


def _is_complete(contents: Contents, records: list[McapRecord], chunks: list[ChunkIndex]) -> bool:
    """Whether the summary leads to every message, attachment and metadata record."""
    found = (len(contents.attachments), len(contents.metadata), len(contents.channels), len(chunks))
    counted = [
        (s.attachment_count, s.metadata_count, s.channel_count, s.chunk_count)
        for s in records
        if isinstance(s, Statistics)
    ]
    return counted == [found] and bool(chunks) and all(c.message_index_offsets for c in chunks)


def _load_indexed(file: RecordFile, index: ChunkIndex) -> Chunk:
    """Chunk with the entries of its message indexes."""
    chunk = file.record_at(index.chunk_start_offset, Opcode.CHUNK, mcap.records.Chunk.read)
    if chunk.uncompressed_size != index.uncompressed_size:
        raise UnreadableFileError("a chunk does not have the size that the index declares")
    data = unpack(chunk)
    offsets = index.message_index_offsets
    entries = {channel: _index_entries(file, at, channel) for channel, at in offsets.items()}
    return Chunk(np.frombuffer(data, dtype=np.uint8), entries)


def _index_entries(file: RecordFile, offset: int, channel: int) -> NDArray[np.uint64]:
    """Log times [ns] and offsets (N, 2) of the messages of a channel in a chunk."""
    opcode, _, found, size = INDEX_HEAD.unpack(file.bytes_at(offset, INDEX_HEAD.size))
    if (opcode, found) != (Opcode.MESSAGE_INDEX, channel):
        raise UnreadableFileError("a message index is not where it should be")
    entries = file.bytes_at(offset + INDEX_HEAD.size, size)
    return np.frombuffer(entries, dtype="<u8").reshape(-1, 2)
