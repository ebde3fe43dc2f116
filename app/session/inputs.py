"""What came in with the frames of a session, next to their pictures: a replay takes it again."""

from dataclasses import dataclass

from cubeling.app.pipeline.scenario import Inputs
from cubeling.characters import SpeechIntent


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
