"""All that one speech does with body, eyes and face besides its gestures."""

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.control.speaking.arms import arm_movement
from cubeling.characters.control.speaking.aversions import Aversions
from cubeling.characters.control.speaking.beats import head_beats, syllable_clock
from cubeling.characters.control.speaking.shifts import shift_times
from cubeling.characters.control.speaking.stance import stance_movement
from cubeling.characters.control.speaking.state import SpeakingState
from cubeling.characters.face.word_emotion import emotion_at, emotions_of
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.speech.prosody.phrases import Phrase, phrases_of
from cubeling.characters.speech.speech import Utterance


def speech_seed(speech: SpeechIntent, seed: int) -> int:
    """Return the seed of what is random in a speech of one character."""
    return zlib.crc32(speech.utterance.text.encode()) + seed


def speech_shifts(speech: SpeechIntent, seed: int) -> tuple[float, ...]:
    """Return when a character shifts its weight in a speech, from its start [s]."""
    if speech.profile.liveliness == 0.0:
        return ()
    rng = np.random.default_rng([speech_seed(speech, seed), 1])
    return shift_times(phrases_of(speech.utterance), rng)


RATE_HZ = 60.0
"""Rate at which a speech's movements are planned [Hz]."""

LEAD_S, TAIL_S = 0.8, 1.6
"""From how long before the sound to how long after it a body moves with a speech [s]."""

HEAD_LEAD_S = 0.11
"""How long nods come before their accents in a body that moves as a whole [s]: hands have their
apex some 0.1 s before the accent, and follow the head and the trunk."""

_NOD, _STANCE, _ARMS, _CLOCK = slice(0, 3), slice(3, 18), slice(18, 26), 26


@dataclass(frozen=True, eq=False)
class SpokenMovement:
    """What one speech does with a body besides gestures, planned at even times.

    Frozen, so that the checkpoints of a session share it.
    """

    rows: Array
    """Nod (3), stance (15), arms (8), and how far the gestures' time is ahead [s], (times, 27)."""

    @staticmethod
    def of(
        utterance: Utterance,
        phrases: Sequence[Phrase],
        shifts: Sequence[float],
        seed: int,
        head_lead: float = HEAD_LEAD_S,
    ) -> "SpokenMovement":
        """Return the movement of a speech with shifts of weight at some times [s].

        `head_lead` is how long nods come before their accents [s].
        """
        rngs = [np.random.default_rng(each) for each in (seed, [seed, 3], [seed, 4])]
        accents, end = utterance.accents, utterance.duration
        count = math.ceil((LEAD_S + end + TAIL_S) * RATE_HZ) + 1
        times = np.arange(count) / RATE_HZ - LEAD_S
        parts = (
            head_beats(times + head_lead, accents, rngs[0]),
            stance_movement(times, phrases, accents, shifts, end, rngs[1]),
            arm_movement(times, accents, utterance.syllables, end, rngs[2]),
            syllable_clock(times, utterance)[:, None],
        )
        return SpokenMovement(np.concatenate(parts, axis=1))

    def at(self, time: float) -> Array:
        """Return the row of a time of the speech [s], (27,)."""
        place = min(max((time + LEAD_S) * RATE_HZ, 0.0), len(self.rows) - 1.001)
        low = int(place)
        before = self.rows[low]
        row: Array = before + (self.rows[low + 1] - before) * (place - low)
        return row


class SpokenBody:
    """The plan of one speech for body, eyes and face.

    `own_shifts` is whether the body is to shift its weight here, as the motion that it stands with
    cannot.
    """

    def __init__(self, speech: SpeechIntent, seed: int, *, own_shifts: bool) -> None:
        said, phrases = speech.utterance, phrases_of(speech.utterance)
        shifts = speech_shifts(speech, seed) if own_shifts else ()
        seed = speech_seed(speech, seed)
        self._lively, self._length = speech.profile.liveliness, said.duration
        lead = HEAD_LEAD_S if self._lively else 0.0
        self._movement = SpokenMovement.of(said, phrases, shifts, seed, lead)
        self._aversions = Aversions(said, np.random.default_rng([seed, 5]))
        self._emotions = emotions_of(said, phrases)
        self._ends = [each.end for each in phrases]
        self._row = self._movement.rows[0]
        self._time = 0.0
        self.end = said.duration + (TAIL_S if self._lively else 0.0)
        """When all is at rest again, from the start of the speech [s]."""

    def advance(self, time: float) -> None:
        """Go to a time of the speech [s]."""
        self._row, self._time = self._movement.at(time), time

    @property
    def gesture_time(self) -> float:
        """The time by which gestures are played [s]."""
        return self._time + min(self._lively, 1.0) * float(self._row[_CLOCK])

    @property
    def arms(self) -> Array:
        """What the arms do besides gestures, (8,) [degrees]."""
        degrees: Array = self._row[_ARMS] * self._lively
        return degrees

    def state(self, elapsed: float, body: float, head: float) -> SpeakingState:
        """Return what is done with the layers after that of speech.

        `body` is the share of the stance that shows, and `head` that of nods; `elapsed` is the time
        since the last frame [s].
        """
        time, row = self._time, self._row
        talking = 0.0 <= time < self._length
        if not self._lively:
            return SpeakingState(row[_NOD] * head, talking=talking)
        return SpeakingState(
            row[_NOD] * head,
            row[_STANCE] * (body * self._lively),
            self._aversions.at(time),
            emotion_at(self._emotions, time),
            talking,
            any(time - elapsed < end <= time for end in self._ends),
        )
