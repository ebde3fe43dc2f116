"""Idle motion without end: balance shifts from rest to rest, and small variations on top.

Source: Egges 2006, sections 3.3.2 and 4.1 (S8, S9, S11).
"""

import math
from collections import deque

import numpy as np

from characters.motion.motion import RootDelta
from characters.skeleton.pose import Array, Pose
from characters.synthesis.idle.database import IdleDatabase, RestingPosture
from characters.synthesis.idle.fitting import fit, nearest_clip
from characters.synthesis.idle.variations import COMPONENTS, VariationStream

_KEPT_S = 2.0  # played time that can still be sampled [s]


class IdleMotion:
    """The idle motion of a person; a `Motion`, to be sampled in the order of time.

    What changes it takes effect at the next frame that is made: another database, another
    activation, and the wish to shift now. A time long before the latest enters it again: it goes
    on from where it is.
    """

    def __init__(self, database: IdleDatabase, seed: int = 0) -> None:
        self.database = database
        """Her idle motion; may be replaced by one with other shifts, see `IdleDatabase.added`."""
        self.activation = 0.0
        """−1…1: active people shift more often, see `pause`."""
        self._rng = np.random.default_rng(seed)
        self._variations = VariationStream(database.variations, self._rng)
        self._posture = self._drawn(database.postures)
        self._left = self.pause(self._posture)
        self._shift: deque[Array] = deque()  # postures on the way to the next rest
        self._kept: deque[Array] = deque(maxlen=max(int(_KEPT_S * database.rate), 2))
        self._made = 0  # number of frames that have been made
        self._entered = 0  # of them, before time 0

    @property
    def duration(self) -> float:
        """Infinite."""
        return math.inf

    def shift_now(self) -> None:
        """Shift the balance as soon as the present shift, if any, has ended."""
        self._left = 0.0

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        at = max(time, 0.0) * self.database.rate
        if self._entered + int(at) < self._made - len(self._kept):
            self._entered = self._made - int(at)
        frame = self._entered + int(at)
        while self._made < frame + 2:
            varied = self._variations.at(self._made / self.database.rate)
            components = self.database.space.components[:, : len(varied)]
            self._kept.append(self.next_posture() + components @ varied)
            self._made += 1
        row, u = frame - (self._made - len(self._kept)), at - int(at)
        vector = self._kept[row] * (1.0 - u) + self._kept[row + 1] * u
        return self.database.kind.poses(vector)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no movement: the feet stay."""
        return RootDelta()

    def next_posture(self) -> Array:
        """Return the posture of the next frame, (size,), without variations (S8)."""
        if self._shift:
            return self._shift.popleft()
        if self._left > 0.0:
            self._left -= 1.0 / self.database.rate
            return self._posture.vector
        following = self._following(self._posture)
        if following is not None:
            self._posture, shift = following
            self._shift.extend(shift[1:])
        self._left = self.pause(self._posture)
        return self._shift.popleft() if self._shift else self._posture.vector

    def pause(self, posture: RestingPosture) -> float:
        """Return how long to rest [s]: drawn from p_m to p_m + (1 − activation) p_o (eq. 4.2)."""
        shortest, longest = self.database.pause_limits(posture.balance)
        return float(
            shortest + self._rng.uniform() * (1.0 - self.activation) * (longest - shortest)
        )

    def _following(self, posture: RestingPosture) -> tuple[RestingPosture, Array] | None:
        """Return where to rest next and the shift to there, or None if no shift leads on."""
        database = self.database
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
