"""When a live picture was taken, and how many others stood in line before it."""

import statistics
from collections import deque

OLDEST_S = 1.0
"""A driver's timestamp that is older than this when its picture arrives is on another clock."""

ROUNDING_S = 0.002
"""So far in the future may a driver's timestamp be: it is rounded, and the clock is read apart."""

DISTRUST = 30
"""Pictures for which a driver is not believed after a wrong timestamp, so that the times of a
sequence do not hop between two ways of telling them."""

RECENT = 120
"""Pictures that the figures speak of: four seconds at 30 a second."""

AT_ONCE = 0.25
"""A read that took less than this share of a period did not wait: the picture was there before."""


class ExposureClock:
    """Chooses between the driver's time of a picture and that of its arrival.

    V4L2 stamps buffers by CLOCK_MONOTONIC, which is Python's `time.monotonic`; but drivers give
    zeros, other clocks, counters that wrap. One is believed if it lies within the last second,
    and after the one before.

    >>> clock = ExposureClock()
    >>> clock.stamp(10.0, 9.96), clock.by_driver
    (9.96, True)
    >>> clock.stamp(10.033, 0.0), clock.by_driver
    (10.033, False)
    """

    def __init__(self) -> None:
        self.by_driver = False
        """Whether the last stamp was the driver's."""
        self._last = -float("inf")
        self._distrust = 0

    def stamp(self, arrival: float, driver: float | None) -> float:
        """Return the time to give to a picture [s].

        Parameters
        ----------
        arrival
            When it arrived [s].
        driver
            When it was taken, as the driver says [s]; None where it says nothing.
        """
        age = None if driver is None else arrival - driver
        sane = age is not None and -ROUNDING_S <= age <= OLDEST_S
        if driver is not None and not (sane and driver > self._last):
            self._distrust = DISTRUST + 1
        self.by_driver = driver is not None and self._distrust == 0
        self._distrust = max(0, self._distrust - 1)
        taken = arrival if driver is None or not self.by_driver else min(driver, arrival)
        self._last = max(self._last, taken)
        return taken


class QueueGauge:
    """Measures the rate at which pictures come, and how many waited in the driver's queue.

    A read that waits finds the queue empty. One that returns at once does not: the picture was
    there before. How many newer ones stood behind it is told by its age beyond that of pictures
    that were waited for; without the driver's time, by how many reads in a row return at once.

    >>> gauge = QueueGauge(30.0)
    >>> gauge.add(0.030, 1.000, 0.030), gauge.add(0.033, 1.033, 0.030)
    (0, 0)
    >>> gauge.add(0.0, 1.166, 0.130), gauge.add(0.0, 1.167, 0.097)
    (3, 2)
    """

    def __init__(self, rate: float) -> None:
        self.deepest = 0
        """The most pictures that ever waited."""
        self._period = 1.0 / rate
        self._arrivals: deque[float] = deque(maxlen=RECENT)
        self._depths: deque[int] = deque(maxlen=RECENT)
        self._young: float | None = None
        self._row = 0

    def add(self, waited: float, arrival: float, age: float | None) -> int:
        """Take in a picture; returns how many were waiting when it was asked for.

        Parameters
        ----------
        waited
            How long the read took [s].
        arrival
            When it returned [s].
        age
            Since the picture was taken, as the driver says [s]; None where it says nothing.
        """
        first = not self._arrivals
        self._arrivals.append(arrival)
        if first or waited >= AT_ONCE * self._period:
            self._row = 0
            if age is not None:
                self._young = age if self._young is None else min(self._young, age)
            depth = 0
        else:
            self._row += 1
            depth = self._row
            if age is not None and self._young is not None:
                depth = max(1, round((age - self._young) / self._period))
        self._depths.append(depth)
        self.deepest = max(self.deepest, depth)
        return depth

    @property
    def rate(self) -> float:
        """Pictures a second; 0 where fewer than two came."""
        if len(self._arrivals) < 2:
            return 0.0
        span = self._arrivals[-1] - self._arrivals[0]
        return (len(self._arrivals) - 1) / span if span > 0 else 0.0

    @property
    def depth(self) -> float:
        """How many waited, in the mean."""
        return statistics.fmean(self._depths) if self._depths else 0.0
