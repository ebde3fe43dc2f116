"""Which hand reaches for a place, and how far it is there, from frame to frame."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cubeling.characters.behaviour.intents import ReachIntent, Times
from cubeling.characters.behaviour.realization.planned_values import PlannedValues
from cubeling.characters.ik.reaching import UpperBody
from cubeling.characters.motion.curves import ease
from cubeling.characters.skeleton.scalar_quaternions import Vector, length, subtract
from cubeling.characters.skeleton.way_round import WayRound

LEAVE_S = 0.9
"""How long a hand takes to go that was at its place and is not asked for any more [s]: a little
longer than it usually comes and sits down, since the body may go elsewhere meanwhile."""

BLEND_S = 0.3
"""In which time its weight goes over from one plan to another [s]."""

JOIN_S = 0.3
"""How long it takes at least to join in late, or to go to another place than before [s]."""

USUAL_AWAY_RAD, MOST_AWAY_RAD = 0.3, 1.8
"""How far a joint of an arm is from where it hangs while the body stirs [rad], and the angle up to
which more than that counts."""

AWAY_SLOWNESS = 0.42
"""How much longer a hand takes for each radian that its arm is farther away [1/rad]: another act
has taken it there and is given up, so its way is longer, and the arm is still going back."""

RELAX_S = 0.6
"""How long it takes to go if its end is not known [s]."""

HAND_CHANGE_MARGIN = 0.12
"""By how much the other hand must be nearer to take over, in arm lengths."""


@dataclass
class ReachingHand:
    """One hand of one character, from frame to frame."""

    intent: ReachIntent | None = None
    """What it does, or did last; None if it is free."""

    place: Vector = (0.0, 0.0, 0.0)
    """Where it is to be, in the character frame [m]."""

    weight: float = 0.0
    """How far it is there, 0…1."""

    jumped: bool = False
    """Whether it is now asked to be somewhere else than a frame before."""

    _joined: tuple[float, float] = (0.0, 0.0)
    _slowness: float = 1.0
    _left: tuple[float, float] | None = None
    way: WayRound = field(default_factory=WayRound)
    """By which way its arm goes there."""

    _weights: PlannedValues = field(default_factory=lambda: PlannedValues(1, BLEND_S))

    def follow(
        self, intent: ReachIntent, place: Vector, now: float, step: float, away: float = 0.0
    ) -> None:
        """Go on with an intent, or begin it; its place moves at most `step` [m] without a jump.

        `away` is how far its arm is from where it hangs [rad]: what another act has left of it.
        """
        old = self.intent
        self.jumped = self.weight > 0.0 and (
            old is None
            or (old.key, old.kind) != (intent.key, intent.kind)
            or length(subtract(place, self.place)) > step
        )
        if old is None or old.key != intent.key or self._left is not None:
            self._joined, self._left = (now, self.weight), None
            farther = max(min(away, MOST_AWAY_RAD) - USUAL_AWAY_RAD, 0.0)
            self._slowness = 1.0 + (AWAY_SLOWNESS * farther if self.weight == 0.0 else 0.0)
        self.intent, self.place = intent, place

    def leave(self, now: float) -> None:
        """Let it fade, because nothing is asked of it."""
        self.jumped = False
        if self._left is None:
            self._left = now, self.weight

    def advance(self, now: float) -> None:
        """Bring its weight to a time [s]; it changes smoothly when its times do."""
        if self.intent is None:
            return
        times, left = self.intent.times, self._left
        plan = (times, self._joined) if left is None else left
        asked = self._weights.update(
            plan, lambda time: np.array([self._wanted_weight(times, time)]), now
        )
        self.weight = min(max(float(asked[0]), 0.0), 1.0)
        if left is not None and now >= left[0] + _leave_s(left[1]):
            self.weight, self.intent, self._left = 0.0, None, None
            self._weights = PlannedValues(1, BLEND_S)

    def _wanted_weight(self, times: Times, now: float) -> float:
        if self._left is not None:
            since, weight = self._left
            return weight * (1.0 - ease((now - since) / _leave_s(weight), "gonio"))
        since, before = self._joined
        begin, ready = max(times.start, since), times.ready
        if since > times.start:  # it joins in late, or comes from another place
            ready = max(ready, since + JOIN_S)
        ready = begin + self._slowness * (ready - begin)
        there = ease((now - begin) / (ready - begin), "gonio") if now < ready else 1.0
        weight = before + (1.0 - before) * there
        if times.relax is None or now <= times.relax:
            return weight
        end = times.relax + RELAX_S if times.end is None else times.end
        going = (now - times.relax) / (end - times.relax) if now < end else 1.0
        return weight * (1.0 - ease(going, "gonio"))


def _leave_s(weight: float) -> float:
    """Return how long a hand of a weight takes to go [s].

    By the root of the way, so that it accelerates no more than over the whole of it: it may still
    be on its way there, and then its weight must first stop growing.
    """
    return max(LEAVE_S * math.sqrt(weight), BLEND_S)


@dataclass
class NearestHand:
    """Chooses a hand for each intent that leaves the choice, and keeps to it."""

    body: UpperBody

    shoulders: dict[str, Vector]
    """Where they begin, in the character frame [m]."""

    _chosen: dict[str, str] = field(default_factory=dict)

    def choose(self, intent: ReachIntent, place: Vector, taken: Sequence[str]) -> str:
        """Return the side of the hand; the nearer free one, with hysteresis."""

        def cost(side: str) -> float:
            arm = self.body.arms[side]
            far = length(subtract(place, self.shoulders[side])) / (arm.upper + arm.fore)
            kept = HAND_CHANGE_MARGIN if self._chosen.get(intent.key) == side else 0.0
            return far - kept + (math.inf if side in taken and len(self.shoulders) > 1 else 0.0)

        self._chosen[intent.key] = min(self.shoulders, key=cost)
        return self._chosen[intent.key]

    def forget(self, intents: Sequence[ReachIntent]) -> None:
        """Forget all choices but those for some intents."""
        if self._chosen:
            keys = {intent.key for intent in intents}
            self._chosen = {key: side for key, side in self._chosen.items() if key in keys}
