"""Motion files written again, record for record, by the writer of the mcap library."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

from mcap.records import Attachment, Channel, Header, Message, Metadata, Schema
from mcap.stream_reader import StreamReader
from mcap.writer import IndexType, Writer

Order = Callable[[list[Message]], list[Message]]
LEAST: dict[str, Any] = {  # what may be left out of a file
    "index_types": IndexType.NONE,
    "repeat_channels": False,
    "repeat_schemas": False,
    "use_statistics": False,
    "use_summary_offsets": False,
}


def rewritten(
    content: bytes,
    *,
    order: Order = list,
    library: str | None = None,
    extras_last: bool = False,
    change: Callable[[Any], None] = lambda record: None,
    **options: Any,
) -> bytes:
    """The content of another file with the same records.

    Args:
        content: of the file to be read.
        order: puts the messages in another order.
        library: name of the writing program; None: the one in the file.
        extras_last: metadata and attachments come after the messages, not before.
        change: called with every record, which it may change.
        options: of the writer.
    """
    records = list(StreamReader(io.BytesIO(content)).records)
    for record in records:
        change(record)
    stream = io.BytesIO()
    writer = Writer(stream, **options)
    (header,) = (r for r in records if isinstance(r, Header))
    writer.start(header.profile, header.library if library is None else library)
    channels = _register(writer, records)
    if not extras_last:
        _add_extras(writer, records)
    for m in order([r for r in records if isinstance(r, Message)]):
        channel = channels[m.channel_id]
        writer.add_message(channel, m.log_time, m.data, m.publish_time, m.sequence)
    if extras_last:
        _add_extras(writer, records)
    writer.finish()
    return stream.getvalue()


def _register(writer: Writer, records: list[Any]) -> dict[int, int]:
    """Number of each channel in the new file, by that in the old one; backwards, for a change."""
    schemas = {r.id: r for r in records if isinstance(r, Schema)}
    numbers = {i: writer.register_schema(s.name, s.encoding, s.data) for i, s in schemas.items()}
    old = {r.id: r for r in records if isinstance(r, Channel)}
    return {
        i: writer.register_channel(
            old[i].topic, old[i].message_encoding, numbers[old[i].schema_id], old[i].metadata
        )
        for i in reversed(old)
    }


def _add_extras(writer: Writer, records: list[Any]) -> None:
    for r in records:
        if isinstance(r, Metadata):
            writer.add_metadata(r.name, r.metadata)
        elif isinstance(r, Attachment):
            writer.add_attachment(r.create_time, r.log_time, r.name, r.media_type, r.data)
