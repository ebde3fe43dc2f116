"""The words of which the names of joints consist, and how well they fit the parts of a body."""


def _words(line: str) -> frozenset[str]:
    return frozenset(line.split())


SIDES = ("left", "right")
"""Both sides, as part names begin."""

SIDE_OF = dict.fromkeys(
    ("left", "l", "lft", "gauche", "links", "izquierda", "izquierdo", "sinistra", "esquerda"),
    "left",
) | dict.fromkeys(
    ("right", "r", "rt", "rgt", "droite", "rechts", "derecha", "derecho", "destra", "direita"),
    "right",
)
"""Side by the word or letter in a joint's name."""

FILLER_WORDS = _words(
    "mixamorig bip bip01 bone bones b j jnt joint jt armature skeleton def c center centre m x "
    "valve valvebiped biped character rig sk humanoid bn cc base bend bind skin deform stretch h"
)
"""Words that say nothing about a part."""

JOINED_FILLERS = ("jnt", "joint", "bone")
"""Those of them that are also written in one with the part."""

AUXILIARY_WORDS = _words(
    "end nub site ik fk pole target twist roll helper socket prop weapon ctrl control "
    "effector mch sec adj offset mesh geo hair skirt bust breast cloth top lid eyelid brow "
    "eyebrow lash corner in inhand vis tweak platform footsteps part share pad heel tip "
    "wing ear horn antenna feather fin whisker beard mane ribbon cape cloak scarf"
)
"""Words of helper joints, as ends, twists and IK targets, and of what is no limb."""

END_WORDS = _words("end nub site tip")
"""Those of the end of a bone."""

FRONT_WORDS = _words("front fore")
"""Words of an animal's front legs."""

HIND_WORDS = _words("back hind rear")
"""Words of an animal's hind legs."""

FRONT_CORNERS = _words("lf rf fl fr")
"""Two letters for the side and the row of a front leg: "FL", "lf"."""

HIND_CORNERS = _words("lb rb bl br lh rh hl hr rr")
"""The same of a hind leg: "RB", "hl"."""

REAR_LEFT = _words("rl lr")
"""The same of a hind leg, but only beside others: it may mean anything else."""

LEFT_CORNERS = _words("lb bl lh hl rl lr lf fl")
"""Those of the left side."""

UPPER_LOWER = _words("lu ru lf rf")
"""Two letters for a side and the beginning of a word: "LUArm", "LFArm"."""

JAPANESE = {
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
"""Words of Japanese models in English, the longer first: a foot is also the first letter of an
ankle."""

LEG_ROLES = ("UpperLeg", "LowerLeg", "Foot", "Toes")
"""Joints of a leg from the hip down."""

ARM_ROLES = ("Shoulder", "UpperArm", "LowerArm", "Hand")
"""Joints of an arm from the collarbone down."""

FINGER_OF = {
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
"""Finger, named as in VRM, by word."""

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


LEG_FIT = _by_word(_LEG_WORDS)
"""How well a word fits each of `LEG_ROLES`."""

ARM_FIT = _by_word(_ARM_WORDS)
"""How well a word fits each of `ARM_ROLES`."""

HINDLEG_FIT = LEG_FIT | _by_word(_ANIMAL_LEG_WORDS)
"""How well a word fits each of `LEG_ROLES` of an animal."""

FORELEG_FIT = HINDLEG_FIT | _by_word(_FORELEG_WORDS)
"""How well a word fits each of `LEG_ROLES` of an animal's front leg."""

LEG_ROLE_OF_ARM = dict(zip(ARM_ROLES, ("Shoulder", *LEG_ROLES), strict=False))
"""Role in a front leg by role in an arm."""

TRUNK_OF = {word: part for words, part in _TRUNK_WORDS.items() for word in words.split()}
"""Part of the trunk or head by word."""

LIMB_WORDS = frozenset({*ARM_FIT, *FORELEG_FIT})
"""Words for parts of limbs."""

KNOWN_WORDS = frozenset({*LIMB_WORDS, *TRUNK_OF, *FINGER_OF, "hipjoint", "fingers", "armdigit"})
"""Words for any part."""
