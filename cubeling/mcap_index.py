"""The index of a whole MCAP file, by which ten hours are read from any time on.

The readers of `mcap` itself sort all chunks whenever they are asked for a message: with two chunks
a second that takes three seconds after ten hours.
"""

import os
import struct
from bisect import bisect_left, bisect_right
from collections.abc import Collection, Iterator
from itertools import accumulate
from typing import BinaryIO

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import NonSeekingReader, SeekingReader
from mcap.records import Channel, Chunk, ChunkIndex, Message, Metadata, Schema
from mcap.stream_reader import get_chunk_data_stream

IndexedMessage = tuple[Schema | None, Channel, Message]

RECORD_START = struct.Struct("<BQ")
"""How a record begins: opcode, and bytes of its content."""

MESSAGE_START = struct.Struct("<HIQQ")
"""How the content of a message begins: channel, sequence, when it was logged and published [ns]."""

ENTRIES_START, ENTRY_BYTES = struct.Struct("<BQHI"), 16
"""How a record begins that lists the messages of a channel in a chunk (opcode, bytes, channel,
bytes of the entries), and the size of an entry [B]."""


class McapIndex:
    """Reads messages of a whole MCAP file from any time on.

    Parameters
    ----------
    file
        The file. Each chunk is read at once, so that others may move its position in between.

    Raises
    ------
    ValueError
        The file has no index. Of a damaged one, whatever `mcap` raises; so do the methods.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        # No record is longer than the file: a damaged length takes no memory.
        self._size = file.seek(0, os.SEEK_END)
        file.seek(0)
        summary = SeekingReader(file, record_size_limit=self._size).get_summary()
        if summary is None:
            raise ValueError("it has no index")
        self.summary = summary
        """Channels, schemas and statistics, as the file states them."""
        self._chunks = sorted(summary.chunk_indexes, key=lambda each: each.chunk_start_offset)
        self._ends = list(accumulate((each.message_end_time for each in self._chunks), max))
        self._known_numbers: dict[str, list[int]] = {}

    def metadata(self) -> dict[str, dict[str, str]]:
        """Return the values of each metadata record, by its name."""
        found = {}
        for each in self.summary.metadata_indexes:
            self._file.seek(each.offset + RECORD_START.size)
            record = Metadata.read(ReadDataStream(self._file))
            found[record.name] = record.metadata
        return found

    def messages(
        self, topics: Collection[str] = (), *, since: int = 0, reverse: bool = False
    ) -> Iterator[IndexedMessage]:
        """Yield the messages of some topics, or of all, in the order of the file.

        Parameters
        ----------
        topics
            Names of channels; () for all.
        since
            What was logged before is left out [ns].
        reverse
            Whether the last one comes first.
        """
        if not self._chunks:  # another program's file may have its messages outside of chunks
            self._file.seek(0)
            reader = NonSeekingReader(self._file, True, record_size_limit=self._size)
            found = list(reader.iter_messages(topics=topics or None, log_time_order=False))
            yield from reversed(found) if reverse else found
            return
        ids = self._channels(topics)
        places = range(bisect_left(self._ends, since), len(self._chunks))
        for place in reversed(places) if reverse else places:
            listed = self._chunks[place].message_index_offsets
            if listed and listed.keys().isdisjoint(ids):
                continue
            own = [each for each in self._read(place, ids) if each[2].log_time >= since]
            yield from reversed(own) if reverse else own

    def number_at(self, topic: str, since: int) -> int:
        """Return how many messages of a topic come before those since a time [ns].

        Their times must not decrease.
        """
        place, ids = bisect_left(self._ends, since), self._channels((topic,))
        before = self._numbers(topic)[place - 1] if place else 0
        if place == len(self._chunks):
            return before
        return before + sum(each[2].log_time < since for each in self._read(place, ids))

    def time_of(self, topic: str, number: int) -> int | None:
        """Return when a message of a topic was logged, by its number from 0 [ns]; None if none."""
        ends = self._numbers(topic)
        place = bisect_right(ends, number)
        if place == len(ends):
            return None
        found = list(self._read(place, self._channels((topic,))))
        return found[number - ends[place]][2].log_time

    def back_from(self, topic: str, last: int) -> Iterator[IndexedMessage]:
        """Yield the last message of a topic until a time [ns], and those before it, backwards."""
        ids = self._channels((topic,))
        for place in range(min(bisect_left(self._ends, last), len(self._chunks) - 1), -1, -1):
            own = [each for each in self._read(place, ids) if each[2].log_time <= last]
            yield from reversed(own)

    def _numbers(self, topic: str) -> list[int]:
        """Return how many messages of a topic there are until the end of each chunk."""
        if topic not in self._known_numbers:
            ids = self._channels((topic,))
            counts = (self._count(place, ids) for place in range(len(self._chunks)))
            self._known_numbers[topic] = list(accumulate(counts))
        return self._known_numbers[topic]

    def _channels(self, topics: Collection[str]) -> set[int]:
        """Return the numbers of the channels of some topics, or of all."""
        channels = self.summary.channels
        return {number for number, each in channels.items() if not topics or each.topic in topics}

    def _count(self, place: int, ids: set[int]) -> int:
        """Return how many messages some channels have in a chunk, without reading it."""
        listed = self._chunks[place].message_index_offsets
        if not listed:
            return sum(1 for _ in self._read(place, ids))
        count = 0
        for channel in ids & listed.keys():
            self._file.seek(listed[channel])
            count += ENTRIES_START.unpack(self._file.read(ENTRIES_START.size))[3] // ENTRY_BYTES
        return count

    def _read(self, place: int, ids: set[int]) -> Iterator[IndexedMessage]:
        """Yield the messages of some channels in a chunk."""
        chunk: ChunkIndex = self._chunks[place]
        self._file.seek(chunk.chunk_start_offset + RECORD_START.size)
        stream, length = get_chunk_data_stream(Chunk.read(ReadDataStream(self._file)), True)
        data, start = stream.read(length), 0
        while start < length:
            opcode, size = RECORD_START.unpack_from(data, start)
            start += RECORD_START.size
            if opcode == Opcode.MESSAGE:
                number, sequence, logged, published = MESSAGE_START.unpack_from(data, start)
                if number in ids:
                    channel = self.summary.channels[number]
                    content = data[start + MESSAGE_START.size : start + size]
                    message = Message(number, logged, content, published, sequence)
                    yield self.summary.schemas.get(channel.schema_id), channel, message
            start += size
