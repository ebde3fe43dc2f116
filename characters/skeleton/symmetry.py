"""Left and right partners of joints and names."""

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.joint_chains import children_of
from cubeling.characters.skeleton.pose import Array, Skeleton

REFLECTION = np.array([-1.0, 1.0, 1.0])
"""Factors of a position that is mirrored about x = 0."""

_MAX_ASYMMETRY = 0.25  # median distance from symmetry over the distance from left to right
# Penalties for names that do not match, in body sizes: another name, another number.
_NAME_PENALTY, _NUMBER_PENALTY = 0.1, 0.01
# "lhipjoint" and "rhipjoint" lie at one place, where each could also be its own partner.
_OWN_PARTNER_PENALTY = 1e-6
# "LeftFoot", "foot_l", "Foot.R.001", "FootL": a word, or a letter that is alone or ends a word.
_SIDE_IN_NAME = re.compile(
    r"[Ll]eft|LEFT|[Rr]ight|RIGHT|(?<![A-Za-z])[LRlr](?![A-Za-z])|(?<=[a-z])[LR](?![a-z])"
)
_OTHER_SIDE_OF = {"left": "right", "Left": "Right", "LEFT": "RIGHT", "l": "r", "L": "R"}
_OTHER_SIDE_OF |= {right: left for left, right in _OTHER_SIDE_OF.items()}


def paired_joints(
    skeleton: Skeleton, positions: Array, pairs: Mapping[str, str]
) -> NDArray[np.intp]:
    """Return the partner of each joint on the other side; joints in the middle are their own.

    Partners are matched from the roots down, so the children of partners are partners. `pairs`
    are given partners by name.
    """
    size = max(float(np.ptp(positions, axis=0).max()), 1e-9)
    given = {skeleton.index(a): skeleton.index(b) for a, b in pairs.items()}
    given |= {b: a for a, b in given.items()}
    children = children_of(skeleton.parents)
    partners = np.full(len(skeleton), -1, np.intp)
    for parent in range(-1, len(skeleton)):
        other = int(partners[parent]) if parent >= 0 else -1
        ours, theirs = children.get(parent, []), children.get(other, [])
        apart = {
            (a, b): float(np.linalg.norm(positions[a] * REFLECTION - positions[b])) / size
            + _misfit(skeleton.names[a], skeleton.names[b])
            + (0.0 if given.get(a, b) == b and given.get(b, a) == a else np.inf)
            + (_OWN_PARTNER_PENALTY if a == b else 0.0)
            for a in ours
            for b in theirs
        }
        for a, b in sorted(apart, key=apart.__getitem__):
            if partners[a] < 0 and partners[b] < 0 and np.isfinite(apart[a, b]):
                partners[a], partners[b] = b, a
        for joint in ours:
            if partners[joint] < 0:
                raise CharacterError(
                    f"mirror: joint {skeleton.names[joint]!r} has no partner on the other side; "
                    "name it in pairs, or mirror another skeleton"
                )
    return partners


def _misfit(name: str, other: str) -> float:
    """Return the penalty for two names as a pair, in body sizes.

    >>> _misfit("Palm2L", "Palm2R"), _misfit("LeftArm_06", "RightArm_09"), _misfit("ArmL", "LegR")
    (0.0, 0.01, 0.1)
    >>> _misfit("lhipjoint", "rhipjoint"), _misfit("LHipJoint", "RHipJoint")
    (0.0, 0.0)
    """
    swapped = _SIDE_IN_NAME.sub(_other_side, name)
    if swapped == other or (name[1:] == other[1:] and _OTHER_SIDE_OF.get(name[:1]) == other[:1]):
        return 0.0
    plain, plain_other = (re.sub(r"[_\s\d]+", "", each).lower() for each in (swapped, other))
    return _NUMBER_PENALTY if plain == plain_other else _NAME_PENALTY


def check_symmetry(skeleton: Skeleton, positions: Array, partners: NDArray[np.intp]) -> None:
    """Refuse a pose in which more than half of the joints are not symmetric about x = 0."""
    paired = np.flatnonzero(partners != np.arange(len(partners)))
    if not len(paired):
        return
    apart = positions[paired] * REFLECTION - positions[partners[paired]]
    apart -= np.median(apart, axis=0)  # the plane may be off the origin
    away = np.linalg.norm(apart, axis=-1)
    across = np.linalg.norm(positions[paired] - positions[partners[paired]], axis=-1)
    if np.median(away / np.maximum(across, 1e-9)) > _MAX_ASYMMETRY:
        worst = paired[away.argmax()]
        raise CharacterError(
            f"mirror: the pose is not symmetric about x = 0: {skeleton.names[worst]!r} is "
            f"{away.max():.3f} m from the mirrored {skeleton.names[partners[worst]]!r}; "
            "give a symmetric pose that faces +z, or name pairs"
        )


def paired_names(names: tuple[str, ...]) -> NDArray[np.intp]:
    """Return for each name the index of its partner, or its own index if there is none."""
    swapped = [_SIDE_IN_NAME.sub(_other_side, name) for name in names]
    return np.array([names.index(n) if n in names else i for i, n in enumerate(swapped)], np.intp)


def _other_side(match: re.Match[str]) -> str:
    return _OTHER_SIDE_OF[match[0]]
