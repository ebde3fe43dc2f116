"""What stands at a bus: a player, a robot's node or an onlooker, without clock, thread or bus."""

from typing import Protocol

from robot.network.bus import Letter

BEAT_EVERY = 2.0
"""A member says this often that it is there [s]."""

SILENT_AFTER = 6.0
"""A member not heard for so long is taken for lost [s]: three beats. The broker's word, the last
will, mostly comes earlier."""


class Endpoint(Protocol):
    """A member's part in the talk. Whoever owns clock and bus calls it; nothing here waits."""

    will: Letter | None
    """What the broker is to publish when the connection breaks."""

    filters: tuple[str, ...]
    """What it wants to hear, in the order in which it wants to hear what is retained."""

    def connected(self, now: float) -> None:
        """Say everything again: the broker may have forgotten all."""

    def receive(self, topic: str, payload: bytes, now: float) -> None:
        """Take a message; whatever it says, this does not raise."""

    def tick(self, now: float) -> None:
        """Do what is due."""

    def letters(self, now: float) -> list[Letter]:
        """Return what is to be published now, each once."""

    def farewell(self) -> tuple[Letter, ...]:
        """Return the last words."""
