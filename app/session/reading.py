"""Reading what a session recorded beside the camera's frames."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, SeekingReader

from app.errors import AppError

MAGIC = b"\x89MCAP0\r\n"


@dataclass(frozen=True)
class About:
    """What a session says of itself."""

    scenario: str
    """The scenario that was played."""

    cube: str
    """Name of the cube."""

    speed_map: str
    """The Speed map that was in use."""

    turns: float
    """Full turns from the least to the greatest intensity."""

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
            reader = SeekingReader(file)
            summary = reader.get_summary()
            notes = next((m.metadata for m in reader.iter_metadata() if m.name == "cubeling"), None)
    except (McapError, OSError, ValueError) as error:
        raise AppError(f"cannot read the session '{path}': {error}") from error
    if notes is None or summary is None or summary.statistics is None:
        raise AppError(f"'{path}' was not recorded by Cubeling: it does not say which scenario it holds")
    numbers = {channel.topic: number for number, channel in summary.channels.items()}
    statistics = summary.statistics
    frames = statistics.channel_message_counts.get(numbers.get("/camera/image", -1), 0)
    seconds = (statistics.message_end_time - statistics.message_start_time) / 1e9
    return About(
        notes.get("scenario", ""),
        notes.get("cube", ""),
        notes.get("speed_map", "corrected"),
        float(notes.get("turns", "2")),
        frames,
        seconds,
    )


def whole(path: Path) -> None:
    """Refuse a file that is no session or was cut off, in one line."""
    try:
        with path.open("rb") as file:
            start = file.read(len(MAGIC))
            file.seek(0, 2)
            size = file.tell()
            file.seek(max(0, size - len(MAGIC)))
            end = file.read()
    except OSError as error:
        raise AppError(f"cannot read the session '{path}': {error.strerror}") from error
    if start != MAGIC:
        raise AppError(f"'{path}' is not a session: it does not begin as an .mcap file does")
    if end != MAGIC or size == len(MAGIC):
        readable, last = _readable(path)
        raise AppError(
            f"the session '{path}' was cut off: {readable} frames up to {last:.1f} s are whole; "
            "add --salvage to play those"
        )


def messages(path: Path, *topics: str) -> Iterator[tuple[str, float, bytes]]:
    """Yield (topic, timestamp [s], bytes) in the order of the file, for some topics or all.

    A file that was cut off gives what is whole, without complaint.
    """
    with path.open("rb") as file:
        reader = NonSeekingReader(file, validate_crcs=True)
        try:
            for _, channel, message in reader.iter_messages(
                topics=topics or None, log_time_order=False
            ):
                yield channel.topic, message.log_time / 1e9, message.data
        except (McapError, EOFError, ValueError):
            return


def events(path: Path) -> list[tuple[float, str]]:
    """Return the events of a session with their times [s]."""
    return [(time, json.loads(data)["event"]) for _, time, data in messages(path, "/events")]


def _readable(path: Path) -> tuple[int, float]:
    times = [time for _, time, _ in messages(path, "/camera/image")]
    return len(times), times[-1] - times[0] if times else 0.0
