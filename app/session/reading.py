"""Reading a recorded session, except for the camera's frames."""

import json
import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, SeekingReader
from mcap.records import Chunk, DataEnd, Metadata
from mcap.stream_reader import StreamReader
from zstandard import ZstdError

from cubeling.app.counted import counted
from cubeling.app.errors import AppError
from cubeling.app.session.encoding import CLOCK_RECORD, CLOCK_ZERO, IMAGE_TOPIC, MESSAGE_TYPES
from cubeling.app.session.file_start import MCAP_MAGIC, check_session_file
from cubeling.app.session.options import SessionOptions

START_OVER_EVENT = "start over"
"""Event of a player who starts over."""

INSIDE_EVENT = "cube opened or closed"
"""Event of a player who asks to open the cube, or to close it."""

READ_ERRORS = (McapError, EOFError, ValueError, struct.error, LookupError, OSError, ZstdError)
"""What the MCAP reader raises for a damaged file: one that ends early, an index that points to no
channel (KeyError) or before the file (OSError), a chunk that cannot be decompressed."""


@dataclass(frozen=True)
class SessionInfo:
    """What a recorded session says of itself."""

    options: SessionOptions
    """Its scenario, cube, character …, with itself as the source."""

    frames: int
    """Camera frames in the file."""

    duration: float
    """From the first to the last camera frame [s]; the robot's line may be recorded for longer."""

    clock_zero: str
    """When the timestamps of a live camera were 0, in UTC by ISO 8601; "" for other sources."""


def session_info(path: Path, *, salvage: bool = False) -> SessionInfo:
    """Read what a session says of itself.

    Parameters
    ----------
    path
        The .mcap file.
    salvage
        Whether to count the intact frames of a session that was cut off, instead of refusing it.

    Raises
    ------
    AppError
        The file cannot be read, is no session, or was cut off.
    """
    check_session_file(path)
    if salvage:
        frames, seconds = _readable_frames(path)
        return _info(path, frames, seconds)
    if not _is_complete(path):
        frames, seconds = _readable_frames(path)
        if not frames:
            raise AppError(f"the session '{path}' was cut off before its first frame was whole")
        raise AppError(
            f"the session '{path}' was cut off: {counted(frames, 'frame')} ({seconds:.1f} s) "
            "can be played with --salvage"
        )
    try:
        with path.open("rb") as file:
            reader = SeekingReader(file)
            summary = reader.get_summary()
            if summary is None or summary.statistics is None:
                raise AppError(f"cannot read the session '{path}': it has no index")
            ids = {channel.topic: number for number, channel in summary.channels.items()}
            counts = summary.statistics.channel_message_counts
            frames = counts.get(ids.get(IMAGE_TOPIC, -1), 0)
            seconds = _end(reader, last=True) - _end(reader, last=False) if frames else 0.0
    except READ_ERRORS as error:
        raise AppError(f"cannot read the session '{path}': {error}") from error
    return _info(path, frames, seconds)


def _end(reader: SeekingReader, *, last: bool) -> float:
    """Return the timestamp of the first or last camera frame [s], from one chunk or few."""
    _, _, message = next(reader.iter_messages(IMAGE_TOPIC, reverse=last))
    return message.log_time / 1e9


def _info(path: Path, frames: int, seconds: float) -> SessionInfo:
    """Add to the figures what the metadata say, which the recorder writes first."""
    metadata: dict[str, dict[str, str]] = {}
    with path.open("rb") as file:
        try:
            for record in StreamReader(file).records:
                if isinstance(record, Metadata):
                    metadata[record.name] = record.metadata
                elif isinstance(record, Chunk | DataEnd):
                    break
        except READ_ERRORS:
            pass
    if "scenario" not in metadata.get("cubeling", {}):
        raise AppError(f"'{path}' names no scenario: it was not recorded by Cubeling")
    options = SessionOptions.from_metadata(metadata["cubeling"], str(path))
    clock_zero = metadata.get(CLOCK_RECORD, {}).get(CLOCK_ZERO, "")
    return SessionInfo(options, frames, seconds, clock_zero)


def _readable_frames(path: Path) -> tuple[int, float]:
    """Return how many camera frames can be read, and their duration [s]."""
    times = [time for _, time, _ in messages(path, IMAGE_TOPIC)]
    return len(times), times[-1] - times[0] if times else 0.0


def _is_complete(path: Path) -> bool:
    """Whether a file that begins with `MCAP_MAGIC` was written to its end."""
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(-min(size, len(MCAP_MAGIC)), os.SEEK_END)
        return file.read() == MCAP_MAGIC and size > len(MCAP_MAGIC)


def messages(path: Path, *topics: str) -> Iterator[tuple[str, float, bytes]]:
    """Yield (topic, timestamp [s], bytes) in the order of the file, for some topics or all.

    Of a file that was cut off, yield what can be read.
    """
    with path.open("rb") as file:
        # The index of a complete session leads straight to the chunks that hold a topic.
        reader_class = SeekingReader if _is_complete(path) else NonSeekingReader
        reader = reader_class(file, validate_crcs=True)
        try:
            for _, channel, message in reader.iter_messages(
                topics=topics or None, log_time_order=False
            ):
                yield channel.topic, message.log_time / 1e9, message.data
        except READ_ERRORS:
            return


def has_channels(path: Path) -> bool:
    """Return whether a session has every channel from the cube to the robot, or only inputs."""
    return all(next(messages(path, topic), None) is not None for topic in MESSAGE_TYPES)


def events(path: Path) -> list[tuple[float, str]]:
    """Return the events of a session with their timestamps [s]."""
    return [(time, json.loads(data)["event"]) for _, time, data in messages(path, "/events")]
