"""Where datagrams go, and where they come in."""

import socket
from dataclasses import dataclass
from typing import Any

from cubeling.app.errors import AppError

LOOPBACK = "127.0.0.1"
"""This computer alone: whoever wants another one names it."""

VMC_PORT = 39539
"""Where receivers of the VMC protocol listen unless they are told otherwise."""

MAX_PORT = 65535
"""The last port that there is."""


@dataclass(frozen=True)
class UdpAddress:
    """A host and a port."""

    host: str
    """A name or a number."""

    port: int

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"

    @classmethod
    def of(cls, text: str, option: str, port: int | None = None) -> "UdpAddress":
        """Return the address that an option names: PORT, HOST:PORT, or HOST with a usual port.

        Raises AppError for another text.

        >>> str(UdpAddress.of("9000", "--osc")), str(UdpAddress.of("[::1]:9000", "--osc"))
        ('127.0.0.1:9000', '[::1]:9000')
        >>> UdpAddress.of("desk.local", "--vmc", 39539).port
        39539
        """
        host, colon, number = text.rpartition(":")
        if text.isdecimal():
            host, number = LOOPBACK, text
        elif port is not None and not (colon and number.isdecimal()):
            host, number = text, str(port)
        host = host.removeprefix("[").removesuffix("]")
        if not host or "://" in text or not number.isdecimal() or not 0 <= int(number) <= MAX_PORT:
            raise AppError(f"{option} {text}: give a port, or HOST:PORT as in {LOOPBACK}:9000")
        return cls(host, int(number))

    def resolve(self) -> tuple[socket.AddressFamily, Any]:
        """Return family and address for a UDP socket; AppError if there is no such host."""
        try:
            found = socket.getaddrinfo(self.host, self.port, type=socket.SOCK_DGRAM)
        except OSError as error:
            raise AppError(f"there is no host '{self.host}': {error.strerror}") from error
        return found[0][0], found[0][4]
