"""A line that the character says: it enters the pipeline from a voice, a file or a recording."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from cubeling.characters import CharacterCommand, SpeechIntent
from cubeling.characters.speech import DEFAULT_PROFILE, Samples, SpeechProfile, Utterance

SUBTITLE_S = 1.2
"""A line stays in the command for so long after its end [s], for those who read it."""


@dataclass(frozen=True, eq=False)
class SpokenLine:
    """What is said, and its sound."""

    utterance: Utterance
    """What is said, with the times of its phones and accents."""

    samples: Samples
    """The sound, (n,)."""

    rate: int
    """Sample rate of the sound [Hz]."""

    profile: SpeechProfile = DEFAULT_PROFILE
    """How it is said with the body."""


Lines = Mapping[str, SpokenLine]
"""What the characters of a cast say, by their names; that of the first one is `LEAD`."""

LEAD = ""
"""The first of a cast among lines, whatever its name: another character may say what it said."""


class Speaking:
    """The line that the character says; a new one takes the place of an old one."""

    def __init__(self) -> None:
        self.line: SpokenLine | None = None
        """What it says; None for nothing."""
        self._speech: SpeechIntent | None = None

    @property
    def end(self) -> float:
        """When its sound is over [s]; −∞ for silence."""
        return -math.inf if self._speech is None else self._speech.end

    def stop(self) -> None:
        """Break off, with the subtitle too."""
        self.line = self._speech = None

    def update(
        self, new: SpokenLine | None, command: CharacterCommand, *, silence: bool
    ) -> SpeechIntent | None:
        """Return what a frame's command says, with a new line or with silence from now on.

        A character that is hidden falls silent, too.
        """
        now = command.timestamp
        if new is not None:
            self.line, self._speech = new, SpeechIntent(new.utterance, now, new.profile)
        over = self._speech is not None and now > self._speech.end + SUBTITLE_S
        if over or silence or not command.visible:
            self.stop()
        if self._speech is None or not self._speech.profile.cube_emphasis:
            return self._speech
        knob = self._speech.profile.cube_emphasis * min(max(command.weight, -1.0), 1.0)
        return replace(self._speech, emphasis=knob)
