"""What came in with the frames of a session, next to their pictures: a replay takes it again."""

from dataclasses import dataclass, replace

from cubeling.app.pipeline.scenario import Inputs, ModelAnswer
from cubeling.app.pipeline.table.acts import Act
from cubeling.app.pipeline.table.spoken_line import LEAD
from cubeling.characters import SpeechIntent


@dataclass(frozen=True)
class RecordedLine:
    """What a further character of the cast wants to say from a frame on."""

    name: str
    """Its name in the cast."""

    speech: SpeechIntent
    """The words, whose sound is on its channel of `line_topic`."""


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

    others: tuple[RecordedLine, ...] = ()
    """What the rest of the cast wants to say."""

    typed: str = ""
    """What the player said."""

    hush: bool = False
    """Whether the player interrupted the character."""

    acts: tuple[Act, ...] = ()
    """What the characters were told to do by somebody beside the player."""

    sounds: tuple[str, ...] = ()
    """Names of the sounds that came for the scenario; each is on its channel of `sound_topic`."""

    answer: ModelAnswer | None = None
    """What a language model has answered."""

    @property
    def asked(self) -> Inputs:
        """What was asked for and said, without what was spoken."""
        names = ("clear", "inside", "typed", "hush", "acts", "answer")
        return Inputs(**{name: getattr(self, name) for name in names})

    @property
    def speeches(self) -> dict[str, SpeechIntent]:
        """What all want to say, by their names as `Lines` have them."""
        own = {} if self.speech is None else {LEAD: self.speech}
        return {**own, **{each.name: each.speech for each in self.others}}

    @classmethod
    def of(cls, inputs: Inputs, timestamp: float) -> "RecordedInputs | None":
        """Return what a recording keeps of the inputs of a frame; None for nothing."""
        if replace(inputs, scenario="", marks=()) == Inputs():
            return None
        speeches = {
            name: SpeechIntent(line.utterance, timestamp, line.profile)
            for name, line in inputs.lines.items()
        }
        own = speeches.pop(LEAD, None)
        others = tuple(RecordedLine(*each) for each in speeches.items())
        return cls(
            inputs.clear,
            inputs.inside,
            own,
            timestamp,
            others,
            inputs.typed,
            inputs.hush,
            inputs.acts,
            tuple(inputs.sounds),
            inputs.answer,
        )
