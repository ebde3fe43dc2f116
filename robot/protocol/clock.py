"""A robot's clock in the host's time: its offset and its drift, from BEATs and their STATEs.

A STATE that answers a BEAT was made between the sending of the one and the arrival of the other, so
the middle is wrong by half of that round trip at most (Cristian 1989, "Probabilistic clock
synchronization", section 3). Of every second only the shortest round trip counts, the one that
waited least: the clock filter of NTP (Mills et al. 2010, RFC 5905, section 10), which also weighs
the age of a sample by how far the clock may have drifted since.
"""

from collections import deque
from dataclasses import dataclass

from cubeling.robot.protocol.timing import CLOCK_TOLERANCE

KEPT_SAMPLES = 60
"""Seconds from which a sample is kept."""

MIN_DRIFT_SAMPLES = 8
"""Samples from which a drift is calculated; before, it counts as 0."""

ERROR_GROWTH = 2 * CLOCK_TOLERANCE
"""Growth of the error with the age of a sample: the clock's own drift, and that assumed for it."""

TICK_S = 1e-3
"""Resolution of the robot's clock [s]."""


@dataclass(frozen=True)
class ClockSample:
    """A reading of the robot's clock."""

    robot: float
    """The robot's clock, without its wraps [s]."""

    host: float
    """The host's clock then, as far as is known [s]."""

    error: float
    """Bound of the error of `host` [s]."""


class RobotClock:
    """Converts the times of a robot to the host's, in one session.

    Examples
    --------
    >>> clock = RobotClock()
    >>> clock.add(5_000, sent=100.000, received=100.004)
    >>> sample = clock.host_time(5_010)
    >>> round(sample.host, 4), round(sample.error, 4)
    (100.012, 0.003)
    """

    def __init__(self) -> None:
        self.drift = 0.0
        """How much faster the robot's clock runs than the host's, as a ratio."""
        self._samples: deque[ClockSample] = deque(maxlen=KEPT_SAMPLES)
        self._best: ClockSample | None = None
        self._last_ms: int | None = None
        self._elapsed_ms = 0
        self._second = 0.0

    def add(self, ms: int, sent: float, received: float) -> None:
        """Take the time of a STATE [ms] between two times of the host [s]."""
        self._elapsed_ms, self._last_ms = self._unwrap(ms), ms
        # The clock shows a millisecond from its begin to its end: at the mean, half of it is over.
        robot = self._elapsed_ms / 1000 + TICK_S / 2
        error = (received - sent) / 2 + TICK_S / 2
        sample = ClockSample(robot, (sent + received) / 2, error)
        if not self._samples or robot - self._second >= 1.0:
            self._second = robot
            self._fit()  # before the second of which one sample is all that is known
            self._samples.append(sample)
        # Only the shortest round trip of a second: delays on the line are one-sided, and short ones
        # hide the least of them.
        elif error < self._samples[-1].error:
            self._samples[-1] = sample
        else:
            return
        # The errors grow alike, so the sample that is best now stays so until there is another.
        self._best = min(self._samples, key=lambda one: one.error - ERROR_GROWTH * one.robot)

    def host_time(self, ms: int) -> ClockSample | None:
        """Return a time of the robot [ms] with the host's time for it; None before any `add`."""
        best = self._best
        if best is None:
            return None
        robot = self._unwrap(ms) / 1000 + TICK_S / 2
        age = robot - best.robot
        error = best.error + TICK_S / 2 + ERROR_GROWTH * abs(age)
        return ClockSample(robot, best.host + age / (1 + self.drift), error)

    def _unwrap(self, ms: int) -> int:
        """Return a time as milliseconds since the first one, however often the clock wrapped."""
        if self._last_ms is None:
            return 0
        # A difference of more than half of the range is one into the past.
        return self._elapsed_ms + (ms - self._last_ms + 0x80000000) % 0x100000000 - 0x80000000

    def _fit(self) -> None:
        """Calculate the drift: the slope through the samples, each by the weight of its error."""
        if len(self._samples) < MIN_DRIFT_SAMPLES:
            return
        rows = [(1 / one.error**2, one.host, one.robot - one.host) for one in self._samples]
        total = sum(weight for weight, _, _ in rows)
        mean_host = sum(weight * host for weight, host, _ in rows) / total
        mean_offset = sum(weight * offset for weight, _, offset in rows) / total
        spread = sum(weight * (host - mean_host) ** 2 for weight, host, _ in rows)
        slope = sum(w * (host - mean_host) * (offset - mean_offset) for w, host, offset in rows)
        # No quartz is worse; a larger slope comes from delays that change.
        self.drift = min(max(slope / spread if spread else 0.0, -CLOCK_TOLERANCE), CLOCK_TOLERANCE)
