"""Which joint is which part of a body: the common language of two skeletons.

Parts are called as in VRM 1.0's humanoid ("leftUpperLeg"); a quadruped's hind legs and trunk are
called like a person's legs and trunk, its front legs "leftFrontUpperLeg" and so on, its tail
"tail1", "tail2" …. What a file or a person says goes first; names and the shape of the tree tell
the rest.
"""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from characters.errors import CharacterError
from characters.skeleton.limbs import find_parts
from characters.skeleton.pose import Skeleton

Kind = Literal["humanoid", "quadruped", "other"]

SIDES = ("left", "right")
"""Both sides, as the names of parts begin."""

_TRUNK = ("hips", "spine", "chest", "upperChest", "neck", "head", "jaw")
_SIDED = (
    *("Eye", "Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes"),
    *(f"Front{part}" for part in ("Shoulder", "UpperLeg", "LowerLeg", "Foot", "Toes")),
    *(f"Thumb{part}" for part in ("Metacarpal", "Proximal", "Distal")),
    *(
        f"{finger}{part}"
        for finger in ("Index", "Middle", "Ring", "Little")
        for part in ("Proximal", "Intermediate", "Distal")
    ),
)

PARTS = (
    *_TRUNK,
    *(side + part for side in SIDES for part in _SIDED),
    *(f"tail{number}" for number in range(1, 33)),
)
"""Every name of a part."""

_LEGS = tuple(side + part for side in SIDES for part in ("UpperLeg", "LowerLeg", "Foot"))
_ARMS = tuple(side + part for side in SIDES for part in ("UpperArm", "LowerArm", "Hand"))
_FORELEGS = tuple(
    side + part for side in SIDES for part in ("FrontUpperLeg", "FrontLowerLeg", "FrontFoot")
)
_NEEDED: dict[Kind, tuple[str, ...]] = {
    "humanoid": ("hips", "spine", "head", *_LEGS, *_ARMS),
    "quadruped": ("hips", "spine", "head", *_LEGS, *_FORELEGS),
    "other": (),
}


@dataclass(frozen=True)
class Anatomy:
    """Which joint of a skeleton is which part of a body."""

    kind: Kind
    """What kind of body it is."""

    joints: Mapping[str, int]
    """Joint number by part, one of `PARTS`."""

    told: frozenset[str] = field(default=frozenset())
    """Parts that were said, not guessed."""

    @staticmethod
    def guess(skeleton: Skeleton, semantics: Mapping[str, str] | None = None) -> "Anatomy":
        """Return the anatomy of a skeleton.

        Parameters
        ----------
        skeleton
            Whose names, tree and rest pose are looked at.
        semantics
            Names of joints by part, where they are known; they go before any guess. An empty
            name says that the body has no such part.

        Raises
        ------
        CharacterError
            If the semantics name a part or a joint that there is not.

        >>> from characters import Character
        >>> anatomy = Anatomy.guess(Character.load("human").skeleton)
        >>> anatomy.kind, anatomy.missing
        ('humanoid', ())
        """
        told = dict(semantics or {})
        known = {part: _told_joint(part, name, skeleton) for part, name in told.items()}
        fixed = {part: joint for part, joint in known.items() if joint is not None}
        guessed = find_parts(skeleton, fixed)
        joints = {
            part: joint
            for part, joint in guessed.items()
            if part not in known and joint not in fixed.values()
        } | fixed
        ordered = {part: joints[part] for part in PARTS if part in joints}
        return Anatomy(_kind(ordered), ordered, frozenset(fixed))

    def joint(self, part: str) -> int | None:
        """Return the number of the joint that is a part, or None if there is none."""
        return self.joints.get(part)

    @cached_property
    def missing(self) -> tuple[str, ...]:
        """Parts that a body of its kind should have and that were not found."""
        return tuple(part for part in _NEEDED[self.kind] if part not in self.joints)

    @cached_property
    def parts(self) -> Mapping[int, str]:
        """Part by joint number."""
        return {joint: part for part, joint in self.joints.items()}

    @property
    def feet(self) -> tuple[int, ...]:
        """Joints of the feet, left before right, hind before front."""
        names = ("leftFoot", "rightFoot", "leftFrontFoot", "rightFrontFoot")
        return tuple(self.joints[name] for name in names if name in self.joints)


def _kind(joints: Mapping[str, int]) -> Kind:
    if any(part in joints for part in _FORELEGS):
        return "quadruped"
    legs = all(part in joints for part in ("hips", "leftUpperLeg", "rightUpperLeg"))
    upper = any(part in joints for part in ("spine", "head", *_ARMS))
    return "humanoid" if legs and upper else "other"


def _told_joint(part: str, name: str, skeleton: Skeleton) -> int | None:
    """Return the joint that is said to be a part; refuse what there is not."""
    if part not in PARTS:
        raise CharacterError(
            f"joints: no part of a body is called {part!r}{_near(part, PARTS)}; parts are called "
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
