"""What the clients of the page's port may use."""

from dataclasses import dataclass


@dataclass(frozen=True)
class WebLimits:
    """Sizes, rates and times. Who exceeds them is disconnected."""

    clients: int = 8
    """Clients with the token at one time."""

    strangers: int = 64
    """Connections without a WebSocket; beyond, the oldest one goes."""

    stranger_s: float = 5.0
    """Time in which a connection asks for what it wants, and has got it [s]."""

    connections_per_s: float = 20.0
    """Connections that are accepted a second; others wait for their turn. A handshake takes
    milliseconds from those who play."""

    burst: int = 32
    """Connections that are accepted at once."""

    message_bytes: int = 2 << 20
    """Size of a picture from a client [B]: one of 1080 x 1920 has half a megabyte."""

    text_bytes: int = 1 << 12
    """Size of any other message [B]: the answer to a question has at most 2,000 characters."""

    messages_per_s: float = 120.0
    """Messages of a client: thirty pictures, and an answer to as many, are half of that."""

    messages_burst_s: float = 0.5
    """It may send those of so many seconds at once [s]: each costs those who play a tenth of a
    millisecond."""

    bytes_per_s: float = 24e6
    """What a client sends [B/s]: thirty pictures a second of 0.8 MB."""

    pictures_in_flight: int = 2
    """Pictures on their way to a client, which it has not shown."""

    idle_s: float = 30.0
    """Time after which a client that says nothing is disconnected [s]. A page that is open says
    something each second."""


class RateLimit:
    """Lets so much a second pass, and as much as in `burst_s` seconds at once.

    >>> limit = RateLimit(10.0, burst_s=0.2)
    >>> [limit.allows(1.0, now) for now in (0.0, 0.0, 0.0, 0.1, 0.1)]
    [True, True, False, True, False]
    """

    def __init__(self, rate: float, burst_s: float = 2.0) -> None:
        self._rate, self._most = rate, rate * burst_s
        self._left, self._then = self._most, 0.0

    def allows(self, amount: float, now: float) -> bool:
        """Return whether an amount passes at a time [s]."""
        self._left = min(self._left + self._rate * (now - self._then), self._most)
        self._then = now
        if self._left < amount:
            return False
        self._left -= amount
        return True
