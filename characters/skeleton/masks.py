"""Joint masks: one weight 0…1 for each joint, in plain arrays, to be combined by arithmetic."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.pose import Array, Skeleton

Mask: TypeAlias = Array
"""Weight of each joint, (joints,), 0…1."""

_NO_ENTRIES: Mapping[str, int] = MappingProxyType({})


def mask_of(
    skeleton: Skeleton,
    subtrees: Mapping[str, float] = _NO_ENTRIES,
    joints: Mapping[str, float] = _NO_ENTRIES,
    default: float = 0.0,
    semantics: Mapping[str, int] = _NO_ENTRIES,
) -> Mask:
    """Return the mask with these weights.

    Parameters
    ----------
    subtrees
        Weight of a joint and all its descendants; later entries override earlier ones.
    joints
        Weight of a joint alone; overrides the subtrees.
    default
        Weight of all other joints.
    semantics
        Further joint names, such as `Anatomy.joints`; the skeleton's own names have priority.

    Raises
    ------
    CharacterError
        If a joint is unknown, or a weight is not 0…1.
    """
    mask = np.full(len(skeleton), _weight("default", default))
    for name, weight in subtrees.items():
        mask[subtree(skeleton, _joint(skeleton, name, semantics))] = _weight(name, weight)
    for name, weight in joints.items():
        mask[_joint(skeleton, name, semantics)] = _weight(name, weight)
    return mask


def subtree(skeleton: Skeleton, joint: int) -> list[int]:
    """Return a joint and all its descendants."""
    below = [joint]
    inside = {joint}
    for child in range(joint + 1, len(skeleton)):  # parents come before their children
        if skeleton.parents[child] in inside:
            inside.add(child)
            below.append(child)
    return below


def check_mask(what: str, mask: Mask | None) -> None:
    """Refuse an array that is not a mask; `what` names it in the message."""
    if mask is None:
        return
    if np.ndim(mask) != 1 or not bool(((mask >= 0) & (mask <= 1)).all()):
        raise CharacterError(f"{what}: the mask is not one weight 0…1 for each joint")


def _weight(name: str, weight: float) -> float:
    if not 0.0 <= weight <= 1.0:
        raise CharacterError(f"mask: weight {weight} of {name!r}; give 0 to 1")
    return weight


def _joint(skeleton: Skeleton, name: str, semantics: Mapping[str, int]) -> int:
    if name not in skeleton.names and name in semantics:
        return semantics[name]
    return skeleton.index(name)


def subtree_sizes(skeleton: Skeleton) -> NDArray[np.int_]:
    """Return how many joints each joint carries, itself included, (joints,)."""
    sizes = np.ones(len(skeleton), int)
    for joint in reversed(range(len(skeleton))):
        if skeleton.parents[joint] >= 0:
            sizes[skeleton.parents[joint]] += sizes[joint]
    return sizes
