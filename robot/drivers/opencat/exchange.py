"""One command on its way at a time, and when its echo may be believed.

A board handles one line after the other and echoes each line's token when it is done with it: a
posture when it is reached, a skill when it has been played. An echo carries no number. So:

- The next line is sent when the last one has been echoed.
- A command that is not echoed in time stays on its way, and a *question* is asked. Its echo can
  only come after the command's. If the command's echo comes first, late, it still counts; if the
  question's comes first, the command is given up. No later echo can be the given-up command's.
- Questions alternate between two tokens, "?" and "j", and a question is repeated until it is
  echoed. So the late echo of a repeat is never taken for the echo of the next question: the
  alternating-bit protocol (Bartlett, Scantlebury, Wilkinson 1969), over a line that keeps order.
- A robot that fell over plays a skill by itself, and echoes that too. From the moment that it says
  so until a question asked later is echoed, echoes of commands count for nothing.
"""

from dataclasses import dataclass
from typing import Literal

from robot.drivers.opencat import tokens

QUESTION_WITHIN = 2.0
"""A question that is not echoed after this long is repeated [s]; a board may be busy as long."""

LOST_TRIES = 3
"""A question asked so often, each time in vain, means that the robot is lost."""

Kind = Literal["posture", "pose", "melody", "gesture", "rest"]


@dataclass(frozen=True)
class Command:
    """A line for the board that does something."""

    kind: Kind
    """What it is for."""

    line: bytes
    """What is sent."""

    name: str
    """The skill or melody; nothing for the others."""

    within: float
    """Time after which its echo is late [s]."""

    word: str | None = None
    """The mood that is shown when it has landed; None for a stop, and for what is no posture."""

    order: int = 0
    """Number of the standing order that it belongs to; 0 for none."""

    whole: bool = False
    """Whether the order is carried out when this has landed; else more is to follow."""


@dataclass
class Flight:
    """The command that is on its way."""

    command: Command
    """What was sent."""

    sent: float
    """When [s]."""

    refused: bool = False
    """Whether the board has said that it does not know the skill."""


@dataclass
class Question:
    """The question that is asked until it is echoed."""

    line: bytes
    """What is sent."""

    sent: float
    """When it was last sent [s]."""

    tries: int = 1
    """How often it was sent."""

    settles: bool = True
    """Whether its echo ends a doubt: it was asked after the doubt had begun."""


class Exchange:
    """What is on its way to a board, and what an echo means."""

    def __init__(self) -> None:
        self.flight: Flight | None = None
        """The command on its way."""
        self.question: Question | None = None
        """The question that waits for its echo."""
        self.answered: float | None = None
        """When the board last echoed something that it had been sent [s]."""
        self.round_trip: float | None = None
        """Time from the last question to its echo, where it was asked once [s]."""
        self.doubtful = False
        """Whether the board may be echoing what it was not sent."""
        self._next = tokens.QUERY

    def launch(self, command: Command, now: float) -> bytes:
        """Put a command in flight; return what is to be sent."""
        assert self.flight is None
        assert self.question is None
        self.flight = Flight(command, now)
        return command.line

    def ask(self, now: float) -> bytes:
        """Ask the question that is due, for the first time or again; return what is to be sent."""
        if self.question is None:
            self.question = Question(self._next, now)
        else:
            self.question.sent = now
            self.question.tries += 1
        return self.question.line

    def hear(self, line: str, now: float) -> Flight | Question | None:
        """Take a line; return what it is the echo of. A question leaves no flight behind it."""
        question, flight = self.question, self.flight
        if question is not None and line == question.line[:1].decode():
            if question.tries == 1:
                self.round_trip = now - question.sent
            self._next = tokens.ANGLES if question.line == tokens.QUERY else tokens.QUERY
            self.question = None
            self.answered = now
            self.doubtful = self.doubtful and not question.settles
            return question
        if flight is None:
            return None
        if flight.command.name and line.startswith(f"?{flight.command.name}"):
            flight.refused = True
        elif line == flight.command.line[:1].decode() and not self.doubtful:
            self.flight = None
            self.answered = now
            return flight
        return None

    def give_up(self) -> Command | None:
        """Forget the command on its way, and return it."""
        flight, self.flight = self.flight, None
        return None if flight is None else flight.command

    def doubt(self) -> None:
        """Believe no echo of a command until a question asked from now on is echoed."""
        self.doubtful = True
        if self.question is not None:
            self.question.settles = False

    def is_late(self, now: float) -> bool:
        """Whether the command's echo is late."""
        return self.flight is not None and now - self.flight.sent >= self.flight.command.within

    def repeat_due(self, now: float) -> bool:
        """Whether the question is to be asked again."""
        return self.question is not None and now - self.question.sent >= QUESTION_WITHIN

    @property
    def tries(self) -> int:
        """How often the question that waits was asked; 0 if none waits."""
        return self.question.tries if self.question else 0

    def restart(self) -> None:
        """Forget everything on its way, after a reboot or a new port; the alternation goes on."""
        if self.question is not None:
            self._next = tokens.ANGLES if self.question.line == tokens.QUERY else tokens.QUERY
        self.flight = self.question = None
        self.doubtful = False
