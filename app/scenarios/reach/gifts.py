"""Small things on the table, which the character brings to the cube one after the other."""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.table.props import GRIP, PosedBody, Side, Thing
from cubeling.app.scenarios.reach.gift import Gift
from cubeling.characters import TableView

Point = NDArray[np.float64]

Doing = Literal["wait", "fetch", "grasp", "carry", "put", "give", "rejoice"]
"""Nothing, go to a thing, take it, go to the cube with it, put it down, let go of it, be glad that
all are there."""

HOMES: dict[str, tuple[float, float]] = {
    "flower": (-0.19, -0.05),
    "balloon": (0.17, 0.10),
    "flag": (0.20, -0.09),
}
"""Where each thing stands at first, (x, z) from where the cube was first seen [m]."""

TURNS_RAD = tuple(sign * 0.15 * step for step in range(11) for sign in (1, -1))
"""By how much that place is turned about the cube, the smallest turn that brings it into the
picture: one that is higher than it is wide shows little beside the cube."""

EXTENT_M = np.array([[-0.035, 0.0, 0.0], [0.035, 0.0, 0.0], [0.0, 0.1, 0.0]])
"""Points of a thing on its place that are to be in the picture [m]."""

SIDES_RAD = {"flower": math.radians(165), "balloon": math.radians(15), "flag": math.radians(215)}
"""Where each thing is put down: its direction from the cube, from +x towards the player."""

BESIDE_M, AWAY_M = 0.035, 0.09
"""How far from a side of the cube a thing is put down, and from where it is brought again [m]."""

RADIUS_M = 0.004
"""Room for the foot of a thing before the feet of the character [m]."""

AT_HAND_M = 0.012
"""A palm this near to where it is to be is there [m]."""

GIVE_S, REJOICE_S = 0.5, 2.2
"""How long it stays with a thing that it has put down, and how long it is glad [s]."""

PATIENCE_S = 2.5
"""A hand that is not there after so long takes the thing, or lets it go, from where it is [s]."""

UNDER_EDGES = 0.75
"""A thing this near to the middle of the cube is in its way, in edges of the cube."""


class Gifts:
    """Where the things are, and what the character does with them."""

    def __init__(self, cube_edge: float) -> None:
        self.doing: Doing = "wait"
        """What it does."""
        self.gift: Gift | None = None
        """With which."""
        self.hand: Side = "right"
        """With which hand."""
        self._edge, self._beside = cube_edge, cube_edge / 2 + BESIDE_M
        self._gifts: list[Gift] = []
        self._since = -math.inf

    def lay_out(self, cube: Point, view: TableView | None = None) -> None:
        """Put the things on the table about a cube, if they are not there yet, and in view."""
        if not self._gifts:
            self._gifts = [
                Gift(name, _place_in_view(cube * [1.0, 0.0, 1.0], np.array([x, 0.0, z]), view))
                for name, (x, z) in HOMES.items()
            ]

    def scatter(self, body: PosedBody | None, now: float) -> None:
        """Let all things hop home."""
        for gift in self._gifts:
            hand = gift.hand
            gift.hop(gift.home, None if body is None or hand is None else body.palm(hand), now)
        self._begin("wait", now)

    def make_way(self, cube: Point, now: float) -> None:
        """Let the things hop aside on which a cube is put down."""
        if cube[1] > self._edge:
            return
        for gift in self._gifts:
            distance = math.dist(gift.place[[0, 2]], cube[[0, 2]])
            if gift.hand is None and distance < UNDER_EDGES * self._edge:
                gift.hop(self._spot(gift, cube), None, now)

    def things(self, now: float) -> tuple[Thing, ...]:
        """Return the things as they are to be drawn."""
        return tuple(gift.thing(now) for gift in self._gifts)

    @property
    def held(self) -> str:
        """Name of the thing in its hand, "" for none."""
        return self.gift.name if self.gift is not None and self.gift.hand is not None else ""

    @property
    def busy(self) -> bool:
        """Whether it has a thing in its hand, or has just had one: the cube must wait."""
        return bool(self.held) or self.doing in ("give", "rejoice")

    @property
    def named(self) -> str:
        """Name of the thing that it fetches or has, "" for none."""
        return "" if self.gift is None else self.gift.name

    def goal(self, cube: Point) -> Point | None:
        """Return where to go, (3,) on the table [m]: the thing, or its place beside the cube."""
        if self.gift is None or self.doing == "wait":
            return None
        return self.gift.place if self.gift.hand is None else self._spot(self.gift, cube)

    def stand_point(self, here: Point, cube: Point, distance: float) -> Point | None:
        """Return where to stand for that, (3,) [m]: before the thing, or behind its place."""
        goal = self.goal(cube)
        if goal is None:
            return None
        carries = self.gift is not None and self.gift.hand is not None
        out = goal - cube if carries else here - goal
        out[1] = 0.0
        length = max(float(np.linalg.norm(out)), 1e-9)
        return np.asarray(goal + out * ((distance + RADIUS_M) / length))

    def end_pauses(self, now: float) -> None:
        """Have time for something else again, some time after a thing was put down."""
        lasts = {"give": GIVE_S, "rejoice": REJOICE_S}.get(self.doing, math.inf)
        if now - self._since > lasts:
            self._begin("wait", now)

    def update(
        self, now: float, cube: Point, body: PosedBody, *, free: bool, there: bool
    ) -> tuple[str, ...]:
        """Advance by one frame; return its events: "taken", "given", "finished".

        `free` is whether the character has time for it, `there` whether it stands at its goal.
        """
        if not free:
            self._begin("carry" if self.held else "wait", now)
            return ()
        if self.doing == "wait":
            self._choose(cube, now)
        elif self.doing == "fetch" and there:
            assert self.gift is not None
            self.hand = _nearer_side(body, self.gift.place)
            self._begin("grasp", now)
        elif self.doing == "carry" and there:
            self._begin("put", now)
        elif self.doing == "grasp":
            return self._grasp(body, now)
        elif self.doing == "put":
            return self._put(cube, body, now)
        return ()

    def _choose(self, cube: Point, now: float) -> None:
        """Begin with a thing that is not beside the cube: each one once before any again."""
        self.gift = min(self._away(cube), key=lambda each: each.given, default=None)
        if self.gift is not None:
            self._begin("fetch", now)

    def _grasp(self, body: PosedBody, now: float) -> tuple[str, ...]:
        gift, palm = self.gift, body.palm(self.hand)
        assert gift is not None
        if palm is None or not self._at_hand(palm, gift.place + GRIP, now):
            return ()
        gift.take(self.hand, palm, now)
        self._begin("carry", now)
        return ("taken",)

    def _put(self, cube: Point, body: PosedBody, now: float) -> tuple[str, ...]:
        gift, palm = self.gift, body.palm(self.hand)
        assert gift is not None
        spot = self._spot(gift, cube)
        if palm is None or not self._at_hand(palm, spot + GRIP, now):
            return ()
        gift.put(spot, palm, now)
        missing = self._away(cube)
        self._begin("give" if missing else "rejoice", now)
        return ("given",) if missing else ("finished",)

    def _at_hand(self, palm: Point, target: Point, now: float) -> bool:
        return math.dist(palm, target) < AT_HAND_M or now - self._since > PATIENCE_S

    def _away(self, cube: Point) -> list[Gift]:
        """Return the things that are not beside the cube."""
        return [
            each for each in self._gifts if math.dist(each.place, self._spot(each, cube)) > AWAY_M
        ]

    def _spot(self, gift: Gift, cube: Point) -> Point:
        angle = SIDES_RAD[gift.name]
        return np.array(
            [
                cube[0] + self._beside * math.cos(angle),
                0.0,
                cube[2] + self._beside * math.sin(angle),
            ]
        )

    def _begin(self, doing: Doing, now: float) -> None:
        self.doing, self._since = doing, now
        if doing in ("wait", "give", "rejoice"):
            self.gift = None


def _place_in_view(centre: Point, offset: Point, view: TableView | None) -> Point:
    """Return a place beside a centre, turned about it into the picture if that can be done."""
    if view is not None:
        for turn in TURNS_RAD:
            c, s = math.cos(turn), math.sin(turn)
            place = centre + offset @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
            if not view.misses(place + EXTENT_M, ()).any():
                return np.asarray(place)
    return np.asarray(centre + offset)


def _nearer_side(body: PosedBody, place: Sequence[float] | Point) -> Side:
    """Return the hand on whose side a place is; the right one for a place ahead."""
    placed = body.posed.table_from_character
    across = float((np.asarray(place) - placed[:3, 3]) @ placed[:3, 0])
    return "left" if across > 0.01 * float(placed[1, 1]) else "right"
