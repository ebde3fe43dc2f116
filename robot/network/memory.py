"""A broker within one process: for a place without a network, and for tests in virtual time."""

import threading

from robot.network.bus import Bus, Letter
from robot.network.topics import fits


class MemoryBroker:
    """Carries messages between the buses of one process. It may be used from any thread."""

    def __init__(self) -> None:
        self.retained: dict[str, Letter] = {}
        """The last retained message of every topic."""
        self.running = True
        """Whether it is there; see `kill`."""
        self._buses: list[MemoryBus] = []
        self._lock = threading.RLock()

    def bus(self) -> "MemoryBus":
        """Return a new connection to it."""
        return MemoryBus(self)

    def kill(self) -> None:
        """Lose power: everything retained is forgotten, and no last will is published."""
        with self._lock:
            self.running = False
            self.retained.clear()
            buses, self._buses = self._buses, []
        for bus in buses:
            bus.cut("the broker was killed")

    def start(self) -> None:
        """Come back, knowing nothing. Buses come back by `MemoryBus.reconnect`."""
        self.running = True

    def join(self, bus: "MemoryBus") -> bool:
        """Take in a bus and tell it what is retained; whether the broker is there."""
        with self._lock:
            if not self.running:
                return False
            self._buses.append(bus)
            known = list(self.retained.values())
        for topic_filter, handler in bus.handlers:  # in their order, as brokers do
            for letter in known:
                if fits(topic_filter, letter.topic):
                    handler(letter.topic, letter.payload)
        return True

    def leave(self, bus: "MemoryBus") -> None:
        """Let a bus go."""
        with self._lock:
            if bus in self._buses:
                self._buses.remove(bus)

    def carry(self, letter: Letter) -> None:
        """Give a message to everyone who wants it."""
        with self._lock:
            if letter.retain:
                self.retained[letter.topic] = letter
            buses = list(self._buses)
        for bus in buses:
            for topic_filter, handler in bus.handlers:
                if fits(topic_filter, letter.topic):
                    handler(letter.topic, letter.payload)


class MemoryBus(Bus):
    """One member's connection to a `MemoryBroker`; see `Bus`."""

    def __init__(self, broker: MemoryBroker) -> None:
        super().__init__()
        self._broker = broker

    def open(self) -> None:
        """Connect; if the broker is not running, the bus is away."""
        self.reconnect()

    def reconnect(self) -> None:
        """Try again to connect."""
        if self._state in ("connected", "closed"):
            return
        if self._broker.join(self):
            self.connections += 1
            self._change("connected", "")
        else:
            self._change("away", "the broker is not running")

    def cut(self, trouble: str = "the line was cut") -> None:
        """Lose the connection; the broker, if it lives, publishes the will."""
        if self._state != "connected":
            return
        self._broker.leave(self)
        self._change("away", trouble)
        if self._will is not None and self._broker.running:
            self._broker.carry(self._will)

    def publish(self, letter: Letter) -> bool:
        """Hand over a message; False if there is no connection."""
        if self._state != "connected":
            return False
        self._broker.carry(letter)
        return True

    def close(self, farewell: tuple[Letter, ...] = ()) -> None:
        """Publish the last words and end, without a last will."""
        if self._state == "closed":
            return
        for letter in farewell:
            self.publish(letter)
        self._broker.leave(self)
        self._change("closed", "")
