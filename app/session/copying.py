"""Copying the messages of a session to another file: byte for byte, or changed."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from google.protobuf.message import Message
from mcap.writer import Writer
from mcap_protobuf.schema import register_schema

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.output_path import later_parts, part_path
from cubeling.app.session.encoding import (
    IMAGE_TOPIC,
    INPUTS_TOPIC,
    LINE_TOPIC,
    encode,
    sound_topic,
)
from cubeling.app.session.file_records import READ_ERRORS
from cubeling.app.session.inputs import RecordedInputs
from cubeling.app.session.message_file import MessageFile, cut_early
from cubeling.app.session.recorder import CHUNK_BYTES, json_schema
from cubeling.app.session.session_file import SessionFile
from cubeling.files import whole_file
from cubeling.mcap_index import IndexedMessage

INPUT_TOPICS = (IMAGE_TOPIC, "/camera/calibration", INPUTS_TOPIC, LINE_TOPIC, "/events")
"""The channels of what came in, besides the sounds of further characters and of the scenario."""

Change = Callable[[str, float, bytes], bytes | None]
"""Takes a message's topic, its time [s] and its bytes; returns those to write, or None to drop."""

Added = Callable[[float], Iterable[tuple[str, RecordedInputs | Message]]]
"""Takes the time of a picture [s]; returns topics and messages that are added at that time."""


def keep_inputs(session: Path, path: Path) -> None:
    """Copy what came in of a session: a replay computes the rest from it.

    The camera's bytes stay as they are. What an older session says in its commands is copied to
    the inputs.
    """
    with SessionFile(session) as recorded:
        older = {} if recorded.has(INPUTS_TOPIC) else recorded.inputs

    def add(time: float) -> Iterable[tuple[str, RecordedInputs]]:
        return ((INPUTS_TOPIC, older[time]),) if time in older else ()

    copy_session(session, path, lambda topic, _, data: data if _came_in(topic) else None, add)


def join_parts(first: Path, path: Path, say: Callable[[str], None]) -> int:
    """Write a recording in parts as one session, which replays like it; return how many they are.

    Of a part that was cut off, what can be read is taken.

    Parameters
    ----------
    first
        The file that it began with; the others are beside it.
    path
        The .mcap file to write; it is whole or not there.
    say
        Called with a line about each part that was cut off.

    Raises
    ------
    AppError
        A part is missing, is damaged or is of another recording, or the file cannot be written.
    """
    later = later_parts(first)
    with SessionFile(first, salvage=True) as session:
        session.check_begins()
        if not session.is_whole and not session.info.frames:
            raise cut_early(first)
        _tell_cut(session, say, is_last=not later)
    for number, part in enumerate(later, start=2):
        if part != part_path(first, number):
            raise AppError(f"the part '{part_path(first, number)}' is missing before '{part}'")
        with SessionFile(part, salvage=True) as session:
            if session.info.first_part != first.name:
                raise AppError(f"'{part}' is no part of the recording '{first}'")
            _tell_cut(session, say, is_last=part == later[-1])
    calibrated = False

    def keep(topic: str, time: float, data: bytes) -> bytes | None:
        nonlocal calibrated
        if topic == "/camera/calibration":  # later parts have it again
            data, calibrated = (b"" if calibrated else data), True
        return data or None

    copy_session(first, path, keep, further=later, salvage=True)
    return 1 + len(later)


def _tell_cut(part: SessionFile, say: Callable[[str], None], *, is_last: bool) -> None:
    if not part.is_whole:
        held = f"{quantity(part.info.frames, 'frame')} ({part.info.duration:.1f} s)"
        more = "" if is_last else ", and from there on a replay is not exact"
        say(f"'{part.path}' was cut off: {held} could be read{more}")


def _came_in(topic: str) -> bool:
    said = topic.startswith("/cast/") and topic.endswith("/line")
    return topic in INPUT_TOPICS or said or topic.startswith(sound_topic(""))


def copy_session(
    session: Path,
    path: Path,
    change: Change,
    add: Added = lambda time: (),
    *,
    pictures: type[Any] | None = None,
    further: Sequence[Path] = (),
    salvage: bool = False,
) -> None:
    """Copy the metadata and messages of a session.

    Parameters
    ----------
    session
        The session to read.
    path
        The .mcap file to write; it is whole or not there.
    change
        What becomes of each message.
    add
        What is added to each picture.
    pictures
        The Protobuf message that `change` makes of pictures; None for that of the session.
    further
        Sessions whose messages follow.
    salvage
        Whether to take what can be read of those that were cut off, instead of refusing them.

    Raises
    ------
    AppError
        A session is damaged, or was cut off, or the file cannot be written.
    """
    with (
        MessageFile(session) as source,
        whole_file(path, AppError) as partial,
        partial.open("wb") as file,
    ):
        writer, ids = Writer(file, chunk_size=CHUNK_BYTES), dict[str, int]()
        writer.start(profile="", library="cubeling")
        for name, values in source.metadata.items():
            writer.add_metadata(name, values)
        for schema, channel, message in _all_messages((session, *further), salvage=salvage):
            time = message.log_time / 1e9
            data = change(channel.topic, time, message.data)
            if data is None:
                continue
            if channel.topic not in ids:
                form = (schema.name, schema.encoding, schema.data) if schema else ("", "", b"")
                if channel.topic == IMAGE_TOPIC and pictures is not None:
                    schema_id = register_schema(writer, pictures)
                else:
                    schema_id = writer.register_schema(*form)
                ids[channel.topic] = writer.register_channel(
                    channel.topic, channel.message_encoding, schema_id
                )
            writer.add_message(ids[channel.topic], message.log_time, data, message.publish_time)
            for topic, more in add(time) if channel.topic == IMAGE_TOPIC else ():
                if topic not in ids:
                    ids[topic] = _register(writer, topic, more)
                document = more.SerializeToString() if isinstance(more, Message) else encode(more)
                writer.add_message(ids[topic], message.log_time, document, message.log_time)
        writer.finish()  # type: ignore[no-untyped-call]  # mcap has no types here


def _all_messages(sessions: Sequence[Path], *, salvage: bool) -> Iterator[IndexedMessage]:
    """Yield schema, channel and message of all sessions, one after another."""
    for session in sessions:
        with MessageFile(session) as file:
            if file.is_whole or not salvage:
                with file.named_damage():
                    yield from file.records()
            else:
                with suppress(*READ_ERRORS):
                    yield from file.records()


def _register(writer: Writer, topic: str, message: RecordedInputs | Message) -> int:
    """Make the channel of an added message, and return its number."""
    if isinstance(message, Message):
        return writer.register_channel(topic, "protobuf", register_schema(writer, type(message)))
    name, text = json_schema(topic)
    return writer.register_channel(topic, "json", writer.register_schema(name, "jsonschema", text))
