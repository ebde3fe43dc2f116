"""Weights over time: fades, envelopes, keyed values and their products.

The shapes are MIRAnim's blending parameters (Egges, "Real-time animation of interactive virtual
humans", 2006, section 4.2 and appendix B): linear, cubic and goniometric fades, ADSR envelopes.
"""

import itertools
import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias, get_args

from cubeling.characters.errors import CharacterError
from cubeling.characters.smoothing import smoothstep

Ease = Literal["linear", "cubic", "gonio"]
"""Shape of a fade: linear, 3u² − 2u³, or half a cosine."""


class Curve(Protocol):
    """A weight or scale that changes over time."""

    def at(self, time: float, duration: float) -> float:
        """Return the value at a time [s] since the start of something that lasts `duration` [s].

        The duration may be infinite; a fade at the end then never starts.
        """
        ...


Weight: TypeAlias = "float | Curve"
"""A constant, or a number that changes over time."""


def value(weight: Weight, time: float, duration: float) -> float:
    """Return a weight at a time [s] since the start of something that lasts `duration` [s]."""
    return float(weight) if isinstance(weight, (int, float)) else weight.at(time, duration)


def ease(u: float, shape: Ease) -> float:
    """Return the progress of a fade, 0…1, at the fraction u of its length; constant outside 0…1.

    >>> [round(ease(u, "gonio"), 3) for u in (-1.0, 0.25, 0.5, 2.0)]
    [0.0, 0.146, 0.5, 1.0]
    """
    u = min(max(u, 0.0), 1.0)
    if shape == "linear":
        return u
    if shape == "cubic":
        return smoothstep(u)
    return (1.0 - math.cos(math.pi * u)) / 2.0


@dataclass(frozen=True)
class FadeCurve:
    """1, with a rise from 0 at the start and a fall to 0 at the end."""

    fade_in: float = 0.0
    """Length of the rise [s]."""

    fade_out: float = 0.0
    """Length of the fall, up to the end [s]; where both overlap, their product is taken."""

    shape: Ease = "gonio"
    """Shape of the rise and of the fall."""

    def __post_init__(self) -> None:
        _check_times("fade curve", self.shape, self.fade_in, self.fade_out)

    @staticmethod
    def percent(
        fade_in: float, fade_out: float, duration: float, shape: Ease = "gonio"
    ) -> "FadeCurve":
        """Return a curve with fades in percent of a duration [s].

        >>> FadeCurve.percent(20, 20, 5.0)
        FadeCurve(fade_in=1.0, fade_out=1.0, shape='gonio')
        """
        return FadeCurve(fade_in / 100 * duration, fade_out / 100 * duration, shape)

    def at(self, time: float, duration: float) -> float:
        """Return the value at a time [s] since the start."""
        return _ramp(time, self.fade_in, self.shape) * _ramp(
            duration - time, self.fade_out, self.shape
        )


@dataclass(frozen=True)
class Adsr:
    """Attack, decay, sustain, release: up to 1, down to a constant level, and down to 0."""

    attack: float
    """Length of the rise from 0 to 1 [s]."""

    decay: float
    """Length of the following fall to the level [s]."""

    level: float
    """The sustained level, 0…1."""

    release: float
    """Length of the fall to 0, up to the end [s]."""

    shape: Ease = "gonio"
    """Shape between the values."""

    def __post_init__(self) -> None:
        _check_times("ADSR curve", self.shape, self.attack, self.decay, self.release)
        if not 0.0 <= self.level <= 1.0:
            raise CharacterError(f"ADSR curve: level {self.level}; give 0 to 1")

    def at(self, time: float, duration: float) -> float:
        """Return the value at a time [s] since the start."""
        attacked = _ramp(time, self.attack, self.shape)
        decayed = _ramp(time - self.attack, self.decay, self.shape) if time > self.attack else 0.0
        released = _ramp(duration - time, self.release, self.shape)
        return attacked * (1.0 - (1.0 - self.level) * decayed) * released


@dataclass(frozen=True)
class Keyed:
    """Values at times, interpolated between them and constant before and after."""

    times: tuple[float, ...]
    """Times since the start [s], ascending."""

    values: tuple[float, ...]
    """One value for each time."""

    shape: Ease = "gonio"
    """Shape between the values."""

    def __post_init__(self) -> None:
        check_knots("keyed curve", self.times, self.values)
        _check_times("keyed curve", self.shape)

    def at(self, time: float, duration: float) -> float:
        """Return the value at a time [s] since the start."""
        after = bisect_right(self.times, time)
        if after in (0, len(self.times)):
            return self.values[max(after - 1, 0)]
        low, high = self.times[after - 1], self.times[after]
        a, b = self.values[after - 1], self.values[after]
        return a + (b - a) * ease((time - low) / (high - low), self.shape)


@dataclass(frozen=True)
class Product:
    """Product of several weights."""

    factors: tuple[Weight, ...]
    """Weights that are multiplied at each time."""

    def at(self, time: float, duration: float) -> float:
        """Return the value at a time [s] since the start."""
        return math.prod(value(factor, time, duration) for factor in self.factors)


def check_knots(what: str, times: tuple[float, ...], values: tuple[float, ...]) -> None:
    """Refuse knots that are not finite, with ascending times and one value for each."""
    ascending = all(a < b for a, b in itertools.pairwise(times))
    if not times or len(times) != len(values) or not ascending:
        raise CharacterError(
            f"{what}: {len(values)} values at times {times}; give one for each, times ascending"
        )
    if not all(map(math.isfinite, (*times, *values))):
        raise CharacterError(f"{what}: {times} to {values}; give finite numbers")


def _ramp(time: float, length: float, shape: Ease) -> float:
    """Return the progress of a fade of a length [s]; a fade of length 0 is complete."""
    return 1.0 if length == 0.0 else ease(time / length, shape)


def _check_times(what: str, shape: str, *times: float) -> None:
    if shape not in get_args(Ease):
        raise CharacterError(f"{what}: shape {shape!r}; there are {', '.join(get_args(Ease))}")
    for time in times:
        if not 0.0 <= time < math.inf:
            raise CharacterError(f"{what}: a fade of {time} s; give 0 or more")
