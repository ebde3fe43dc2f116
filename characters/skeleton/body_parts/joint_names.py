"""Side and body part that are encoded in a joint's name.

A name ("mixamorig:LeftUpLeg", "thigh.L", "lfemur", "Bip01 L Thigh", "BackUpLeg.L", "左ひざ") is
split into words; sides, prefixes and numbers are removed; the rest is looked up. A word that is
unknown makes the name a guess: "Head_Hat" is a head only if nothing else is.
"""

import re
import unicodedata
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from cubeling.characters.skeleton.body_parts.joint_words import (
    ARM_FIT,
    AUXILIARY_WORDS,
    END_WORDS,
    FILLER_WORDS,
    FINGER_OF,
    FORELEG_FIT,
    FRONT_CORNERS,
    FRONT_WORDS,
    HIND_CORNERS,
    HIND_WORDS,
    HINDLEG_FIT,
    JAPANESE,
    JOINED_FILLERS,
    KNOWN_WORDS,
    LEFT_CORNERS,
    LEG_FIT,
    LEG_ROLE_OF_ARM,
    LIMB_WORDS,
    REAR_LEFT,
    SIDE_OF,
    TRUNK_OF,
    UPPER_LOWER,
)

_NAME_WORD = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")
_VERTEBRA = re.compile(r"(?i)v?([ltsc])\d+")  # "L5" and "vl5" are lumbar, "vc7" is cervical
_UNKNOWN_WORD_FIT = 0.7  # of a name with unknown words, relative to one of known words
_COMMON_SHARE = 0.8  # of the joints: a word in more names than that says nothing
_MIN_COMMON = 6  # joints; of fewer, a word may be in all names and still say something


@dataclass(frozen=True)
class JointName:
    """What the name of a joint encodes."""

    word: str
    """The part in lower case, such as "upperleg"; "" if none."""

    side: str = ""
    """"left", "right", or "" if the name has no side."""

    front: bool = False
    """Whether the name says front leg."""

    hind: bool = False
    """Whether the name says hind leg."""

    auxiliary: bool = False
    """Whether it is a helper joint: an end, a twist, an IK target, hair."""

    end: bool = False
    """Whether it is the end of the bone above it."""

    certainty: float = 1.0
    """How sure the part is, 0…1: less if the name has unknown words too."""

    @property
    def leg(self) -> dict[str, float]:
        """How well it fits each role of a leg; empty if it fits none."""
        return self._fit(LEG_FIT)

    @property
    def arm(self) -> dict[str, float]:
        """How well it fits each role of an arm; empty if it fits none."""
        return self._fit(ARM_FIT)

    @property
    def hindleg(self) -> dict[str, float]:
        """How well it fits each role of an animal's hind leg; empty if it fits none."""
        return {} if self.word == "hand" else self._fit(HINDLEG_FIT)

    @property
    def foreleg(self) -> dict[str, float]:
        """How well it fits each role of a front leg and its shoulder; empty if it fits none."""
        as_arm = {LEG_ROLE_OF_ARM[role]: fit for role, fit in self.arm.items()}
        fit = as_arm | self._fit(FORELEG_FIT)
        return {"Shoulder": 0.2} | fit if self.leg else fit

    def as_end_of_limb(self, role: str) -> float:
        """Return how well it fits a "Foot" or "Hand", even if it is a target of IK."""
        table = LEG_FIT if role == "Foot" else ARM_FIT
        sure = 0.5 if self.auxiliary else 1.0
        return 0.0 if self.end else table.get(self.word, {}).get(role, 0.0) * sure

    @property
    def known(self) -> bool:
        """Whether its word is a part of a body."""
        return self.word in KNOWN_WORDS

    @property
    def trunk(self) -> str:
        """The part of the trunk or head, "" if none."""
        return "" if self.auxiliary else TRUNK_OF.get(self.word, "")

    @property
    def finger(self) -> str:
        """The finger it belongs to, named as in VRM, "" if none."""
        if self.auxiliary:
            return ""
        word = self.word.removeprefix("hand").removeprefix("finger").removesuffix("finger")
        return FINGER_OF.get(re.sub(r"(proximal|intermediate|distal|metacarpal)$", "", word), "")

    def _fit(self, table: dict[str, dict[str, float]]) -> dict[str, float]:
        if self.auxiliary:
            return {}
        return {role: fit * self.certainty for role, fit in table.get(self.word, {}).items()}


def read_names(names: Sequence[str]) -> list[JointName]:
    """Return what the names of all joints of a skeleton encode.

    Words that nearly all of them share, such as the name of the character, are left out.

    >>> names = read_names(["LeftOver_Head", *(f"LeftOver_Foot_{n}" for n in "RABCD")])
    >>> names[0] == JointName("head"), names[1] == JointName("foot", "right")
    (True, True)
    >>> [read_names([name])[0].side for name in ("mixamorig:LeftUpLeg", "lfemur", "FootR")]
    ['left', 'left', 'right']
    >>> read_names(["BackUpLeg.L"]) == [JointName("upleg", "left", hind=True)]
    True
    >>> read_names(["L_legUpper0001_bind_JNT"]) == [JointName("legupper", "left")]
    True
    """
    pieces = _without_frame([list(_pieces(name)) for name in names])
    counts = Counter(word for words in pieces for word in set(words) if word not in SIDE_OF)
    common = frozenset(word for word, count in counts.items() if count >= _enough(names))
    corners = not HIND_CORNERS.isdisjoint(counts)
    return [_read(words, common, corners) for words in pieces]


def _enough(names: Sequence[object]) -> float:
    return max(_COMMON_SHARE * len(names), _MIN_COMMON)


def _without_frame(pieces: list[list[str]]) -> list[tuple[str, ...]]:
    """Return the words of names without those with which nearly all of them begin or end."""
    for end in (0, -1):
        while True:
            counts = Counter(words[end] for words in pieces if len(words) > 1)
            word, count = max(counts.items(), key=lambda item: item[1], default=("", 0))
            if count < _enough(pieces):
                break
            for words in pieces:
                if len(words) > 1 and words[end] == word:
                    del words[end]
    return [tuple(words) for words in pieces]


@cache
def _pieces(name: str) -> tuple[str, ...]:
    """Return the words of a name in lower case, without numbers."""
    own = unicodedata.normalize("NFKC", re.split(r"[:|]", name)[-1])
    vertebra = _VERTEBRA.fullmatch(own)
    if vertebra:
        return ("neck" if vertebra[1].lower() == "c" else "spine",)
    for word, english in JAPANESE.items():
        own = own.replace(word, f" {english} ")
    words = [word.lower() for word in _NAME_WORD.findall(own) if not word.isdigit()]
    return tuple(piece for word in words for piece in _split_joined(word))


@cache
def _read(words: tuple[str, ...], common: frozenset[str], corners: bool) -> JointName:
    words = tuple(word for word in words if word not in common) or words
    words = tuple(piece for word in words for piece in _split_corner(word, corners))
    sides = [SIDE_OF[word] for word in words if word in SIDE_OF]
    rest = [word for word in words if word not in SIDE_OF and word not in FILLER_WORDS]
    part, unknown = _part_of(rest)
    if part != "thumb" and part in FINGER_OF and "metacarpal" in unknown:
        part = "metacarpal"  # the finger begins at the knuckle
    end = not END_WORDS.isdisjoint(unknown)
    auxiliary = not AUXILIARY_WORDS.isdisjoint(unknown) or any(
        word.endswith("twist") for word in unknown
    )
    limb = part in LIMB_WORDS
    front = limb and not FRONT_WORDS.isdisjoint(unknown)
    hind = limb and not HIND_WORDS.isdisjoint(unknown)
    if limb:
        unknown = [word for word in unknown if word not in FRONT_WORDS | HIND_WORDS]
    certain = all(word in KNOWN_WORDS or word in "uf" for word in unknown)
    side = sides[0] if sides else ""
    return JointName(part, side, front, hind, auxiliary, end, 1.0 if certain else _UNKNOWN_WORD_FIT)


def _part_of(words: Sequence[str]) -> tuple[str, list[str]]:
    """Return the part that words name, and the other words; several words may be one part.

    The longest part counts, and of several the last: "neck_head" is the head. Words that name
    nothing are joined, for the fingers.
    """
    for length in range(len(words), 0, -1):
        for start in range(len(words) - length, -1, -1):
            part = "".join(words[start : start + length])
            if part in KNOWN_WORDS:
                return part, [*words[:start], *words[start + length :]]
    return "".join(words), list(words)


def _split_corner(word: str, corners: bool) -> list[str]:
    """Split two letters: of a corner if the names have corners, else of a side and a word."""
    if corners and word in FRONT_CORNERS | HIND_CORNERS | REAR_LEFT:
        side = "left" if word in LEFT_CORNERS else "right"
        return [side, "front" if word in FRONT_CORNERS else "hind"]
    if word in UPPER_LOWER:
        return list(word)
    return [word]


def _split_joined(word: str) -> list[str]:
    """Split a word that joins a side, a row and a part: "lfemur", "leftfoot", "lefthindfoot"."""
    if word in KNOWN_WORDS:
        return [word]
    for filler in JOINED_FILLERS:
        for inner in (word.removeprefix(filler), word.removesuffix(filler)):
            pieces = _split_joined(inner) if inner != word else []
            if not KNOWN_WORDS.isdisjoint(pieces):
                return pieces
    for side in ("left", "right", "l", "r"):
        for inner in (word.removeprefix(side), word.removesuffix(side)):
            if inner != word and (inner in KNOWN_WORDS or len(_split_row(inner)) > 1):
                return [side, *_split_row(inner)]
    return _split_row(word)


def _split_row(word: str) -> list[str]:
    for row in (*FRONT_WORDS, *HIND_WORDS):
        if word.startswith(row) and word[len(row) :] in LIMB_WORDS:
            return [row, word[len(row) :]]
    return [word]
