"""Access to the records of an MCAP file whose two ends are sound and whose checksums hold.

A checksum of 0 says that the program that wrote the file computed none (mcap.dev/spec), so it is
not compared. Every other checksum is, before anything that it covers is interpreted.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from typing import BinaryIO, TypeVar

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Header, McapRecord

from mgs.core.limits import MAX_RECORD
from mgs.motion_file.mcap_layout import DATA_END, FOOTER, MAGIC, RECORD_HEAD, crc_of

R = TypeVar("R", bound=McapRecord)

NO_CHECKSUM = 0
NOT_OURS = "an MCAP file, but not a motion file that mgs wrote"


class UnreadableFileError(ValueError):
    """A file is not MCAP, incomplete, contradicts itself, or needs a package that is missing."""


class RecordFile:
    """An MCAP file of which any record can be read.

    Attributes:
        size: length of the file [bytes].
        data_end: offset of the record that ends the data section [bytes].
        summary_start: offset of the summary [bytes]; None where the file has none.
        has_checksums: both the data section and the summary have one.
        header: the first record.
    """

    def __init__(self, stream: BinaryIO) -> None:
        """Check the ends of the file and all checksums outside its chunks and attachments.

        Raises:
            UnreadableFileError: the file is not MCAP, truncated, or a checksum does not match.
        """
        self.stream = stream
        self.size = stream.seek(0, os.SEEK_END)
        footer, start, summary_crc = self._read_footer()
        self.summary_start = start or None
        self.data_end = (start or footer) - DATA_END.size
        if self.data_end < len(MAGIC) or footer < start:
            raise UnreadableFileError("the summary is not where the end of the file says it is")
        data_crc = self._read_data_end()
        self._compare(summary_crc, start or footer, self.size - len(MAGIC) - 4, "summary")
        self._compare(data_crc, 0, self.data_end, "data section")
        self.has_checksums = NO_CHECKSUM not in (summary_crc, data_crc)
        self.header = self.record_at(len(MAGIC), Opcode.HEADER, Header.read)

    def bytes_at(self, offset: int, size: int) -> bytes:
        """Part of the file; raises UnreadableFileError where it is shorter or the part too long."""
        if offset + size > self.size:
            raise UnreadableFileError("a record reaches beyond the end")
        if size > MAX_RECORD:
            raise UnreadableFileError(
                f"a record of {size} bytes is longer than the {MAX_RECORD} that are read at once"
            )
        self.stream.seek(offset)
        return self.stream.read(size)

    def content_at(self, offset: int, opcode: Opcode) -> bytes:
        """Content of the record of a kind; raises UnreadableFileError where there is none."""
        found, size = RECORD_HEAD.unpack(self.bytes_at(offset, RECORD_HEAD.size))
        if found != opcode:
            raise UnreadableFileError(
                f"there is no {opcode.name.lower()} where there should be one"
            )
        return self.bytes_at(offset + RECORD_HEAD.size, size)

    def record_at(self, offset: int, opcode: Opcode, read: Callable[[ReadDataStream], R]) -> R:
        """Record of a kind, decoded by a function of the mcap library."""
        return decoded(self.content_at(offset, opcode), read)

    def _read_footer(self) -> tuple[int, int, int]:
        """Offset of the footer, offset of the summary (0: none), and the summary's checksum."""
        footer = self.size - FOOTER.size - len(MAGIC)
        if footer < 0 or self.bytes_at(0, len(MAGIC)) != MAGIC:
            raise UnreadableFileError("not an MCAP file")
        tail = self.bytes_at(footer, FOOTER.size + len(MAGIC))
        opcode, _, start, _, crc = FOOTER.unpack(tail[: FOOTER.size])
        if tail[FOOTER.size :] != MAGIC or opcode != Opcode.FOOTER:
            raise UnreadableFileError("the end is missing; the file is truncated")
        return footer, start, crc

    def _read_data_end(self) -> int:
        """Checksum of the data section."""
        opcode, length, crc = DATA_END.unpack(self.bytes_at(self.data_end, DATA_END.size))
        if (opcode, length) != (Opcode.DATA_END, 4):
            raise UnreadableFileError("the summary does not follow the data")
        return int(crc)

    def _compare(self, crc: int, start: int, end: int, name: str) -> None:
        if crc != NO_CHECKSUM and crc_of(self.stream, start, end) != crc:
            raise UnreadableFileError(
                f"the checksum of the {name} does not match; the file is damaged"
            )


def decoded(content: bytes, read: Callable[[ReadDataStream], R]) -> R:
    """Record from its content, decoded by a function of the mcap library."""
    return read(ReadDataStream(io.BytesIO(content)))
