"""What a tree of springs stands on, and how it is at rest."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from cubeling.characters.ik.reaching.torso import PlacedTorso
from cubeling.characters.skeleton.scalar_quaternions import Vector


class Strut(NamedTuple):
    """A leg that stands."""

    hip: Vector
    """[m]"""

    ankle: Vector
    """Where it is and stays [m]."""

    length: float
    """Of thigh and shin [m]."""


@dataclass(frozen=True)
class PlacedTree:
    """A body in one pose, in the character frame."""

    torso: PlacedTorso

    spine_ranges: Sequence[tuple[float, float]]
    """How far the joints of its spine bow, turn and tilt together [rad]."""

    centre: Vector
    """The middle between the hips [m]."""

    legs: Sequence[Strut]
    """None of a body whose pelvis stays where it is."""

    height: float
    """Of the body [m]."""

    eyes: Vector
    """Where it looks from [m]."""


class Settled(NamedTuple):
    """How a tree is at rest: what its joints do besides the pose."""

    shift: Vector
    """Of the pelvis [m]."""

    pelvis: Vector
    """Turn of the pelvis about the middle between the hips, a rotation vector [rad]."""

    spine: Vector
    """Turn of the whole spine from the pelvis to the chest [rad]."""

    left: Vector = (0.0, 0.0, 0.0)
    """Turn of the left collarbone [rad]."""

    right: Vector = (0.0, 0.0, 0.0)
    """Turn of the right collarbone [rad]."""

    def collar(self, side: str) -> Vector:
        """Return the turn of the collarbone of a side [rad]."""
        return self.left if side == "left" else self.right
