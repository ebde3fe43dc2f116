"""What the character is saying: the last line, until it is over."""

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.spoken_line import SpokenLine
from cubeling.characters import CharacterCommand, SpeechIntent

SUBTITLE_S = 1.2
"""A line stays in the command for so long after its end [s], for those who read it."""


class Speaking:
    """The line that the character says; a new one takes the place of an old one."""

    def __init__(self) -> None:
        self.line: SpokenLine | None = None
        """What it says; None for nothing."""
        self._speech: SpeechIntent | None = None

    def update(self, inputs: Inputs, command: CharacterCommand) -> SpeechIntent | None:
        """Return what the command of a frame says. A character that is hidden falls silent."""
        now = command.timestamp
        if inputs.line is not None:
            self.line = inputs.line
            self._speech = SpeechIntent(inputs.line.utterance, now, inputs.line.profile)
        over = self._speech is not None and now > self._speech.end + SUBTITLE_S
        if over or inputs.clear or not command.visible:
            self.line = self._speech = None
        return self._speech
