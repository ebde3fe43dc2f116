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


def _words(line: str) -> frozenset[str]:
    return frozenset(line.split())


_NAME_WORD = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")
_VERTEBRA = re.compile(r"(?i)v?([ltsc])\d+")  # "L5" and "vl5" are lumbar, "vc7" is cervical
_SIDE_OF = {"left": "left", "l": "left", "lft": "left"} | {
    "right": "right",
    "r": "right",
    "rt": "right",
    "rgt": "right",
}
_FILLER_WORDS = _words(
    "mixamorig bip bip01 bone bones b j jnt joint jt armature skeleton def org c center centre m x "
    "valve valvebiped biped character rig sk humanoid bn cc base bend bind skin deform stretch "
    "h"
)
# Helper joints: ends, twists, IK targets, cloth, meshes.
_AUXILIARY_WORDS = _words(
    "end nub site ik fk pole target twist roll helper socket prop weapon ctrl control "
    "effector mch sec adj offset mesh geo hair skirt bust breast cloth top lid eyelid brow "
    "eyebrow lash corner in inhand vis tweak platform footsteps part share pad heel tip"
)
_END_WORDS = _words("end nub site tip")
_FRONT_WORDS, _HIND_WORDS = _words("front fore"), _words("back hind rear")
# Two letters: a corner of an animal ("FL", "lf", "RB"), or a side and a word ("LUArm", "LFArm").
_HIND_CORNERS = _words("lb rb bl br lh rh hl hr rr")
_FRONT_CORNERS = _words("lf rf fl fr")
_UPPER_LOWER = _words("lu ru lf rf")
_LEFT_CORNERS = _words("lb bl lh hl rl lr lf fl")

# Words of Japanese models, longest first: a foot is also the first letter of an ankle.
_JAPANESE = {
    "左": "left",
    "右": "right",
    "下半身": "hipjoint",
    "上半身": "spine",
    "足首": "ankle",
    "手首": "wrist",
    "つま先": "toe",
    "腰キャンセル": "helper",
    "センター": "hips",
    "親指": "thumb",
    "人指": "index",
    "人差指": "index",
    "中指": "middle",
    "薬指": "ring",
    "小指": "little",
    "ひざ": "knee",
    "ひじ": "elbow",
    "捩": "twist",
    "髪": "hair",
    "スカート": "skirt",
    "足": "thigh",
    "腕": "upperarm",
    "肩": "clavicle",
    "首": "neck",
    "頭": "head",
    "目": "eye",
    "先": "end",
}

LEG_ROLES = ("UpperLeg", "LowerLeg", "Foot", "Toes")
"""Joints of a leg from the hip down."""

ARM_ROLES = ("Shoulder", "UpperArm", "LowerArm", "Hand")
"""Joints of an arm from the collarbone down."""

_FINGER_OF = {
    "thumb": "Thumb",
    "index": "Index",
    "pointer": "Index",
    "middle": "Middle",
    "mid": "Middle",
    "ring": "Ring",
    "pinky": "Little",
    "little": "Little",
    "pinkie": "Little",
}

# How well a word fits each role of a limb, 0…1. "Shoulder" is the collarbone in some rigs and the
# upper arm in others; the rest of the limb decides.
_LEG_WORDS: dict[str, dict[str, float]] = {
    "upleg upperleg thigh femur upperthigh legupper legup highleg stifle": {"UpperLeg": 1.0},
    "hip": {"UpperLeg": 0.7},
    "lowerleg lowleg loleg shin calf tibia knee leglower leglow crus gaskin": {"LowerLeg": 1.0},
    "leg": {"UpperLeg": 0.5, "LowerLeg": 0.6, "Foot": 0.3, "Toes": 0.25},
    "foot feet paw hoof": {"Foot": 1.0, "Toes": 0.2},
    "ankle talocrural legankle tarsus hock horselink": {"Foot": 1.1},
    "toe toes toebase toetip ball football metatarsal metatarsals midtarsal phalanges legdigit "
    "fetlock pastern": {"Toes": 1.0},
}
_ARM_WORDS: dict[str, dict[str, float]] = {
    "clavicle clav collar collarbone armcollarbone scapula sternoclavicular": {"Shoulder": 1.0},
    "acromioclavicular": {"Shoulder": 0.9},
    "shoulder shldr": {"Shoulder": 0.9, "UpperArm": 0.7},
    "uparm upperarm uarm humerus armupper armup bicep": {"UpperArm": 1.0},
    "forearm farm lowerarm lowarm loarm elbow radius ulna armlower armlow": {"LowerArm": 1.0},
    "arm": {"Shoulder": 0.2, "UpperArm": 0.6, "LowerArm": 0.45, "Hand": 0.3},
    "wrist radiocarpal carpus": {"Hand": 0.6},
    "metacarpus": {"Hand": 0.3},
    "hand palm armpalm": {"Hand": 1.0},
}
# Animals stand on their toes, so what is named foot may be the toes below a heel.
_ANIMAL_LEG_WORDS: dict[str, dict[str, float]] = {
    "foot feet paw hoof hand": {"Foot": 0.6, "Toes": 0.6},
    "metatarsus metacarpus": {"Foot": 0.5, "Toes": 0.6},
}
# Front legs are named as legs, as arms, or by their own words.
_FORELEG_WORDS: dict[str, dict[str, float]] = {
    "elbow": {"LowerLeg": 0.9},
    "wrist carpus": {"Foot": 0.6},
    "knee": {"LowerLeg": 0.4, "Foot": 0.5},
}
_TRUNK_WORDS: dict[str, str] = {
    "hips hip pelvis lowertorso": "hips",
    "spine lowerback upperback waist abdomen abdomenlower abdomenupper stomach torso body lumbar "
    "uppertorso upperbody": "spine",
    "chest thorax ribcage rib ribs chestlower": "chest",
    "upperchest chestupper": "upperChest",
    "neck lowerneck upperneck necklower neckupper cervical": "neck",
    "head skull skullbase": "head",
    "jaw mandible": "jaw",
    "eye eyeball": "Eye",
    "tail caudal": "tail",
}


def _by_word(table: dict[str, dict[str, float]]) -> dict[str, dict[str, float]]:
    return {word: roles for words, roles in table.items() for word in words.split()}


_LEG_FIT, _ARM_FIT = _by_word(_LEG_WORDS), _by_word(_ARM_WORDS)
_HINDLEG_FIT = _LEG_FIT | _by_word(_ANIMAL_LEG_WORDS)
_FORELEG_FIT = _HINDLEG_FIT | _by_word(_FORELEG_WORDS)
_LEG_ROLE_OF_ARM = dict(zip(ARM_ROLES, ("Shoulder", *LEG_ROLES), strict=False))
_TRUNK_OF = {word: part for words, part in _TRUNK_WORDS.items() for word in words.split()}
_LIMB_WORDS = frozenset({*_ARM_FIT, *_FORELEG_FIT})
_KNOWN_WORDS = frozenset({*_LIMB_WORDS, *_TRUNK_OF, *_FINGER_OF, "hipjoint", "fingers", "armdigit"})
_GUESS = (
    0.7  # how well a name fits if some of its words are unknown, relative to one of known words
)
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
        return self._fit(_LEG_FIT)

    @property
    def arm(self) -> dict[str, float]:
        """How well it fits each role of an arm; empty if it fits none."""
        return self._fit(_ARM_FIT)

    @property
    def hindleg(self) -> dict[str, float]:
        """How well it fits each role of an animal's hind leg; empty if it fits none."""
        return {} if self.word == "hand" else self._fit(_HINDLEG_FIT)

    @property
    def foreleg(self) -> dict[str, float]:
        """How well it fits each role of a front leg and its shoulder; empty if it fits none."""
        as_arm = {_LEG_ROLE_OF_ARM[role]: fit for role, fit in self.arm.items()}
        fit = as_arm | self._fit(_FORELEG_FIT)
        return {"Shoulder": 0.2} | fit if self.leg else fit

    @property
    def foot(self) -> float:
        """How well it fits a foot, 0…1, even if it is the target of inverse kinematics."""
        sure = 0.5 if self.auxiliary else 1.0
        return 0.0 if self.end else _LEG_FIT.get(self.word, {}).get("Foot", 0.0) * sure

    @property
    def known(self) -> bool:
        """Whether its word is a part of a body."""
        return self.word in _KNOWN_WORDS

    @property
    def trunk(self) -> str:
        """The part of the trunk or head, "" if none."""
        return "" if self.auxiliary else _TRUNK_OF.get(self.word, "")

    @property
    def finger(self) -> str:
        """The finger it belongs to, named as in VRM, "" if none."""
        if self.auxiliary:
            return ""
        word = self.word.removeprefix("hand").removeprefix("finger").removesuffix("finger")
        return _FINGER_OF.get(re.sub(r"(proximal|intermediate|distal|metacarpal)$", "", word), "")

    def _fit(self, table: dict[str, dict[str, float]]) -> dict[str, float]:
        if self.auxiliary:
            return {}
        return {role: fit * self.certainty for role, fit in table.get(self.word, {}).items()}


def read_names(names: Sequence[str]) -> list[JointName]:
    """Return what the names of all joints of a skeleton encode.

    Words that nearly all of them share, such as the name of the character, are left out.

    >>> [name.word for name in read_names(["OrcArm_Head", *(f"OrcArm_{n}" for n in "abcde")])][0]
    'head'
    """
    pieces = [tuple(_pieces(name)) for name in names]
    counts = Counter(word for words in pieces for word in set(words) if word not in _SIDE_OF)
    enough = max(_COMMON_SHARE * len(names), _MIN_COMMON)
    common = frozenset(word for word, count in counts.items() if count >= enough)
    corners = not _HIND_CORNERS.isdisjoint(counts)
    return [_read(words, common, corners) for words in pieces]


def read_name(name: str) -> JointName:
    """Return side and part that a joint's name encodes.

    >>> read_name("mixamorig:LeftUpLeg").word, read_name("lfemur").side, read_name("FootR").side
    ('upleg', 'left', 'right')
    >>> read_name("BackUpLeg.L") == JointName("upleg", "left", hind=True)
    True
    >>> read_name("L_legUpper0001_bind_JNT") == JointName("legupper", "left")
    True
    """
    return read_names([name])[0]


@cache
def _pieces(name: str) -> tuple[str, ...]:
    """Return the words of a name in lower case, without numbers."""
    own = unicodedata.normalize("NFKC", re.split(r"[:|]", name)[-1])
    vertebra = _VERTEBRA.fullmatch(own)
    if vertebra:
        return ("neck" if vertebra[1].lower() == "c" else "spine",)
    for word, english in _JAPANESE.items():
        own = own.replace(word, f" {english} ")
    words = [word.lower() for word in _NAME_WORD.findall(own) if not word.isdigit()]
    return tuple(piece for word in words for piece in _split_joined(word))


@cache
def _read(words: tuple[str, ...], common: frozenset[str], corners: bool) -> JointName:
    words = tuple(word for word in words if word not in common) or words
    words = tuple(piece for word in words for piece in _split_corner(word, corners))
    sides = [_SIDE_OF[word] for word in words if word in _SIDE_OF]
    rest = [word for word in words if word not in _SIDE_OF and word not in _FILLER_WORDS]
    part, unknown = _part_of(rest)
    if part != "thumb" and part in _FINGER_OF and "metacarpal" in unknown:
        part = "metacarpal"  # the finger begins at the knuckle
    end = not _END_WORDS.isdisjoint(unknown)
    auxiliary = not _AUXILIARY_WORDS.isdisjoint(unknown) or any(
        word.endswith("twist") for word in unknown
    )
    limb = part in _LIMB_WORDS
    front = limb and not _FRONT_WORDS.isdisjoint(unknown)
    hind = limb and not _HIND_WORDS.isdisjoint(unknown)
    if limb:
        unknown = [word for word in unknown if word not in _FRONT_WORDS | _HIND_WORDS]
    certain = all(word in _KNOWN_WORDS or word in "uf" for word in unknown)
    side = sides[0] if sides else ""
    return JointName(part, side, front, hind, auxiliary, end, 1.0 if certain else _GUESS)


def _part_of(words: Sequence[str]) -> tuple[str, list[str]]:
    """Return the part that words name, and the other words; several words may be one part.

    The longest part counts, and of several the last: "neck_head" is the head. Words that name
    nothing are joined, for the fingers.
    """
    for length in range(len(words), 0, -1):
        for start in range(len(words) - length, -1, -1):
            part = "".join(words[start : start + length])
            if part in _KNOWN_WORDS:
                return part, [*words[:start], *words[start + length :]]
    return "".join(words), list(words)


def _split_corner(word: str, corners: bool) -> list[str]:
    """Split two letters: of a corner if the names have corners, else of a side and a word."""
    if corners and word in _FRONT_CORNERS | _HIND_CORNERS | {"rl", "lr"}:
        side = "left" if word in _LEFT_CORNERS else "right"
        return [side, "front" if word in _FRONT_CORNERS else "hind"]
    if word in _UPPER_LOWER:
        return list(word)
    return [word]


def _split_joined(word: str) -> list[str]:
    """Split a word that joins a side, a row and a part: "lfemur", "leftfoot", "lefthindfoot"."""
    if word in _KNOWN_WORDS:
        return [word]
    for side in ("left", "right", "l", "r"):
        for inner in (word.removeprefix(side), word.removesuffix(side)):
            if inner != word and (inner in _KNOWN_WORDS or len(_split_row(inner)) > 1):
                return [side, *_split_row(inner)]
    return _split_row(word)


def _split_row(word: str) -> list[str]:
    for row in (*_FRONT_WORDS, *_HIND_WORDS):
        if word.startswith(row) and word[len(row) :] in _LIMB_WORDS:
            return [row, word[len(row) :]]
    return [word]
