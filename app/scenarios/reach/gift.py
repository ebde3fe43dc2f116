"""One small thing and its ways: into a hand, out of it, and hopping to another place."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.table.props import GRIP, Side, Thing
from cubeling.characters.motion import smoothstep

Point = NDArray[np.float64]

SETTLE_S, HOP_S, HOP_M = 0.25, 0.7, 0.08
"""Time in which a thing comes to its place in a hand or from one [s]; time [s] and height [m] of
its hops."""


@dataclass(frozen=True)
class _Move:
    """The way of a thing from one place to another."""

    start: Point  # (3,) [m]
    since: float  # [s]
    seconds: float
    height: float = 0.0  # of the arc [m]

    def at(self, end: Point, now: float) -> Point:
        """Return where it is, on its way to its end."""
        share = smoothstep(min(max((now - self.since) / self.seconds, 0.0), 1.0))
        place = self.start + share * (end - self.start)
        place[1] += 4.0 * self.height * share * (1.0 - share)
        return place


class Gift:
    """A thing with its history."""

    def __init__(self, name: str, home: Point) -> None:
        self.name = name
        """What it is: one of `TOYS`."""
        self.home = home
        """Where it stands at first, (3,) [m]."""
        self.place = home
        """Where it stands, or will in a moment; in a hand: its offset from there, (3,) [m]."""
        self.given = 0
        """How often it was brought."""
        self.hand: Side | None = None
        """The hand that has it."""
        self._move = _Move(home, -math.inf, 1.0)

    def take(self, hand: Side, palm: Point, now: float) -> None:
        """Let a hand have it from now on."""
        start = self._now_at(now) + GRIP - palm
        self.hand, self.place = hand, np.zeros(3)
        self._move = _Move(start, now, SETTLE_S)

    def put(self, place: Point, palm: Point, now: float) -> None:
        """Let it go, to stand at a place."""
        self.hand, self.place = None, place
        self.given += 1
        self._move = _Move(palm - GRIP, now, SETTLE_S)

    def hop(self, place: Point, palm: Point | None, now: float) -> None:
        """Let it hop to another place."""
        start = self._now_at(now) if palm is None or self.hand is None else palm - GRIP
        self.hand, self.place = None, place
        self._move = _Move(start, now, HOP_S, HOP_M)

    def thing(self, now: float) -> Thing:
        """Return it as it is to be drawn."""
        return Thing(self.name, self._now_at(now), self.hand)

    def _now_at(self, now: float) -> Point:
        return self._move.at(self.place, now)
