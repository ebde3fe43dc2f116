"""The network of players and robots: over a broker, or within this program."""

import time
from contextlib import ExitStack
from typing import TypeVar

from cubeling.robot import Closeable
from cubeling.robot.network import (
    DEFAULT_SITE,
    Address,
    Bus,
    BusClient,
    Credentials,
    Endpoint,
    Member,
    MemoryBroker,
    MqttBus,
    Role,
    check_name,
)

E = TypeVar("E", bound=Endpoint)


class Network(Closeable):
    """Connects members to each other. Close it, or use it in a `with` statement.

    Without the URL of a broker it stays within this program. Raises RobotError if the URL, the
    name of the site or a file of the credentials cannot be used.
    """

    def __init__(
        self,
        url: str | None = None,
        site: str = DEFAULT_SITE,
        credentials: Credentials | None = None,
    ) -> None:
        self.site = check_name(site, "site")
        """Our site."""
        self.address = None if url is None else Address.of(url, credentials)
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
        bus: Bus = self._memory.bus()
        if self.address is not None:
            bus = MqttBus(self.address, f"cubeling:{name}:{self.session}")
        client = BusClient(endpoint, bus, time.monotonic).open()
        self._closing.callback(client.close)
        return client

    def close(self) -> None:
        """Disconnect all members. A second call does nothing."""
        self._closing.close()
