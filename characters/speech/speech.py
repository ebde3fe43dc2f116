"""What is said: text, words and phones with their times, and the sound."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float32]
"""Sound, (n,), each sample from −1 to 1."""

SILENCE = ""
"""The symbol of a pause among phones."""


@dataclass(frozen=True)
class Phone:
    """A speech sound, or a pause."""

    symbol: str
    """In the International Phonetic Alphabet, without stress marks; `SILENCE` for a pause."""

    start: float
    """When it begins, from the start of the speech [s]."""

    end: float
    """When it ends [s]."""

    stressed: bool | None = None
    """Whether it is the vowel of a stressed syllable; None if that is not known."""


@dataclass(frozen=True)
class Word:
    """A word of a text."""

    text: str
    """As it is written."""

    start: float
    """When it begins, from the start of the speech [s]."""

    end: float
    """When it ends [s]."""

    offset: int = 0
    """Index of its first character in the text."""


@dataclass(frozen=True)
class Accent:
    """A pitch accent: a syllable that stands out by its pitch and loudness."""

    time: float
    """When, from the start of the speech [s]."""

    strength: float
    """0…1; the strongest of a speech has 1."""


@dataclass(frozen=True)
class Syllable:
    """A syllable of a speech."""

    time: float
    """When its nucleus is loudest, from the start of the speech [s]."""

    loudness: float
    """0…1, between the quiet and the loud ones of the speech."""


@dataclass(frozen=True)
class GestureSpan:
    """A gesture that a tagged text asks for."""

    name: str
    """Of a gesture, a clip or an expression."""

    start: float
    """When it begins, from the start of the speech [s]."""

    end: float
    """When it ends [s]."""


@dataclass(frozen=True)
class Utterance:
    """What a speaker does with mouth and hands while a speech sounds; the sound is elsewhere."""

    text: str
    """What is said; "" if it is not known."""

    language: str
    """Language of the text by its code, such as "en" or "ca"; "" if it is not known."""

    duration: float
    """Length of the sound [s]."""

    words: tuple[Word, ...] = ()
    """The words, in order."""

    phones: tuple[Phone, ...] = ()
    """The phones and pauses, in order, without gaps or overlaps."""

    accents: tuple[Accent, ...] = ()
    """The pitch accents, in order."""

    gestures: tuple[GestureSpan, ...] = ()
    """What a tagged text asks for; spans may cross."""

    syllables: tuple[Syllable, ...] = ()
    """The syllables, in order; () if the sound was not measured."""


@dataclass(frozen=True, eq=False)
class Speech:
    """The sound of a speech, with the times of its words and phones."""

    samples: Samples
    """The sound, (n,)."""

    rate: int
    """Sample rate [Hz]."""

    text: str = ""
    """What is said; "" if it is not known."""

    language: str = ""
    """Language of the text by its code."""

    words: tuple[Word, ...] = ()
    """The words, in order."""

    phones: tuple[Phone, ...] = field(default=())
    """The phones and pauses, in order, without gaps or overlaps."""

    @property
    def duration(self) -> float:
        """Length of the sound [s]."""
        return len(self.samples) / self.rate
