"""The body of MPEG-4: the joints of H-ANIM 1.1, and their body animation parameters (BAPs).

Sources: ISO/IEC 14496-2, annex C, for the 186 parameters and their order; the axis of each is that
of Greta (Huang 2013, chapter 8): x to the left, y up, z forward, right-handed. A joint's rotation
is Rz Ry Rx (Huang 2013, equation 13.0.7). At rest the body stands with hanging arms.
"""

from functools import cache

import numpy as np

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Pose, Skeleton

BAP_COUNT = 296
"""Parameters of a frame: 186 of the standard's bodies, and 110 for extensions, which stay 0."""

ROOT = "HumanoidRoot"
"""The joint that carries the body."""

VERTEBRAE = (
    *(f"vc{number}" for number in range(1, 8)),
    *(f"vt{number}" for number in range(1, 13)),
    *(f"vl{number}" for number in range(1, 6)),
)
"""The joints of the trunk and neck, from the head down."""

FINGERS = ("pinky", "ring", "middle", "index")
"""The fingers without the thumb, in the standard's order."""

# Of one side in the standard's order: joint, parameter, axis.
_LIMBS = """hip flexion x, hip abduct z, hip twisting y, knee flexion x, knee twisting y,
    ankle flexion x, ankle twisting y, subtalar flexion z, midtarsal twisting z,
    metatarsal flexion x, sternoclavicular abduct z, sternoclavicular rotate y,
    acromioclavicular abduct z, acromioclavicular rotate y, shoulder flexion x, shoulder abduct z,
    shoulder twisting y, elbow flexion x, elbow twisting y, wrist flexion z, wrist pivot x,
    wrist twisting y"""
_FINGER = "0 flexion z, 1 flexion z, 1 pivot x, 1 twisting y, 2 flexion z, 3 flexion z"
_THUMB = "1 flexion x, 1 pivot y, 1 twisting z, 2 flexion x, 3 flexion x"
_TRUNK = "roll z, torsion y, tilt x"

# Joint, its parent, and the offset from it [m], of a person of 1.75 m; the left side.
_LEFT = """hip sacroiliac 0.09 -0.06 0.0, knee hip 0 -0.42 0, ankle knee 0 -0.41 0,
    subtalar ankle 0 0 0, midtarsal subtalar 0 -0.06 0.07, metatarsal midtarsal 0 0 0.06,
    sternoclavicular vt1 0.03 0.0 0.0, acromioclavicular sternoclavicular 0.13 0 0,
    shoulder acromioclavicular 0.03 0 0, elbow shoulder 0 -0.3 0, wrist elbow 0 -0.26 0"""
_FINGER_Z_M = {"pinky": -0.03, "ring": -0.01, "middle": 0.01, "index": 0.03}
_HIPS_HEIGHT_M = 1.0
_VERTEBRA_M = {"vc": 0.017, "vt": 0.023, "vl": 0.035}

_PART_OF = {"Shoulder": "sternoclavicular", "UpperArm": "shoulder", "LowerArm": "elbow",
            "Hand": "wrist", "UpperLeg": "hip", "LowerLeg": "knee", "Foot": "ankle",
            "Toes": "metatarsal", "ThumbMetacarpal": "thumb1", "ThumbProximal": "thumb2",
            "ThumbDistal": "thumb3"}  # fmt: skip
_TRUNK_PARTS = {"hips": ROOT, "spine": "vl5", "chest": "vt12", "upperChest": "vt6", "neck": "vc7",
                "head": "skullbase"}  # fmt: skip


@cache
def parameters() -> tuple[tuple[str, str], ...]:
    """Return joint and axis ("x", "y", "z") of parameters 1 to 186; "X", "Y", "Z" are offsets.

    >>> len(parameters()), parameters()[37], parameters()[180]
    (186, ('l_elbow', 'x'), ('HumanoidRoot', 'Y'))
    """
    trunk = [row.split()[1] for row in _TRUNK.split(",")]
    found = [("sacroiliac", axis) for axis in reversed(trunk)]
    found += [
        (f"{side}_{joint}", axis)
        for joint, _, axis in map(str.split, _LIMBS.split(","))
        for side in "lr"
    ]
    found += [(joint, axis) for joint in ("skullbase", *VERTEBRAE) for axis in trunk]
    for finger, rows in (*((name, _FINGER) for name in FINGERS), ("thumb", _THUMB)):
        found += [
            (f"{side}_{finger}{number}", axis)
            for number, _, axis in map(str.split, rows.split(","))
            for side in "lr"
        ]
    return (*found, *((ROOT, axis) for axis in "YXZyzx"))


@cache
def hanim_skeleton() -> Skeleton:
    """Return the skeleton of a person of 1.75 m with every joint that has parameters."""
    joints: dict[str, tuple[str, tuple[float, float, float]]] = {
        ROOT: ("", (0.0, _HIPS_HEIGHT_M, 0.0)),
        "sacroiliac": (ROOT, (0.0, 0.0, 0.0)),
    }
    below = ROOT
    for name in reversed(VERTEBRAE):
        joints[name] = below, (0.0, _VERTEBRA_M[name[:2]], 0.0)
        below = name
    joints["skullbase"] = below, (0.0, 0.03, 0.0)
    for side, sign in (("l", 1.0), ("r", -1.0)):
        for row in _LEFT.split(","):
            name, parent, x, y, z = row.split()
            above = parent if parent in joints else f"{side}_{parent}"
            joints[f"{side}_{name}"] = above, (sign * float(x), float(y), float(z))
        for finger in FINGERS:
            above = f"{side}_wrist"
            for number, length in enumerate((0.02, 0.07, 0.04, 0.025)):
                across = _FINGER_Z_M[finger] if number == 0 else 0.0
                joints[f"{side}_{finger}{number}"] = above, (0.0, -length, across)
                above = f"{side}_{finger}{number}"
        for number, offset in enumerate(
            ((0.0, -0.02, 0.03), (0.0, -0.03, 0.02), (0.0, -0.03, 0.0))
        ):
            above = f"{side}_wrist" if number == 0 else f"{side}_thumb{number}"
            joints[f"{side}_thumb{number + 1}"] = above, offset
    names = (*joints,)
    parents = tuple(names.index(parent) if parent else -1 for parent, _ in joints.values())
    rest = Pose(
        np.array([offset for _, offset in joints.values()]),
        np.tile(rotations.IDENTITY, (len(names), 1)),
    )
    return Skeleton(names, parents, rest)


@cache
def hanim_anatomy() -> Anatomy:
    """Return the body parts of `hanim_skeleton`."""
    parts = dict(_TRUNK_PARTS)
    for side in SIDES:
        names = dict(_PART_OF)
        for finger in FINGERS:
            own = "Little" if finger == "pinky" else finger.capitalize()
            phalanges = enumerate(("Proximal", "Intermediate", "Distal"), 1)
            names |= {f"{own}{phalanx}": f"{finger}{number}" for number, phalanx in phalanges}
        parts |= {side + part: f"{side[0]}_{joint}" for part, joint in names.items()}
    return Anatomy.guess(hanim_skeleton(), parts)
