"""Idle motion without end: balance shifts from rest to rest, and small variations on top.

Source: Egges 2006, sections 3.3.2 and 4.1 (S8, S9, S11).
"""

import math
from collections import deque
from collections.abc import Iterator

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
    activation, and the wish to shift now.
    """

    def __init__(self, database: IdleDatabase, seed: int = 0) -> None:
        self.database = database
        """Her idle motion; may be replaced by one of the same skeleton and rate."""
        self.activation = 0.0
        """−1…1: active people shift more often, see `pause`."""
        self._rng = np.random.default_rng(seed)
        self._variations = VariationStream(database.variations, self._rng)
        self._shift_now = False
        self._rows: deque[Array] = deque(maxlen=max(int(_KEPT_S * database.rate), 2))
        self._count = 0
        self._frames = self._base()

    @property
    def duration(self) -> float:
        """Infinite."""
        return math.inf

    def shift_now(self) -> None:
        """Shift the balance as soon as the present shift, if any, has ended."""
        self._shift_now = True

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s], not long before the latest."""
        at = max(time, 0.0) * self.database.rate
        while self._count < at + 2.0:
            self._rows.append(self._made(self._count / self.database.rate))
            self._count += 1
        first = max(int(at), self._count - len(self._rows))
        row = first - (self._count - len(self._rows))
        u = min(max(at - first, 0.0), 1.0)
        vector = self._rows[row] * (1.0 - u) + self._rows[row + 1] * u
        return self.database.kind.poses(vector)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no movement: the feet stay."""
        return RootDelta()

    def _made(self, time: float) -> Array:
        """Return the next frame: where she rests or shifts to, and the variation."""
        varied = self._variations.at(time)
        return next(self._frames) + self.database.space.components[:, : len(varied)] @ varied

    def _base(self) -> Iterator[Array]:
        """Yield postures without end: rest, shift, rest (S8)."""
        posture = self._drawn(self.database.postures)
        while True:
            left = self.pause(posture)
            while left > 0.0 and not self._shift_now:
                yield posture.vector
                left -= 1.0 / self.database.rate
            self._shift_now = False
            following = self._following(posture)
            if following is None:
                yield posture.vector
                continue
            posture, shift = following
            yield from shift[1:]

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
