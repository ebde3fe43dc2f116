"""A recorded session: all that is read of it, except for the camera's frames."""

import json
from collections.abc import Collection, Iterator
from dataclasses import replace
from functools import cached_property
from itertools import groupby
from operator import itemgetter
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.pipeline.table.spoken_line import Lines, SpokenLine
from cubeling.app.pipeline.table.stage_sounds import SoundClip
from cubeling.app.scenarios import scenario_cube
from cubeling.app.session.acts import WizardAct, wizard_acts
from cubeling.app.session.encoding import (
    APPEARANCE_TOPIC,
    CLOCK_RECORD,
    CLOCK_ZERO,
    FIRST_PART_KEY,
    IMAGE_TOPIC,
    INPUTS_TOPIC,
    LINE_TOPIC,
    MESSAGE_TYPES,
    PLAYED_RECORD,
    SESSION_RECORD,
    decode_sound_message,
    line_topic,
    message_type,
    sound_topic,
)
from cubeling.app.session.info import SessionInfo
from cubeling.app.session.inputs import RecordedInputs
from cubeling.app.session.labels import (
    LABEL_NAMES,
    Mark,
    SessionLabels,
    corrected_labels,
    recorded_marks,
)
from cubeling.app.session.message_file import Message, MessageFile
from cubeling.app.session.options import START_STAGES, SessionOptions, check_stage
from cubeling.characters import CharacterCommand, SpeechIntent
from cubeling.characters.speech import Samples
from cubeling.tracking import CubeModel
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
    "/robot/emotion": "emotion",
}
"""The field of `ReplayInputs` for each channel, in the order of the stages after the camera."""


class SessionFile(MessageFile):
    """A recorded session, opened once for all that is read of it; close it after use."""

    @cached_property
    def info(self) -> SessionInfo:
        """What the session says of itself.

        Raises
        ------
        AppError
            The file is damaged, names no scenario, or was cut off and is not to be salvaged.
        """
        frames, seconds = self.count_frames()
        about = self.metadata.get(SESSION_RECORD, {})
        if "scenario" not in about:
            raise AppError(f"'{self.path}' names no scenario: it was not recorded by Cubeling")
        try:
            options = SessionOptions.from_metadata(about, str(self.path))
        except ValueError as error:
            raise AppError(f"cannot read the session '{self.path}': {error}") from None
        clock_zero = self.metadata.get(CLOCK_RECORD, {}).get(CLOCK_ZERO, "")
        labels = self.labels
        names = {name: getattr(labels, name) for name in LABEL_NAMES}
        options = replace(options, **names)
        played = self.metadata.get(PLAYED_RECORD, {})
        has_video = about.get("video", "yes") != "no"
        first = about.get(FIRST_PART_KEY, "")
        return SessionInfo(options, frames, seconds, played, labels, has_video, first, clock_zero)

    def check_begins(self) -> None:
        """Refuse to play a later part of a recording from its pictures on; raises AppError."""
        if first := self.info.first_part:
            raise AppError(
                f"'{self.path}' goes on from '{first}', and does not hold what was before: "
                f"replay '{first}', or this part as it was recorded with --from pose, or join them"
            )

    def check_has_video(self) -> None:
        """Refuse to look for a cube in pictures that were not recorded; raises AppError."""
        if not self.info.has_video:
            raise AppError(
                f"'{self.path}' was recorded without video: cubeling replay plays it from where "
                "the cube was"
            )

    @property
    def cube_edge(self) -> float:
        """Edge of the cube that it was played with [m]; raises AppError or TrackingError."""
        options = self.info.options
        return CubeModel.load(options.cube or scenario_cube(options.scenario)).edge

    @cached_property
    def labels(self) -> SessionLabels:
        """Who played, as it was corrected since, else as it was said; raises AppError."""
        about = self.metadata.get(SESSION_RECORD, {})
        participant, condition, notes = (about.get(name, "") for name in LABEL_NAMES)
        return corrected_labels(self.path, SessionLabels(participant, condition, notes))

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
            with self.named_message(topic, time):
                found.append((time, str(json.loads(data)["event"])))
        return found

    @property
    def first_time(self) -> float:
        """Timestamp of the first frame [s]; 0 without one."""
        return next(self.messages(IMAGE_TOPIC), ("", 0.0, b""))[1]

    @cached_property
    def marks(self) -> tuple[Mark, ...]:
        """The marked moments in the order of time, those of `labels` too; raises AppError."""
        marks = (*recorded_marks(self.events, self.first_time), *self.labels.marks)
        return tuple(sorted(marks, key=lambda mark: mark.at_s))

    @property
    def wizard_acts(self) -> tuple[WizardAct, ...]:
        """What a wizard did, in the order of time; raises AppError."""
        return wizard_acts(self.inputs, self.first_time)

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
                with self.named_message(topic, time):
                    rate, sound = decode_sound_message(data)
                yield (topic, time), rate, sound

    def replay_inputs(self, start: str, since: float = 0.0) -> Iterator[ReplayInputs]:
        """Yield the recorded messages up to the stage `start`, for each frame since a time [s].

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
        return self._replay_inputs(topics, since)

    def _replay_inputs(self, topics: tuple[str, ...], since: float) -> Iterator[ReplayInputs]:
        parts = {topic.rpartition("/")[2] for topic in topics}
        further = [
            topic
            for topic in self.channels
            if topic.startswith(("/cast/", "/cubes/")) and topic.rpartition("/")[2] in parts
        ]
        kinds = {topic: message_type(topic) or object for topic in (*topics, *further)}
        seen: Appearance | None = None
        for _, found in groupby(self.decode_messages(kinds, since), key=itemgetter(1)):
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


def session_info(path: Path, *, salvage: bool = False) -> SessionInfo:
    """Return what a session says of itself; see `SessionFile` and `SessionFile.info`."""
    with SessionFile(path, salvage=salvage) as session:
        return session.info


def messages(path: Path, *topics: str) -> Iterator[Message]:
    """Yield the messages of a session; see `SessionFile.messages`."""
    with SessionFile(path) as session:
        yield from session.messages(*topics)
