"""Skeletons and poses: arrays over joints, never objects a joint."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Pose:
    """Where every joint is, relative to its parent."""

    translations: Array
    """(…, joints, 3) [m]."""

    rotations: Array
    """Unit quaternions xyzw, (…, joints, 4)."""

    scales: Array | None = None
    """(…, joints, 3), or None for all ones."""

    def globals(self, skeleton: "Skeleton") -> Array:
        """Return `character_from_joint` of every joint, (…, joints, 4, 4)."""
        raise NotImplementedError


@dataclass(frozen=True)
class Skeleton:
    """Names, parents and rest pose of a tree of joints."""

    names: tuple[str, ...]
    """Name of each joint."""

    parents: tuple[int, ...]
    """Number of each joint's parent, −1 for a root; a parent always comes before its children."""

    rest: Pose
    """The pose in the file."""
