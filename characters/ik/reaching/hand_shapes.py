"""Shapes of a hand: how far each finger is bent and spread, for any skeleton with fingers.

Shapes are absolute: a hand that is half closed in its rest pose opens as flat as any other.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.ik.reaching.hands import HandJoints, find_hand, fingertip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton


@dataclass(frozen=True)
class HandShape:
    """Bends of the fingers of a hand."""

    curls_deg: tuple[float, float, float]
    """Bends of the three joints of a finger towards the palm [degrees], index to little finger."""

    thumb: tuple[float, float, float]
    """Where the thumb points: along the fingers, away from them, out of the palm."""

    thumb_curl_deg: float = 10.0
    """Bend of each joint of the thumb after the first [degrees]."""

    spread_deg: float = 0.0
    """How far each finger is spread from the middle one [degrees]."""

    index_deg: tuple[float, float, float] | None = None
    """Bends of the index finger if they differ [degrees]."""

    middle_deg: tuple[float, float, float] | None = None
    """Bends of the middle finger if they differ [degrees]."""

    def curls(self, finger: str) -> tuple[float, float, float]:
        """Return the bends of the joints of a finger [degrees]."""
        own = {"Index": self.index_deg, "Middle": self.middle_deg}.get(finger)
        return self.curls_deg if own is None else own


_FLAT, _FOLDED = (0.0, 0.0, 0.0), (80.0, 95.0, 60.0)
_OVER_FINGERS = (0.75, 0.05, 0.65)

HAND_SHAPES: Mapping[str, HandShape] = {
    "relaxed": HandShape((18.0, 25.0, 15.0), (0.75, 0.45, 0.45)),
    "flat": HandShape(_FLAT, (0.85, 0.5, 0.1), 0.0),
    "fist": HandShape(_FOLDED, _OVER_FINGERS, 35.0),
    "point": HandShape(_FOLDED, _OVER_FINGERS, 35.0, index_deg=_FLAT),
    "thumb": HandShape(_FOLDED, (0.1, 1.0, 0.0), 0.0),
    "ok": HandShape((8.0, 12.0, 8.0), (0.85, 0.1, 0.6), 15.0, 6.0, index_deg=(55.0, 65.0, 30.0)),
    "claw": HandShape((5.0, 65.0, 45.0), (0.55, 0.65, 0.5), 35.0, 12.0),
    "spread": HandShape(_FLAT, (0.45, 0.9, 0.05), 0.0, 14.0),
    "grasp": HandShape((35.0, 35.0, 20.0), (0.6, 0.3, 0.75), 15.0, 6.0),
    "three": HandShape(_FOLDED, (0.1, 1.0, 0.0), 0.0, 14.0, index_deg=_FLAT, middle_deg=_FLAT),
    "victory": HandShape(_FOLDED, _OVER_FINGERS, 35.0, 14.0, index_deg=_FLAT, middle_deg=_FLAT),
}
"""The shapes by name."""

_FROM_MIDDLE = {"Index": -1.0, "Middle": 0.0, "Ring": 1.0, "Little": 2.0}


@dataclass(frozen=True)
class HandPosture:
    """The shape of one hand of a skeleton."""

    joints: NDArray[np.intp]
    """Joints of the fingers, (n,)."""

    rotations: Array
    """Their local rotations, (n, 4)."""

    tips: Mapping[str, Array]
    """Tip of each finger while the hand is as at rest, (3,) in the character frame [m]."""


class HandShapes:
    """The shapes of both hands of a skeleton; a hand without fingers has empty ones."""

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy) -> None:
        self.hands = {side: find_hand(skeleton, anatomy, side) for side in SIDES}
        """The hands by side; None for one that is missing."""
        self._skeleton = skeleton
        self._postures: dict[tuple[str, str], HandPosture] = {}

    def posture(self, side: str, shape: str) -> HandPosture:
        """Return the fingers of a hand in a shape.

        Raises
        ------
        CharacterError
            If there is no such shape.
        """
        if shape not in HAND_SHAPES:
            raise CharacterError(
                f"no hand shape is named {shape!r}; there are {', '.join(HAND_SHAPES)}"
            )
        key = side, shape
        if key not in self._postures:
            hand = self.hands[side]
            found = HandPosture(np.zeros(0, np.intp), np.zeros((0, 4)), {})
            if hand is not None and hand.fingers:
                found = _posture(hand, HAND_SHAPES[shape], self._skeleton)
            self._postures[key] = found
        return self._postures[key]

    def shape(self, pose: Pose, side: str, shape: str, weight: float = 1.0) -> Pose:
        """Return a pose with a hand in a shape, or part of the way there; `weight` is 0…1."""
        posture = self.posture(side, shape)
        if not len(posture.joints) or weight <= 0.0:
            return pose
        local = pose.rotations.copy()
        if weight >= 1.0:
            local[posture.joints] = posture.rotations
        else:
            local[posture.joints] = rotations.slerp(
                local[posture.joints], posture.rotations, weight
            )
        return replace(pose, rotations=local)


def _posture(hand: HandJoints, shape: HandShape, skeleton: Skeleton) -> HandPosture:
    rest = skeleton.rest.globals(skeleton)
    places, turns = rest[:, :3, 3], _turns(rest[:, :3, :3])
    joints, local, tips = [], [], {}
    for finger, chain in hand.fingers.items():
        points = np.stack([*places[list(chain)], fingertip(chain, skeleton)])
        segments = np.diff(points, axis=0)
        lengths = np.linalg.norm(segments, axis=1, keepdims=True)
        at_rest = segments / np.maximum(lengths, 1e-9)
        if finger == "Thumb":
            rest_hinge, directions, hinge = _thumb(hand, shape, at_rest)
        else:
            rest_hinge = np.cross(hand.axes[0], hand.axes[2])
            directions, hinge = _finger(hand, shape, finger, len(chain))
        above = turns[skeleton.parents[chain[0]]]
        for joint, before, after in zip(chain, at_rest, directions, strict=True):
            turn = rotations.from_matrix(_frame(after, hinge) @ _frame(before, rest_hinge).T)
            placed = rotations.multiply(turn, turns[joint])
            joints.append(joint)
            local.append(rotations.multiply(rotations.conjugate(above), placed))
            above = placed
        tips[finger] = points[0] + (lengths * directions).sum(0)
    return HandPosture(np.array(joints, np.intp), np.array(local), tips)


def _finger(hand: HandJoints, shape: HandShape, finger: str, count: int) -> tuple[Array, Array]:
    """Return the directions of the segments of a finger, (count, 3), and its hinge."""
    along, across, palm = hand.axes
    spread = -math.radians(shape.spread_deg) * _FROM_MIDDLE[finger]
    base = math.cos(spread) * along + math.sin(spread) * across
    curls = list(shape.curls(finger)[:count])
    curls[-1] += 0.5 * sum(shape.curls(finger)[count:])  # a segment for two is bent between them
    bends = np.radians(np.cumsum(curls))[:, None]
    return np.cos(bends) * base + np.sin(bends) * palm, np.cross(base, palm)


def _thumb(hand: HandJoints, shape: HandShape, at_rest: Array) -> tuple[Array, Array, Array]:
    """Return the hinge at rest, the directions of the segments of a thumb, and its hinge."""
    first = np.array(shape.thumb) @ hand.axes
    first = first / np.linalg.norm(first)
    closing = hand.axes[2] - hand.axes[1]
    rest_hinge, hinge = np.cross(at_rest[0], closing), np.cross(first, closing)
    hinge = hinge / np.linalg.norm(hinge)
    bends = np.radians(shape.thumb_curl_deg) * np.arange(len(at_rest))[:, None]
    directions = np.cos(bends) * first + np.sin(bends) * np.cross(hinge, first)
    if len(at_rest) > 2:  # the metacarpal in the palm goes half of the way
        middle = at_rest[0] + first
        directions[0] = middle / max(float(np.linalg.norm(middle)), 1e-9)
    return rest_hinge, directions, hinge


def _frame(along: Array, hinge: Array) -> Array:
    """Return axes by columns: along a segment, its hinge made perpendicular, and their cross."""
    second = hinge - along * float(along @ hinge)
    size = float(np.linalg.norm(second))
    if size < 1e-6:
        second = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
        size = float(np.linalg.norm(second))
    second = second / size
    return np.stack([along, second, np.cross(along, second)], axis=1)


def _turns(matrices: Array) -> Array:
    """Return the rotations of matrices with scales, (joints, 4)."""
    sizes = np.linalg.norm(matrices, axis=1, keepdims=True)
    return rotations.from_matrix(matrices / np.where(sizes > 0.0, sizes, 1.0))
