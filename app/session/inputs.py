"""What came in with the frames of a session, next to their pictures: a replay takes it again."""

from dataclasses import dataclass
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.spoken_line import SpokenLine
from cubeling.app.session.encoding import INPUTS_TOPIC, LINE_TOPIC, decode, decode_sound
from cubeling.app.session.reading import INSIDE_EVENT, START_OVER_EVENT, events, messages
from cubeling.characters import CharacterCommand, SpeechIntent


@dataclass(frozen=True)
class RecordedInputs:
    """What came in with a frame; a frame with which nothing came in has no such message."""

    clear: bool
    """Whether the player started over."""

    inside: bool
    """Whether the player asked to open the cube, or to close it."""

    speech: SpeechIntent | None
    """What the character began to say, whose sound is on `LINE_TOPIC`; None for nothing new."""

    timestamp: float
    """Time of the frame [s]."""

    @classmethod
    def of(cls, inputs: Inputs, timestamp: float) -> "RecordedInputs | None":
        """Return what a recording keeps of the inputs of a frame; None for nothing."""
        line = inputs.line
        if not (inputs.clear or inputs.inside or line is not None):
            return None
        speech = None if line is None else SpeechIntent(line.utterance, timestamp, line.profile)
        return cls(inputs.clear, inputs.inside, speech, timestamp)


def recorded_inputs(path: Path) -> dict[float, RecordedInputs]:
    """Return what came in with the frames of a session, by their timestamps [s].

    Older sessions have no channel for it: what the player asked for is among their events, and
    what a character says is in its command.

    Raises
    ------
    AppError
        A message is not what a recorder writes.
    """
    try:
        found = {
            time: decode(RecordedInputs, data) for _, time, data in messages(path, INPUTS_TOPIC)
        }
        return found or _older_inputs(path)
    except (ValueError, KeyError, TypeError) as error:
        raise AppError(f"cannot read the session '{path}': its inputs: {error}") from error


def _older_inputs(path: Path) -> dict[float, RecordedInputs]:
    happened = set(events(path))
    speech: dict[float, SpeechIntent | None] = {}
    if sounds := {time for _, time, _ in messages(path, LINE_TOPIC)}:
        for _, time, document in messages(path, "/character/command"):
            if time in sounds:
                speech[time] = decode(CharacterCommand, document).speech
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


def start_over_times(path: Path) -> frozenset[float]:
    """Return the timestamps of the frames in which the player started over [s]."""
    return frozenset(time for time, inputs in recorded_inputs(path).items() if inputs.clear)


def opening_times(path: Path) -> frozenset[float]:
    """Return the timestamps of the frames in which the player opened or closed the cube [s]."""
    return frozenset(time for time, inputs in recorded_inputs(path).items() if inputs.inside)


def spoken_lines(path: Path) -> dict[float, SpokenLine]:
    """Return what the character says in a session, by the frame in which it begins [s].

    What was said is an input, so a replay needs no voice.
    """
    said = {time: each.speech for time, each in recorded_inputs(path).items() if each.speech}
    lines: dict[float, SpokenLine] = {}
    for _, time, data in messages(path, LINE_TOPIC):
        if (speech := said.get(time)) is not None:
            from foxglove_schemas_protobuf.RawAudio_pb2 import RawAudio

            audio = RawAudio.FromString(data)
            sound = decode_sound(audio.data)
            lines[time] = SpokenLine(speech.utterance, sound, audio.sample_rate, speech.profile)
    return lines
