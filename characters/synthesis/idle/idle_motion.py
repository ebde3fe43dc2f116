"""Idle motion without end: balance shifts from rest to rest, and small variations on top.

Source: Egges 2006, sections 3.3.2 and 4.1 (S8, S9, S11).
"""

import math
from collections import deque
from typing import Literal

import numpy as np

from cubeling.affect import NEUTRAL, Emotion
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import hermite
from cubeling.characters.synthesis.idle.bridges import (
    bridge,
    fitted_shift,
    hurry,
    nearest_balance,
)
from cubeling.characters.synthesis.idle.database import (
    IdleDatabase,
    RestingPosture,
    shifts_from,
)
from cubeling.characters.synthesis.idle.motion_texture import StretchStream
from cubeling.characters.synthesis.idle.pauses import PauseLaw
from cubeling.characters.synthesis.idle.variations import VariationStream

Small = Literal["recorded", "extrema"]
"""How small variations are made: of recorded stretches, or of clustered extrema as published."""

REACTION_S = 0.7
"""After how long it leaves a posture that does not suit a new emotion [s]."""

REGION_MARGIN = 0.1
"""How far an emotion may leave the region of a posture before that does not suit it."""

FOLLOWED = 0.8
"""How often it goes on from a rest as she did: people shift in bursts, with long rests between."""

USUAL_PAUSES = PauseLaw()
"""α = β = 1, as in the thesis."""

RAMP_S = 0.4
"""How long small variations take to come and go [s]."""

MAX_HASTE = 2.0
"""How much faster than recorded a shift is made at most, for an act that begins soon: one that then
comes too late goes over into the act."""

_UNHURRIED = 10**6  # frames
_KEPT_S = 2.0  # played time that can still be sampled [s]


class IdleMotion:
    """The idle motion of a person; a `Motion`, to be sampled in the order of time.

    What changes it takes effect at the next frame that is made: another database, another emotion,
    and the wish to shift now. A time long before the latest enters it again: it goes on from where
    it is.
    """

    def __init__(
        self,
        database: IdleDatabase,
        seed: int = 0,
        small: Small = "recorded",
        pauses: PauseLaw = USUAL_PAUSES,
    ) -> None:
        self.pauses = pauses
        """How activation shortens her pauses; may be changed while it plays."""
        self._rng = np.random.default_rng(seed)
        self._emotion = NEUTRAL
        self._database = database
        self._suiting = database.for_emotion(NEUTRAL)
        self._variations: StretchStream | VariationStream
        if small == "recorded":
            self._variations = StretchStream(self._suiting.stretches, self._rng)
        else:
            variations = self._suiting.variations
            self._variations = VariationStream(variations, database.space, self._rng)
        self._posture = self._draw(self._suiting.postures)
        self._rested, self._chance = 0.0, self._share(self._posture)
        self._here = self._posture.vector  # the posture of the latest frame
        self._shift: deque[Array] = deque()  # postures on the way to the next rest
        self._kept: deque[Array] = deque(maxlen=max(int(_KEPT_S * database.rate), 4))
        self._made = 0  # number of frames that have been made
        self._entered = 0  # of them, before time 0
        self._asked = 0.0  # for which time, the last one [s]
        self._talking = False  # shifts are those of a speech
        self._rests = False  # shifts nowhere by itself
        self._lively = 1.0  # how much of the small variations shows
        self._calming = 0  # for how many frames they fade out at the end of a way; 0: not leading

    @property
    def duration(self) -> float:
        """Infinite: it goes on for as long as it is sampled."""
        return math.inf

    @property
    def database(self) -> IdleDatabase:
        """Her idle motion; may be replaced by one with other shifts (`with_shift`)."""
        return self._database

    @database.setter
    def database(self, database: IdleDatabase) -> None:
        self._database = database
        self._suit(database.for_emotion(self._emotion))

    def feel(self, emotion: Emotion | None) -> None:
        """Show an emotion from now on: by its postures and shifts, and in the length of pauses.

        A posture that does not suit it any more is left within `REACTION_S`.
        """
        emotion = emotion or NEUTRAL
        if emotion == self._emotion:
            return
        self._emotion = emotion
        suiting = self._database.for_emotion(emotion)
        if suiting is self._suiting:
            return
        region = self._posture.feeling
        if region is not None and region.contains(emotion, REGION_MARGIN):
            return
        self._suit(suiting)
        if self._posture not in suiting.postures:
            self._rested = max(self._rested, self.pause(self._posture, self._chance) - REACTION_S)

    def _suit(self, suiting: IdleDatabase) -> None:
        """Take postures, shifts and small variations of a part of the database from now on."""
        self._suiting = suiting
        if isinstance(self._variations, StretchStream):
            self._variations.change(suiting.stretches)
        else:
            self._variations.change(suiting.variations)

    def shift_now(self) -> None:
        """Shift the balance as soon as the present shift, if any, has ended."""
        self._rested = math.inf

    def talk(self, shift: bool | None) -> None:
        """Shift when a speech asks for it, or not until then; None in silence."""
        self._talking = shift is not None
        if shift:
            self.shift_now()

    def begin_at(self, posture: Array) -> None:
        """Stand in a posture, (size,), from the next frame on, and go on from there."""
        balance = nearest_balance(self._database, posture)
        self._posture = RestingPosture(posture, balance, 0.0, cut=True)
        self._here = posture
        self._shift.clear()
        self._kept.clear()
        self._rested = self._lively = 0.0
        self.go_on()

    def lead_to(self, posture: Array, within: float = math.inf, haste: float = math.inf) -> float:
        """Go to a posture, (size,), by the shortest way and stay there; see `bridge`.

        Parameters
        ----------
        within
            When to be there at the latest, from the last time that was asked for [s]; at least two
            frames.
        haste
            How much faster than recorded it goes at most; then it comes later.

        Returns
        -------
        float
            When it is exactly there [s], from that time.
        """
        database, rate = self._database, self._database.rate
        asked, limit = self._asked * rate + self._entered, self._frames_until(within)
        way = bridge(database, self._posture, posture, self._rng, limit - len(self._shift))
        rows = self._hurried([*self._shift, *way[1:]], limit, haste)
        self._posture = RestingPosture(posture, nearest_balance(database, posture), 0.0, cut=True)
        self._calming = min(round(RAMP_S * rate), len(rows))
        return (self._made + len(rows) - 1 - asked) / rate

    def await_act(self, first: Pose | None, within: float) -> None:
        """Go to the pose in which an act begins; see `StandingMotion`."""
        if first is None:
            self.rest(within, MAX_HASTE)
        else:
            self.lead_to(self._database.kind.vectors(first), within, MAX_HASTE)

    def rest(self, within: float = math.inf, haste: float = math.inf) -> None:
        """End the shift under way, and begin none by itself; the parameters are of `lead_to`."""
        if self._shift:
            self._hurried([*self._shift], self._frames_until(within), haste)
        self._rests = True

    def go_on(self) -> None:
        """Go on after `lead_to` or `rest`."""
        self._calming, self._rests = 0, False

    def _frames_until(self, within: float) -> int:
        """Return in how many frames from now a time is over, from the last one asked for [s]."""
        if math.isinf(within):
            return _UNHURRIED
        rate = self._database.rate
        asked = self._asked * rate + self._entered
        return max(int(asked + within * rate + 1e-6) - self._made + 1, 1)

    def _hurried(self, way: list[Array], limit: int, haste: float) -> Array:
        """Take a way from here on, in so many frames if that is possible, and return its rows."""
        rows = hurry(np.stack([self._here, *way]), max(limit, math.ceil(len(way) / haste)))
        self._shift = deque(rows)
        return rows

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        self._asked = max(time, 0.0)
        at = self._asked * self.database.rate
        if self._entered + int(at) < self._made - len(self._kept):
            self._entered = self._made - int(at)
        frame = self._entered + int(at)
        while self._made < frame + 3:
            self._here = self.next_posture()
            varied = self._variations.at(self._made / self.database.rate)
            self._kept.append(self._here + self._liveliness() * varied)
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
        if self._calming:
            return self._posture.vector
        waits = (self._talking or self._rests) and self._rested < math.inf
        if waits or self._rested < self.pause(self._posture, self._chance):
            self._rested += 1.0 / self.database.rate
            return self._posture.vector
        following = self._next_posture(self._posture)
        if following is not None:
            self._posture, shift = following
            self._shift.extend(shift[1:])
        self._rested, self._chance = 0.0, self._share(self._posture)
        return self._shift.popleft() if self._shift else self._posture.vector

    def _liveliness(self) -> float:
        """Return how much of the small variations shows in the next frame."""
        if self._calming:
            self._lively = min(self._lively, len(self._shift) / self._calming)
        else:
            self._lively = min(self._lively + 1.0 / (RAMP_S * self._database.rate), 1.0)
        return self._lively

    def pause(self, posture: RestingPosture, chance: float) -> float:
        """Return how long to rest [s]: p_m + (α − activation) β (d − p_m), d of her own rests.

        Equation 4.2 has chance · p_o for d − p_m; but people rest long or shortly, and seldom in
        between. A chance, 0…1, is the share of her rests on this balance that are shorter.
        """
        database = self._database_for(posture.balance)
        dwells = database.dwells[posture.balance]
        dwell = float(dwells[min(int(chance * len(dwells)), len(dwells) - 1)])
        # Nobody is active for less time than her rests that were not cut.
        shortest = min(database.pause_limits(posture.balance)[0], dwell)
        return self.pauses.length(shortest, dwell - shortest, self._emotion.arousal)

    def _share(self, posture: RestingPosture) -> float:
        """Return the chance of the pause that was recorded in a posture; any, if none was."""
        if posture.number < 0:
            return float(self._rng.uniform())
        dwells = self._database_for(posture.balance).dwells[posture.balance]
        return float((np.searchsorted(dwells, posture.duration) + 0.5) / len(dwells))

    def _database_for(self, balance: str) -> IdleDatabase:
        """Return what suits the emotion if it has rests on a balance, else all of the database."""
        return self._suiting if balance in self._suiting.by_balance else self._database

    def _next_posture(self, posture: RestingPosture) -> tuple[RestingPosture, Array] | None:
        """Return where to rest next and the shift to there, or None if no shift leads on."""
        database = self._suiting
        recorded = [each for each in database.shifts if each.leaves == posture.number >= 0]
        after = [each for each in database.postures if each.number == posture.number + 1]
        if recorded and after and self._rng.uniform() < FOLLOWED:
            return after[0], fitted_shift(database, recorded, posture.vector, after[0].vector)
        chances = database.probabilities(posture.balance)
        shifts = [each for each in database.shifts if each.start == posture.balance]
        if not chances:
            shifts = list(database.shifts)
            chances = {each.end: 1.0 / len(shifts) for each in shifts}
        if not chances:
            return None
        names, odds = [*chances], np.array([*chances.values()])
        balance = names[int(self._rng.choice(len(names), p=odds / odds.sum()))]
        end = self._draw(database.by_balance.get(balance) or database.postures)
        fitting = [each for each in shifts if each.end == balance]
        fitting = shifts_from(fitting, posture.feeling)
        return end, fitted_shift(database, fitting, posture.vector, end.vector)

    def _draw(self, postures: tuple[RestingPosture, ...]) -> RestingPosture:
        return postures[int(self._rng.integers(len(postures)))]


def _between(rows: list[Array], u: float) -> Array:
    """Return the cubic curve through four rows, at u from the second to the third (Catmull-Rom)."""
    before, start, end, after = rows
    return hermite(start, (end - before) / 2.0, end, (after - start) / 2.0, u)
