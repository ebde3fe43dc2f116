"""Flips of the pattern: when each was shown, and when the camera's pictures showed it."""

from dataclasses import dataclass
from itertools import chain

import numpy as np

from cubeling.app.workshop.latency.pattern import MIN_CONTRAST

GOLDEN_RATIO = (1 + 5**0.5) / 2

MIN_PAUSE_S = 0.12
"""The pattern stays for this time at least after a flip was seen [s]."""

FLIP_TIMEOUT_S = 1.5
"""A flip that no picture shows within this time is missed [s]."""


@dataclass(frozen=True)
class Flip:
    """One flip of the pattern that the camera has seen. Times are those of one clock [s]."""

    shown: float
    """When the picture with the flip was handed to the screen: the return of the buffer swap."""

    before: float
    """Arrival in the program of the last picture that does not show it."""

    seen: float
    """Arrival in the program of the first picture that shows it: both fields have passed the middle
    between black and white."""

    @property
    def delay(self) -> float:
        """Time from the screen to the first picture that shows it [s]."""
        return self.seen - self.shown


class FlipDetector:
    """Follows the fields from picture to picture, and times every flip.

    One flip is under way at a time: the next is due only after the last was seen or missed, so a
    delay is never taken for that of another flip, however long it is. `seed` is that of the moments
    of the flips.
    """

    def __init__(self, seed: int) -> None:
        self._phase = float(np.random.default_rng(seed).uniform())
        self._arrivals: list[float] = []
        self.flips: list[Flip] = []
        """The flips that were seen."""
        self.missed = 0
        """Number of flips that were not."""
        self.left_is_white = True
        """Which way the pattern is, or is to be after the next flip is shown."""
        self._shown: float | None = None
        self._before: float | None = None
        self._due: float | None = None

    @property
    def interval(self) -> float:
        """Median time from one picture to the next [s]; 0 before there are two."""
        return float(np.median(np.diff(self._arrivals))) if len(self._arrivals) > 1 else 0.0

    def is_due(self, now: float) -> bool:
        """Return whether the pattern is to flip."""
        return self._due is not None and now >= self._due

    def wait(self, now: float) -> float:
        """Return the time until the next flip is due [s]; infinite while none is planned."""
        return np.inf if self._due is None else max(0.0, self._due - now)

    def show(self, shown: float) -> None:
        """Note that the pattern was flipped; `shown` is when [s]."""
        self.left_is_white = not self.left_is_white
        self._shown, self._due = shown, None

    def add(self, arrived: float, lightness: float | None) -> None:
        """Add a picture: when it arrived [s], and `PatternReader.read` of it."""
        self._arrivals.append(arrived)
        clear = lightness is not None and abs(lightness) >= MIN_CONTRAST
        as_shown = lightness is not None and (lightness > 0) == self.left_is_white
        if self._shown is not None:
            self._follow(arrived, lightness, as_shown)
        elif not (clear and as_shown):
            self._due = None  # the pattern is out of view
        elif self._due is None:
            self._due = arrived + self._pause()
        if self._shown is None and clear:
            self._before = arrived

    def _follow(self, arrived: float, lightness: float | None, as_shown: bool) -> None:
        """Time the flip that was shown, or give it up."""
        assert self._shown is not None
        lost = lightness is None or self._before is None
        if lost or arrived - self._shown > FLIP_TIMEOUT_S:
            self.missed += 1
            self._shown = self._before = None
        elif as_shown:
            assert self._before is not None
            self.flips.append(Flip(self._shown, self._before, arrived))
            self._shown = None
        else:
            self._before = arrived

    def _pause(self) -> float:
        """Return how long the pattern stays [s].

        Multiples of the golden ratio, modulo one, are spread evenly: so are the flips over the time
        between two pictures, and few of them tell as much as many at random.
        """
        self._phase = (self._phase + GOLDEN_RATIO) % 1.0
        return MIN_PAUSE_S + self._phase * self.interval


def picture_age(flips: list[Flip]) -> float:
    """Return how old the world in a picture is when it arrives [s].

    The flip was in view after the exposure of the one picture and before that of the next, so the
    age lies between `before - shown` and `seen - shown`. The median of all these bounds contradicts
    the fewest of them, by the least: it minimises the sum of the distances to the intervals.
    """
    bounds = chain.from_iterable((each.before - each.shown, each.delay) for each in flips)
    return float(np.median(list(bounds)))
