"""The gesture space about a body: 84 cells in metres, for the proportions of a character.

McNeill (1992) divides the space of gestures by how far it is from the chest. The centimetres are
those of Greta for one agent; here they grow with the arms.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from cubeling.characters.behaviour.symbolic_gesture import (
    SECTORS_X,
    SECTORS_Y,
    SECTORS_Z,
    Place,
    Vector3,
)
from cubeling.characters.skeleton.pose import Array

REFERENCE_ARM_M = 0.55
"""Length of the arm, shoulder to wrist, to which the centimetres below belong [m]."""

CHEST_CM = 10.0
"""Height of the middle of the chest in the centimetres below: XC, YCC [cm]."""

DEPTH = 0.25
"""From the shoulders' middle to the front of the chest, in parts of an arm's length."""

CENTRES_X_CM = dict(zip(SECTORS_X, (45.0, 30.0, 15.0, -15.0), strict=True))
"""Outward from the middle of the body [cm]."""

CENTRES_Y_CM = dict(zip(SECTORS_Y, (60.0, 40.0, 20.0, 10.0, 0.0, -10.0, -20.0), strict=True))
"""Up from the middle of the chest [cm]."""

CENTRES_Z_CM = dict(zip(SECTORS_Z, (10.0, 20.0, 40.0), strict=True))
"""Forward from the chest [cm]."""


@dataclass(frozen=True, eq=False)
class GestureSpace:
    """The cells about one body, as large, and turned, as its torso is."""

    chest: Array
    """The middle of the front of the chest, (3,) in the character frame [m]."""

    arm: float
    """Length of an arm, shoulder to wrist [m]."""

    spatial: float = 0.0
    """Cells are scaled about the chest by 1 + this."""

    turn: Array = field(default_factory=lambda: np.eye(3))
    """Rotation of the torso from upright, (3, 3)."""

    torso_scale: float = 1.0
    """Length of the torso ÷ its length when upright."""

    @staticmethod
    def about(shoulders: Array, arm: float) -> "GestureSpace":
        """Return the space of a body whose shoulders' middle is at a place, (3,) [m].

        Shoulders are at the height of YUpperC, a trunk is half as thick as `DEPTH` of an arm.
        """
        below = (CENTRES_Y_CM["YUpperC"] - CHEST_CM) / 100.0 * arm / REFERENCE_ARM_M
        return GestureSpace(shoulders + np.array([0.0, -below, DEPTH * arm]), arm)

    def turn_by(self, turn: Array, chest: Array, torso_scale: float = 1.0) -> "GestureSpace":
        """Return the space of a body whose torso is turned, moved and bent."""
        return replace(self, turn=turn, chest=chest, torso_scale=torso_scale)

    def point(self, place: Place, left: bool) -> Array:
        """Return where a place of a hand is, (3,) in the character frame [m].

        c + R (p − c)(1 + spatial) s, as in Huang 2013, section 8.7.
        """
        outward, up, forward = cell(place)
        scale = self.arm / REFERENCE_ARM_M / 100.0
        own = np.array([outward, up - CHEST_CM, forward]) * scale
        return self.chest + self.vector(own + np.array(place.offset) * self.arm, left)

    def vector(self, own: Array, left: bool) -> Array:
        """Return outward, up and forward of a hand [m] in the character frame, scaled, (…, 3)."""
        mirrored = own * np.array([1.0 if left else -1.0, 1.0, 1.0])
        scaled: Array = mirrored @ self.turn.T * ((1.0 + self.spatial) * self.torso_scale)
        return scaled

    def radius(self, radius: Vector3, left: bool) -> Array:
        """Return the amplitude of a path in the character frame, (3,) [m]."""
        return self.vector(np.array(radius) * self.arm, left)

    def nearest(self, point: Array, left: bool) -> Place:
        """Return the cell of a point (3,) in the character frame, and its offset in the cell."""
        scale = (1.0 + self.spatial) * self.torso_scale * self.arm
        own = (point - self.chest) @ self.turn / max(scale, 1e-9)
        own = own * np.array([1.0 if left else -1.0, 1.0, 1.0])
        centimetres = own * REFERENCE_ARM_M * 100.0 + np.array([0.0, CHEST_CM, 0.0])
        outward, up, forward = centimetres.tolist()
        bare = Place(
            _nearest(CENTRES_X_CM, outward),
            _nearest(CENTRES_Y_CM, up),
            _nearest(CENTRES_Z_CM, forward),
        )
        offset = (centimetres - np.array(cell(bare))) / (REFERENCE_ARM_M * 100.0)
        x, y, z = offset.tolist()
        return replace(bare, offset=(x, y, z))

    def cells(self, left: bool) -> dict[tuple[str, str, str], Array]:
        """Return the centres of the 84 cells of a hand, (3,) each [m]."""
        return {
            (x, y, z): self.point(Place(x, y, z), left)
            for x in SECTORS_X
            for y in SECTORS_Y
            for z in SECTORS_Z
        }


def cell(place: Place) -> Vector3:
    """Return the centre of the cell of a place: outward, up and forward [cm]."""
    return CENTRES_X_CM[place.x], CENTRES_Y_CM[place.y], CENTRES_Z_CM[place.z]


def _nearest(centres: dict[str, float], value: float) -> str:
    return min(centres, key=lambda name: abs(centres[name] - value))
