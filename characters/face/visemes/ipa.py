"""Speech sounds of any language by their phonetic features, and how much alike they look.

The letters and their features are those of the International Phonetic Alphabet (International
Phonetic Association, *Handbook*, 1999). A symbol of a voice may join several letters (diphthongs,
affricates) and carry marks (length, tone, aspiration): the letters count, the marks do not.
"""

import unicodedata
from collections.abc import Iterable
from functools import cache
from typing import NamedTuple

_PLACES = {
    "bilabial": 0, "labiodental": 6, "dental": 10, "alveolar": 12, "rhotic": 13,
    "postalveolar": 14, "alveolopalatal": 14.5, "palatal": 15.5, "velar": 20, "uvular": 22,
    "pharyngeal": 26, "glottal": 28,
}  # fmt: skip
"""Places of articulation from the lips to the throat; distances say how different they look."""

_CONSONANTS = {
    "bilabial stop": "p b ɓ ʘ", "bilabial nasal": "m", "bilabial trill": "ʙ",
    "bilabial fricative": "ɸ β", "labiodental nasal": "ɱ", "labiodental fricative": "f v",
    "labiodental approximant": "ʋ ⱱ", "dental fricative": "θ ð", "dental stop": "ǀ",
    "alveolar stop": "t d ɗ ǃ", "alveolar nasal": "n", "alveolar sibilant": "s z",
    "alveolar lateral": "l ɫ ɬ ɮ ɺ ǁ", "alveolar tap": "ɾ r", "rhotic rhotic": "ɹ ɻ",
    "postalveolar sibilant": "ʃ ʒ ʂ ʐ", "postalveolar stop": "ʈ ɖ", "postalveolar nasal": "ɳ",
    "postalveolar lateral": "ɭ", "postalveolar tap": "ɽ", "alveolopalatal sibilant": "ɕ ʑ ɧ",
    "palatal stop": "c ɟ ʄ ǂ", "palatal nasal": "ɲ", "palatal fricative": "ç ʝ",
    "palatal approximant": "j", "palatal lateral": "ʎ", "velar stop": "k ɡ ɠ g",
    "velar nasal": "ŋ", "velar fricative": "x ɣ", "velar approximant": "ɰ", "velar lateral": "ʟ",
    "uvular stop": "q ɢ ʛ", "uvular nasal": "ɴ", "uvular fricative": "χ ʁ", "uvular trill": "ʀ",
    "pharyngeal fricative": "ħ ʕ ʜ ʢ ʡ", "glottal fricative": "h ɦ", "glottal stop": "ʔ",
    "velar round": "w ʍ", "palatal round": "ɥ",
}  # fmt: skip

_VOWELS = {
    # height, from 0 close to 6 open: front, central and back, unrounded | rounded
    0: ("i", "ɨ", "ɯ", "y", "ʉ", "u"),
    1: ("ɪ", "", "", "ʏ", "", "ʊ"),
    2: ("e", "ɘ", "ɤ", "ø", "ɵ", "o"),
    3: ("", "ə", "", "", "", ""),
    4: ("ɛ ε", "ɜ ɝ ɚ", "ʌ", "œ", "ɞ", "ɔ"),
    5: ("æ", "ɐ", "", "", "", ""),
    6: ("", "a", "ɑ", "ɶ", "", "ɒ"),
}

_MANNER_COST, _BACKNESS_COST, _ROUNDING_COST = 4.0, 0.5, 6.0
_FIRST_OF_TWO_VOWELS = 0.6
"""Share of a diphthong's time that its first vowel has."""


class IpaSegment(NamedTuple):
    """What a letter says of lips, tongue and jaw."""

    vowel: bool
    """Whether it is a vowel."""

    place: float
    """Of a consonant, from the lips, 0, to the throat; of a vowel, its backness, 0…2."""

    manner: str
    """Manner of articulation of a consonant; "" of a vowel."""

    height: float
    """Of a vowel, from close, 0, to open, 6."""

    rounded: bool
    """Whether the lips are rounded."""


def _segments() -> dict[str, IpaSegment]:
    found = {}
    for kind, letters in _CONSONANTS.items():
        place, manner = kind.split()
        for letter in letters.split():
            segment = IpaSegment(False, _PLACES[place], manner, 0.0, manner == "round")
            found[letter] = segment
    for height, row in _VOWELS.items():
        for column, letters in enumerate(row):
            for letter in letters.split():
                found[letter] = IpaSegment(True, column % 3, "", height, column >= 3)
    return found


SEGMENTS = _segments()
"""The features of every letter of the alphabet."""


@cache
def letters_of(symbol: str) -> tuple[str, ...]:
    """Return the letters of a symbol, without its marks; none if it has none that is known.

    >>> letters_of("t̪ʰ"), letters_of("ɔ̃"), letters_of("aɪə"), letters_of("(en)")
    (('t',), ('ɔ',), ('a', 'ɪ', 'ə'), ())
    """
    if symbol.startswith("("):  # a switch of languages
        return ()
    letters = []
    for written in unicodedata.normalize("NFC", symbol):
        plain = written if written in SEGMENTS else unicodedata.normalize("NFD", written)[0]
        if plain in SEGMENTS:
            letters.append(plain)
    return tuple(letters)


def parts_of(symbol: str) -> tuple[tuple[str, float], ...]:
    """Return the letters of a symbol in turn, each with its share of the time.

    >>> parts_of("aɪ"), parts_of("ts")
    ((('a', 0.6), ('ɪ', 0.4)), (('t', 0.5), ('s', 0.5)))
    """
    letters = letters_of(symbol)
    if len(letters) == 2 and all(SEGMENTS[letter].vowel for letter in letters):
        return (letters[0], _FIRST_OF_TWO_VOWELS), (letters[1], 1.0 - _FIRST_OF_TWO_VOWELS)
    return tuple((letter, 1.0 / len(letters)) for letter in letters)


def difference(a: IpaSegment, b: IpaSegment) -> float:
    """Return how different two sounds of one kind look; infinite for a vowel and a consonant."""
    if a.vowel != b.vowel:
        return float("inf")
    rounding = _ROUNDING_COST * (a.rounded != b.rounded)
    if a.vowel:
        return abs(a.height - b.height) + _BACKNESS_COST * abs(a.place - b.place) + rounding
    return abs(a.place - b.place) + _MANNER_COST * (a.manner != b.manner) + rounding


def most_alike(letter: str, among: Iterable[str]) -> str:
    """Return which of some letters looks most like another; of equals, the first.

    >>> most_alike("y", ["i", "u", "a"]), most_alike("ɲ", ["n", "k", "s"])
    ('u', 'n')
    """
    return min(among, key=lambda other: difference(SEGMENTS[letter], SEGMENTS[other]))
