"""A recorded session: all that is read of it, except for the camera's frames."""

import json
import os
from collections.abc import Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from functools import cached_property
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any, BinaryIO, Self

from mcap.reader import McapReader, NonSeekingReader, SeekingReader
from mcap.summary import Summary

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.pipeline.table.spoken_line import Lines, SpokenLine
from cubeling.app.pipeline.table.stage_sounds import SoundClip
from cubeling.app.session.acts import WizardAct, wizard_acts
from cubeling.app.session.encoding import (
    APPEARANCE_TOPIC,
    CLOCK_RECORD,
    CLOCK_ZERO,
    FORMAT_KEY,
    IMAGE_TOPIC,
    INPUTS_TOPIC,
    LINE_TOPIC,
    MESSAGE_TYPES,
    PLAYED_RECORD,
    SESSION_FORMAT,
    SESSION_RECORD,
    decode,
    decode_sound_message,
    line_topic,
    message_type,
    sound_topic,
)
from cubeling.app.session.file_records import READ_ERRORS, is_whole, metadata_of
from cubeling.app.session.file_start import open_session_file
from cubeling.app.session.info import SessionInfo
from cubeling.app.session.inputs import RecordedInputs
from cubeling.app.session.labels import (
    LABEL_NAMES,
    Mark,
    SessionLabels,
    corrected_labels,
    recorded_marks,
)
from cubeling.app.session.options import START_STAGES, SessionOptions, check_stage
from cubeling.characters import CharacterCommand, SpeechIntent
from cubeling.characters.speech import Samples
from cubeling.tracking.appearance import Appearance

START_OVER_EVENT = "start over"
"""Event of a player who starts over."""

INSIDE_EVENT = "cube opened or closed"
"""Event of a player who asks to open the cube, or to close it."""

FIELD_OF_TOPIC = {
    "/cube/state": "state",
    "/cube/controls": "controls",
    APPEARANCE_TOPIC: "appearance",
    "/character/command": "command",
    "/character/pose": "posed",
}
"""The field of `ReplayInputs` for each channel, in the order of the stages after the camera."""

Message = tuple[str, float, bytes]
"""Topic, timestamp [s] and document of a message."""


class SessionFile:
    """A recorded session, opened once for all that is read of it; close it after use.

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
        self._is_whole = is_whole(self._file)
        # No record is longer than the file: a damaged length takes no memory.
        self._size = self._file.seek(0, os.SEEK_END)
        self._metadata = metadata_of(self._file, self._size)
        version = self._metadata.get(SESSION_RECORD, {}).get(FORMAT_KEY, "0")
        if not version.isdecimal() or int(version) > SESSION_FORMAT:
            self.close()
            raise AppError(
                f"the session '{path}' has the format {version:.20}, and this Cubeling reads up to "
                f"{SESSION_FORMAT}: update it"
            )
        self.format = int(version)
        """The version of its format; 0 before there were versions."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; a second call does nothing."""
        self._file.close()

    @cached_property
    def info(self) -> SessionInfo:
        """What the session says of itself.

        Raises
        ------
        AppError
            The file is damaged, names no scenario, or was cut off and is not to be salvaged.
        """
        if self._is_whole and not self._salvage:
            frames, seconds = self._indexed_frames()
        else:
            frames, seconds = self._readable_frames()
        about = self._metadata.get(SESSION_RECORD, {})
        if "scenario" not in about:
            raise AppError(f"'{self.path}' names no scenario: it was not recorded by Cubeling")
        try:
            options = SessionOptions.from_metadata(about, str(self.path))
        except ValueError as error:
            raise AppError(f"cannot read the session '{self.path}': {error}") from None
        clock_zero = self._metadata.get(CLOCK_RECORD, {}).get(CLOCK_ZERO, "")
        labels = self.labels
        names = {name: getattr(labels, name) for name in LABEL_NAMES}
        options = replace(options, **names)
        played = self._metadata.get(PLAYED_RECORD, {})
        has_video = about.get("video", "yes") != "no"
        return SessionInfo(options, frames, seconds, played, labels, has_video, clock_zero)

    @cached_property
    def labels(self) -> SessionLabels:
        """Who played, as it was corrected since, else as it was said; raises AppError."""
        about = self._metadata.get(SESSION_RECORD, {})
        participant, condition, notes = (about.get(name, "") for name in LABEL_NAMES)
        return corrected_labels(self.path, SessionLabels(participant, condition, notes))

    def messages(self, *topics: str) -> Iterator[Message]:
        """Yield (topic, timestamp [s], bytes) in the order of the file, for some topics or all.

        Of a file that was cut off, yield what can be read.
        """
        with ExitStack() as closing:
            if self._is_whole:
                # Its index leads straight to the chunks that hold a topic, wherever another reader
                # of the same file has gone in between.
                self._file.seek(0)
                reader: McapReader = SeekingReader(self._file, True, record_size_limit=self._size)
            else:
                own = closing.enter_context(open_session_file(self.path))
                own.seek(0)
                reader = NonSeekingReader(own, True, record_size_limit=self._size)
            with suppress(*READ_ERRORS):
                for _, channel, message in reader.iter_messages(
                    topics=topics or None, log_time_order=False
                ):
                    yield channel.topic, message.log_time / 1e9, message.data

    def decode_messages(self, kinds: Mapping[str, type[Any]]) -> Iterator[tuple[str, float, Any]]:
        """Yield (topic, timestamp [s], message) as `messages` does, for the types of some topics.

        Raises
        ------
        AppError
            A message is not what a recorder writes.
        """
        for topic, time, data in self.messages(*kinds):
            with self._named_message(topic, time):
                message = decode(kinds[topic], data)
            yield topic, time, message

    @contextmanager
    def _named_message(self, topic: str, time: float) -> Iterator[None]:
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
        if self._is_whole:
            try:
                summary = self._index()[1]
            except READ_ERRORS as error:
                raise AppError(f"cannot read the session '{self.path}': {error}") from error
            topics = {each.topic for each in summary.channels.values()}
        else:
            topics = {topic for topic, _, _ in self.messages()}
        return tuple(sorted(topic for topic in topics if message_type(topic) is not None))

    @property
    def has_channels(self) -> bool:
        """Whether it has every channel from the cube to the robot, or only what came in."""
        return self.has(*MESSAGE_TYPES)

    @cached_property
    def events(self) -> list[tuple[float, str]]:
        """The events, with their timestamps [s].

        Raises
        ------
        AppError
            A message is not what a recorder writes.
        """
        found = []
        for topic, time, data in self.messages("/events"):
            with self._named_message(topic, time):
                found.append((time, str(json.loads(data)["event"])))
        return found

    @cached_property
    def marks(self) -> tuple[Mark, ...]:
        """The marked moments in the order of time, those of `labels` too; raises AppError."""
        first = next(self.messages(IMAGE_TOPIC), ("", 0.0, b""))[1]
        marks = (*recorded_marks(self.events, first), *self.labels.marks)
        return tuple(sorted(marks, key=lambda mark: mark.at_s))

    @property
    def wizard_acts(self) -> tuple[WizardAct, ...]:
        """What a wizard did, in the order of time; raises AppError."""
        return wizard_acts(self.inputs, next(self.messages(IMAGE_TOPIC), ("", 0.0, b""))[1])

    @cached_property
    def inputs(self) -> dict[float, RecordedInputs]:
        """What came in with the frames besides their pictures, by their timestamps [s].

        Older sessions have no channel for it: what the player asked for is among their events, and
        what a character says is in its command.

        Raises
        ------
        AppError
            A message is not what a recorder writes.
        """
        found = {
            time: each for _, time, each in self.decode_messages({INPUTS_TOPIC: RecordedInputs})
        }
        return found or self._older_inputs()

    @property
    def start_overs(self) -> frozenset[float]:
        """Timestamps of the frames in which the player started over [s]."""
        return frozenset(time for time, each in self.inputs.items() if each.clear)

    @property
    def openings(self) -> frozenset[float]:
        """Timestamps of the frames in which the player opened or closed the cube [s]."""
        return frozenset(time for time, each in self.inputs.items() if each.inside)

    @cached_property
    def lines(self) -> dict[float, Lines]:
        """What the cast says, by the frame in which it is said first [s].

        What was said is an input, so a replay needs no voice.

        Raises
        ------
        AppError
            A message is not what a recorder writes.
        """
        said = {
            (line_topic(name), time): (name, speech)
            for time, each in self.inputs.items()
            for name, speech in each.speeches.items()
        }
        lines: dict[float, dict[str, SpokenLine]] = {}
        for at, rate, sound in self._sounds_at(said):
            name, speech = said[at]
            line = SpokenLine(speech.utterance, sound, rate, speech.profile)
            lines.setdefault(at[1], {})[name] = line
        return dict(lines)

    @cached_property
    def stage_sounds(self) -> dict[float, dict[str, SoundClip]]:
        """The sounds that came for the scenario, by frame [s] and name: a replay needs no file.

        Raises
        ------
        AppError
            A message is not what a recorder writes.
        """
        came = {
            (sound_topic(name), time): name
            for time, each in self.inputs.items()
            for name in each.sounds
        }
        clips: dict[float, dict[str, SoundClip]] = {}
        for at, rate, sound in self._sounds_at(came):
            clips.setdefault(at[1], {})[came[at]] = SoundClip(sound, rate)
        return clips

    def _sounds_at(
        self, places: Collection[tuple[str, float]]
    ) -> Iterator[tuple[tuple[str, float], int, Samples]]:
        """Yield place, sample rate and sound of the messages at some (topic, time [s])."""
        topics = dict.fromkeys(topic for topic, _ in places)
        for topic, time, data in self.messages(*topics) if topics else ():
            if (topic, time) in places:
                with self._named_message(topic, time):
                    rate, sound = decode_sound_message(data)
                yield (topic, time), rate, sound

    def replay_inputs(self, start: str) -> Iterator[ReplayInputs]:
        """Yield the recorded messages up to the stage `start`, for each frame.

        Raises
        ------
        AppError
            There is no such stage, or the session lacks its channel.
        """
        check_stage(start)
        topics = tuple(FIELD_OF_TOPIC)[: START_STAGES.index(start)]
        if not topics:  # from the camera on, nothing is taken as recorded
            return iter(())
        if not self.has(topics[-1]):
            raise AppError(f"'{self.path}' has no recorded channels to start from '{start}'")
        return self._replay_inputs(topics)

    def _replay_inputs(self, topics: tuple[str, ...]) -> Iterator[ReplayInputs]:
        parts = {topic.rpartition("/")[2] for topic in topics}
        further = [
            topic
            for topic in self.channels
            if topic.startswith(("/cast/", "/cubes/")) and topic.rpartition("/")[2] in parts
        ]
        kinds = {topic: message_type(topic) or object for topic in (*topics, *further)}
        seen: Appearance | None = None
        for _, found in groupby(self.decode_messages(kinds), key=itemgetter(1)):
            of_frame = {topic: message for topic, _, message in found}
            if APPEARANCE_TOPIC in of_frame:
                seen = of_frame[APPEARANCE_TOPIC] = of_frame[APPEARANCE_TOPIC].after(seen)
            first = {
                FIELD_OF_TOPIC[topic]: of_frame.pop(topic) for topic in topics if topic in of_frame
            }
            yield ReplayInputs(**first, further=of_frame)

    def _older_inputs(self) -> dict[float, RecordedInputs]:
        happened = set(self.events)
        speech: dict[float, SpeechIntent | None] = {}
        if sounds := {time for _, time, _ in self.messages(LINE_TOPIC)}:
            for _, time, command in self.decode_messages({"/character/command": CharacterCommand}):
                if time in sounds:
                    speech[time] = command.speech
        asked = {time for time, event in happened if event in (START_OVER_EVENT, INSIDE_EVENT)}
        return {
            time: RecordedInputs(
                (time, START_OVER_EVENT) in happened,
                (time, INSIDE_EVENT) in happened,
                speech.get(time),
                time,
            )
            for time in sorted(asked | speech.keys())
        }

    def _index(self) -> tuple[SeekingReader, Summary]:
        """Return a reader of a whole session, and its index; raises one of `READ_ERRORS`."""
        self._file.seek(0)
        reader = SeekingReader(self._file, record_size_limit=self._size)
        summary = reader.get_summary()
        if summary is None:
            raise ValueError("it has no index")
        return reader, summary

    def _indexed_frames(self) -> tuple[int, float]:
        """Return how many camera frames a whole session has, and their duration [s]."""
        try:
            reader, summary = self._index()
            if summary.statistics is None:
                raise ValueError("it has no index")
            ids = {channel.topic: number for number, channel in summary.channels.items()}
            counts = summary.statistics.channel_message_counts
            frames = counts.get(ids.get(IMAGE_TOPIC, -1), 0)
            return frames, _end(reader, last=True) - _end(reader, last=False) if frames else 0.0
        except READ_ERRORS as error:
            raise AppError(f"cannot read the session '{self.path}': {error}") from error

    def _readable_frames(self) -> tuple[int, float]:
        """Return the same of what can be read; refuse it if it is not to be salvaged."""
        times = [time for _, time, _ in self.messages(IMAGE_TOPIC)]
        frames, seconds = len(times), times[-1] - times[0] if times else 0.0
        if self._salvage:
            return frames, seconds
        if not frames:
            raise AppError(
                f"the session '{self.path}' was cut off before its first frame was whole"
            )
        raise AppError(
            f"the session '{self.path}' was cut off: {quantity(frames, 'frame')} ({seconds:.1f} s) "
            "can be played with --salvage"
        )


def session_info(path: Path, *, salvage: bool = False) -> SessionInfo:
    """Return what a session says of itself; see `SessionFile` and `SessionFile.info`."""
    with SessionFile(path, salvage=salvage) as session:
        return session.info


def messages(path: Path, *topics: str) -> Iterator[Message]:
    """Yield the messages of a session; see `SessionFile.messages`."""
    with SessionFile(path) as session:
        yield from session.messages(*topics)


def _end(reader: SeekingReader, *, last: bool) -> float:
    """Return the timestamp of the first or last camera frame [s], from one chunk or few."""
    found = next(reader.iter_messages(IMAGE_TOPIC, reverse=last), None)
    if found is None:
        raise ValueError("its index leads to no frame")
    return found[2].log_time / 1e9
