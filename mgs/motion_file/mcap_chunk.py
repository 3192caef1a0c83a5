"""The messages of a span of an MCAP file as arrays, and how a chunk is unpacked.

zstd is always there, since we write it; lz4 is a package that only those need who read files that
other programs compressed with it.
"""

from __future__ import annotations

import zlib
from array import array
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import mcap.records
import numpy as np
import zstandard
from mcap.opcode import Opcode
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from mgs.core.limits import MAX_RATIO, MAX_RECORD
from mgs.motion_file.cdr import Bytes
from mgs.motion_file.mcap_layout import HEAD, MESSAGE, MESSAGE_HEAD, RECORD_HEAD, Times
from mgs.motion_file.mcap_records import NO_CHECKSUM, UnreadableFileError


@dataclass(frozen=True)
class Chunk:
    """Messages of a span: the uncompressed records, and where those of each channel are."""

    data: Bytes
    entries: Mapping[int, NDArray[np.uint64]]  # log times [ns] and offsets (N, 2) by channel

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
            UnreadableFileError: a message has another length, or its head differs from the index.
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
            raise UnreadableFileError("a message does not fit its topic and index")
        return rows[:, HEAD:]

    def _windows(self, channel: int, length: int, select: Any) -> Bytes:
        """Copies (N, length) of the bytes from each message's offset on."""
        offsets = self.entries[channel][select, 1]
        if not len(offsets):
            return np.empty((0, length), dtype=np.uint8)
        if int(offsets.max()) + length > len(self.data):
            raise UnreadableFileError("a message reaches beyond its chunk")
        rows: Bytes = sliding_window_view(self.data, length)[offsets.astype(np.intp)]
        return rows


def chunk_of_records(data: bytes) -> Chunk:
    """Chunk of uncompressed records without an index, whose messages are looked for one by one."""
    found: defaultdict[int, array[int]] = defaultdict(lambda: array("Q"))
    for opcode, offset, end in walk(data):
        if opcode == Opcode.MESSAGE:
            if end - offset < HEAD:
                raise UnreadableFileError("a message is shorter than its head")
            _, _, channel, _, log_time, _ = MESSAGE_HEAD.unpack_from(data, offset)
            found[channel].extend((log_time, offset))
    entries = {
        channel: np.frombuffer(pairs, dtype=np.uint64).reshape(-1, 2)
        for channel, pairs in found.items()
    }
    return Chunk(np.frombuffer(data, dtype=np.uint8), entries)


def walk(data: bytes) -> Iterator[tuple[int, int, int]]:
    """Opcode, offset and end of each of some consecutive records.

    Raises:
        UnreadableFileError: the last record is incomplete.
    """
    offset = 0
    while offset < len(data):
        if offset + RECORD_HEAD.size > len(data):
            raise UnreadableFileError("a chunk ends in the middle of a record")
        opcode, length = RECORD_HEAD.unpack_from(data, offset)
        end = offset + RECORD_HEAD.size + length
        if end > len(data):
            raise UnreadableFileError("a record reaches beyond its chunk")
        yield opcode, offset, end
        offset = end


def refuse_expansion(unpacked: int, size: int) -> None:
    """Raise UnreadableFileError where all chunks unpacked are too large for a file of a size."""
    if unpacked > MAX_RATIO * size:
        raise UnreadableFileError(
            f"its chunks would unpack to {unpacked} bytes, more than {MAX_RATIO} times the file"
        )


def unpack(chunk: mcap.records.Chunk) -> bytes:
    """Uncompressed records of a chunk.

    Raises:
        UnreadableFileError: the chunk is damaged, too large, or compressed in a way that cannot be
            read here.
    """
    size = chunk.uncompressed_size
    if size > MAX_RECORD:
        raise UnreadableFileError(
            f"a chunk of {size} bytes is larger than the {MAX_RECORD} that are read at once; write "
            "the file again with smaller chunks"
        )
    if chunk.compression not in UNPACKERS:
        known = ", ".join(repr(name) for name in UNPACKERS)
        raise UnreadableFileError(
            f"a chunk is compressed by {chunk.compression!r}, which mgs cannot read; write the "
            f"file again with one of {known}"
        )
    data = UNPACKERS[chunk.compression](chunk.data, size)
    if len(data) != size:
        raise UnreadableFileError("a chunk does not have the size that it declares")
    if chunk.uncompressed_crc not in (NO_CHECKSUM, zlib.crc32(data)):
        raise UnreadableFileError("the checksum of a chunk does not match; the file is damaged")
    return data


def _unpack_zstd(packed: bytes, size: int) -> bytes:
    """Unpack at most `size` bytes; a frame may omit its size but must not declare another one."""
    if zstandard.frame_content_size(packed) not in (size, -1):
        raise UnreadableFileError("a chunk is not compressed as expected")
    return zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)


def _unpack_lz4(packed: bytes, size: int) -> bytes:
    """Unpack at most one byte more than `size`."""
    try:
        import lz4.frame
    except ImportError as error:
        raise UnreadableFileError(
            "its chunks are compressed by lz4, and the Python package lz4 is not installed; "
            "install it with: python -m pip install lz4"
        ) from error
    unpacker = lz4.frame.LZ4FrameDecompressor()
    data: bytes = unpacker.decompress(packed, max_length=size + 1)
    if not unpacker.eof:
        raise UnreadableFileError("a chunk is not compressed as expected")
    return data


UNPACKERS = {"": lambda packed, size: packed, "zstd": _unpack_zstd, "lz4": _unpack_lz4}
