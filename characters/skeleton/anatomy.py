"""Which joint of a skeleton is which part of a body.

Parts are named as in VRM 1.0's humanoid ("leftUpperLeg"). A quadruped's hind legs and trunk have
the names of a person's legs and trunk, its front legs are "leftFrontUpperLeg" and so on, its tail
is "tail1", "tail2" ….
"""

import difflib
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.body_parts.joint_words import SIDES as SIDES
from cubeling.characters.skeleton.body_parts.parts import find_parts
from cubeling.characters.skeleton.pose import Skeleton

Kind = Literal["humanoid", "quadruped", "other"]

_TRUNK_PARTS = ("hips", "spine", "chest", "upperChest", "neck", "head", "jaw")
_SIDED_PARTS = (
    *("Eye", "Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes"),
    *(f"Front{part}" for part in ("Shoulder", "UpperLeg", "LowerLeg", "Foot", "Toes")),
    *(f"Thumb{part}" for part in ("Metacarpal", "Proximal", "Distal")),
    *(
        f"{finger}{part}"
        for finger in ("Index", "Middle", "Ring", "Little")
        for part in ("Proximal", "Intermediate", "Distal")
    ),
)

BODY_PARTS = (
    *_TRUNK_PARTS,
    *(side + part for side in SIDES for part in _SIDED_PARTS),
    *(f"tail{number}" for number in range(1, 33)),
)
"""Names of the parts that `Anatomy` looks for."""

_LEG_PARTS = tuple(side + part for side in SIDES for part in ("UpperLeg", "LowerLeg", "Foot"))
_ARM_PARTS = tuple(side + part for side in SIDES for part in ("UpperArm", "LowerArm", "Hand"))
_FORELEG_PARTS = tuple(
    side + part for side in SIDES for part in ("FrontUpperLeg", "FrontLowerLeg", "FrontFoot")
)
_NEEDED_PARTS: dict[Kind, tuple[str, ...]] = {
    "humanoid": ("hips", "spine", "head", *_LEG_PARTS, *_ARM_PARTS),
    "quadruped": ("hips", "spine", "head", *_LEG_PARTS, *_FORELEG_PARTS),
    "other": (),
}


@dataclass(frozen=True)
class Anatomy:
    """Which joint of a skeleton is which part of a body."""

    kind: Kind
    """The kind of body."""

    joints: Mapping[str, int]
    """Joint number by part, one of `BODY_PARTS`."""

    @staticmethod
    def guess(skeleton: Skeleton, semantics: Mapping[str, str] | None = None) -> "Anatomy":
        """Return the anatomy of a skeleton.

        Parameters
        ----------
        skeleton
            Its joint names, hierarchy and rest pose are examined.
        semantics
            Declared joint names by part; they have priority over guesses. An empty name declares
            that the body has no such part.

        Raises
        ------
        CharacterError
            If the semantics name an unknown part or joint.

        >>> from cubeling.characters import Character
        >>> anatomy = Anatomy.guess(Character.load("human").skeleton)
        >>> anatomy.kind, anatomy.missing
        ('humanoid', ())
        """
        if semantics:
            return _guess(skeleton, semantics)
        for guessed, anatomy in tuple(
            _GUESSED
        ):  # every clip of a character asks for its feet again
            if guessed is skeleton:
                return anatomy
        _GUESSED.append((skeleton, _guess(skeleton, {})))
        return _GUESSED[-1][1]

    def joint(self, part: str) -> int | None:
        """Return the joint number of a part, or None if there is none."""
        return self.joints.get(part)

    @cached_property
    def missing(self) -> tuple[str, ...]:
        """Parts that a body of this kind should have and that were not found."""
        return tuple(part for part in _NEEDED_PARTS[self.kind] if part not in self.joints)

    @cached_property
    def parts(self) -> Mapping[int, str]:
        """Part by joint number."""
        return {joint: part for part, joint in self.joints.items()}

    @property
    def feet(self) -> tuple[int, ...]:
        """Joints of the feet, left before right, hind before front."""
        names = ("leftFoot", "rightFoot", "leftFrontFoot", "rightFrontFoot")
        return tuple(self.joints[name] for name in names if name in self.joints)


def _guess(skeleton: Skeleton, semantics: Mapping[str, str]) -> Anatomy:
    known = {part: _declared_joint(part, name, skeleton) for part, name in semantics.items()}
    fixed = {part: joint for part, joint in known.items() if joint is not None}
    guessed = find_parts(skeleton, fixed)
    joints = {
        part: joint
        for part, joint in guessed.items()
        if part not in known and joint not in fixed.values()
    } | fixed
    ordered = {part: joints[part] for part in BODY_PARTS if part in joints}
    return Anatomy(_kind(ordered), ordered)


_GUESSED: deque[tuple[Skeleton, Anatomy]] = deque(maxlen=8)
"""The last guesses, for as many skeletons as a session has at a time."""


def _kind(joints: Mapping[str, int]) -> Kind:
    if any(part in joints for part in _FORELEG_PARTS):
        return "quadruped"
    legs = all(part in joints for part in ("hips", "leftUpperLeg", "rightUpperLeg"))
    upper = any(part in joints for part in ("spine", "head", *_ARM_PARTS))
    return "humanoid" if legs and upper else "other"


def _declared_joint(part: str, name: str, skeleton: Skeleton) -> int | None:
    """Return the joint that is declared as a part; refuse unknown parts and joints."""
    if part not in BODY_PARTS:
        raise CharacterError(
            f"joints: no body part is named {part!r}{_near(part, BODY_PARTS)}; parts are named "
            "as in VRM 1.0, see docs/your-own-character.md"
        )
    if not name:
        return None
    if name not in skeleton.names:
        raise CharacterError(
            f"joints: {part} = {name!r}, but the skeleton has no such joint"
            f"{_near(name, skeleton.names)}; it has {_some(skeleton.names)}"
        )
    return skeleton.names.index(name)


def _near(name: str, names: tuple[str, ...]) -> str:
    near = difflib.get_close_matches(name, names, 1)
    return f" (do you mean {near[0]!r}?)" if near else ""


def _some(names: tuple[str, ...], most: int = 12) -> str:
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
