"""What carries messages: a broker's client, or the same within one process."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

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


class Bus(Protocol):
    """One member's connection. Nothing is kept while it is away: the member says all again."""

    @property
    def state(self) -> BusState:
        """How the connection is."""

    @property
    def trouble(self) -> str:
        """Why it is not connected, in one line; "" when nothing is wrong."""

    @property
    def connections(self) -> int:
        """How often it has been connected; a change means that all must be said again."""

    def subscribe(self, topic_filter: str, handler: Handler) -> None:
        """Hear what is published there, now and after every reconnection; before `open`."""

    def will(self, letter: Letter) -> None:
        """Leave a last will, published by the broker when the connection breaks; before `open`."""

    def on_change(self, hook: Callable[[], None]) -> None:
        """Call this whenever `state` or `connections` changes; before `open`."""

    def open(self) -> None:
        """Connect; raises RobotError if the broker is there and refuses."""

    def publish(self, letter: Letter) -> bool:
        """Hand over a message; False if that is not possible now. Never waits."""

    def close(self, farewell: tuple[Letter, ...] = ()) -> None:
        """Publish the last words if possible, and end. A second call does nothing."""
