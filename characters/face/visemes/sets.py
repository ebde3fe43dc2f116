"""Sets of visemes, and which viseme each speech sound of any language has.

Sources of the sets are in `sets.toml`. A sound that a set does not name has the viseme of the one
that looks most like it (`ipa.py`).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from cubeling.characters.errors import CharacterError
from cubeling.characters.face.visemes.ipa import SEGMENTS, most_alike, parts_of
from cubeling.toml_file import bundled

MOUTH_SHAPES = (
    "sil",
    "PP",
    "FF",
    "TH",
    "DD",
    "kk",
    "CH",
    "SS",
    "nn",
    "RR",
    "aa",
    "E",
    "I",
    "O",
    "U",
)
"""The shapes of the mouth that all sets are made of, by the names of the Oculus visemes."""

VOWEL_SHAPES = frozenset(("aa", "E", "I", "O", "U"))
"""Shapes that have a weaker and a stronger version."""

_IPA_OF_ARPABET: Mapping[str, tuple[str, ...]] = {
    "aa": ("ɑ",), "ae": ("æ",), "ah": ("ʌ",), "ao": ("ɔ",), "aw": ("aʊ",), "ax": ("ə",),
    "ay": ("aɪ",), "b": ("b",), "ch": ("tʃ",), "d": ("d",), "dh": ("ð",), "e": ("e",), "eh": ("ɛ",),
    "el": ("əl",), "em": ("əm",), "en": ("ən",), "er": ("ɜ", "ɝ", "ɚ"), "ey": ("eɪ", "e"),
    "f": ("f",), "g": ("ɡ",), "h": ("h",), "hh": ("h",), "ih": ("ɪ",), "ix": ("ɨ",), "iy": ("i",),
    "jh": ("dʒ",), "k": ("k",), "l": ("l",), "m": ("m",), "n": ("n",), "ng": ("ŋ",), "o": ("o",),
    "ow": ("oʊ", "əʊ", "o"), "oy": ("ɔɪ",), "p": ("p",), "pau": (), "r": ("ɹ",), "s": ("s",),
    "sh": ("ʃ",), "t": ("t",), "th": ("θ",), "uh": ("ʊ",), "uw": ("u",), "v": ("v",),
    "w": ("w",), "y": ("j",), "z": ("z",), "zh": ("ʒ",),
}  # fmt: skip

_NO_CONTACT = frozenset("ɸβ")
"""Sounds whose lips come close and do not touch."""


@dataclass(frozen=True)
class Viseme:
    """One viseme of a set."""

    name: str
    """Its name in the set."""

    phones: tuple[str, ...]
    """The speech sounds that have it, in the IPA."""

    spread: float
    """Length of its dominance curve, in durations of the phone."""

    weight: float
    """Height of its dominance curve."""

    alpha: float
    """Steepness of its dominance curve; 0 is a triangle."""

    shape: Mapping[str, float]
    """What it is mixed of: weights of `MOUTH_SHAPES`, 0…1."""

    contact: bool
    """Whether lips or teeth touch, whatever comes before and after."""


@dataclass(frozen=True)
class SoundingViseme:
    """A viseme within a phone."""

    viseme: Viseme

    share: float
    """Its share of the phone's time, 0…1; those of a phone sum to 1."""

    vowel: bool
    """Whether it is that of a vowel."""

    contact: bool
    """Whether lips or teeth are to touch."""


class VisemeSet:
    """A set of visemes; it knows the visemes of every symbol of the phonetic alphabet."""

    def __init__(self, name: str, visemes: tuple[Viseme, ...]) -> None:
        self.name = name
        self.visemes = visemes
        self._of_phone = {phone: viseme for viseme in visemes for phone in viseme.phones}
        self._letters = [phone for phone in self._of_phone if phone in SEGMENTS]
        self._known: dict[str, tuple[SoundingViseme, ...]] = {}

    @property
    def silence(self) -> Viseme:
        """The viseme of pauses."""
        return self.visemes[0]

    def of(self, symbol: str) -> tuple[SoundingViseme, ...]:
        """Return the visemes of a phone in turn; none for a symbol without a known letter.

        >>> [each.viseme.name for each in viseme_set("oculus").of("aɪ")]
        ['aa', 'I']
        """
        if symbol not in self._known:
            self._known[symbol] = self._find(symbol)
        return self._known[symbol]

    def _find(self, symbol: str) -> tuple[SoundingViseme, ...]:
        parts = parts_of(symbol)
        joined = "".join(letter for letter, _ in parts)
        if len(parts) > 1 and joined in self._of_phone:
            parts = ((joined, 1.0),)
        sounding = []
        for phone, share in parts:
            vowel = SEGMENTS[phone[0]].vowel
            viseme = self._of_phone.get(phone) or self._of_phone[most_alike(phone, self._letters)]
            contact = viseme.contact and phone not in _NO_CONTACT
            sounding.append(SoundingViseme(viseme, share, vowel, contact))
        return tuple(sounding)


@cache
def viseme_sets() -> Mapping[str, VisemeSet]:
    """Return every set by its name."""
    data = bundled(Path(__file__).with_name("sets.toml"))
    return {
        each["name"]: VisemeSet(each["name"], tuple(_viseme(row) for row in each["visemes"]))
        for each in data["set"]
    }


def viseme_set(name: str) -> VisemeSet:
    """Return a set of visemes.

    Raises
    ------
    CharacterError
        There is none of that name.
    """
    sets = viseme_sets()
    if name not in sets:
        raise CharacterError(f"no set of visemes is called {name!r}; there are {', '.join(sets)}")
    return sets[name]


def _viseme(row: Mapping[str, Any]) -> Viseme:
    phones = [ipa for arpabet in row["phones"].split() for ipa in _IPA_OF_ARPABET[arpabet]]
    return Viseme(
        row["name"],
        tuple(dict.fromkeys(phones)),
        row.get("spread", 5.0),
        row.get("weight", 1.0),
        row.get("alpha", 1.0),
        row.get("shape", {row["name"]: 1.0}),
        row.get("contact", False),
    )
