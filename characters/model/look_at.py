"""How the eyes of a character follow a point, as VRM's "lookAt" states it."""

from dataclasses import dataclass
from typing import Literal

from cubeling.characters.model.springs import Point


@dataclass(frozen=True)
class RangeMap:
    """What eyes make of an angle: linear up to a greatest angle, then constant."""

    greatest: float
    """The angle up to which the output grows [rad]; above 0."""

    output: float
    """Output for this angle: the turn of an eye's joint [rad], or the weight of a morph."""

    def map_angle(self, angle: float) -> float:
        """Return the output for an angle [rad] to either side.

        >>> RangeMap(2.0, 0.5).map_angle(-1.0), RangeMap(2.0, 0.5).map_angle(3.0)
        (-0.25, 0.5)
        """
        return min(max(angle / self.greatest, -1.0), 1.0) * self.output


@dataclass(frozen=True)
class LookAt:
    """How eyes follow a point."""

    by: Literal["bone", "expression"]
    """Whether their joints turn, or morphs called lookLeft, lookRight, lookUp and lookDown."""

    inner: RangeMap
    """Of an eye that looks towards the nose."""

    outer: RangeMap
    """Of an eye that looks away from the nose; also of both by morphs."""

    down: RangeMap
    """Range for looking downwards."""

    up: RangeMap
    """Range for looking upwards."""

    eye_offset: Point | None = None
    """Middle of the eyes in the frame of the head's joint [m]; None if it is not stated."""

    def map_angles(self, yaw: float, pitch: float, side: str = "") -> tuple[float, float]:
        """Return what the eye of a side, or morphs, make of a yaw to the left and a pitch up.

        The angles are in radians. Yaw and pitch keep their signs.
        """
        inwards = yaw < 0 if side == "left" else yaw > 0
        across = self.inner if side and inwards else self.outer
        parts = across.map_angle(yaw), (self.up if pitch > 0 else self.down).map_angle(pitch)
        if self.by == "bone":
            return parts
        # VRM 0 files state ranges beyond a whole morph, which move the eyes down the face.
        return min(max(parts[0], -1.0), 1.0), min(max(parts[1], -1.0), 1.0)
