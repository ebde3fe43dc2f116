"""How much a robot may say: what comes beyond that is thrown away, and costs the picture nothing.

A robot of our protocol says about 2 kB in a second. One that babbles, because it is broken or meant
to, could fill whole cores with decoding its noise; Python's threads share one.
"""

RATE = 32_000
"""Bytes a second that are listened to in the long run; 115200 baud carry 11520."""

BURST = 16_000
"""Bytes that may come at once: what waits after this computer has slept for some seconds."""

REST = 0.020
"""Pause after more than that has come [s]; less than half a beat, so that ours are not late."""


class Budget:
    """Counts bytes against `RATE` and `BURST` (a token bucket)."""

    def __init__(self) -> None:
        self._left = float(BURST)
        self._last: float | None = None

    def spend(self, count: int, now: float) -> bool:
        """Take account of bytes received at `now` [s]; whether that was more than may come."""
        elapsed = 0.0 if self._last is None else max(0.0, now - self._last)
        self._last = now
        self._left = min(self._left + RATE * elapsed, BURST) - count
        overdrawn = self._left < 0
        self._left = max(self._left, 0.0)
        return overdrawn
