"""Who may use a port that the program opens, and how much of it each client gets."""

import hmac
import re
import secrets
from dataclasses import dataclass

from cubeling.app.errors import AppError

TOKEN_BYTES = 16
"""Random bytes of a token that is made: more than anyone can try."""

TOKEN = re.compile(r"[A-Za-z0-9._~-]{8,128}")
"""What a token may be: it fits into a line, a URL and a header as it is."""


@dataclass(frozen=True)
class Token:
    """The secret that a client has to tell before anything of it is read."""

    text: str
    """The secret; `TOKEN` says of what."""

    def __post_init__(self) -> None:
        if not TOKEN.fullmatch(self.text):
            raise AppError("a token has 8 to 128 letters, digits and characters of . _ ~ -")

    @classmethod
    def generate(cls) -> "Token":
        """Return a new one that nobody can guess."""
        return cls(secrets.token_urlsafe(TOKEN_BYTES))

    def admits(self, offered: str) -> bool:
        """Return whether a client has told it; how long that takes tells nothing of it.

        >>> Token("open-sesame").admits("open-sesame"), Token("open-sesame").admits("open")
        (True, False)
        """
        return hmac.compare_digest(self.text.encode(), offered.encode())


@dataclass(frozen=True)
class ClientLimits:
    """What the clients of a port may use."""

    clients: int = 16
    """Clients at one time."""

    strangers: int = 128
    """Connections that have not told the token yet; beyond, the one that has waited longest goes.
    They come and go quickly: with few of them, a burst of others ends one that is about to."""

    quiet_s: float = 1.0
    """Where no place is left, the client that has sent nothing for longest, and for longer than
    this, gives its own up to a newcomer [s]."""

    documents: int = 16
    """Documents of a client that wait for their turn; until then no more are read from it."""

    bytes: int = 1 << 20
    """Size of these documents after which no more are read [B]."""

    unsent: int = 8 << 20
    """What waits to be sent to a client [B]; one that takes less is disconnected."""

    admission_s: float = 5.0
    """Time in which a client tells the token [s]."""

    document_s: float = 30.0
    """Time in which a document that has begun is complete [s]."""

    idle_s: float = 600.0
    """Time after which a client that sends nothing is disconnected [s]."""

    farewell_s: float = 2.0
    """Time in which a client that is disconnected may read why [s]."""
