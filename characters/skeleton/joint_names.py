"""Side and body part that are encoded in a joint's name.

A name ("mixamorig:LeftUpLeg", "thigh.L", "lfemur", "Bip01 L Thigh", "BackUpLeg.L") is split into
words; sides, prefixes and numbers are removed; the rest is looked up.
"""

import re
from dataclasses import dataclass
from functools import cache


def _words(line: str) -> frozenset[str]:
    return frozenset(line.split())


_NAME_WORD = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")
_SIDE_OF = {"left": "left", "l": "left", "right": "right", "r": "right"}
_FILLER_WORDS = _words(
    "mixamorig bip bip01 bone bones b j jnt joint jt armature skeleton def org c center centre m "
    "valve valvebiped biped character rig sk humanoid bn cc base bend"
)
# Helper joints: ends, twists, IK targets, cloth, meshes.
_AUXILIARY_WORDS = _words(
    "end nub site tip ik fk pole target twist roll helper socket prop weapon ctrl control "
    "effector mch sec adj offset mesh geo hair skirt bust breast cloth top lid eyelid brow "
    "eyebrow lash corner inhand vis tweak"
)
_FRONT_WORDS, _HIND_WORDS = frozenset({"front", "fore"}), frozenset({"back", "hind", "rear"})

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
    "upleg upperleg thigh femur upperthigh legupper legup": {"UpperLeg": 1.0},
    "hip": {"UpperLeg": 0.7},
    "lowerleg lowleg shin calf knee tibia leglower leglow crus": {"LowerLeg": 1.0},
    "leg": {"UpperLeg": 0.5, "LowerLeg": 0.6, "Foot": 0.3, "Toes": 0.25},
    "foot paw hoof": {"Foot": 1.0, "Toes": 0.2},
    "ankle talocrural": {"Foot": 0.9},
    "toe toes toebase ball football metatarsal midtarsal": {"Toes": 1.0},
}
_ARM_WORDS: dict[str, dict[str, float]] = {
    "clavicle collar collarbone scapula sternoclavicular": {"Shoulder": 1.0},
    "acromioclavicular": {"Shoulder": 0.9},
    "shoulder shldr": {"Shoulder": 0.9, "UpperArm": 0.7},
    "uparm upperarm humerus armupper armup bicep": {"UpperArm": 1.0},
    "forearm lowerarm lowarm elbow radius ulna armlower armlow": {"LowerArm": 1.0},
    "arm": {"Shoulder": 0.2, "UpperArm": 0.6, "LowerArm": 0.45, "Hand": 0.3},
    "wrist radiocarpal": {"Hand": 0.6},
    "hand palm": {"Hand": 1.0},
}
_TRUNK_WORDS: dict[str, str] = {
    "hips hip pelvis": "hips",
    "spine lowerback upperback waist abdomen abdomenlower abdomenupper stomach torso body": "spine",
    "chest thorax ribcage rib chestlower": "chest",
    "upperchest chestupper": "upperChest",
    "neck lowerneck upperneck necklower neckupper": "neck",
    "head skull skullbase": "head",
    "jaw mandible": "jaw",
    "eye eyeball": "Eye",
    "tail": "tail",
}


def _by_word(table: dict[str, dict[str, float]]) -> dict[str, dict[str, float]]:
    return {word: roles for words, roles in table.items() for word in words.split()}


LEG_FIT = _by_word(_LEG_WORDS)
"""How well a word fits each of `LEG_ROLES`, 0…1."""

ARM_FIT = _by_word(_ARM_WORDS)
"""How well a word fits each of `ARM_ROLES`, 0…1."""

_TRUNK_OF = {word: part for words, part in _TRUNK_WORDS.items() for word in words.split()}
_KNOWN_WORDS = frozenset({*LEG_FIT, *ARM_FIT, *_TRUNK_OF, *_FINGER_OF, "hipjoint", "fingers"})


@dataclass(frozen=True)
class JointName:
    """What the name of a joint encodes."""

    word: str
    """The part in lower case, such as "upperleg"; "" if none."""

    side: str = ""
    """"left", "right", or "" if the name has no side."""

    front: bool = False
    """Whether the name says front leg."""

    auxiliary: bool = False
    """Whether it is a helper joint: an end, a twist, an IK target, hair."""

    @property
    def leg(self) -> dict[str, float]:
        """How well it fits each role of a leg, 0…1; empty if it fits none."""
        return {} if self.auxiliary else LEG_FIT.get(self.word, {})

    @property
    def arm(self) -> dict[str, float]:
        """How well it fits each role of an arm, 0…1; empty if it fits none."""
        return {} if self.auxiliary else ARM_FIT.get(self.word, {})

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


@cache
def read_name(name: str) -> JointName:
    """Return side and part that a joint's name encodes.

    >>> read_name("mixamorig:LeftUpLeg").word, read_name("lfemur").side, read_name("FootR").side
    ('upleg', 'left', 'right')
    >>> read_name("BackUpLeg.L") == JointName("upleg", "left")
    True
    """
    own = re.split(r"[:|]", name)[-1]
    words = [word.lower() for word in _NAME_WORD.findall(own) if not word.isdigit()]
    words = [piece for word in words for piece in _split_side(word)]
    sides = [_SIDE_OF[word] for word in words if word in _SIDE_OF]
    auxiliary = not _AUXILIARY_WORDS.isdisjoint(words)
    rest = [word for word in words if word not in _SIDE_OF and word not in _FILLER_WORDS]
    front = False
    if len(rest) > 1 and "".join(rest) not in _KNOWN_WORDS and "".join(rest[1:]) in _KNOWN_WORDS:
        # "BackLeg" is a hind leg, but "Back" alone and "ForeArm" are not.
        front = rest[0] in _FRONT_WORDS
        rest = rest[1:] if front or rest[0] in _HIND_WORDS else rest
    return JointName("".join(rest), sides[0] if sides else "", front, auxiliary)


def _split_side(word: str) -> list[str]:
    """Split a word that joins a side and a part: "lfemur", "leftfoot", "footr"."""
    for side in ("left", "right", "l", "r"):
        inner = word.removeprefix(side)
        if inner == word:
            inner = word.removesuffix(side)
        if inner != word and inner in _KNOWN_WORDS and word not in _KNOWN_WORDS:
            return [side, inner]
    for pair in ("front", "hind", "back"):
        if word.startswith(pair) and word[len(pair) :] in _KNOWN_WORDS:
            return [pair, word[len(pair) :]]
    return [word]
