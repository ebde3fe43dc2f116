"""How much a robot may say: what comes beyond that is thrown away, and costs the picture nothing.

A robot of our protocol says about 2 kB in a second. One that babbles, because it is broken or meant
to, could fill whole cores with decoding its noise; Python's threads share one.
"""

RATE = 12_000
"""Bytes a second that are listened to in the long run: a little more than 115200 baud carry."""

BURST = 16_000
"""Bytes that may come at once: what waits after this computer has slept for some seconds."""

REST = 0.020
"""Pause after more than that has come [s]; less than half a beat, so that ours are not late. What a
flood leaves in the buffers of the system, some 64 kB, is so read away within two seconds."""


class Budget:
    """Counts bytes against `RATE` and `BURST` (a token bucket)."""

    def __init__(self) -> None:
        self._left = float(BURST)
        self._last: float | None = None

    def grant(self, count: int, now: float) -> int:
        """Return how many of `count` bytes that came at `now` [s] are listened to."""
        elapsed = 0.0 if self._last is None else max(0.0, now - self._last)
        self._last = now
        self._left = min(self._left + RATE * elapsed, BURST)
        granted = min(count, int(self._left))
        self._left -= granted
        return granted
