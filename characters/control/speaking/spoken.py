"""All that one speech does with body, eyes and face besides its gestures."""

import zlib

import numpy as np

from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.control.speaking.arms import DOFS, TAIL_S, SpeakingArms
from cubeling.characters.control.speaking.aversions import Aversions
from cubeling.characters.control.speaking.beats import SyllableClock, head_beats
from cubeling.characters.control.speaking.shifts import shift_times
from cubeling.characters.control.speaking.stance import SpeakingStance
from cubeling.characters.control.speaking.state import SpeakingState
from cubeling.characters.face.word_emotion import emotion_at, emotions_of
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.speech.phrases import phrases_of


def speech_seed(speech: SpeechIntent, seed: int) -> int:
    """Return the seed of what is random in a speech of one character."""
    return zlib.crc32(speech.utterance.text.encode()) + seed


def speech_shifts(speech: SpeechIntent, seed: int) -> tuple[float, ...]:
    """Return when a character shifts its weight in a speech, from its start [s]."""
    if speech.profile.liveliness == 0.0:
        return ()
    rng = np.random.default_rng([speech_seed(speech, seed), 1])
    return shift_times(phrases_of(speech.utterance), rng)


class SpokenBody:
    """The plan of one speech for body, eyes and face.

    `own_shifts` is whether the body is to shift its weight here, as the motion that it stands with
    cannot.
    """

    def __init__(self, speech: SpeechIntent, seed: int, *, own_shifts: bool) -> None:
        said = speech.utterance
        rngs = [np.random.default_rng([speech_seed(speech, seed), n]) for n in range(2, 6)]
        phrases = phrases_of(said)
        self._lively, self._length = speech.profile.liveliness, said.duration
        self._head = head_beats(said.accents, rngs[0])
        self._arms = SpeakingArms(said.accents, said.syllables, said.duration, rngs[1])
        shifts = speech_shifts(speech, seed) if own_shifts else ()
        self._stance = SpeakingStance(phrases, said.accents, shifts, said.duration, rngs[2])
        self._aversions = Aversions(said, rngs[3])
        self._emotions = emotions_of(said, phrases)
        self._ends = [each.end for each in phrases]
        self.clock = SyllableClock(said, self._lively)
        """The time by which gestures are played."""
        self.end = self._length + (TAIL_S if self._lively else 0.0)
        """When all is at rest again, from the start of the speech [s]."""

    def arms_at(self, time: float) -> Array:
        """Return what the arms do besides gestures at a time of the speech, (2, 4) [degrees]."""
        return self._lively * self._arms.at(time) if self._lively else np.zeros((2, len(DOFS)))

    def state(self, time: float, elapsed: float, body: float, head: float) -> SpeakingState:
        """Return what it does at a time of the speech [s].

        `body` is the share of the stance that shows, and `head` that of nods.
        """
        talking = 0.0 <= time < self._length
        nod = head * self._head.at(time)
        if not self._lively:
            return SpeakingState(nod, talking=talking)
        return SpeakingState(
            nod,
            self._stance.values(time) * (body * self._lively),
            self._aversions.at(time),
            emotion_at(self._emotions, time),
            talking,
            any(time - elapsed < end <= time for end in self._ends),
        )
