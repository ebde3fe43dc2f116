"""The motion that a character stands with, under commands."""

from cubeling.characters.control.command import CharacterCommand, SpeechIntent
from cubeling.characters.control.speaking.spoken import speech_shifts
from cubeling.characters.model.character import Character
from cubeling.characters.motion.motion import StandingMotion


class CommandedStanding:
    """Shows emotions, and shifts its weight where a speech asks for it."""

    def __init__(self, character: Character) -> None:
        self.motion: StandingMotion | None = character.stand()
        """What it stands with; None if it stands with its idle clip."""
        self._seed = character.seed
        self._speech: SpeechIntent | None = None
        self._shifts: tuple[float, ...] = ()
        self._last = 0.0

    def update(self, command: CharacterCommand) -> None:
        """Take the command of a frame."""
        if self.motion is None:
            return
        speech, now = command.speech, command.timestamp
        self.motion.feel(command.emotion)
        if speech is None or not speech.profile.liveliness or now >= speech.end:
            self.motion.talk(None)
        else:
            if self._speech is None or self._speech.start != speech.start:
                self._speech, self._last = speech, now
                self._shifts = speech_shifts(speech, self._seed)
            due = any(self._last < speech.start + time <= now for time in self._shifts)
            self.motion.talk(due if now >= speech.start else None)
        self._last = now
