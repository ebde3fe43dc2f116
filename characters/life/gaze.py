"""Head and eyes that look at a point, as far as a body can.

Eyes jump, the head follows, and while it follows the eyes turn back by as much: the gaze stays
where it is. The head leaves small turns to the eyes (Stahl, "Amplitude of human head movements
associated with horizontal saccades", 1999; Guitton and Volle, "Gaze control in humans", 1987).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters import rotations
from characters.anatomy import Anatomy
from characters.part import Part
from characters.pose import Array, Pose, Skeleton
from characters.smoothing import eased, sprung


@dataclass(frozen=True)
class Limits:
    """How far a body can look, from where its chest faces."""

    head_yaw: float = math.radians(72)
    """Of the head to either side [rad]."""

    head_up: float = math.radians(42)
    """Of the head upwards [rad]."""

    head_down: float = math.radians(48)
    """Of the head downwards [rad]."""

    eye_yaw: float = math.radians(28)
    """Of the eyes to either side in the head [rad]."""

    eye_pitch: float = math.radians(22)
    """Of the eyes up and down in the head [rad]."""

    given_up: float = math.radians(130)
    """What is farther round than this is not looked at: the head stays as it is [rad]."""


HUMAN = Limits()
"""Ranges of motion of a healthy adult, a little within (Youdas et al., 1992)."""

_EYES_ALONE = math.radians(9)  # the head leaves turns up to this to the eyes
_HEAD_SHARE = 0.92  # of what is beyond it, the head takes this part
_HEAD_LAG, _EYE_LAG, _FADE = 0.34, 0.035, 0.3  # [s]


@dataclass(frozen=True)
class _Places:
    """Where joints are in the part of the skeleton that carries head and eyes; −1: nowhere."""

    base: int
    """What carries the neck."""

    line: NDArray[np.intp]
    """From the neck to the head."""

    parents: NDArray[np.intp]
    """Their parents."""

    eyes: NDArray[np.intp]
    """The eyes, two or none."""


class Gaze:
    """Turns neck, head and eyes of one character.

    Parameters
    ----------
    skeleton, anatomy
        Whose.
    limits
        How far they turn.
    """

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy, limits: Limits = HUMAN) -> None:
        head = anatomy.joint("head")
        self.able = head is not None
        """Whether there is a head to turn."""
        self._limits = limits
        self._yaw = self._pitch = self._yaw_speed = self._pitch_speed = self._heed = 0.0
        self.jumped = 0.0
        """How far the eyes' aim went in the last update [rad]."""
        self._aim: tuple[float, float] | None = None
        if head is None:
            return
        line = _line(head, anatomy.joint("neck"), skeleton)
        eyes = [j for side in ("left", "right") if (j := anatomy.joint(f"{side}Eye")) is not None]
        self._eyes = np.array(eyes, np.intp)
        self._line = np.array(line, np.intp)
        base = skeleton.parents[line[0]]
        part = self._part = Part.of(skeleton, [*line, *eyes])
        self._at = _Places(
            base=part.number(base),
            line=np.array([part.number(joint) for joint in line]),
            parents=np.array([part.number(skeleton.parents[joint]) for joint in line]),
            eyes=np.array([part.number(joint) for joint in eyes], np.intp),
        )
        rest = skeleton.rest.globals(skeleton)[:, :3, :3]
        self._base_rest = _upright(rest[base]) if base >= 0 else np.eye(3)
        self._head_rest = _upright(rest[head])
        self._eye_rest = np.array([_upright(rest[j]) for j in eyes]).reshape(-1, 3, 3)
        self._eye_turn = np.zeros((len(eyes), 2))

    def update(
        self, pose: Pose, target: Array | None, elapsed: float, head_share: float = 1.0
    ) -> Pose:
        """Advance by a time [s] and return the pose with head and eyes turned.

        Parameters
        ----------
        pose
            As the body holds it.
        target
            What is looked at, (3,) in the character frame [m]; None for nothing.
        elapsed
            Since the last call.
        head_share
            How much of its part the head takes, 0…1; the eyes look anyway.
        """
        if not self.able:
            return pose
        globals_ = self._part.globals(pose)
        turns, places = globals_[:, :3, :3], globals_[:, :3, 3]
        body = self._body(turns)
        head = turns[self._at.line[-1]]
        facing = body.T @ (head @ self._head_rest.T)[:, 2]
        yaw, pitch = _angles(facing)
        wish, heed = (0.0, 0.0), 0.0
        if target is not None:
            seen = self._origin(places)
            to = body.T @ (target - seen)
            if np.linalg.norm(to) > 1e-6:
                aim = _angles(to)
                heed = float(abs(aim[0]) < self._limits.given_up)
                wish = self._head_wish(aim, (yaw, pitch), head_share) if heed else wish
                self._note(aim if heed else None)
        self._heed = eased(self._heed, heed, elapsed, _FADE)
        self._yaw, self._yaw_speed = sprung(self._yaw, self._yaw_speed, wish[0], elapsed, _HEAD_LAG)
        self._pitch, self._pitch_speed = sprung(
            self._pitch, self._pitch_speed, wish[1], elapsed, _HEAD_LAG
        )
        turn = body @ _turn_between((yaw, pitch), (yaw + self._yaw, pitch + self._pitch))
        local = pose.rotations.copy()
        self._turn_line(local, turns, turn)
        if self._eyes.size:
            self._turn_eyes(local, turns, places, turn, target if heed else None, elapsed)
        return Pose(pose.translations, local, pose.scales, pose.morphs)

    def _body(self, turns: Array) -> Array:
        """Return which way the chest faces: its left, up and forward as columns, (3, 3)."""
        if self._at.base < 0:
            return np.eye(3)
        body: Array = turns[self._at.base] @ self._base_rest.T
        return body

    def _origin(self, places: Array) -> Array:
        """Return the point from which it looks, (3,)."""
        if self._at.eyes.size:
            between: Array = places[self._at.eyes].mean(0)
            return between
        point: Array = places[self._at.line[-1]]
        return point

    def _head_wish(
        self, aim: tuple[float, float], held: tuple[float, float], share: float
    ) -> tuple[float, float]:
        """Return how far the head is to turn beside what the pose does [rad]: yaw, pitch."""
        limits, wished = self._limits, []
        ranges = ((-limits.head_yaw, limits.head_yaw), (-limits.head_down, limits.head_up))
        for angle, now, (low, high) in zip(aim, held, ranges, strict=True):
            away = angle - now
            beyond = math.copysign(max(abs(away) - _EYES_ALONE, 0.0) * _HEAD_SHARE, away)
            at = min(max(now + beyond, low), high)
            wished.append((at - now) * share)
        return wished[0], wished[1]

    def _note(self, aim: tuple[float, float] | None) -> None:
        """Remember the aim and how far it went since the last time."""
        before, self._aim = self._aim, aim
        self.jumped = 0.0
        if before is not None and aim is not None:
            self.jumped = math.dist(before, aim)

    def _turn_line(self, local: Array, turns: Array, turn: Array) -> None:
        """Turn neck and head: each joint of the line by an equal part, so that they bend alike.

        Powers of one rotation commute: each joint's parent has made its part already, so the part
        of each is the same vector, seen from the parent as it was.
        """
        parts = np.broadcast_to(turn / len(self._line), (len(self._line), 3)).copy()
        carried = self._at.parents >= 0
        parents = turns[self._at.parents[carried]]
        parts[carried] = (parts[carried, None] @ parents)[:, 0]
        local[self._line] = rotations.multiply(
            rotations.from_rotation_vector(parts), local[self._line]
        )

    def _turn_eyes(
        self,
        local: Array,
        turns: Array,
        places: Array,
        turn: Array,
        target: Array | None,
        elapsed: float,
    ) -> None:
        """Turn the eyes in the head that has turned, each to the target by itself."""
        wish = np.zeros_like(self._eye_turn)
        if target is not None:
            centre = places[self._at.line[-1]]
            turned = rotations.to_matrix(rotations.from_rotation_vector(turn))
            head = turned @ turns[self._at.line[-1]]
            eyes = centre + (places[self._at.eyes] - centre) @ turned.T
            seen = (target - eyes) @ (head @ self._head_rest.T)
            wish[:, 0] = np.arctan2(seen[:, 0], seen[:, 2])
            wish[:, 1] = np.arctan2(seen[:, 1], np.hypot(seen[:, 0], seen[:, 2]))
            most = (self._limits.eye_yaw, self._limits.eye_pitch)
            wish = np.clip(wish, np.negative(most), most)
        self._eye_turn = wish + (self._eye_turn - wish) * math.exp(-elapsed / _EYE_LAG)
        yaw, pitch = self._eye_turn[:, :1], self._eye_turn[:, 1:]
        # About the body's up, and about its left downwards, in the frames of the eyes.
        vectors = yaw * self._eye_rest[:, 1] - pitch * self._eye_rest[:, 0]
        local[self._eyes] = rotations.multiply(
            local[self._eyes], rotations.from_rotation_vector(vectors)
        )


def _line(head: int, neck: int | None, skeleton: Skeleton) -> list[int]:
    """Return the joints from the neck down to the head; the head alone where there is no neck."""
    line = [head]
    while neck is not None and line[-1] not in (neck, -1):
        line.append(skeleton.parents[line[-1]])
    return line[::-1] if line[-1] == neck else [head]


def _upright(turns: Array) -> Array:
    """Return a matrix (3, 3) without its scale."""
    unit: Array = turns / np.maximum(np.linalg.norm(turns, axis=0), 1e-12)
    return unit


def _angles(direction: Array) -> tuple[float, float]:
    """Return yaw to the left and pitch upwards [rad] of a direction (3,): left, up, forward."""
    x, y, z = direction.tolist()
    return math.atan2(x, z), math.atan2(y, math.hypot(x, z))


def _turn_between(start: tuple[float, float], end: tuple[float, float]) -> Array:
    """Return what turns one direction to another, level to level, as a rotation vector (3,) [rad].

    The directions are yaws to the left and pitches upwards: first back to straight ahead by
    the yaw of one, then by the difference of the pitches, then by the yaw of the other.
    """
    half = (end[0] / 2, (start[1] - end[1]) / 2, -start[0] / 2)
    (sa, sb, sc), (ca, cb, cc) = map(math.sin, half), map(math.cos, half)
    x, y, z, w = ca * sb, sa * cb, -sa * sb, ca * cb
    x, y, z, w = x * cc - z * sc, w * sc + y * cc, z * cc + x * sc, w * cc - y * sc
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 if sine < 1e-9 else 2.0 * math.atan2(sine, w) / sine
    return np.array([x * scale, y * scale, z * scale])
