"""A broker within one process: for use without a network, and for tests in virtual time."""

import threading

from cubeling.robot.network.bus import Bus, Message
from cubeling.robot.network.topics import topic_matches


class MemoryBroker:
    """Carries messages between the buses of one process. Thread-safe."""

    def __init__(self) -> None:
        self.retained: dict[str, Message] = {}
        """The last retained message of every topic."""
        self.running = True
        """Whether it accepts connections; see `kill`."""
        self._buses: list[MemoryBus] = []
        self._lock = threading.RLock()

    def bus(self) -> "MemoryBus":
        """Return a new bus of this broker."""
        return MemoryBus(self)

    def kill(self) -> None:
        """Simulate a crash: retained messages are lost, and no last will is published."""
        with self._lock:
            self.running = False
            self.retained.clear()
            buses, self._buses = self._buses, []
        for bus in buses:
            bus.disconnect("the broker was killed")

    def start(self) -> None:
        """Run again, without any state. Buses come back by `MemoryBus.open`."""
        self.running = True

    def add(self, bus: "MemoryBus") -> bool:
        """Connect a bus and send it the retained messages; False if the broker does not run."""
        with self._lock:
            if not self.running:
                return False
            self._buses.append(bus)
            retained = list(self.retained.values())
        for topic_filter, handler in bus.subscriptions:  # in this order, as brokers do
            for message in retained:
                if topic_matches(topic_filter, message.topic):
                    handler(message.topic, message.payload)
        return True

    def remove(self, bus: "MemoryBus") -> None:
        """Disconnect a bus; it receives nothing any more. One that is unknown is ignored."""
        with self._lock:
            if bus in self._buses:
                self._buses.remove(bus)

    def publish(self, message: Message) -> None:
        """Send a message to all subscribers."""
        with self._lock:
            if message.retain:
                self.retained[message.topic] = message
            buses = list(self._buses)
        for bus in buses:
            for topic_filter, handler in bus.subscriptions:
                if topic_matches(topic_filter, message.topic):
                    handler(message.topic, message.payload)


class MemoryBus(Bus):
    """One member's connection to a `MemoryBroker`, made by `MemoryBroker.bus`; see `Bus`."""

    def __init__(self, broker: MemoryBroker) -> None:
        super().__init__()
        self._broker = broker

    def open(self) -> None:
        """Connect, or try it again; if the broker does not run, the state is "away"."""
        if self._state in ("connected", "closed"):
            return
        if self._broker.add(self):
            self.connections += 1
            self._change("connected", "")
        else:
            self._change("away", "the broker is not running")

    def disconnect(self, problem: str = "the connection broke") -> None:
        """Lose the connection; the broker, if it runs, publishes the last will."""
        if self._state != "connected":
            return
        self._broker.remove(self)
        self._change("away", problem)
        if self._will is not None and self._broker.running:
            self._broker.publish(self._will)

    def publish(self, message: Message) -> bool:
        """Send a message; False if there is no connection."""
        if self._state != "connected":
            return False
        self._broker.publish(message)
        return True

    def close(self, closing_messages: tuple[Message, ...] = ()) -> None:
        """Publish the last messages and disconnect, without a last will."""
        if self._state == "closed":
            return
        for message in closing_messages:
            self.publish(message)
        self._broker.remove(self)
        self._change("closed", "")
