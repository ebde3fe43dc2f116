"""The network of players and robots: over a broker, or within this program."""

import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import TypeVar

from robot.contract.closeable import Closeable
from robot.network import (
    Address,
    Bus,
    BusClient,
    Credentials,
    Endpoint,
    Member,
    MemoryBroker,
    MqttBus,
    check_name,
)
from robot.network.topics import Role

E = TypeVar("E", bound=Endpoint)

SITE = "home"
"""The default site."""


@dataclass(frozen=True)
class Access:
    """Options for the network."""

    url: str | None = None
    """URL of the broker; None to stay within this program."""

    site: str = SITE
    """Our site."""

    credentials: Credentials = field(default_factory=Credentials)
    """User, password file, certificates."""


class Network(Closeable):
    """Connects members to each other. Close it, or use it in a `with` statement.

    Parameters
    ----------
    access
        The broker and the credentials.

    Raises
    ------
    RobotError
        If the URL, a name or a file of `access` cannot be used.
    """

    def __init__(self, access: Access) -> None:
        self.site = check_name(access.site, "site")
        """Our site."""
        self.address = None if access.url is None else Address.of(access.url, access.credentials)
        """The broker; None within this program."""
        self.session = time.time_ns() // 1_000_000
        """Epoch of this program, the same for all its members; greater for a later start."""
        self._memory = MemoryBroker()
        self._closing = ExitStack()

    def member(self, role: Role, name: str) -> Member:
        """Return a member of our site."""
        return Member(self.site, role, check_name(name, role))

    def join(self, endpoint: E, name: str) -> BusClient[E]:
        """Connect an endpoint, with an MQTT client id made from a name; see `BusClient.open`."""
        client = BusClient(endpoint, self._bus(name), time.monotonic).open()
        self._closing.callback(client.close)
        return client

    def close(self) -> None:
        """Disconnect all members. A second call does nothing."""
        self._closing.close()

    def _bus(self, name: str) -> Bus:
        if self.address is None:
            return self._memory.bus()
        return MqttBus(self.address, f"cubeling:{name}:{self.session}")
