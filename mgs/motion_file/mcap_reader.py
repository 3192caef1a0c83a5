"""Reading MCAP files in which all messages of a topic and a span of time are one array.

The counterpart of `mcap_writer`. A file that mgs wrote is read by its summary and its indexes. One
that another program wrote or rewrote may lack them, so it is walked through first (`mcap_scan`),
which takes longer. From there on both are read alike.
"""

from __future__ import annotations

from collections.abc import Iterator, Set
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Metadata

from mgs.motion_file.mcap_chunk import Chunk
from mgs.motion_file.mcap_contents import Contents, contents_of_summary
from mgs.motion_file.mcap_records import NOT_OURS, RecordFile, UnreadableFileError
from mgs.motion_file.mcap_scan import contents_by_scan

OWN_LIBRARY = "mgs "  # the beginning of the library's name in the header of our files
METADATA = "mgs"


class McapReader:
    """An MCAP file of profile ros2 with the metadata record `mgs`.

    Attributes:
        file: access to its records.
        contents: what it holds and where.
        topics: channel of each topic.
    """

    def __init__(self, stream: BinaryIO) -> None:
        """Read all but the messages.

        Raises:
            UnreadableFileError: the file is damaged or not a motion file; other errors on records
                that make no sense.
        """
        self.file = RecordFile(stream)
        self.contents = _contents(self.file)
        self.topics: dict[str, Channel] = {c.topic: c for c in self.contents.channels.values()}

    def count(self, topic: str) -> int:
        """Number of messages of a topic."""
        return self.contents.counts.get(self.topics[topic].id, 0)

    def kind(self, topic: str) -> str:
        """Message type of a topic, as ROS writes it."""
        return self.contents.schemas[self.topics[topic].schema_id].name

    def read_metadata(self) -> dict[str, str]:
        """Content of the metadata record `mgs`."""
        offset = self.contents.metadata[METADATA].offset
        return self.file.record_at(offset, Opcode.METADATA, Metadata.read).metadata

    def read_attachment(self, name: str) -> bytes:
        """Content of an attachment."""
        offset = self.contents.attachments[name].offset
        return self.file.record_at(offset, Opcode.ATTACHMENT, Attachment.read).data

    def chunks(self, channels: Set[int]) -> Iterator[Chunk]:
        """All messages of some channels and others beside them, one part of the file at a time."""
        for place in self.contents.places:
            if place.channels & channels:
                yield place.load()


def _contents(file: RecordFile) -> Contents:
    if file.header.profile != "ros2":
        raise UnreadableFileError(NOT_OURS)
    own = file.header.library.startswith(OWN_LIBRARY)
    contents = contents_of_summary(file) if own else None
    if contents is None:
        contents = contents_by_scan(file, METADATA)
    if METADATA not in contents.metadata:
        raise UnreadableFileError(NOT_OURS)
    return contents
