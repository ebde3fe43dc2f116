"""The publish/subscribe bus of a member: a broker's client, or the same within one process."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

BusState = Literal["connecting", "connected", "away", "refused", "closed"]
"""connecting: no answer yet. connected: messages are sent. away: the broker cannot be reached; the
bus reconnects by itself. refused: the broker rejects our credentials or our certificate, or we its.
closed: `close()` was called."""

Handler = Callable[[str, bytes], None]
"""Called with topic and payload, on the bus's thread; must return quickly."""


@dataclass(frozen=True)
class Message:
    """A message on the bus."""

    topic: str
    """Below `ROOT`: site, role, name and kind of message; see `topics`."""

    payload: bytes
    """JSON as UTF-8; see `messages`."""

    retain: bool = False
    """Whether the broker keeps it for later subscribers."""


class Bus(ABC):
    """One member's connection to a broker.

    `subscribe`, `set_will` and `on_change` are called before `open`. After a reconnection the
    member publishes its whole state again: the broker may have lost it.
    """

    def __init__(self) -> None:
        self.subscriptions: list[tuple[str, Handler]] = []
        """Topic filters, and the handlers of the messages that match them."""
        self.connections = 0
        """Number of connections so far; after a change everything must be published again."""
        self._will: Message | None = None
        self._on_change: Callable[[], None] = lambda: None
        self._state: BusState = "connecting"
        self._problem = ""

    @property
    def state(self) -> BusState:
        """State of the connection."""
        return self._state

    @property
    def problem(self) -> str:
        """Why it is not connected, or what the broker refused, in one line; "" if nothing."""
        return self._problem

    def subscribe(self, topic_filter: str, handler: Handler) -> None:
        """Receive the messages of matching topics, also after every reconnection."""
        self.subscriptions.append((topic_filter, handler))

    def set_will(self, message: Message) -> None:
        """Set the last will, which the broker publishes when the connection breaks."""
        self._will = message

    def on_change(self, callback: Callable[[], None]) -> None:
        """Call this whenever `state` or `connections` changes."""
        self._on_change = callback

    def _change(self, state: BusState, problem: str) -> None:
        self._state, self._problem = state, problem
        self._on_change()

    @abstractmethod
    def open(self) -> None:
        """Connect; raises RobotError if the broker can be reached and refuses."""

    @abstractmethod
    def publish(self, message: Message) -> bool:
        """Send a message; False if that is not possible now. Never blocks."""

    @abstractmethod
    def close(self, closing_messages: tuple[Message, ...] = ()) -> None:
        """Publish the last messages if possible, and disconnect. A second call does nothing."""
