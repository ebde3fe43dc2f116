"""Which command is sent next, sent again, or given up: one on its way at a time, the latest wins.

Two kinds of wishes meet here. The *standing order*, an emotion or a stop, is a state: only the
latest counts, and it is restored after every break. *Actions*, motions and sounds, are events:
each is sent in its turn, at most once, and dropped when the session breaks.
"""

from collections import deque
from dataclasses import dataclass

from affect import Emotion
from affect.words import closest_word
from robot.protocol import messages as m
from robot.protocol import timing

Command = m.Express | m.Play | m.Stop


Order = Emotion | None
"""A standing order; None is the order to stop."""


@dataclass
class Flight:
    """The one command that is on its way."""

    command: Command
    """What was sent."""

    order: Order
    """The standing order it carries, if it is not an action."""

    sent: float
    """When it was last sent [s]."""

    tries: int = 1
    """How often it, or what it replaced unacknowledged, was sent."""


class CommandLane:
    """The host's commands of one link, over all its sessions."""

    def __init__(self) -> None:
        self.acknowledged: Emotion | None = None
        """The emotion that the robot has confirmed and, as far as is known, still holds."""
        self.retries = 0
        """Commands sent again."""
        self.refused = 0
        """Commands acknowledged but not carried out."""
        self.dropped = 0
        """Actions given up before they were acknowledged."""
        self.moods: tuple[str, ...] = ()
        """The robot's words for what it can show."""
        self._order: Order = None
        self._ordered = False  # whether there is a standing order at all
        self._unsent = False  # whether it still has to be put in flight
        self._order_number = 0  # under which it was last sent
        self._actions: deque[tuple[int, int]] = deque()
        self._flight: Flight | None = None
        self._number = 0

    @property
    def commanded(self) -> Emotion | None:
        """The emotion that was last asked for; None before, and after a stop."""
        return self._order

    @property
    def tries(self) -> int:
        """How often the command on its way was sent; 0 if none is."""
        return self._flight.tries if self._flight else 0

    @property
    def exhausted(self) -> bool:
        """Whether the command on its way has been sent as often as the protocol allows."""
        return self.tries >= timing.TRIES_MAX

    def express(self, emotion: Emotion) -> None:
        """Order an emotion."""
        if emotion != self._order:
            self._set_order(emotion)

    def stop(self) -> None:
        """Order a stop, before and instead of everything that waits or is on its way."""
        self.dropped += len(self._actions)
        self._actions.clear()
        self._give_up_flight()
        self._set_order(None)

    def play(self, item: int, index: int) -> bool:
        """Ask for an action; False if too many wait already."""
        if len(self._actions) >= timing.ACTIONS_MAX:
            return False
        self._actions.append((item, index))
        return True

    def next(self, now: float, retry_after: float) -> Command | None:
        """Return the command to be sent at time `now` [s], if one is due."""
        flight = self._flight
        if flight is None:
            return self._launch(now)
        if now - flight.sent < retry_after or self.exhausted:
            return None
        self.retries += 1
        if self._unsent and not isinstance(flight.command, m.Play):
            return self._fly_order(now, flight.tries + 1)  # the latest wins: repeat no old one
        flight.tries += 1
        flight.sent = now
        return flight.command

    def land(self, number: int, result: int = m.TAKEN) -> None:
        """Hear that the robot has taken the command with this number."""
        flight = self._flight
        if flight is None or number != flight.command.number:
            return
        self._flight = None
        if result != m.TAKEN:
            self.refused += 1
        elif not isinstance(flight.command, m.Play):
            self.acknowledged = flight.order

    def break_off(self) -> None:
        """Lose the session: actions that wait or fly are dropped, the standing order stays."""
        self.acknowledged = None
        self.dropped += len(self._actions)
        self._actions.clear()
        self._give_up_flight()

    def resume(self, taken: int) -> None:
        """Begin a session with a robot in which command `taken` is in force, 0 for none.

        Commands are taken in the order of their numbers, and the order's was never passed over,
        so a later number says that the order is in force too.
        """
        if taken >= self._order_number > 0:
            if not self._unsent:
                self.acknowledged = self.commanded
        else:
            self._unsent = self._ordered

    def _set_order(self, order: Order) -> None:
        self._order, self._ordered, self._unsent = order, True, True

    def _give_up_flight(self) -> None:
        flight, self._flight = self._flight, None
        if flight is not None and isinstance(flight.command, m.Play):
            self.dropped += 1  # a nod that comes seconds late is worse than none

    def _launch(self, now: float) -> Command | None:
        if self._unsent and self._order is None:
            return self._fly_order(now)
        if self._actions:
            item, index = self._actions.popleft()
            return self._fly(m.Play(self._next_number(), item, index), None, now)
        return self._fly_order(now) if self._unsent else None

    def _fly_order(self, now: float, tries: int = 1) -> Command:
        self._unsent = False
        number = self._order_number = self._next_number()
        order = self._order
        if order is None:
            return self._fly(m.Stop(number), order, now, tries)
        word = order.word and closest_word(self.moods, order)
        mood = self.moods.index(word) if word else m.NOTHING
        express = m.Express(number, order.valence, order.arousal, mood)
        return self._fly(express, order, now, tries)

    def _fly(self, command: Command, order: Order, now: float, tries: int = 1) -> Command:
        self._flight = Flight(command, order, now, tries)
        return command

    def _next_number(self) -> int:
        self._number += 1
        return self._number
