"""One direction of a faulty line, in virtual time."""

from collections import Counter, deque
from typing import Final

import numpy as np

from cubeling.robot.simulators.faults import Faults

MAX_IN_FLIGHT_BYTES: Final = 65536
"""Most bytes in flight; further ones are lost, as in any buffer."""

MAX_DUPLICATED_BYTES: Final = 4096
"""Longest frame that is duplicated [bytes]; a longer one is noise without an edge."""

SPLIT_GAP_S: Final = 0.004
"""Time between the two pieces of a split frame [s]."""

MEAN_BURST_BYTES: Final = 16
"""Mean length of a burst of noise [bytes]."""


class BernoulliFault:
    """A fault that occurs with the same probability in each trial.

    It draws only the number of trials until the next fault, so rare faults cost next to nothing.
    """

    def __init__(self, random: np.random.Generator, probability: float) -> None:
        self._random = random
        self._probability = probability
        self._left: float = float("inf")
        if probability > 0:
            self._draw()

    def occurs(self) -> bool:
        """Return whether it occurs in this trial."""
        self._left -= 1
        if self._left > 0:
            return False
        self._draw()
        return True

    def occurrences(self, count: int) -> list[int]:
        """Return the indices among the next `count` trials at which it occurs."""
        if self._left > count:
            self._left -= count
            return []
        return [index for index in range(count) if self.occurs()]

    def _draw(self) -> None:
        self._left = int(self._random.geometric(self._probability))


class FaultyChannel:
    """One direction of a line. It loses, corrupts, duplicates and delays, but never reorders.

    A frame ends at an edge and includes the zero bytes before it. Its faults are drawn at its first
    byte; bytes never wait for the end of their frame. Each kind of fault has its own generator, so
    that adding one kind does not change the others. Faults of the robot itself are ignored.
    """

    def __init__(self, faults: Faults, edge: bytes, seed: tuple[int, ...]) -> None:
        self.cut = False
        """Whether everything that is sent is lost."""
        self.counts: Counter[str] = Counter()
        """Number of faults by the name of their option; "lost": bytes over the limit."""
        self._edge = edge
        drop, flip, dup, split, corruption, noise, lateness = (
            np.random.default_rng((*seed, kind)) for kind in range(7)
        )
        self._drop = BernoulliFault(drop, faults.drop)
        self._flip = BernoulliFault(flip, faults.flip)
        self._dup = BernoulliFault(dup, faults.dup)
        self._split = BernoulliFault(split, faults.split)
        self._corruption, self._noise, self._lateness = corruption, noise, lateness
        self._delay, self._jitter = faults.delay, faults.jitter
        self._babble = faults.babble
        self._noise_at = float("inf")  # until the first call tells the time
        self._in_flight: deque[tuple[float, bytes]] = deque()
        self.in_flight = 0
        """Number of bytes in flight."""
        self._last_arrival = float("-inf")
        self._started = False
        self._copy: bytes | None = None  # the part so far of a frame that will be duplicated
        self._forget_frame()

    @property
    def due(self) -> float:
        """Time of the next arrival [s]; infinite if nothing is in flight."""
        return min(self._in_flight[0][0], self._noise_at) if self._in_flight else self._noise_at

    def send(self, data: bytes, now: float) -> None:
        """Send bytes at time `now` [s]."""
        self._make_noise(now)
        if self.cut:
            self._forget_frame()
            return
        start = 0
        while start < len(data):
            if not self._inside:
                self._begin_frame()
            end = self._end_of_frame(data, start)
            if not self._dropping:
                self._pass(data[start:end], now)
            start = end

    def receive(self, now: float) -> bytes:
        """Return the bytes that have arrived by time `now` [s], once."""
        self._make_noise(now)
        in_flight = self._in_flight
        if not in_flight or in_flight[0][0] > now:
            return b""
        arrived = in_flight.popleft()[1]
        while in_flight and in_flight[0][0] <= now:
            arrived += in_flight.popleft()[1]
        self.in_flight -= len(arrived)
        return arrived

    def clear(self) -> None:
        """Lose everything in flight."""
        self._in_flight.clear()
        self.in_flight = 0
        self._noise_at, self._started = float("inf"), False
        self._forget_frame()

    def _begin_frame(self) -> None:
        """Draw the faults of a frame."""
        self._inside = True
        self._dropping = self._drop.occurs()
        self._splitting = self._split.occurs()
        self._copy = b"" if self._dup.occurs() else None
        self.counts["drop"] += self._dropping
        self.counts["split"] += self._splitting and not self._dropping
        self.counts["dup"] += self._copy is not None and not self._dropping

    def _forget_frame(self) -> None:
        self._inside = self._filled = self._dropping = self._splitting = False
        self._copy = None

    def _end_of_frame(self, data: bytes, start: int) -> int:
        """Return where the frame that begins or continues at `start` ends, at most `len(data)`."""
        if not self._filled and self._edge == b"\0":  # elsewhere an empty line is a frame, too
            filled = data[start:].lstrip(self._edge)
            if not filled:
                return len(data)
            self._filled = True
            start = len(data) - len(filled)
        edge = data.find(self._edge, start)
        if edge < 0:
            return len(data)
        self._inside = self._filled = False
        return edge + 1

    def _pass(self, piece: bytes, now: float) -> None:
        delay = self._delay
        if self._jitter:
            delay += float(self._lateness.uniform(-self._jitter, self._jitter))
        arrival = now + delay
        if self._splitting and len(piece) > 1:
            middle = int(self._corruption.integers(1, len(piece)))
            self._put(piece[:middle], arrival)
            self._put(piece[middle:], max(arrival, self._last_arrival) + SPLIT_GAP_S)
            self._splitting = False
        else:
            self._put(piece, arrival)
        if self._copy is not None:
            self._copy += piece
            if not self._inside:
                self._put(self._copy, arrival)
                self._copy = None
            elif len(self._copy) > MAX_DUPLICATED_BYTES:
                self._copy = None

    def _put(self, data: bytes, arrival: float) -> None:
        """Flip bits, then put the bytes in flight."""
        flips = self._flip.occurrences(len(data))
        if flips:
            corrupted = bytearray(data)
            for index in flips:
                corrupted[index] ^= 1 << int(self._corruption.integers(8))
            data = bytes(corrupted)
            self.counts["flip"] += len(flips)
        self._append(data, arrival)

    def _append(self, data: bytes, arrival: float) -> None:
        if self.in_flight + len(data) > MAX_IN_FLIGHT_BYTES:
            self.counts["lost"] += len(data)
            return
        self.in_flight += len(data)
        self._last_arrival = max(arrival, self._last_arrival)
        self._in_flight.append((self._last_arrival, data))

    def _make_noise(self, now: float) -> None:
        """Add the bursts of noise that are due."""
        if not self._babble:
            return
        if not self._started:
            self._started = True
            self._noise_at = now + self._pause()
        while self._noise_at <= now:
            burst = self._noise.bytes(int(self._noise.integers(1, 2 * MEAN_BURST_BYTES)))
            if not self.cut:
                self.counts["babble"] += len(burst)
                self._append(burst, self._noise_at)
            self._noise_at += self._pause()

    def _pause(self) -> float:
        """Draw the time until the next burst [s]."""
        return float(self._noise.exponential(MEAN_BURST_BYTES / self._babble))
