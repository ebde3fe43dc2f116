"""What carries messages: a broker's client, or the same within one process."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

BusState = Literal["connecting", "connected", "away", "refused", "closed"]
"""connecting: nobody has answered yet. connected: what is published goes out. away: the broker is
gone, and is tried again and again. refused: it does not want us, or another took our name.
closed: `close()` was called."""

Handler = Callable[[str, bytes], None]
"""Is given topic and payload; from the bus's thread, so it must be quick."""


@dataclass(frozen=True)
class Letter:
    """A message on its way."""

    topic: str
    """Where to."""

    payload: bytes
    """What."""

    retain: bool = False
    """Whether the broker keeps it for those who come later."""


class Bus(ABC):
    """One member's connection. Nothing is kept while it is away: the member says all again.

    What is subscribed, willed and hooked is said before `open`.
    """

    def __init__(self) -> None:
        self.handlers: list[tuple[str, Handler]] = []
        """What is subscribed to: filters and who hears what fits them."""
        self.connections = 0
        """How often it has been connected; a change means that all must be said again."""
        self._will: Letter | None = None
        self._hook: Callable[[], None] = lambda: None
        self._state: BusState = "connecting"
        self._trouble = ""

    @property
    def state(self) -> BusState:
        """How the connection is."""
        return self._state

    @property
    def trouble(self) -> str:
        """Why it is not connected, or what the broker did not allow, in one line; "" if nothing."""
        return self._trouble

    def subscribe(self, topic_filter: str, handler: Handler) -> None:
        """Hear what is published there, now and after every reconnection."""
        self.handlers.append((topic_filter, handler))

    def will(self, letter: Letter) -> None:
        """Leave a last will, published by the broker when the connection breaks."""
        self._will = letter

    def on_change(self, hook: Callable[[], None]) -> None:
        """Call this whenever `state` or `connections` changes."""
        self._hook = hook

    def _change(self, state: BusState, trouble: str) -> None:
        self._state, self._trouble = state, trouble
        self._hook()

    @abstractmethod
    def open(self) -> None:
        """Connect; raises RobotError if the broker is there and refuses."""

    @abstractmethod
    def publish(self, letter: Letter) -> bool:
        """Hand over a message; False if that is not possible now. Never waits."""

    @abstractmethod
    def close(self, farewell: tuple[Letter, ...] = ()) -> None:
        """Publish the last words if possible, and end. A second call does nothing."""
