"""Reading what a session recorded beside the camera's frames."""

import json
import os
import stat
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, SeekingReader
from mcap.records import Chunk, DataEnd, Metadata
from mcap.stream_reader import StreamReader
from zstandard import ZstdError

from app.errors import AppError

START_OVER = "start over"
"""The event of a player who starts over: an input, so a replay gives it again."""

MAGIC = b"\x89MCAP0\r\n"

BROKEN = (McapError, EOFError, ValueError, struct.error, LookupError, OSError, ZstdError)
"""What the reader raises where a file ends in the middle of something, or has a wrong bit: an index
that leads to no channel (KeyError) or before the file (OSError), a chunk that does not unpack."""


@dataclass(frozen=True)
class About:
    """What a session says of itself."""

    scenario: str
    """The scenario that was played."""

    cube: str
    """Name of the cube."""

    character: str
    """Name or file of the character; "" for the scenario's own."""

    speed_map: str
    """The Speed map that was in use."""

    turns: float
    """Full turns from the least to the greatest intensity."""

    personality: str
    """Name or file of who felt; "" for the scenario's own."""

    look: str
    """What the character's eyes followed."""

    frames: int
    """Camera frames in the file."""

    duration: float
    """From the first to the last message [s]."""


def about(path: Path) -> About:
    """Read what a whole session says of itself.

    Raises
    ------
    AppError
        The file cannot be read, is no session, or was cut off.
    """
    whole(path)
    try:
        with path.open("rb") as file:
            summary = SeekingReader(file).get_summary()
    except BROKEN as error:
        raise AppError(f"cannot read the session '{path}': {error}") from error
    if summary is None or summary.statistics is None:
        raise AppError(f"cannot read the session '{path}': it has no index")
    numbers = {channel.topic: number for number, channel in summary.channels.items()}
    statistics = summary.statistics
    frames = statistics.channel_message_counts.get(numbers.get("/camera/image", -1), 0)
    seconds = (statistics.message_end_time - statistics.message_start_time) / 1e9
    return _about(path, frames, seconds)


def salvaged(path: Path) -> About:
    """Read what a session that may have been cut off says of itself, and what of it is whole."""
    _begins_well(path)
    times = [time for _, time, _ in messages(path, "/camera/image")]
    return _about(path, len(times), times[-1] - times[0] if times else 0.0)


def _about(path: Path, frames: int, seconds: float) -> About:
    notes = _notes(path)
    return About(
        notes["scenario"],
        notes.get("cube", ""),
        notes.get("character", ""),
        notes.get("speed_map", "corrected"),
        float(notes.get("turns", "2")),
        notes.get("personality", ""),
        notes.get("look", "auto"),
        frames,
        seconds,
    )


def _notes(path: Path) -> dict[str, str]:
    """Return the metadata that the recorder wrote first of all."""
    with path.open("rb") as file:
        try:
            for record in StreamReader(file).records:
                if isinstance(record, Metadata) and record.name == "cubeling":
                    if "scenario" in record.metadata:
                        return dict(record.metadata)
                elif isinstance(record, Chunk | DataEnd):
                    break
        except BROKEN:
            pass
    raise AppError(
        f"'{path}' does not say which scenario it holds: it was not recorded by Cubeling"
    )


def whole(path: Path) -> None:
    """Refuse a file that is no session or was cut off, in one line."""
    _begins_well(path)
    if _ends_well(path):
        return
    times = [time for _, time, _ in messages(path, "/camera/image")]
    seconds = times[-1] - times[0] if times else 0.0
    raise AppError(
        f"the session '{path}' was cut off: {len(times)} frames ({seconds:.1f} s) are whole; "
        "add --salvage to play those"
    )


def _begins_well(path: Path) -> None:
    try:
        if stat.S_ISFIFO(path.stat().st_mode):  # to open one waits for whoever writes to it
            raise AppError(f"cannot read the session '{path}': it is a pipe, no file")
        with path.open("rb") as file:
            start = file.read(len(MAGIC))
    except OSError as error:
        raise AppError(f"cannot read the session '{path}': {error.strerror}") from error
    if start != MAGIC:
        raise AppError(f"'{path}' is not a session: it does not begin as an .mcap file does")


def _ends_well(path: Path) -> bool:
    """Whether a file that begins well was written to its end."""
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(-min(size, len(MAGIC)), os.SEEK_END)
        return file.read() == MAGIC and size > len(MAGIC)


def messages(path: Path, *topics: str) -> Iterator[tuple[str, float, bytes]]:
    """Yield (topic, timestamp [s], bytes) in the order of the file, for some topics or all.

    A file that was cut off gives what is whole, without complaint.
    """
    with path.open("rb") as file:
        # The index of a whole session leads straight to the chunks that hold a topic.
        kind = SeekingReader if _ends_well(path) else NonSeekingReader
        reader = kind(file, validate_crcs=True)
        try:
            for _, channel, message in reader.iter_messages(
                topics=topics or None, log_time_order=False
            ):
                yield channel.topic, message.log_time / 1e9, message.data
        except BROKEN:
            return


def cues(path: Path) -> frozenset[float]:
    """Return the times of the frames in which the player started over [s]."""
    return frozenset(time for time, what in events(path) if what == START_OVER)


def events(path: Path) -> list[tuple[float, str]]:
    """Return the events of a session with their times [s]."""
    return [(time, json.loads(data)["event"]) for _, time, data in messages(path, "/events")]
