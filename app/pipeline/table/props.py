"""Small virtual things on the table, and the body that reaches for them."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.characters import Character, PosedCharacter
from cubeling.characters.motion import find_hand, reach_effort
from cubeling.characters.rendering import GRIP_M, SceneCharacter, toy

Point = NDArray[np.float64]

Side = Literal["left", "right"]
"""One of two hands."""

CLEARANCE_M = 0.006
"""Between the front of the body and what it stands before, if it reaches so far [m]."""

COMFORTABLE_EFFORT = 0.7
"""Effort with which it takes a thing: it leans, but not as far as it can."""

FINGERS_M, PAW_M = 0.012, 0.03
"""How near fingers are that touch something, and a paw, which is broad and under a muzzle [m]."""

GRIP = np.array([0.0, GRIP_M, 0.0])
"""Where a hand holds a thing, from its foot [m]."""


@dataclass(frozen=True)
class Thing:
    """A small thing on the table, or in a hand; it stays upright."""

    name: str
    """What it is: one of `cubeling.characters.rendering.toys.TOYS`."""

    place: Point
    """Where its foot is, (3,) in the table frame [m]. In a hand: where it is from there."""

    hand: Side | None = None
    """The hand that carries it; None for none."""


@dataclass(frozen=True)
class BodyParts:
    """The parts of a character that reach."""

    hands: Mapping[Side, tuple[int, Point]]
    """Joint of each hand; the middle of its palm and its fingertips, (2, 3) in the frame of the
    joint [m]."""

    chest: Point
    """The middle of its chest at rest, (3,) in the character frame [m]."""

    touching: float
    """A hand this near to something touches it [m on the table]."""

    stand: float
    """How far from a thing it stands that it takes [m on the table]."""

    margins: Point
    """How far the body reaches beyond its joints at rest, lowest and highest corner (2, 3) [m]."""

    head: int | None = None
    """Joint of its head; None for a character without one."""

    @staticmethod
    def of(character: Character, scale: float) -> "BodyParts":
        """Return the parts of a character, which is `scale` times as large on the table.

        One without arms has no hands.
        """
        skeleton, anatomy = character.skeleton, character.anatomy
        rest = skeleton.rest.globals(skeleton)
        hands: dict[Side, tuple[int, Point]] = {}
        touching = FINGERS_M
        sides: tuple[Side, Side] = ("left", "right")
        for side in sides:
            hand = find_hand(skeleton, anatomy, side)
            if hand is not None:
                placed = rest[hand.joint]
                touching = FINGERS_M if hand.fingers else PAW_M
                tip = placed[:3, 3] + hand.length * hand.axes[0]
                points = np.stack([hand.palm, tip]) - placed[:3, 3]
                hands[side] = hand.joint, points @ np.linalg.inv(placed[:3, :3]).T
        joint = anatomy.joint("chest") or anatomy.joint("spine")
        chest = np.array([0.0, 0.6 * character.height, 0.0])
        if joint is not None:
            chest = rest[joint, :3, 3]
        stand = _stand_distance(character, scale)
        margins = character.bounds - _box(rest[:, :3, 3])
        return BodyParts(hands, chest, touching, stand, margins, anatomy.joint("head"))


def _box(points: Point) -> Point:
    """Return the lowest and highest corner, (2, 3), of points (n, 3)."""
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _stand_distance(character: Character, scale: float) -> float:
    """Return how far from a thing a character stands [m]: as near as it needs to reach the grip."""
    distance = character.length * scale / 2 + CLEARANCE_M
    placed = np.diag([scale, scale, scale, 1.0])
    distances = np.arange(distance, 0.4 * distance, -0.005).tolist()
    for each in distances if character.upper_body.arms else ():
        if reach_effort(character, placed, GRIP + [0.0, 0.0, each]) < COMFORTABLE_EFFORT:
            return float(each)
    return distance


@dataclass(frozen=True)
class PosedBody:
    """The character's body on the table, as after the previous frame."""

    character: Character

    parts: BodyParts
    """The parts of it that reach."""

    posed: PosedCharacter
    """Its pose and its place."""

    @property
    def place(self) -> Point:
        """Where it stands, (3,) in the table frame [m]."""
        return self.posed.table_from_character[:3, 3]

    @property
    def height(self) -> float:
        """Its height on the table [m]."""
        return self.character.height * float(self.posed.table_from_character[1, 1])

    @property
    def chest(self) -> Point:
        """The middle of its chest when it stands straight, (3,) in the table frame [m]."""
        placed = self.posed.table_from_character
        return np.asarray(placed[:3, :3] @ self.parts.chest + placed[:3, 3])

    @property
    def face(self) -> Point:
        """Where others look that look at it, (3,) in the table frame [m]."""
        head = self.parts.head
        return self.chest if head is None else np.asarray(self._table_from_joints[head, :3, 3])

    @property
    def bounds(self) -> Point:
        """A box around it as it stands now, lowest and highest corner (2, 3), in its frame [m]."""
        if len(self.posed.pose.rotations) != len(self.character.skeleton.parents):
            return self.character.bounds  # an older session has a pose of another skeleton
        return _box(self._joints[:, :3, 3]) + self.parts.margins

    @property
    def has_hands(self) -> bool:
        """Whether it has a hand to reach with."""
        return bool(self.parts.hands)

    def effort(self, target: Point, placed: Point | None = None) -> float:
        """Return how hard a point, (3,) in the table frame [m], is to reach.

        0 is within the arm, 1 the limit of the body, more is beyond; infinite without arms. It is
        reached from where the body stands, or from another place of it, (4, 4).
        """
        place = self.posed.table_from_character if placed is None else placed
        return reach_effort(self.character, place, target)

    def beside(self, point: Point, distance: float) -> Point:
        """Return its place, (4, 4), if it went straight to a distance [m] from a point, (3,)."""
        placed = self.posed.table_from_character.copy()
        x, _, z = point - placed[:3, 3]
        size, scale = max(float(np.hypot(x, z)), 1e-9), float(placed[1, 1])
        sine, cosine = x / size, z / size
        placed[[0, 2], 3] = point[[0, 2]] - distance * np.array([sine, cosine])
        turned = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
        placed[:3, :3] = scale * turned
        return placed

    def palm(self, side: Side) -> Point | None:
        """Return where the palm of a hand is, (3,) in the table frame [m]; None without hands."""
        return self._hand_points(side)[0] if side in self.parts.hands else None

    def hand_distance(self, target: Point) -> float:
        """Return how far the nearest palm or fingertip is from a point, (3,) on the table [m]."""
        points = [self._hand_points(side) for side in self.parts.hands]
        return min(float(np.linalg.norm(each - target, axis=1).min()) for each in points)

    def place_thing(self, thing: Thing) -> SceneCharacter:
        """Return a thing as it is to be drawn: in the hand that carries it, or where it stands."""
        table_from_toy = np.eye(4)
        palm = None if thing.hand is None else self.palm(thing.hand)
        table_from_toy[:3, 3] = thing.place if palm is None else palm - GRIP + thing.place
        return toy(thing.name).place(table_from_toy, self.posed.timestamp)

    def _hand_points(self, side: Side) -> Point:
        joint, points = self.parts.hands[side]
        placed = self._table_from_joints[joint]
        return np.asarray(points @ placed[:3, :3].T + placed[:3, 3])

    @cached_property
    def _joints(self) -> Point:
        """Placements of all joints in the character's frame, (joints, 4, 4)."""
        return self.posed.pose.globals(self.character.skeleton)

    @cached_property
    def _table_from_joints(self) -> Point:
        """The same on the table."""
        return np.asarray(self.posed.table_from_character @ self._joints)
