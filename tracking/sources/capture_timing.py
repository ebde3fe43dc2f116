"""When a live image was taken, and how many images waited in the driver's queue."""

import statistics
from collections import deque

MAX_DRIVER_AGE_S = 1.0
"""A driver's timestamp that is older than this on arrival comes from another clock."""

MAX_DRIVER_LEAD_S = 0.002
"""How far in the future a driver's timestamp may be: it is rounded and read at another moment."""

DISTRUST_IMAGES = 30
"""Number of images for which a driver is not trusted after a wrong timestamp, so that the
timestamps of a sequence do not alternate between two clocks."""

RECENT_IMAGES = 120
"""Number of images that statistics cover: four seconds at 30 a second."""

MAX_READY_WAIT_PERIODS = 0.25
"""A read that took less than this share of a period found an image waiting."""


class ExposureClock:
    """Chooses between the driver's timestamp of an image and its arrival.

    V4L2 stamps buffers with CLOCK_MONOTONIC, which is Python's `time.monotonic`; but drivers also
    give zeros, other clocks, and counters that wrap. A timestamp is trusted if it lies within the
    last second and after the one before.

    >>> clock = ExposureClock()
    >>> clock.stamp(10.0, 9.96), clock.by_driver
    (9.96, True)
    >>> clock.stamp(10.033, 0.0), clock.by_driver
    (10.033, False)
    """

    def __init__(self) -> None:
        self.by_driver = False
        """Whether the last timestamp is the driver's."""
        self._last = -float("inf")
        self._distrust = 0

    def stamp(self, arrival: float, driver: float | None) -> float:
        """Return an image's timestamp from its arrival and, if there is one, the driver's [s]."""
        age = None if driver is None else arrival - driver
        plausible = age is not None and -MAX_DRIVER_LEAD_S <= age <= MAX_DRIVER_AGE_S
        if driver is not None and not (plausible and driver > self._last):
            self._distrust = DISTRUST_IMAGES + 1
        self.by_driver = driver is not None and self._distrust == 0
        self._distrust = max(0, self._distrust - 1)
        taken = arrival if driver is None or not self.by_driver else min(driver, arrival)
        self._last = max(self._last, taken)
        return taken


class QueueGauge:
    """Measures the rate of images, and how many of them wait in the driver's queue.

    A read that has to wait finds the queue empty; one that returns immediately does not. The number
    of images behind the one read follows from its age beyond that of images that were waited for;
    without driver timestamps, from the number of immediate reads in a row.

    >>> gauge = QueueGauge(30.0)
    >>> gauge.add(0.030, 1.000, 0.030), gauge.add(0.033, 1.033, 0.030)
    (0, 0)
    >>> gauge.add(0.0, 1.166, 0.130), gauge.add(0.0, 1.167, 0.097)
    (3, 2)
    """

    def __init__(self, rate: float, max_depth: int = 0) -> None:
        self.max_depth = max_depth
        """Largest number of images that ever waited."""
        self._period = 1.0 / rate
        self._arrivals: deque[float] = deque(maxlen=RECENT_IMAGES)
        self._depths: deque[int] = deque(maxlen=RECENT_IMAGES)
        self._min_age: float | None = None
        self._immediate_reads = 0

    def add(self, waited: float, arrival: float, age: float | None) -> int:
        """Add an image; return how many were waiting when it was read.

        The read took `waited` [s] and returned at `arrival` [s]; `age` [s] is that of the image by
        the driver's timestamp, if there is one.
        """
        first = not self._arrivals
        self._arrivals.append(arrival)
        if first or waited >= MAX_READY_WAIT_PERIODS * self._period:
            self._immediate_reads = 0
            if age is not None:
                self._min_age = age if self._min_age is None else min(self._min_age, age)
            depth = 0
        else:
            self._immediate_reads += 1
            depth = self._immediate_reads
            if age is not None and self._min_age is not None:
                depth = max(1, round((age - self._min_age) / self._period))
        self._depths.append(depth)
        self.max_depth = max(self.max_depth, depth)
        return depth

    @property
    def rate(self) -> float:
        """Recent rate [images/s]; 0 if fewer than two arrived."""
        if len(self._arrivals) < 2:
            return 0.0
        span = self._arrivals[-1] - self._arrivals[0]
        return (len(self._arrivals) - 1) / span if span > 0 else 0.0

    @property
    def mean_depth(self) -> float:
        """Recent mean number of images waiting."""
        return statistics.fmean(self._depths) if self._depths else 0.0
