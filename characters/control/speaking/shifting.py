"""The motion that a character stands with, under commands."""

from cubeling.characters.behaviour.intents import BehaviourIntent
from cubeling.characters.control.command import CharacterCommand, ComingAct, SpeechIntent
from cubeling.characters.control.speaking.spoken import speech_shifts
from cubeling.characters.model.character import Character
from cubeling.characters.motion.motion import StandingMotion
from cubeling.characters.skeleton.pose import Pose

AHEAD_S = 3.0
"""From how long before an act on it gets ready: most shifts last less [s]."""


class CommandedStanding:
    """Shows emotions, shifts its weight where a speech asks for it, and ends that before acts."""

    def __init__(self, character: Character) -> None:
        self.motion: StandingMotion | None = character.stand()
        """What it stands with; None if it stands with its idle clip."""
        self._seed = character.seed
        self._awaited: ComingAct | None = None
        self._speech: SpeechIntent | None = None
        self._shifts: tuple[float, ...] = ()
        self._last = 0.0

    def update(
        self, command: CharacterCommand, first: Pose | None = None, tempo: float = 1.0
    ) -> None:
        """Take the command of a frame.

        `first` is the pose in which the coming action begins, and `tempo` how fast time goes for
        the motion.
        """
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
        self._await(command, first, tempo)

    def _await(self, command: CharacterCommand, first: Pose | None, tempo: float) -> None:
        """Be ready for what comes, and shift again when it is over."""
        assert self.motion is not None
        coming, now = command.coming, command.timestamp
        if coming is not None and now < coming.start <= now + AHEAD_S:
            if coming != self._awaited:
                self.motion.await_act(first, (coming.start - now) * tempo)
                self._awaited = coming
        elif self._awaited is not None and not _gestures(command.behaviour):
            self.motion.go_on()
            self._awaited = None


def _gestures(asked: BehaviourIntent | None) -> bool:
    """Return whether hands or body are asked for something."""
    return asked is not None and bool(
        asked.gestures or asked.reaches or asked.clips or asked.postures
    )
