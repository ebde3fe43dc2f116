"""Holding the feet of a character where they stand: see `held_foot`.

What its feet are to do is asked of each; here the legs are bent, and the pelvis is lowered a little
where a leg is too short.
"""

import math

import numpy as np

from characters.ik.legs import LegIK, Placed
from characters.locomotion.foot_constraint import FootConstraint, FootPoints, turned
from characters.motion.motion import RootDelta
from characters.skeleton.pose import Pose
from characters.skeleton.scalar_quaternions import Quaternion, Vector, rotate

_STRETCH = 0.997  # part of a leg's length that a held foot may need
_SINK = 0.02  # body heights: how far the pelvis may be lowered for it
_RISE = 0.12  # [s]: how slowly it comes up again


class FootLock:
    """Holds the feet of one character; advanced once a frame.

    Parameters
    ----------
    legs
        What is bent.
    height
        Of the body [m].
    """

    def __init__(self, legs: LegIK, height: float) -> None:
        self.legs = legs
        self.feet = tuple(FootConstraint(height) for _ in range(legs.count))
        self._height = height
        self._points, self._levels = _soles(legs)
        self._hip, self._ankle, self._toes = legs.joints[:, [1, 3, 4]].T.tolist()
        self._lengths: list[float] = legs.lengths.tolist()
        self._sunk = 0.0
        self._fresh = True

    def apply(
        self, pose: Pose, place: RootDelta, down: list[bool], standing: bool, elapsed: float
    ) -> Pose:
        """Return a pose with its standing feet held.

        Parameters
        ----------
        pose
            The motion's, with the root in place.
        place
            Where the root stands, in metres of the character.
        down
            Which feet the motion has on the ground.
        standing
            Whether the character stands, so that feet that are off their place step back to it.
        elapsed
            Time since the last call [s].
        """
        placed = self.legs.placed(pose)
        soles = self._soles(placed, place)
        for foot, sole in zip(self.feet, soles, strict=True):
            foot.advance(sole, elapsed)
        if self._fresh:  # it has stood there for ever
            self._fresh = False
            for foot, sole in zip(self.feet, soles, strict=True):
                foot.hold(sole)
        for foot, sole, on_ground in zip(self.feet, soles, down, strict=True):
            self._decide(foot, sole, on_ground, standing)
            foot.lift(sole)
        return self._shown(pose, placed, place, elapsed)

    def _decide(self, foot: FootConstraint, sole: FootPoints, down: bool, standing: bool) -> None:
        """Hold a foot or let it go."""
        others = all(o.held for o in self.feet if o is not foot)
        if not down:
            foot.release(sole, step=False)
        elif foot.held and (foot.strained(False) or (standing and others and foot.strained(True))):
            foot.release(sole, step=True)
        elif foot.held or foot.may_land(sole):
            foot.hold(sole)

    def _soles(self, placed: Placed, place: RootDelta) -> list[FootPoints]:
        """Return what of each foot meets the ground."""
        sine, cosine = math.sin(place.yaw), math.cos(place.yaw)
        soles = []
        for ankle, points, levels in zip(self._ankle, self._points, self._levels, strict=True):
            facing, (ax, ay, az) = placed.turns[ankle], placed.places[ankle]
            heel, ball = (
                (
                    place.x + cosine * (ax + x) + sine * (az + z),
                    ay + y - level,
                    place.z - sine * (ax + x) + cosine * (az + z),
                )
                for (x, y, z), level in zip(
                    (rotate(facing, p) for p in points), levels, strict=True
                )
            )
            soles.append(FootPoints(heel, ball))
        return soles

    def _shown(self, pose: Pose, placed: Placed, place: RootDelta, elapsed: float) -> Pose:
        """Return the pose with its feet shifted, and the pelvis lowered where they are far."""
        shifts = [foot.shift for foot in self.feet]
        if (
            max(s.length + abs(s.y) + abs(s.yaw) * 0.06 * self._height for s in shifts)
            < 1e-5 * self._height
        ):
            self._sunk = 0.0
            return pose
        ankles, turns = self._ankles(placed, place)
        self._sunk = max(self._needed(placed, ankles), self._sunk * math.exp(-elapsed / _RISE))
        if self._sunk > 1e-5 * self._height:
            pose, placed = self.legs.lowered(pose, placed, self._sunk)
        return self.legs.bend(pose, placed, ankles, turns)

    def _ankles(self, placed: Placed, place: RootDelta) -> tuple[list[Vector], list[Quaternion]]:
        """Return where the ankles are shown, and how the feet are turned, in the character."""
        sine, cosine = math.sin(place.yaw), math.cos(place.yaw)
        ankles: list[Vector] = []
        turns: list[Quaternion] = []
        for foot, number, toes in zip(self.feet, self._ankle, self._toes, strict=True):
            shift, ankle, ball = foot.shift, placed.places[number], placed.places[toes]
            x, z = turned(ankle[0] - ball[0], ankle[2] - ball[2], shift.yaw)
            x += ball[0] + cosine * shift.x - sine * shift.z
            z += ball[2] + sine * shift.x + cosine * shift.z
            ankles.append((x, ankle[1] + shift.y, z))
            turns.append((0.0, math.sin(shift.yaw / 2), 0.0, math.cos(shift.yaw / 2)))
        return ankles, turns

    def _needed(self, placed: Placed, ankles: list[Vector]) -> float:
        """Return how far the pelvis is to go down for the held feet [m], and tell the too far."""
        most, needed = _SINK * self._height, 0.0
        for foot, hip, ankle, length in zip(
            self.feet, self._hip, ankles, self._lengths, strict=True
        ):
            if not foot.held:
                continue
            x, y, z = placed.places[hip]
            reach = (_STRETCH * length) ** 2 - (x - ankle[0]) ** 2 - (z - ankle[2]) ** 2
            down = y - ankle[1] - math.sqrt(max(reach, 0.0))
            foot.too_far = reach < 0.0 or down > most
            needed = max(needed, min(down, most))
        return needed


def _soles(legs: LegIK) -> tuple[list[list[Vector]], list[tuple[float, float]]]:
    """Return heel and ball in the frame of each ankle, and their heights at rest [m].

    The heel is under the ankle and half as far behind it as the ball is before it.
    """
    rest = legs.at_rest
    ankle, ball = rest[legs.joints[:, 3]], rest[legs.joints[:, 4], :3, 3]
    heel = ankle[:, :3, 3] - 0.5 * (ball - ankle[:, :3, 3])
    heel[:, 1] = 0.0
    points = np.stack([heel, ball], axis=1)
    seen = (points - ankle[:, None, :3, 3]) @ ankle[:, :3, :3]
    return seen.tolist(), [tuple(row) for row in points[..., 1].tolist()]
