"""What is known of a person's idle motion.

Source: Egges 2006, section 3.3.2 (S6). Nothing is compared pair by pair, so that balance shifts may
be added and removed while it plays.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from cubeling.affect import Emotion
from cubeling.affect.regions import Region
from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.idle.motion_texture import Stretches
from cubeling.characters.synthesis.idle.posture_space import PostureSpace, PostureVectors
from cubeling.characters.synthesis.idle.recordings import StandingRecording
from cubeling.characters.synthesis.idle.variations import COMPONENTS, Variations


@dataclass(frozen=True, eq=False)
class BalanceShift:
    """A recorded way from one rest to another."""

    vectors: Array
    """Its posture vectors, (frames, size)."""

    start: str
    """Balance before: "left", "both" or "right"."""

    end: str
    """The balance that it leads to, one of `BALANCES`."""

    feeling: Region | None = None
    """The emotions that it leads to; None if it suits any."""

    leaves: int = -1
    """Number of the resting posture that it left in the recording, for that with the next number;
    −1 if it was not recorded between two rests."""

    before: Region | None = None
    """The emotions that it leaves, where they are others than it leads to."""


@dataclass(frozen=True, eq=False)
class RestingPosture:
    """A posture in which the person rests, and for how long she did."""

    vector: Array
    """The posture, (size,)."""

    balance: str
    """On which foot she stands."""

    duration: float
    """How long she rested so [s]."""

    cut: bool
    """Whether the recording begins or ends in this rest, so that it was longer."""

    feeling: Region | None = None
    """The emotions that it shows; None if it suits any."""

    number: int = -1
    """Its number among the rests of the recordings; −1 if it was not recorded."""

    frames: Array | None = None
    """How she moved while she rested, posture vectors (frames, size); None if not recorded."""


_Felt = TypeVar("_Felt", BalanceShift, RestingPosture)


@dataclass(frozen=True)
class IdleDatabase:
    """The idle motion of a person, on a skeleton."""

    kind: PostureVectors
    """What the vectors hold."""

    rate: float
    """Frame rate of the shifts [Hz]."""

    space: PostureSpace
    """Principal components in which her postures are compared and mixed."""

    postures: tuple[RestingPosture, ...]
    """The postures in which she rests between shifts."""

    shifts: tuple[BalanceShift, ...]
    """How she shifts her balance."""

    @staticmethod
    def of(recordings: Sequence[StandingRecording], kind: PostureVectors) -> "IdleDatabase":
        """Return the idle motion of the person in recordings of one rate.

        Raises
        ------
        CharacterError
            If there is no recording, or their rates differ.
        """
        if not recordings:
            raise CharacterError("idle motion is learned from at least one recording")
        rate = recordings[0].rate
        if any(abs(each.rate - rate) > 1e-6 for each in recordings):
            raise CharacterError("recordings of one person need the same frame rate")
        space = PostureSpace.of(np.concatenate([each.vectors for each in recordings]))
        postures: list[RestingPosture] = []
        shifts: list[BalanceShift] = []
        for each in recordings:
            for a, b in each.shifts:
                way = each.vectors[a.end - 1 : b.first + 1]
                leaves = len(postures) + each.rests.index(a)
                turns = b is each.rests[-1]  # from the emotion at its begin to that at its end
                before = each.before if turns else None
                feeling = each.feeling if turns else each.before or each.feeling
                shifts.append(BalanceShift(way, a.balance, b.balance, feeling, leaves, before))
            for rest in each.rests:
                frames = each.vectors[rest.first : rest.end]
                lasted = (rest.end - rest.first) / rate
                cut = rest in (each.rests[0], each.rests[-1])
                feeling = each.feeling if rest is each.rests[-1] else each.before or each.feeling
                own = rest.balance, lasted, cut, feeling, len(postures)
                postures.append(RestingPosture(frames.mean(0), *own, frames))
        return IdleDatabase(kind, rate, space, tuple(postures), tuple(shifts))

    @property
    def rests(self) -> list[Array]:
        """Posture vectors of each rest that was recorded, (frames, size)."""
        found = [each.frames for each in self.postures if each.frames is not None]
        return found or [np.repeat(self.postures[0].vector[None], 2, axis=0)]

    @cached_property
    def stretches(self) -> Stretches:
        """Her small variations as recorded."""
        return Stretches.of(self.rests, self.rate)

    @cached_property
    def variations(self) -> Variations:
        """Her small variations as extrema of components."""
        return Variations.of([self.space.project(r, COMPONENTS) for r in self.rests], self.rate)

    def for_emotion(self, emotion: Emotion) -> "IdleDatabase":
        """Return what suits an emotion (S11), small variations too.

        These are the postures and shifts whose region it is in; if there is none, those that suit
        any emotion; if there is none of them either, all. The choice is made for postures and for
        shifts by itself.
        """
        there = tuple(n for n, region in enumerate(self._regions) if region.contains(emotion))
        if there not in self._known:
            regions = [self._regions[n] for n in there]
            self._known[there] = replace(
                self,
                postures=_items_for(self.postures, regions),
                shifts=_items_for(self.shifts, regions),
            )
        return self._known[there]

    @cached_property
    def _regions(self) -> list[Region]:
        return list(dict.fromkeys(p.feeling for p in self.postures if p.feeling is not None))

    @cached_property
    def _known(self) -> "dict[tuple[int, ...], IdleDatabase]":
        """What suits emotions, by the numbers of the regions that they are in."""
        return {}

    @cached_property
    def by_balance(self) -> dict[str, tuple[RestingPosture, ...]]:
        """The postures of each balance that there is."""
        names = dict.fromkeys(each.balance for each in self.postures)
        return {name: tuple(p for p in self.postures if p.balance == name) for name in names}

    def probabilities(self, balance: str) -> dict[str, float]:
        """Return the probability of each balance after one, by counting; none if none follows."""
        ends = [each.end for each in self.shifts if each.start == balance]
        return {name: ends.count(name) / len(ends) for name in dict.fromkeys(ends)}

    def pause_limits(self, balance: str) -> tuple[float, float]:
        """Return the shortest and the longest rest on a balance [s]."""
        own = self.by_balance[balance]
        whole = [each.duration for each in own if not each.cut]
        longest = max(each.duration for each in own)
        return min(whole, default=longest), longest

    @cached_property
    def dwells(self) -> dict[str, Array]:
        """How long she rested on each balance that there is, from short to long [s]."""
        return {
            name: np.sort([each.duration for each in own]) for name, own in self.by_balance.items()
        }

    def with_shift(self, shift: BalanceShift) -> "IdleDatabase":
        """Return it with one more shift."""
        return replace(self, shifts=(*self.shifts, shift))

    def without_shift(self, number: int) -> "IdleDatabase":
        """Return it without one of its shifts."""
        return replace(self, shifts=self.shifts[:number] + self.shifts[number + 1 :])


def shifts_from(shifts: Sequence[BalanceShift], feeling: Region | None) -> list[BalanceShift]:
    """Return the shifts that were recorded as one emotion became another, if this one was left.

    Else those that need no such change; if there are none, all.
    """
    turning = [each for each in shifts if each.before is not None and each.before == feeling]
    return turning or [each for each in shifts if each.before is None] or list(shifts)


def _items_for(items: tuple[_Felt, ...], regions: Sequence[Region]) -> tuple[_Felt, ...]:
    """Return the items of regions, or else those without a region, or else all."""
    there = tuple(each for each in items if each.feeling in regions)
    return there or tuple(each for each in items if each.feeling is None) or items
