"""How a character tries to get the cube: what it does, by how easy, far or impossible that is."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Doing = Literal[
    "watch", "touch", "cheer", "clasp", "stretch", "shrug", "point", "come", "sulk", "shade",
    "search",
]  # fmt: skip
"""Watch it at rest, touch it, be glad, hold it with both hands, stretch in vain, give up, point at
it, go to it, wait disappointed, shade the eyes against the light, and look about for it."""

HIGH, LOW = 0.95, 0.85
"""Height of the cube's centre, over that of the body, from which it is held up, and below which it
no longer is."""

EASY, HARD = 1.06, 1.18
"""Effort up to which it begins to touch the cube, and beyond which it can no longer: fingertips
reach further than the palm, whose limit is 1."""

EASIER = 0.25
"""By how much the effort must fall below that at which it gave up, to try again."""

NEAR_M = 0.18
"""A cube that is no further from where it would stand is worth stretching for [m]."""

ARRIVED_M, LEFT_BEHIND_M = 0.015, 0.06
"""How near to that place it is there, and from where on it has to go again [m]."""

MOVED_M = 0.03
"""A cube that has been touched is to be touched again when it has moved by this [m]."""

ELSEWHERE_M = 0.06
"""A cube that it gave up is worth another try when it has moved by this [m]."""

SURPRISED = ("touch", "stretch", "point", "come", "sulk")
"""What it stops to look up to a cube that is held up high."""

LOST_S, FOUND_S = 0.5, 0.2
"""How long the cube must be hidden to be looked for, and seen to be found: fingers hide it."""

CHEER_S, STRETCH_S, SHRUG_S, POINT_S, SHADE_S = 2.0, 2.2, 1.9, 1.3, 2.0
"""How long it is glad, stretches before it gives up, shrugs, points, and shades its eyes [s]."""

TOUCH_S, COME_S = 3.0, 10.0
"""A cube that is not touched, or not arrived at, in this time is as good as out of reach [s]."""

SULK_S = 5.0
"""After so long it tries again, although nothing has become easier [s]."""


@dataclass(frozen=True)
class Prospect:
    """What a character knows about the cube in a frame."""

    now: float
    """Time of the frame [s]."""

    seen: bool
    """Whether the cube is seen."""

    cube: NDArray[np.float64]
    """Its centre, (3,) in the table frame [m]; where it was last, if it is not seen."""

    touch: NDArray[np.float64]
    """The point of it that is nearest, (3,) [m]."""

    effort: float
    """How hard the cube is to touch from here: see `reach_effort`."""

    gap: float
    """How far the character is from where it would stand beside the cube [m]; 0 if it is there."""

    height: float
    """Height of the cube's centre over that of the body."""

    touching: bool
    """Whether its hand is at the cube."""

    claspable: bool = False
    """Whether it is off the table, with both sides in reach."""


class Catching:
    """A state machine: `update` once a frame; `doing` is what the character does now."""

    def __init__(self) -> None:
        self.doing: Doing = "search"
        """What it does."""
        self.since = -math.inf
        """Since when [s]."""
        self.gave_up_at = math.inf
        """The effort at which it gave up last."""
        self.gave_up_on: NDArray[np.float64] | None = None
        """Where the cube was then, (3,) [m]."""
        self.caught: NDArray[np.float64] | None = None
        """Where the cube was when it was touched last, (3,) [m]; None before."""
        self.high = False
        """Whether the cube is held up above its head."""
        self._shaded = False
        self._seen_since: float | None = None
        self._hidden_since: float | None = None

    def update(self, prospect: Prospect) -> tuple[str, ...]:
        """Advance by one frame; return its events: "reached", "unreachable"."""
        before = self.doing
        self.look(prospect)
        following = _NEXT[self.doing](self, prospect, prospect.now - self.since)
        far = prospect.effort > HARD
        if self.high and far and not self._shaded and following in SURPRISED:
            following, self._shaded = "shade", True
        self._begin(following, prospect.now)
        if self.doing == before:
            return ()
        if self.doing == "cheer":
            self.caught = prospect.cube
            return ("reached",)
        if self.doing == "shrug":
            self.gave_up_at, self.gave_up_on = prospect.effort, prospect.cube
            return ("unreachable",)
        return ()

    @property
    def content(self) -> bool:
        """Whether the cube is where it was touched last."""
        return self.doing == "watch" and self.caught is not None

    @staticmethod
    def has_moved(prospect: Prospect, place: NDArray[np.float64] | None, by: float) -> bool:
        """Return whether the cube is elsewhere than at a place, (3,), by a distance [m]."""
        return place is None or math.dist(place, prospect.cube) >= by

    def look(self, prospect: Prospect) -> None:
        """Begin to look for a cube that is hidden, and stop when it is seen."""
        now = prospect.now
        self.high = prospect.height > (LOW if self.high else HIGH)
        self._shaded = self._shaded and self.high
        if prospect.seen:
            self._hidden_since = None
            self._seen_since = now if self._seen_since is None else self._seen_since
            if self.doing == "search" and now - self._seen_since >= FOUND_S - 1e-9:
                self._begin("watch", now)
        else:
            self._seen_since = None
            self._hidden_since = now if self._hidden_since is None else self._hidden_since
            if now - self._hidden_since >= LOST_S - 1e-9:
                self._begin("search", now)

    def _begin(self, doing: Doing, now: float) -> None:
        if doing != self.doing:
            self.doing, self.since = doing, now


def _try(catching: Catching, prospect: Prospect) -> Doing:
    """Return how to begin to get at a cube that is not caught."""
    if prospect.effort <= EASY:
        return "touch"
    return "stretch" if catching.high or prospect.gap <= NEAR_M else "point"


def _watch(catching: Catching, prospect: Prospect, spent: float) -> Doing:
    moved = catching.has_moved(prospect, catching.caught, MOVED_M)
    return _try(catching, prospect) if moved else "watch"


def _cheer(catching: Catching, prospect: Prospect, spent: float) -> Doing:
    if spent <= CHEER_S:
        return "cheer"
    return "clasp" if prospect.claspable else _watch(catching, prospect, spent)


def _clasp(catching: Catching, prospect: Prospect, spent: float) -> Doing:
    if prospect.claspable:
        return "clasp"
    catching.caught = prospect.cube  # where it was let go
    return _try(catching, prospect) if prospect.effort > HARD else "watch"


def _touch(catching: Catching, prospect: Prospect, spent: float) -> Doing:
    if prospect.touching:
        return "cheer"
    if prospect.effort > HARD:
        return "come" if prospect.gap > LEFT_BEHIND_M and not catching.high else "stretch"
    return "shrug" if spent > TOUCH_S else "touch"


def _stretch(catching: Catching, prospect: Prospect, spent: float) -> Doing:
    if prospect.touching:
        return "cheer"
    if prospect.effort <= EASY:
        return "touch"
    if spent > STRETCH_S:
        return "shrug"
    return "point" if prospect.gap > 2.0 * NEAR_M and not catching.high else "stretch"


def _shrug(catching: Catching, prospect: Prospect, spent: float) -> Doing:
    easy = prospect.effort <= EASY < catching.gave_up_at
    if spent > SHRUG_S / 2 and (
        easy or catching.has_moved(prospect, catching.gave_up_on, ELSEWHERE_M)
    ):
        return _try(catching, prospect)
    if spent <= SHRUG_S:
        return "shrug"
    return "come" if prospect.gap > ARRIVED_M and not catching.high else "sulk"


def _point(catching: Catching, prospect: Prospect, spent: float) -> Doing:
    if prospect.effort <= EASY or catching.high:
        return _try(catching, prospect)
    return "come" if spent > POINT_S else "point"


def _come(catching: Catching, prospect: Prospect, spent: float) -> Doing:
    if prospect.effort <= EASY:
        return "touch"
    arrived = prospect.gap <= ARRIVED_M or spent > COME_S or catching.high
    if not arrived:
        return "come"
    return "touch" if prospect.effort <= HARD else "stretch"


def _sulk(catching: Catching, prospect: Prospect, spent: float) -> Doing:
    easier = prospect.effort < catching.gave_up_at - EASIER
    left = prospect.gap > LEFT_BEHIND_M and not catching.high
    return _try(catching, prospect) if easier or left or spent > SULK_S else "sulk"


def _shade(catching: Catching, prospect: Prospect, spent: float) -> Doing:
    if prospect.effort <= EASY or not catching.high:
        return _try(catching, prospect)
    return "stretch" if spent > SHADE_S else "shade"


_NEXT: dict[Doing, Callable[[Catching, Prospect, float], Doing]] = {
    "watch": _watch,
    "touch": _touch,
    "cheer": _cheer,
    "clasp": _clasp,
    "stretch": _stretch,
    "shrug": _shrug,
    "point": _point,
    "come": _come,
    "sulk": _sulk,
    "shade": _shade,
    "search": lambda catching, prospect, spent: "search",
}
"""What follows: from what it does, what it knows, and for how long it has done so [s]."""
