"""The messages and metadata of a session's file, whole or cut off, by their channels."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO, Self

from mcap.reader import NonSeekingReader

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.session.encoding import (
    FORMAT_KEY,
    IMAGE_TOPIC,
    SESSION_FORMAT,
    SESSION_RECORD,
    decode,
    message_type,
)
from cubeling.app.session.file_records import READ_ERRORS, is_whole, metadata_of
from cubeling.app.session.file_start import open_session_file
from cubeling.mcap_index import IndexedMessage, McapIndex
from cubeling.tracking import nanoseconds_of

Message = tuple[str, float, bytes]
"""Topic, timestamp [s] and document of a message."""


class MessageFile:
    """The file of a session: metadata, and messages by channel; close it after use.

    Parameters
    ----------
    path
        The .mcap file.
    salvage
        Whether to take the intact part of a session that was cut off, instead of refusing it.
    opened
        The same file, as `open_session_file` returned it; None to open it.

    Raises
    ------
    AppError
        The file cannot be read, is no session, or was recorded by a newer version.
    """

    def __init__(
        self, path: Path, *, salvage: bool = False, opened: BinaryIO | None = None
    ) -> None:
        self.path, self._salvage = path, salvage
        self._file = opened or open_session_file(path)
        self.is_whole = is_whole(self._file)
        """Whether it was written to its end."""
        # No record is longer than the file: a damaged length takes no memory.
        self._size = self._file.seek(0, os.SEEK_END)
        self.metadata = self._read_metadata()
        """The values of each metadata record, by its name."""
        version = self.metadata.get(SESSION_RECORD, {}).get(FORMAT_KEY, "0")
        if not version.isdecimal() or int(version) > SESSION_FORMAT:
            self.close()
            raise AppError(
                f"the session '{path}' has the format {version:.20}, and this Cubeling reads up to "
                f"{SESSION_FORMAT}: update it"
            )
        self.format = int(version)
        """The version of its format; 0 before there were versions."""

    def _read_metadata(self) -> dict[str, dict[str, str]]:
        if self.is_whole:
            with suppress(*READ_ERRORS):
                if found := self._index.metadata():
                    return found
        return metadata_of(self._file, self._size)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; a second call does nothing."""
        self._file.close()

    def messages(self, *topics: str, since: float = 0.0) -> Iterator[Message]:
        """Yield (topic, timestamp [s], bytes) in the order of the file, for some topics or all.

        What was before a time is left out [s]. Of a file that was cut off, yield what can be read.
        """
        with suppress(*READ_ERRORS):
            for _, channel, message in self.records(*topics, since=since):
                yield channel.topic, message.log_time / 1e9, message.data

    def records(self, *topics: str, since: float = 0.0) -> Iterator[IndexedMessage]:
        """Yield schema, channel and message as `messages` does.

        Raises one of `READ_ERRORS` where a file is damaged, or was cut off.
        """
        start = nanoseconds_of(since)
        if self.is_whole:
            yield from self._index.messages(topics, since=start)
            return
        with open_session_file(self.path) as own:
            own.seek(0)
            reader = NonSeekingReader(own, True, record_size_limit=self._size)
            yield from reader.iter_messages(topics or None, starting_at=start, log_time_order=False)

    def decode_messages(
        self, kinds: Mapping[str, type[Any]], since: float = 0.0
    ) -> Iterator[tuple[str, float, Any]]:
        """Yield (topic, timestamp [s], message) as `messages` does, for the types of some topics.

        Raises
        ------
        AppError
            A message is not what a recorder writes.
        """
        for topic, time, data in self.messages(*kinds, since=since):
            with self.named_message(topic, time):
                message = decode(kinds[topic], data)
            yield topic, time, message

    @contextmanager
    def named_message(self, topic: str, time: float) -> Iterator[None]:
        """Name the message of what a block refuses."""
        try:
            yield
        except (ValueError, LookupError, TypeError, AttributeError) as error:
            reason = " ".join(str(error).split())
            raise AppError(
                f"cannot read the session '{self.path}': {topic} at {time:.3f} s: "
                f"{reason if reason.isprintable() else ascii(reason)}"
            ) from error

    def has(self, *topics: str) -> bool:
        """Return whether there are messages on all of some channels."""
        return all(next(self.messages(topic), None) is not None for topic in topics)

    @cached_property
    def channels(self) -> tuple[str, ...]:
        """The channels between camera and picture, those of its cast too.

        Raises
        ------
        AppError
            The file is damaged.
        """
        if self.is_whole:
            with self.named_damage():
                topics = {each.topic for each in self._index.summary.channels.values()}
        else:
            topics = {topic for topic, _, _ in self.messages()}
        return tuple(sorted(topic for topic in topics if message_type(topic) is not None))

    def count_frames(self) -> tuple[int, float]:
        """Return how many camera frames it has, and their duration [s].

        Raises
        ------
        AppError
            The file is damaged, or was cut off and is not to be salvaged.
        """
        if self.is_whole and not self._salvage:
            return self._indexed_frames()
        return self._readable_frames()

    def number_at(self, timestamp: float) -> int:
        """Return the number of the first frame at a time or later [s]; raises AppError."""
        with self.named_damage():
            return self._index.number_at(IMAGE_TOPIC, nanoseconds_of(timestamp))

    def frame_time(self, number: int) -> float:
        """Return the timestamp of a frame by its number [s]; raises AppError."""
        with self.named_damage():
            time = self._index.time_of(IMAGE_TOPIC, number)
            if time is None:
                raise ValueError("its index leads to no frame")
            return time / 1e9

    @contextmanager
    def named_damage(self) -> Iterator[None]:
        """Name the file that a block finds damaged."""
        try:
            yield
        except READ_ERRORS as error:
            raise AppError(f"cannot read the session '{self.path}': {error}") from error

    @cached_property
    def _index(self) -> McapIndex:
        """The index of a whole session; raises one of `READ_ERRORS`."""
        return McapIndex(self._file)

    def _indexed_frames(self) -> tuple[int, float]:
        """Return how many camera frames a whole session has, and their duration [s]."""
        with self.named_damage():
            summary = self._index.summary
            if summary.statistics is None:
                raise ValueError("it has no index")
            ids = {channel.topic: number for number, channel in summary.channels.items()}
            counts = summary.statistics.channel_message_counts
            frames = counts.get(ids.get(IMAGE_TOPIC, -1), 0)
            return frames, self._end(last=True) - self._end(last=False) if frames else 0.0

    def _end(self, *, last: bool) -> float:
        """Return the timestamp of the first or last camera frame [s], from one chunk or few."""
        found = next(self._index.messages((IMAGE_TOPIC,), reverse=last), None)
        if found is None:
            raise ValueError("its index leads to no frame")
        return found[2].log_time / 1e9

    def _readable_frames(self) -> tuple[int, float]:
        """Return the same of what can be read; refuse it if it is not to be salvaged."""
        times = [time for _, time, _ in self.messages(IMAGE_TOPIC)]
        frames, seconds = len(times), times[-1] - times[0] if times else 0.0
        if self._salvage:
            return frames, seconds
        if not frames:
            raise cut_early(self.path)
        raise AppError(
            f"the session '{self.path}' was cut off: {quantity(frames, 'frame')} ({seconds:.1f} s) "
            "can be played with --salvage"
        )


def cut_early(path: Path) -> AppError:
    """Return the error of a session of which no frame can be read."""
    return AppError(f"the session '{path}' was cut off before its first frame was whole")
