"""From the messages of the topics with one message per sample to the arrays of a motion.

In our own files the messages of a topic stand in the order of the samples. Another program may have
put them in any order; they are then read as they come, and put in order by their log times at the
end. Either way there must be one message for each sample, logged at its time.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mgs.motion_file.mcap_chunk import Chunk
from mgs.motion_file.mcap_layout import Times
from mgs.motion_file.mcap_reader import McapReader
from mgs.motion_file.mcap_records import UnreadableFileError
from mgs.motion_file.topics import (
    SUPPORT_TOPIC,
    SampleTopic,
    field_shapes,
    split_stamps,
    support_layouts,
)


@dataclass
class Arrivals:
    """The messages of one topic that have been found so far."""

    topic: str
    channel: int
    expected: Times  # (N,) log times of the samples [ns]
    in_order: bool  # refuse messages that are not in the order of the samples
    times: Times = field(init=False)  # (N,) log times in the order of the file [ns]
    count: int = 0

    def __post_init__(self) -> None:
        self.times = np.zeros_like(self.expected)

    def add(self, chunk: Chunk) -> slice:
        """Places, in the order of the file, of the messages that a chunk holds."""
        found = chunk.times(self.channel)
        places = slice(self.count, self.count + len(found))
        if self.in_order and not np.array_equal(found, self.expected[places]):
            raise self._out_of_step()
        self.times[places] = found
        self.count = places.stop
        return places

    def order(self) -> NDArray[np.intp] | None:
        """Indices (N,) that put the messages in the order of the samples; None: they are in it.

        Raises:
            UnreadableFileError: a sample has no message, or more than one.
        """
        if self.count != len(self.expected):
            raise UnreadableFileError("messages are missing")
        if np.array_equal(self.times, self.expected):
            return None
        order = np.argsort(self.times)
        if not np.array_equal(self.times[order], self.expected):
            raise self._out_of_step()
        return order

    def _out_of_step(self) -> UnreadableFileError:
        return UnreadableFileError(f"the messages of {self.topic} are not in step with dt")


def read_samples(
    reader: McapReader, n_joints: int, topics: list[SampleTopic], times: Times
) -> dict[str, Any]:
    """Arrays of a motion by name, those of `field_shapes` and `support` (N,).

    Args:
        reader: a file that has all these topics and /support, with N messages each.
        n_joints: number of joints of the robot.
        topics: which topic holds which part of which array.
        times: log times (N,) of the samples [ns].

    Raises:
        UnreadableFileError: a message is missing, malformed or not logged at its sample's time.
    """
    n, in_order = len(times), reader.contents.in_order
    arrays: dict[str, Any] = {
        name: np.empty((n, *shape)) for name, shape in field_shapes(n_joints).items()
    }
    arrays["support"] = np.empty(n, dtype=np.int8)
    names = [*(topic.name for topic in topics), SUPPORT_TOPIC]
    arrivals = {name: Arrivals(name, reader.topics[name].id, times, in_order) for name in names}
    for chunk in reader.chunks({a.channel for a in arrivals.values()}):
        for topic in topics:
            _read_topic(chunk, topic, arrivals[topic.name], arrays)
        _read_support(chunk, arrivals[SUPPORT_TOPIC], arrays["support"])
    for topic in topics:
        _put_in_order(arrivals[topic.name], topic.columns(arrays, slice(None)))
    _put_in_order(arrivals[SUPPORT_TOPIC], {"support": arrays["support"]})
    return arrays


def _read_topic(
    chunk: Chunk, topic: SampleTopic, arrivals: Arrivals, arrays: dict[str, Any]
) -> None:
    """Fill arrays, in the order of the file, from a topic's messages in a chunk."""
    if arrivals.channel not in chunk.entries:
        return
    places = arrivals.add(chunk)
    columns = topic.layout.decode(chunk.messages(arrivals.channel, topic.layout.size))
    if not np.array_equal(columns["stamp"], split_stamps(arrivals.times[places])):
        raise UnreadableFileError(f"a stamp in {topic.name} is not the time of its message")
    for slot, part in topic.columns(arrays, places).items():
        part[:] = columns[slot]


def _read_support(chunk: Chunk, arrivals: Arrivals, support: NDArray[np.int8]) -> None:
    """Fill support (N,), in the order of the file, from the messages in a chunk."""
    if arrivals.channel not in chunk.entries:
        return
    found, sizes = support[arrivals.add(chunk)], chunk.sizes(arrivals.channel)
    found[:] = -1
    for s, layout in support_layouts().items():
        chosen = np.flatnonzero(sizes == layout.size)
        layout.decode(chunk.messages(arrivals.channel, layout.size, chosen))
        found[chosen] = s
    if (found < 0).any():
        raise UnreadableFileError(
            f"{SUPPORT_TOPIC} says something other than double, left or right"
        )


def _put_in_order(arrivals: Arrivals, parts: dict[str, NDArray[Any]]) -> None:
    order = arrivals.order()
    if order is not None:
        for part in parts.values():
            part[:] = part[order]
