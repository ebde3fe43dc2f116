"""Where hands are to be, and how a body reaches."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.skeleton.way_round import WayRound

ReachKind = Literal["reach", "touch", "point", "grasp", "hold"]

SHAPE_OF_KIND: dict[ReachKind, str] = {
    "reach": "relaxed",
    "touch": "flat",
    "point": "point",
    "grasp": "grasp",
    "hold": "flat",
}
"""The shape of a hand that does not ask for another one."""


@dataclass(frozen=True)
class HandTarget:
    """Where a hand is to be; vectors are in the character frame."""

    place: Sequence[float] | Array
    """Where, (3,) [m]."""

    kind: ReachKind = "reach"
    """The palm ("reach", "grasp", "hold") or the fingertips are there, or the index finger points
    there."""

    palm: Sequence[float] | Array | None = None
    """Where the palm faces, (3,); None as it comes."""

    fingers: Sequence[float] | Array | None = None
    """Where the fingers point, (3,); None as it comes. Used together with `palm`."""

    shape: str = ""
    """One of `HAND_SHAPES`; that of the kind if empty."""

    weight: float = 1.0
    """0 as in the pose … 1 there."""

    way: WayRound | None = None
    """By which way a hand that is part of the way there goes on from the frame before; None for the
    shorter one."""


@dataclass(frozen=True)
class ReachStyle:
    """How a body reaches."""

    openness: float = 0.5
    """Elbows close to the trunk, 0, to far from it, 1."""

    power: float = 0.0
    """How much shoulders and torso join in, 0…1."""


NEUTRAL_REACH = ReachStyle()
"""The way that takes the least effort: no expression changes it."""
