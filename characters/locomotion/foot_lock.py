"""Holds standing feet in place: bends the legs, and lowers the pelvis if a leg is too short."""

import math
from collections.abc import Sequence

import numpy as np

from cubeling.characters.ik.legs import LegFrames, LegIK
from cubeling.characters.locomotion.foot_constraint import FootConstraint, FootPoints, rotate_yaw
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.skeleton.scalar_quaternions import Quaternion, Vector, rotate
from cubeling.characters.smoothing import low_pass

_MAX_EXTENSION = 0.997  # of a leg's length
_MAX_PELVIS_DROP = 0.02  # [body heights]
_PELVIS_DROP_LAG_S, _PELVIS_RISE_LAG_S = 0.05, 0.12
_MIN_CHANGE = 1e-5  # [body heights]: smaller offsets are not applied
# Of a leg's length: beyond these it stretches ever more slowly, with its foot held or moving.
_SOFT_EXTENSION_HELD, _SOFT_EXTENSION_MOVING = 0.98, 0.94
_SOFTENING_S = 0.05  # over which the first goes over into the second after the foot is let go
_MIN_BALL_AHEAD = 0.5  # of the height of the ankle: nearer toes are the middle of the foot
_YAW_RADIUS = 0.06  # [body heights]: converts a foot's rotation to a length


class FootLock:
    """Holds the feet of one character; advanced once a frame.

    Parameters
    ----------
    legs
        Its legs.
    body_height
        [m].
    bending_toes
        For each leg, whether the foot bends at its toes; None if all do. One that does not turns
        about its tip, where no joint is.
    """

    def __init__(
        self, legs: LegIK, body_height: float, bending_toes: Sequence[bool] | None = None
    ) -> None:
        self.legs = legs
        self._body_height = body_height
        self._points, self._rest_heights = _rest_foot_points(legs)
        bending = bending_toes or [True] * len(legs.joints)
        self.feet = tuple(
            FootConstraint(body_height, bends and rolls)
            for bends, rolls in zip(bending, _rolling_feet(legs), strict=True)
        )
        self._hip, self._ankle, self._toes = legs.joints[:, [1, 3, 4]].T.tolist()
        offsets = legs.skeleton.rest.translations[legs.joints[:, 2:4]]
        lengths = np.sqrt(np.einsum("lji,lji->lj", offsets, offsets))
        self._lengths: list[float] = lengths.sum(1).tolist()
        self._pelvis_drop = 0.0
        self._first_frame = True

    def apply(
        self, pose: Pose, place: RootDelta, down: list[bool], standing: bool, elapsed: float
    ) -> Pose:
        """Return a pose whose standing feet are held in place.

        Parameters
        ----------
        pose
            The pose of the motion, with the root at the origin.
        place
            Place of the root, in metres of the character.
        down
            Which feet have ground contact in the motion.
        standing
            Whether the character stands; feet with an offset then step back.
        elapsed
            Time since the last call [s].
        """
        frames = self.legs.frames(pose)
        points = self._foot_points(frames, place)
        # All feet advance before any is let go: whether one may step depends on the others.
        for foot, own in zip(self.feet, points, strict=True):
            foot.advance(own, elapsed)
        if self._first_frame:
            self._first_frame = False
            for foot, own in zip(self.feet, points, strict=True):
                foot.hold(own)
        for foot, own, contact in zip(self.feet, points, down, strict=True):
            self._update(foot, own, contact, standing)
            foot.lift(own)
        return self._bend(pose, frames, place, elapsed)

    def _update(self, foot: FootConstraint, points: FootPoints, down: bool, standing: bool) -> None:
        others_held = all(other.held for other in self.feet if other is not foot)
        # One foot at a time; a body cannot stand on feet that are both stepping.
        step_back = standing and others_held
        if not down:
            foot.release(points, step=False)
        elif foot.held and (foot.is_strained(False) or (step_back and foot.is_strained(True))):
            foot.release(points, step=True)
        elif foot.held or foot.may_land(points):
            foot.hold(points)

    def _foot_points(self, frames: LegFrames, place: RootDelta) -> list[FootPoints]:
        """Return the points of each foot in the world."""
        sine, cosine = math.sin(place.yaw), math.cos(place.yaw)
        feet = []
        for ankle, points, heights in zip(
            self._ankle, self._points, self._rest_heights, strict=True
        ):
            facing, (ax, ay, az) = frames.rotations[ankle], frames.positions[ankle]
            offsets = [rotate(facing, point) for point in points]
            heel, ball = (
                (
                    place.x + cosine * (ax + x) + sine * (az + z),
                    ay + y - height,
                    place.z - sine * (ax + x) + cosine * (az + z),
                )
                for (x, y, z), height in zip(offsets, heights, strict=True)
            )
            feet.append(FootPoints(heel, ball))
        return feet

    def _bend(self, pose: Pose, frames: LegFrames, place: RootDelta, elapsed: float) -> Pose:
        """Return the pose with the feet's offsets, and a lower pelvis if they are far away."""
        least = _MIN_CHANGE * self._body_height
        changes = (
            foot.offset.length
            + abs(foot.offset.y)
            + abs(foot.offset.yaw) * _YAW_RADIUS * self._body_height
            for foot in self.feet
        )
        # Most frames of an undisturbed walk: the motion's own legs, to the bit.
        if max(changes) < least:
            self._pelvis_drop = 0.0
            return pose
        ankles, turns = self._ankles(frames, place)
        needed = self._needed_drop(frames, ankles)
        # Down fast, or the knee snaps straight; up slowly, as nothing but the look depends on it.
        lag = _PELVIS_DROP_LAG_S if needed > self._pelvis_drop else _PELVIS_RISE_LAG_S
        self._pelvis_drop = low_pass(self._pelvis_drop, needed, elapsed, lag)
        if self._pelvis_drop > least:
            pose, frames = self.legs.lower_pelvis(pose, frames, self._pelvis_drop)
        return self.legs.bend(pose, frames, ankles, turns)

    def _ankles(self, frames: LegFrames, place: RootDelta) -> tuple[list[Vector], list[Quaternion]]:
        """Return shown ankle positions and rotations of the feet, in the character's frame."""
        sine, cosine = math.sin(place.yaw), math.cos(place.yaw)
        ankles: list[Vector] = []
        turns: list[Quaternion] = []
        for foot, hip, number, toes, length in zip(
            self.feet, self._hip, self._ankle, self._toes, self._lengths, strict=True
        ):
            offset, ankle, ball = foot.offset, frames.positions[number], frames.positions[toes]
            x, z = rotate_yaw(ankle[0] - ball[0], ankle[2] - ball[2], offset.yaw)
            x += ball[0] + cosine * offset.x - sine * offset.z
            z += ball[2] + sine * offset.x + cosine * offset.z
            wanted = (x, ankle[1] + offset.y, z)
            ankles.append(_within_reach(frames.positions[hip], ankle, wanted, length, foot))
            turns.append((0.0, math.sin(offset.yaw / 2), 0.0, math.cos(offset.yaw / 2)))
        return ankles, turns

    def _needed_drop(self, frames: LegFrames, ankles: list[Vector]) -> float:
        """Return how far to lower the pelvis for the held feet [m]; mark feet out of reach."""
        limit, needed = _MAX_PELVIS_DROP * self._body_height, 0.0
        for foot, hip, ankle, length in zip(
            self.feet, self._hip, ankles, self._lengths, strict=True
        ):
            if not foot.held:
                continue
            x, y, z = frames.positions[hip]
            squared = (_MAX_EXTENSION * length) ** 2 - (x - ankle[0]) ** 2 - (z - ankle[2]) ** 2
            drop = y - ankle[1] - math.sqrt(max(squared, 0.0))
            foot.out_of_reach = squared < 0.0 or drop > limit
            needed = max(needed, min(drop, limit))
        return needed


def _within_reach(
    hip: Vector, own: Vector, wanted: Vector, length: float, foot: FootConstraint
) -> Vector:
    """Return where an ankle comes on its way out of reach, so that the knee never snaps straight.

    Beyond a limit, and beyond its `own` position in the motion, it comes nearer to the full length
    of the leg ever more slowly ("soft IK", A. Nicholas, 2008).
    """
    away = math.dist(hip, wanted)
    moving = 0.0 if foot.held else min(foot.age / _SOFTENING_S, 1.0)
    limit = _SOFT_EXTENSION_HELD + moving * (_SOFT_EXTENSION_MOVING - _SOFT_EXTENSION_HELD)
    # What the motion itself reaches is never shortened.
    start = max(limit * length, math.dist(hip, own))
    if away <= start:
        return wanted
    room = max(_MAX_EXTENSION * length - start, 1e-3 * length)
    share = (start + room * (1.0 - math.exp((start - away) / room))) / away
    x, y, z = (h + share * (w - h) for h, w in zip(hip, wanted, strict=True))
    return x, y, z


def _rolling_feet(legs: LegIK) -> list[bool]:
    """Return which feet have the joint of their toes low and far enough ahead to roll onto it."""
    rest = legs.skeleton.rest.globals(legs.skeleton)[:, :3, 3]
    ankles, balls = rest[legs.joints[:, 3]], rest[legs.joints[:, 4]]
    ahead = np.linalg.norm((balls - ankles)[:, [0, 2]], axis=-1)
    low = balls[:, 1] <= ankles[:, 1]
    rolls: list[bool] = (low & (ahead > _MIN_BALL_AHEAD * np.abs(ankles[:, 1]))).tolist()
    return rolls


def _rest_foot_points(legs: LegIK) -> tuple[list[list[Vector]], list[list[float]]]:
    """Return heel and ball in the frame of each ankle, and their heights at rest [m].

    The heel is below the ankle, and half as far behind it as the ball is in front of it.
    """
    rest = legs.skeleton.rest.globals(legs.skeleton)
    ankle, ball = rest[legs.joints[:, 3]], rest[legs.joints[:, 4], :3, 3]
    heel = ankle[:, :3, 3] - 0.5 * (ball - ankle[:, :3, 3])
    # On the ground, whatever the shoe: only its place behind the ankle is estimated.
    heel[:, 1] = 0.0
    points = np.stack([heel, ball], axis=1)
    local = (points - ankle[:, None, :3, 3]) @ ankle[:, :3, :3]
    return local.tolist(), points[..., 1].tolist()
