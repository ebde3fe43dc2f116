"""One pending command at a time, and when its echo is reliable.

A board processes one line after the other and echoes the token of each when it is done: a posture
when it is reached, a skill when it has been played. An echo has no sequence number. Therefore:

- The next line is sent when the last one has been echoed.
- A command that is not echoed in time remains pending, and a *question* is asked. Its echo can only
  come after the command's. If the late echo of the command comes first, it still counts; if the
  question's comes first, the command is given up. No later echo can be that command's.
- Questions alternate between two tokens, "?" and "j", and a question is repeated until it is
  echoed. So the late echo of a repetition is never taken for the echo of the next question: the
  alternating-bit protocol (Bartlett, Scantlebury, Wilkinson 1969) over a line that keeps order.
- A robot that fell over plays a skill by itself and echoes it too. From its report on until a later
  question is echoed, echoes of commands are ignored.
"""

from dataclasses import dataclass
from typing import Literal

from cubeling.robot.drivers.opencat import tokens

QUESTION_TIMEOUT_S = 2.0
"""Time after which a question without an echo is repeated [s]; a board may be busy this long."""

MAX_QUESTION_TRIES = 3
"""Sends of a question without an echo after which the robot is lost."""

Kind = Literal["posture", "pose", "melody", "gesture", "rest"]


@dataclass(frozen=True)
class BoardCommand:
    """A line with an effect."""

    kind: Kind
    """What the line starts, which tells what echo and what text follow."""

    line: bytes
    """The bytes on the wire."""

    name: str
    """The skill or melody; empty for others."""

    timeout: float
    """Time after which its echo is late [s]."""

    word: str | None = None
    """The mood that it shows; None for a stop and for commands other than a posture or pose."""

    order: int = 0
    """Number of the desired state that it belongs to; 0 for none."""

    whole: bool = False
    """Whether it completes the desired state; otherwise another command follows."""


@dataclass
class PendingLine:
    """The command that waits for its echo."""

    command: BoardCommand

    sent: float
    """Time of the send [s]."""

    refused: bool = False
    """Whether the board has reported an unknown skill."""


@dataclass
class Question:
    """The question that waits for its echo."""

    line: bytes
    """The bytes on the wire."""

    sent: float
    """Time of the last send [s]."""

    tries: int = 1
    """Number of sends so far; see `MAX_QUESTION_TRIES`."""

    settles: bool = True
    """Whether its echo makes later echoes reliable: it was asked after the doubt began."""


class EchoMatcher:
    """Assigns the echoes of a board to the pending command and question."""

    def __init__(self) -> None:
        self.pending: PendingLine | None = None
        """The pending command."""
        self.question: Question | None = None
        """The pending question."""
        self.answered: float | None = None
        """Time of the last echo of a line of ours [s]."""
        self.round_trip: float | None = None
        """Time from the last question to its echo, if it was asked once [s]."""
        self.doubtful = False
        """Whether the board may echo lines that it did not receive."""
        self._next_question = tokens.QUERY

    def send(self, command: BoardCommand, now: float) -> bytes:
        """Make a command pending; return its line."""
        assert self.pending is None
        assert self.question is None
        self.pending = PendingLine(command, now)
        return command.line

    def ask(self, now: float) -> bytes:
        """Ask the next question, or repeat the pending one; return its line."""
        if self.question is None:
            self.question = Question(self._next_question, now)
        else:
            self.question.sent = now
            self.question.tries += 1
        return self.question.line

    def match(self, line: str, now: float) -> PendingLine | Question | None:
        """Return what a received line is the echo of. No command is pending after a question."""
        question, pending = self.question, self.pending
        # The board echoes only the token, the first letter of a line.
        if question is not None and line == question.line[:1].decode():
            # Of a repeated question it is unknown which send was echoed (Karn's rule).
            if question.tries == 1:
                self.round_trip = now - question.sent
            self._end_question(question)
            self.answered = now
            # A question asked before the fall says nothing about what came after it.
            self.doubtful = self.doubtful and not question.settles
            return question
        if pending is None:
            return None
        if pending.command.name and line.startswith(f"?{pending.command.name}"):
            pending.refused = True
        elif line == pending.command.line[:1].decode() and not self.doubtful:
            self.pending = None
            self.answered = now
            return pending
        return None

    def give_up(self) -> BoardCommand | None:
        """Forget the pending command, and return it."""
        pending, self.pending = self.pending, None
        return None if pending is None else pending.command

    def doubt(self) -> None:
        """Ignore echoes of commands until a question asked from now on is echoed."""
        self.doubtful = True
        if self.question is not None:
            self.question.settles = False

    def is_late(self, now: float) -> bool:
        """Return whether the echo of the command is late."""
        return self.pending is not None and now - self.pending.sent >= self.pending.command.timeout

    def repeat_due(self, now: float) -> bool:
        """Return whether the question must be repeated."""
        return self.question is not None and now - self.question.sent >= QUESTION_TIMEOUT_S

    @property
    def tries(self) -> int:
        """Number of sends of the pending question; 0 if there is none."""
        return self.question.tries if self.question else 0

    def restart(self) -> None:
        """Forget everything pending after a reboot or a new port; the alternation continues."""
        if self.question is not None:
            self._end_question(self.question)
        self.pending = None
        self.doubtful = False

    def _end_question(self, question: Question) -> None:
        # Alternate, or a late echo of this one would count for the next.
        self._next_question = tokens.ANGLES if question.line == tokens.QUERY else tokens.QUERY
        self.question = None
