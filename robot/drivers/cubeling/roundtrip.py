"""How long an answer takes, and how long to wait before asking again."""

from robot.protocol import timing


class RoundTrip:
    """Smoothed time from BEAT to STATE and its spread (Jacobson 1988, as in RFC 6298).

    BEATs are numbered and never repeated, so an answer always tells which one it answers.
    """

    def __init__(self) -> None:
        self.smoothed: float | None = None
        """Round trip [s]; None before the first."""
        self._spread = 0.0
        self._count = 0
        self._sent: dict[int, float] = {}

    def start(self, now: float) -> int:
        """Count a BEAT that is sent at `now` [s]."""
        self._count = (self._count + 1) & 0xFFFF
        self._sent[self._count] = now
        if len(self._sent) > 16:  # older ones were lost, or their answers are of no use now
            del self._sent[next(iter(self._sent))]
        return self._count

    def stop(self, count: int, now: float) -> None:
        """Take the first answer to that BEAT; later ones repeat an old count and say nothing."""
        sent = self._sent.pop(count, None)
        if sent is None:
            return
        took = now - sent
        if self.smoothed is None:
            self.smoothed, self._spread = took, took / 2
        else:
            self._spread += (abs(took - self.smoothed) - self._spread) / 4
            self.smoothed += (took - self.smoothed) / 8

    @property
    def retry_after(self) -> float:
        """Time to wait for an acknowledgement before sending again [s]."""
        if self.smoothed is None:
            return timing.RETRY_FIRST
        wait = self.smoothed + 4 * self._spread
        return min(max(wait, timing.RETRY_MIN), timing.RETRY_MAX)
