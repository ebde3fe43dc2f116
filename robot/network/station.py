"""The thread between a bus and a member: it has the clock, and it never waits for the broker."""

import threading
from collections import deque
from typing import Generic, Self, TypeVar

from robot.contract.closeable import Closeable
from robot.contract.port import Clock
from robot.network.bus import Bus, BusState, Letter
from robot.network.endpoint import Endpoint

TURN_EVERY = 0.05
"""A member thinks at least this often [s], and at once when something has come."""

INBOX = 1024
"""Most messages that wait for the member; newer ones are dropped, and come again if they matter."""

OUTBOX = 256
"""Most messages that are not retained and wait for the bus; newer ones are dropped."""

JOIN_WITHIN = 2.0
"""Longest wait for the thread to end [s]."""

E = TypeVar("E", bound=Endpoint)


class Station(Closeable, Generic[E]):
    """Puts a member on a bus. Close it, or use it in a `with` statement.

    Whoever else touches the member holds `lock`; it is held for moments only.

    Parameters
    ----------
    endpoint
        The member.
    bus
        Its own connection; the station opens and closes it.
    clock
        The time [s].
    """

    def __init__(self, endpoint: E, bus: Bus, clock: Clock) -> None:
        self.endpoint = endpoint
        """The member."""
        self.lock = threading.Lock()
        """Guards the member."""
        self.dropped = 0
        """Messages lost because too many waited."""
        self.failure: Exception | None = None
        """What ended the thread, if that was not `close`."""
        self._bus = bus
        self._clock = clock
        self._inbox: deque[tuple[str, bytes]] = deque()
        self._retained: dict[str, Letter] = {}
        self._passing: deque[Letter] = deque()
        self._connections = 0
        self._woken = threading.Event()
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        if endpoint.will is not None:
            bus.will(endpoint.will)
        for topic_filter in endpoint.filters:
            bus.subscribe(topic_filter, self._arrive)
        bus.on_change(self._woken.set)

    def open(self) -> Self:
        """Connect and begin.

        Raises
        ------
        RobotError
            If the broker is there and refuses; nothing is left open then. One that is away is
            looked for as long as the station lives.
        """
        try:
            self._bus.open()
        except BaseException:
            self._bus.close()
            raise
        self._thread = threading.Thread(target=self._run, name="station", daemon=True)
        self._thread.start()
        return self

    @property
    def state(self) -> BusState:
        """How the connection is; "refused" also for a member that has been replaced."""
        return "refused" if self.endpoint.trouble else self._bus.state

    @property
    def trouble(self) -> str:
        """Why there is none, in one line; "" when nothing is wrong."""
        if self.failure is not None:
            return f"it broke: {self.failure!r}"
        return self.endpoint.trouble or self._bus.trouble

    def wake(self) -> None:
        """Let the member think now."""
        self._woken.set()

    def turn(self) -> None:
        """Let the member hear what has come, think, and speak."""
        now = self._clock()
        with self.lock:
            if self._bus.connections != self._connections:
                self._connections = self._bus.connections
                self._retained.clear()
                self._passing.clear()
                self.endpoint.connected(now)
            for _ in range(len(self._inbox)):
                self.endpoint.receive(*self._inbox.popleft(), now)
            self.endpoint.tick(now)
            if self._bus.state == "connected":
                self._sort(self.endpoint.letters(now))
        self._post()

    def close(self) -> None:
        """Say goodbye and end. A second call does nothing."""
        self._closing.set()
        self._woken.set()
        if self._thread is not None:
            self._thread.join(JOIN_WITHIN)
            self._thread = None
        with self.lock:
            farewell = self.endpoint.farewell()
        self._bus.close(farewell)

    def _run(self) -> None:
        try:
            while not self._closing.is_set():
                self._woken.wait(TURN_EVERY)
                self._woken.clear()
                self.turn()
        except Exception as error:
            self.failure = error  # a thread has nobody to tell; `trouble` does

    def _arrive(self, topic: str, payload: bytes) -> None:
        if len(self._inbox) < INBOX:
            self._inbox.append((topic, payload))
        else:
            self.dropped += 1
        self._woken.set()

    def _sort(self, letters: list[Letter]) -> None:
        """Put letters where they wait: of what is retained only the latest of each topic."""
        for letter in letters:
            if letter.retain:
                self._retained[letter.topic] = letter
            elif len(self._passing) < OUTBOX:
                self._passing.append(letter)
            else:
                self.dropped += 1

    def _post(self) -> None:
        """Hand to the bus what it takes."""
        for topic, letter in list(self._retained.items()):
            if not self._bus.publish(letter):
                return
            del self._retained[topic]
        while self._passing and self._bus.publish(self._passing[0]):
            self._passing.popleft()
