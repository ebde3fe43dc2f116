"""Eyes that look about by morphs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.body.eye_range import MAX_EYE_PITCH_RAD, MAX_EYE_YAW_RAD
from cubeling.characters.face.lids import numbers_by_name
from cubeling.characters.skeleton.pose import Array

# Normalised names of VRM and ARKit: to the left, to the right, up, down. ARKit's "in" is towards
# the nose.
_NAMES = (
    (("lookleft",), ("lookright",), ("lookup",), ("lookdown",)),
    (
        ("eyelookoutleft", "eyelookinright"),
        ("eyelookinleft", "eyelookoutright"),
        ("eyelookupleft", "eyelookupright"),
        ("eyelookdownleft", "eyelookdownright"),
    ),
)


@dataclass(frozen=True)
class GazeMorphs:
    """The morphs with which a character looks about."""

    directions: tuple[NDArray[np.intp], ...]
    """Numbers of those that look to the left, to the right, up and down."""

    @staticmethod
    def of(morphs: Sequence[str]) -> "GazeMorphs | None":
        """Find them among the names of a character's morphs; None without those to both sides.

        >>> GazeMorphs.of(["aa", "lookLeft", "lookRight"]).directions[1].tolist()
        [2]
        >>> GazeMorphs.of(["lookLeft"]) is None
        True
        """
        found = numbers_by_name(morphs)
        for names in _NAMES:
            directions = tuple(
                np.array([found[name] for name in direction if name in found], np.intp)
                for direction in names
            )
            if directions[0].size and directions[1].size:
                return GazeMorphs(directions)
        return None

    def look(self, weights: Array, yaw: float, pitch: float) -> None:
        """Set morph weights (morphs,) for parts of the whole ways to the left and up, −1…1."""
        for direction, part in zip(self.directions, (yaw, -yaw, pitch, -pitch), strict=True):
            weights[direction] = max(part, 0.0)


def range_parts(yaw: float, pitch: float) -> tuple[float, float]:
    """Return turns of eyes [rad] as parts of their range, −1…1."""
    return yaw / MAX_EYE_YAW_RAD, pitch / MAX_EYE_PITCH_RAD
