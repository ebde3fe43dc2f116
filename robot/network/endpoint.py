"""What stands at a bus: a player, a robot's node or an onlooker, without clock, thread or bus."""

from typing import Protocol

from robot.network.bus import Letter
from robot.network.messages import Status
from robot.network.schema import COUNT_MAX

BEAT_EVERY = 2.0
"""A member says this often that it is there [s]."""

SILENT_AFTER = 6.0
"""A member not heard for so long is taken for lost [s]: three beats. The broker's word, the last
will, mostly comes earlier."""


SETTLE = 1.0
"""So long after its first connection a run learns of earlier ones under its name [s]."""


class Run:
    """Which run of a member's program this is, among others under the same name.

    A later run has a greater number, so that nobody mixes them up. The number comes from the time
    of day; where that went back, the run learns of the earlier one from what the broker retained,
    and goes beyond it. A run that meets a greater one after that has been replaced, and is silent.

    Parameters
    ----------
    number
        Of this run, ≥ 1.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        """The session in every message."""
        self.replaced = False
        """Whether another program speaks under the same name, and was started later."""
        self._first: float | None = None

    def connected(self, now: float) -> None:
        """Take note of a connection."""
        self._first = now if self._first is None else self._first

    def meet(self, other: int, now: float, *, alive: bool = False) -> bool:
        """Take note of another run; whether this one has a new number now."""
        if not self.number < other < COUNT_MAX:
            return False
        if self._first is None or now - self._first <= SETTLE:
            self.number = other + 1
            return True
        self.replaced |= alive
        return False

    def meet_status(self, status: Status, now: float) -> bool:
        """Take note of what was said under our name; whether this one has a new number now."""
        return self.meet(status.session, now, alive=status.status == "online")


REPLACED = "another program, started later, speaks as {}: give one of them another name"
"""What a member that was replaced says."""


class Endpoint(Protocol):
    """A member's part in the talk. Whoever owns clock and bus calls it; nothing here waits."""

    @property
    def will(self) -> Letter | None:
        """What the broker is to publish when the connection breaks."""

    @property
    def filters(self) -> tuple[str, ...]:
        """What it wants to hear, in the order in which it wants to hear what is retained."""

    @property
    def trouble(self) -> str:
        """Why it has fallen silent for good, in one line; "" as long as it has not."""

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
