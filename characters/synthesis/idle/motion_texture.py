"""Small variations of a resting posture, from stretches of the recorded rests.

Egges joins extrema of each component by itself (`variations`). That keeps how far and how fast each
one goes, but not how joints move together, nor that people are calm and lively in turn. Here
stretches of a few seconds follow each other, each a little faster or slower, larger or smaller than
it was recorded, and each begins where the one before is nearly (as motion textures do: Li, Wang and
Shum 2002). A few minutes of recordings would come again soon, so that other stretches, played
backwards, are mixed in.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import hermite

MIN_REST_S = 3.0
"""Shorter rests are left out, unless all are [s]."""

MIN_STRETCH_S, MAX_STRETCH_S = 2.0, 6.0
"""How long a stretch is played [s]."""

JOIN_S = 1.5
"""How long what is left of the stretch before takes to vanish [s]."""

TEMPO, SIZE = 0.15, 0.2
"""How much faster or larger than recorded it is at most, as a logarithm."""

BACKWARD_SHARE = 0.3
"""Amplitude of what is played backwards; with that of the others, the variance is as recorded."""

CANDIDATE_STRETCHES = 20
"""Stretches of which the nearest is taken."""

_VELOCITY_SHARE = 0.1  # [s²] of the squared distance of velocities in that of stretches
_NOTHING = np.zeros(1), np.zeros(1)  # left of the stretch before


@dataclass(frozen=True)
class Stretches:
    """Recorded rests, one after the other, about their mean postures."""

    offsets: Array
    """Posture vectors minus the mean of their rest, (frames, size)."""

    velocities: Array
    """Their change [1/s], (frames, size)."""

    last: Array
    """Last frame of the rest that each frame belongs to, (frames,)."""

    rate: float
    """[Hz]."""

    @staticmethod
    def of(rests: Sequence[Array], rate: float) -> "Stretches":
        """Return the stretches of rests, posture vectors (frames, size) each."""
        long = [each for each in rests if len(each) >= MIN_REST_S * rate]
        longest = max(rests, key=len)
        used = [each - each.mean(0) for each in long or [longest.repeat(2, axis=0)]]
        ends = np.cumsum([len(each) for each in used])
        return Stretches(
            np.concatenate(used),
            np.concatenate([np.gradient(each, axis=0) * rate for each in used]),
            np.concatenate(
                [np.full(len(each), end - 1) for each, end in zip(used, ends, strict=True)]
            ),
            rate,
        )

    def backward(self) -> "Stretches":
        """Return the rests as they look when time runs backwards."""
        ends = np.unique(self.last)
        firsts = np.repeat([0, *(ends[:-1] + 1)], np.diff([-1, *ends]))
        return Stretches(
            self.offsets[::-1],
            -self.velocities[::-1],
            (len(firsts) - 1 - firsts)[::-1],
            self.rate,
        )


@dataclass(frozen=True)
class _Played:
    """A stretch that is played."""

    stretches: Stretches

    first: int
    """Frame at which it begins."""

    begin: float
    """When [s]."""

    end: float
    """When the next one begins [s]."""

    tempo: float
    size: float

    left: tuple[Array, Array]
    """What is left of the stretch before: offset, and its change in `JOIN_S`; (size,) each."""

    def at(self, time: float) -> Array:
        """Return the posture's offset at a time [s], (size,)."""
        own = self.stretches
        at = self.first + (time - self.begin) * self.tempo * own.rate
        frame = min(int(at), int(own.last[self.first]) - 1)
        (a, b), slopes = (
            own.offsets[frame : frame + 2],
            own.velocities[frame : frame + 2] / own.rate,
        )
        offset: Array = self.size * hermite(a, slopes[0], b, slopes[1], min(at - frame, 1.0))
        u = (time - self.begin) / JOIN_S
        return offset if u >= 1.0 else offset + hermite(*self.left, *_NOTHING, u)


class StretchStream:
    """Makes small variations of stretches, in the order of time."""

    def __init__(self, stretches: Stretches, rng: np.random.Generator) -> None:
        self._forward = _Sequence(stretches, rng)
        self._backward = _Sequence(stretches.backward(), rng)

    def at(self, time: float) -> Array:
        """Return the offset of the posture, (size,), at a time [s] not before the last one."""
        share = math.sqrt(1.0 - BACKWARD_SHARE**2)
        return share * self._forward.at(time) + BACKWARD_SHARE * self._backward.at(time)

    def change(self, stretches: Stretches) -> None:
        """Take other stretches from now on."""
        self._forward.change(stretches)
        self._backward.change(stretches.backward())


class _Sequence:
    """One stretch after the other."""

    def __init__(self, stretches: Stretches, rng: np.random.Generator) -> None:
        self._stretches, self._rng = stretches, rng
        self._time = 0.0
        self._now = self._next(0.0, None)

    def at(self, time: float) -> Array:
        """Return the offset of the posture, (size,), at a time [s] not before the last one."""
        while time >= self._now.end:
            self._now = self._next(self._now.end, self._now)
        self._time = time
        return self._now.at(time)

    def change(self, stretches: Stretches) -> None:
        """Go over to other stretches now."""
        self._stretches = stretches
        self._now = self._next(self._time, self._now)

    def _next(self, time: float, before: _Played | None) -> _Played:
        """Return the stretch that begins at a time [s]: the nearest of some to the one before."""
        own, rng = self._stretches, self._rng
        tempo = float(np.exp(rng.uniform(-TEMPO, TEMPO)))
        size = float(np.exp(rng.uniform(-SIZE, SIZE)))
        firsts = rng.integers(len(own.offsets) - 1, size=CANDIDATE_STRETCHES)
        long = firsts[own.last[firsts] - firsts >= MIN_STRETCH_S * tempo * own.rate]
        firsts = long if len(long) else firsts - (own.last[firsts] == firsts)
        first, left = int(firsts[0]), _NOTHING
        if before is not None:
            here, soon = (before.at(t) for t in (time, time + 1.0 / own.rate))
            apart = here - own.offsets[firsts] * size
            faster = (soon - here) * own.rate - own.velocities[firsts] * (size * tempo)
            far = (apart**2).sum(1) + _VELOCITY_SHARE * (faster**2).sum(1)
            nearest = int(far.argmin())
            first, left = int(firsts[nearest]), (apart[nearest], faster[nearest] * JOIN_S)
        longest = (own.last[first] - first - 1) / (tempo * own.rate)
        length = min(rng.uniform(MIN_STRETCH_S, MAX_STRETCH_S), max(longest, 1.0 / own.rate))
        return _Played(own, first, time, time + float(length), tempo, size, left)
