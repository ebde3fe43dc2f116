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

from characters.skeleton.pose import Array
from characters.smoothing import hermite

MIN_REST_S = 3.0
"""Shorter rests are left out, unless all are [s]."""

MIN_STRETCH_S, MAX_STRETCH_S = 2.0, 6.0
"""How long a stretch is played [s]."""

CROSSFADE_S = 0.8
"""How long a stretch goes over into the next one [s]."""

TEMPO, SIZE = 0.15, 0.2
"""How much faster or larger than recorded it is at most, as a logarithm."""

BACKWARD_SHARE = 0.3
"""Amplitude of what is played backwards; with that of the others, the variance is as recorded."""

CANDIDATES = 20
"""Stretches of which the nearest is taken."""

_VELOCITY_SHARE = 0.1  # [s²] of the squared distance of velocities in that of stretches


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

    first: float
    """Frame at which it begins."""

    last: float
    """Frame at which it stays if it is played for longer."""

    begin: float
    """When [s]."""

    end: float
    """When the next one begins [s]."""

    tempo: float
    size: float

    def at(self, stretches: Stretches, time: float) -> Array:
        """Return the posture's offset at a time [s], (size,)."""
        at = self.first + (time - self.begin) * self.tempo * stretches.rate
        frame = min(int(at), int(self.last) - 1)
        u = min(at - frame, 1.0)
        (a, b), slopes = (
            stretches.offsets[frame : frame + 2],
            stretches.velocities[frame : frame + 2] / stretches.rate,
        )
        offset: Array = self.size * hermite(a, slopes[0], b, slopes[1], u)
        return offset


class StretchStream:
    """Makes small variations of stretches, in the order of time."""

    def __init__(self, stretches: Stretches, rng: np.random.Generator) -> None:
        self._forward = _Sequence(stretches, rng)
        self._backward = _Sequence(stretches.backward(), rng)

    def at(self, time: float) -> Array:
        """Return the offset of the posture, (size,), at a time [s] not before the last one."""
        share = math.sqrt(1.0 - BACKWARD_SHARE**2)
        return share * self._forward.at(time) + BACKWARD_SHARE * self._backward.at(time)


class _Sequence:
    """One stretch after the other."""

    def __init__(self, stretches: Stretches, rng: np.random.Generator) -> None:
        self._stretches, self._rng = stretches, rng
        self._now = self._before = self._next(0.0)

    def at(self, time: float) -> Array:
        """Return the offset of the posture, (size,), at a time [s] not before the last one."""
        while time >= self._now.end:
            self._before, self._now = self._now, self._next(self._now.end)
        value = self._now.at(self._stretches, time)
        u = (time - self._now.begin) / CROSSFADE_S
        if u >= 1.0 or self._before is self._now:
            return value
        eased = u * u * (3.0 - 2.0 * u)
        return value * eased + self._before.at(self._stretches, time) * (1.0 - eased)

    def _next(self, time: float) -> _Played:
        """Return the stretch that begins at a time [s]: the nearest of some to the present one."""
        own, rng = self._stretches, self._rng
        tempo = float(np.exp(rng.uniform(-TEMPO, TEMPO)))
        size = float(np.exp(rng.uniform(-SIZE, SIZE)))
        firsts = rng.integers(len(own.offsets) - 1, size=CANDIDATES)
        needed = (MIN_STRETCH_S + CROSSFADE_S) * tempo * own.rate
        long = firsts[own.last[firsts] - firsts >= needed]
        firsts = long if len(long) else firsts - (own.last[firsts] == firsts)
        if time > 0.0:
            here, soon = (self._now.at(own, t) for t in (time, time + 1.0 / own.rate))
            apart = own.offsets[firsts] * size - here
            faster = own.velocities[firsts] * (size * tempo) - (soon - here) * own.rate
            far = (apart**2).sum(1) + _VELOCITY_SHARE * (faster**2).sum(1)
            firsts = firsts[[int(far.argmin())]]
        first, last = int(firsts[0]), int(own.last[firsts[0]])
        longest = (last - first) / (tempo * own.rate) - CROSSFADE_S
        length = min(rng.uniform(MIN_STRETCH_S, MAX_STRETCH_S), max(longest, 1.0 / own.rate))
        return _Played(float(first), float(last), time, time + float(length), tempo, size)
