"""Idle motion without end: balance shifts from rest to rest, and small variations on top.

Source: Egges 2006, sections 3.3.2 and 4.1 (S8, S9, S11).
"""

import math
from collections import deque
from typing import Literal

import numpy as np

from affect import NEUTRAL, Emotion
from characters.motion.motion import RootDelta
from characters.skeleton.pose import Array, Pose
from characters.synthesis.idle.database import IdleDatabase, RestingPosture
from characters.synthesis.idle.fitting import fit, nearest_clip
from characters.synthesis.idle.stretches import StretchStream
from characters.synthesis.idle.variations import COMPONENTS, VariationStream

Small = Literal["recorded", "extrema"]
"""How small variations are made: of recorded stretches, or of clustered extrema as published."""

REACTION_S = 0.7
"""After how long it leaves a posture that does not suit a new emotion [s]."""

MARGIN = 0.1
"""How far an emotion may leave the region of a posture before that does not suit it."""

_KEPT_S = 2.0  # played time that can still be sampled [s]


class IdleMotion:
    """The idle motion of a person; a `Motion`, to be sampled in the order of time.

    What changes it takes effect at the next frame that is made: another database, another emotion,
    and the wish to shift now. A time long before the latest enters it again: it goes on from where
    it is.
    """

    def __init__(self, database: IdleDatabase, seed: int = 0, small: Small = "recorded") -> None:
        self._rng = np.random.default_rng(seed)
        self._emotion = NEUTRAL
        self._database = database
        self._suiting = database.suiting(NEUTRAL)
        self._variations = (
            StretchStream(database.stretches, self._rng)
            if small == "recorded"
            else VariationStream(database.variations, database.space, self._rng)
        )
        self._posture = self._drawn(self._suiting.postures)
        self._rested, self._chance = 0.0, self._rng.uniform()
        self._shift: deque[Array] = deque()  # postures on the way to the next rest
        self._kept: deque[Array] = deque(maxlen=max(int(_KEPT_S * database.rate), 4))
        self._made = 0  # number of frames that have been made
        self._entered = 0  # of them, before time 0

    @property
    def duration(self) -> float:
        """Infinite."""
        return math.inf

    @property
    def database(self) -> IdleDatabase:
        """Her idle motion; may be replaced by one with other shifts, see `IdleDatabase.added`."""
        return self._database

    @database.setter
    def database(self, database: IdleDatabase) -> None:
        self._database = database
        self._suiting = database.suiting(self._emotion)

    def feel(self, emotion: Emotion | None) -> None:
        """Show an emotion from now on: by its postures and shifts, and in the length of pauses.

        A posture that does not suit it any more is left within `REACTION_S`.
        """
        emotion = emotion or NEUTRAL
        if emotion == self._emotion:
            return
        self._emotion = emotion
        suiting = self._database.suiting(emotion)
        if suiting is self._suiting:
            return
        region = self._posture.feeling
        if region is not None and region.contains(emotion, MARGIN):
            return
        self._suiting = suiting
        if self._posture not in suiting.postures:
            self._rested = max(self._rested, self.pause(self._posture, self._chance) - REACTION_S)

    def shift_now(self) -> None:
        """Shift the balance as soon as the present shift, if any, has ended."""
        self._rested = math.inf

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        at = max(time, 0.0) * self.database.rate
        if self._entered + int(at) < self._made - len(self._kept):
            self._entered = self._made - int(at)
        frame = self._entered + int(at)
        while self._made < frame + 3:
            varied = self._variations.at(self._made / self.database.rate)
            self._kept.append(self.next_posture() + varied)
            self._made += 1
        first = frame - (self._made - len(self._kept))
        rows = [self._kept[max(first + n, 0)] for n in (-1, 0, 1, 2)]
        return self.database.kind.poses(_between(rows, at - int(at)))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no movement: the feet stay."""
        return RootDelta()

    def next_posture(self) -> Array:
        """Return the posture of the next frame, (size,), without variations (S8)."""
        if self._shift:
            return self._shift.popleft()
        if self._rested < self.pause(self._posture, self._chance):
            self._rested += 1.0 / self.database.rate
            return self._posture.vector
        following = self._following(self._posture)
        if following is not None:
            self._posture, shift = following
            self._shift.extend(shift[1:])
        self._rested, self._chance = 0.0, self._rng.uniform()
        return self._shift.popleft() if self._shift else self._posture.vector

    def pause(self, posture: RestingPosture, chance: float) -> float:
        """Return how long to rest [s]: p_m + chance · (1 − activation) · p_o (eq. 4.2)."""
        known = posture.balance in self._suiting.by_balance
        shortest, longest = (self._suiting if known else self._database).pause_limits(
            posture.balance
        )
        return shortest + chance * (1.0 - self._emotion.arousal) * (longest - shortest)

    def _following(self, posture: RestingPosture) -> tuple[RestingPosture, Array] | None:
        """Return where to rest next and the shift to there, or None if no shift leads on."""
        database = self._suiting
        chances = database.probabilities(posture.balance)
        shifts = [each for each in database.shifts if each.start == posture.balance]
        if not chances:
            shifts = list(database.shifts)
            chances = {each.end: 1.0 / len(shifts) for each in shifts}
        if not chances:
            return None
        names, odds = [*chances], np.array([*chances.values()])
        balance = names[int(self._rng.choice(len(names), p=odds / odds.sum()))]
        end = self._drawn(database.by_balance.get(balance) or database.postures)
        fitting = [each for each in shifts if each.end == balance]
        ends = np.stack([each.vectors[[0, -1]] for each in fitting])
        at = database.space.project(
            np.concatenate([ends, [[posture.vector, end.vector]]]), COMPONENTS
        )
        chosen = fitting[nearest_clip(at[:-1, 0], at[:-1, 1], at[-1, 0], at[-1, 1])].vectors
        return end, fit(chosen, [(0, posture.vector), (len(chosen) - 1, end.vector)])

    def _drawn(self, postures: tuple[RestingPosture, ...]) -> RestingPosture:
        return postures[int(self._rng.integers(len(postures)))]


def _between(rows: list[Array], u: float) -> Array:
    """Return the cubic curve through four rows, at u from the second to the third (Catmull-Rom)."""
    before, start, end, after = rows
    leaving, arriving = (end - before) / 2.0, (after - start) / 2.0
    rise = end - start
    curve: Array = start + u * (
        leaving
        + u * (3.0 * rise - 2.0 * leaving - arriving + u * (leaving + arriving - 2.0 * rise))
    )
    return curve
