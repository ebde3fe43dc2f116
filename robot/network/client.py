"""The thread between an endpoint and a bus: it has the clock, and never blocks on the broker."""

import threading
from collections import deque
from typing import Generic, Self, TypeVar

from cubeling.robot.contract.closeable import Closeable
from cubeling.robot.contract.port import Clock
from cubeling.robot.network.bus import Bus, BusState, Message
from cubeling.robot.network.endpoint import Endpoint

STEP_EVERY_S = 0.05
"""Longest time between two steps of an endpoint [s]; a message triggers the next one at once."""

MAX_INCOMING = 1024
"""Most messages waiting for the endpoint; newer ones are dropped, and repeated if they matter."""

MAX_OUTGOING = 256
"""Most messages waiting for the bus that are not retained; newer ones are dropped."""

JOIN_TIMEOUT_S = 2.0
"""Longest wait for the thread to end [s]."""

E = TypeVar("E", bound=Endpoint)


class BusClient(Closeable, Generic[E]):
    """Runs an endpoint on a bus of its own. Close it, or use it in a `with` statement.

    Hold `lock` while accessing the endpoint from elsewhere, for a short time only.

    Parameters
    ----------
    endpoint
        A player, a robot's node or an observer.
    bus
        Its own connection; the client opens and closes it.
    clock
        Returns the time [s].
    """

    def __init__(self, endpoint: E, bus: Bus, clock: Clock) -> None:
        self.endpoint = endpoint
        """The endpoint."""
        self.bus = bus
        """Its connection."""
        self.lock = threading.Lock()
        """Guards the endpoint."""
        self._failure: Exception | None = None
        self._clock = clock
        self._incoming: deque[tuple[str, bytes]] = deque()
        self._retained: dict[str, Message] = {}
        self._outgoing: deque[Message] = deque()
        self._connections = 0
        self._wake = threading.Event()
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        if endpoint.will is not None:
            bus.set_will(endpoint.will)
        for topic_filter in endpoint.topic_filters:
            bus.subscribe(topic_filter, self._on_message)
        bus.on_change(self._wake.set)

    def open(self) -> Self:
        """Connect and start. If the broker cannot be reached, the bus tries again until `close`.

        Raises
        ------
        RobotError
            If the broker can be reached and refuses; nothing is left open then.
        """
        try:
            self.bus.open()
        except BaseException:
            self.bus.close()
            raise
        self._thread = threading.Thread(target=self._run, name="bus client", daemon=True)
        self._thread.start()
        return self

    @property
    def state(self) -> BusState:
        """State of the connection; "refused" also for an endpoint that has been replaced."""
        return "refused" if self.endpoint.problem else self.bus.state

    @property
    def problem(self) -> str:
        """What is wrong, in one line; "" if nothing is."""
        if self._failure is not None:
            return f"internal error: {self._failure!r}"
        return self.endpoint.problem or self.bus.problem

    def wake(self) -> None:
        """Run the next step now."""
        self._wake.set()

    def step(self) -> None:
        """Let the endpoint process what has arrived, do what is due, and publish."""
        now = self._clock()
        with self.lock:
            if self.bus.connections != self._connections:
                self._connections = self.bus.connections
                self._retained.clear()
                self._outgoing.clear()
                self.endpoint.on_connect(now)
            for _ in range(len(self._incoming)):
                self.endpoint.receive(*self._incoming.popleft(), now)
            self.endpoint.tick(now)
            if self.bus.state == "connected":
                self._queue(self.endpoint.outgoing_messages(now))
        self._publish()

    def close(self) -> None:
        """Publish the closing messages and end. A second call does nothing."""
        self._closing.set()
        self._wake.set()
        if self._thread is not None:
            self._thread.join(JOIN_TIMEOUT_S)
            self._thread = None
        with self.lock:
            closing_messages = self.endpoint.closing_messages()
        self.bus.close(closing_messages)

    def _run(self) -> None:
        try:
            while not self._closing.is_set():
                self._wake.wait(STEP_EVERY_S)
                self._wake.clear()
                self.step()
        except Exception as error:
            self._failure = error  # `problem` reports it

    def _on_message(self, topic: str, payload: bytes) -> None:
        if len(self._incoming) < MAX_INCOMING:
            self._incoming.append((topic, payload))
        self._wake.set()

    def _queue(self, messages: list[Message]) -> None:
        """Queue messages; of retained ones only the latest of each topic."""
        for message in messages:
            if message.retain:
                self._retained[message.topic] = message
            elif len(self._outgoing) < MAX_OUTGOING:
                self._outgoing.append(message)

    def _publish(self) -> None:
        """Publish as many messages as the bus takes."""
        for topic, message in list(self._retained.items()):
            if not self.bus.publish(message):
                return
            del self._retained[topic]
        while self._outgoing and self.bus.publish(self._outgoing[0]):
            self._outgoing.popleft()
