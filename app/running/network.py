"""Joining others: over a broker, or within this program where there is none."""

import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import TypeVar

from robot.contract.closeable import Closeable
from robot.network import (
    Address,
    Bus,
    Credentials,
    Endpoint,
    Member,
    MemoryBroker,
    MqttBus,
    Station,
    check_name,
)
from robot.network.topics import Role

E = TypeVar("E", bound=Endpoint)

SITE = "home"
"""The site of those who name none."""


@dataclass(frozen=True)
class Access:
    """Where to meet the others, as a person gives it."""

    url: str | None = None
    """The broker; None to stay within this program."""

    site: str = SITE
    """Where we are."""

    credentials: Credentials = field(default_factory=Credentials)
    """User, password file, certificates."""


class Network(Closeable):
    """Puts members on a bus. `close` it at the end; a second `close` does nothing.

    Parameters
    ----------
    access
        Where, and how to get in.

    Raises
    ------
    RobotError
        If the URL, a name or a file of `access` cannot be used.
    """

    def __init__(self, access: Access) -> None:
        self.site = check_name(access.site, "site")
        """Where we are."""
        self.address = None if access.url is None else Address.of(access.url, access.credentials)
        """The broker; None within one program."""
        self.session = time.time_ns() // 1_000_000
        """The run of this program: a later one has a greater number."""
        self._memory = MemoryBroker()
        self._closing = ExitStack()

    def member(self, role: Role, name: str) -> Member:
        """Return one of our members."""
        return Member(self.site, role, check_name(name, role))

    def join(self, endpoint: E, name: str) -> Station[E]:
        """Connect a member, under a client's id that is made from its name.

        Raises
        ------
        RobotError
            If the broker is there and refuses. One that is away is tried on.
        """
        station = Station(endpoint, self._bus(name), time.monotonic).open()
        self._closing.callback(station.close)
        return station

    def close(self) -> None:
        """Say goodbye for all members."""
        self._closing.close()

    def _bus(self, name: str) -> Bus:
        if self.address is None:
            return self._memory.bus()
        return MqttBus(self.address, f"cubeling:{name}:{self.session}")
