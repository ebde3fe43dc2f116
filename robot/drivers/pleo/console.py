"""One command on its way at a time: sent after a prompt, answered by a prompt, or nudged for."""

from dataclasses import dataclass
from typing import Literal

from robot.drivers.pleo import timing
from robot.drivers.pleo.commands import NUDGE, Command
from robot.drivers.pleo.reading import Answer, ConsoleReader

Outcome = Literal["answered", "unsure", "silent"]
"""answered: the prompt came. unsure: it came only after a nudge, and no text with it, so the
command or its answer was lost. silent: no prompt came at all."""


@dataclass(frozen=True)
class Landing:
    """How a command ended."""

    command: Command
    """What was sent."""

    sent: float
    """When [s]."""

    ended: float
    """When the prompt came [s]; infinity if none stands."""

    outcome: Outcome
    """Whether the console took it."""

    answer: Answer
    """What it said."""


@dataclass
class Flight:
    """The command that is on its way."""

    command: Command
    """What was sent."""

    sent: float
    """When [s]."""

    patient: bool
    """Whether text may follow the prompt, as it does while Pleo's own behaviour still talks."""

    asked: float
    """When it, or a nudge for it, was last sent [s]."""

    nudges: int = 0
    """How often the answer was asked for."""


class Console:
    """The console at the far end of a line.

    Parameters
    ----------
    boot_text
        As for `ConsoleReader`.
    """

    def __init__(self, boot_text: tuple[str, ...]) -> None:
        self.reader = ConsoleReader(boot_text)
        """What it says."""
        self.sent = 0
        """Lines sent, the empty ones included."""
        self.answered = 0
        """Answers that ended with a prompt."""
        self.flight: Flight | None = None
        """What is on its way; None when the prompt is free."""
        self._out = bytearray()

    def send(self, command: Command, now: float, patient: bool = False) -> None:
        """Send a command. Whoever calls this has seen that the prompt is free, or looks for it."""
        self.flight = Flight(command, now, patient, asked=now)
        self.reader.begin(command.text)
        self._write(command)

    def tick(self, now: float) -> Landing | None:
        """Return how the command ended, once, if it has; nudge the console if it is overdue."""
        flight = self.flight
        if flight is None:
            return None
        settle = timing.NUDGED_SETTLES if flight.nudges or flight.patient else None
        if self.reader.ended(now, settle or timing.PROMPT_SETTLES):
            return self._land(flight)
        wait = timing.NUDGE_EVERY if flight.nudges else flight.command.within
        if now - flight.asked < wait or self.reader.prompt_came is not None:
            return None  # a prompt that still has to settle is not asked for
        if flight.patient and self.reader.answer.prompted:
            return self._land(flight)
        if flight.command is NUDGE and flight.patient:  # a search: its owner decides what is next
            return self._land(flight, silent=True)
        if flight.nudges >= timing.NUDGES_MAX:
            return self._land(flight, silent=True)
        flight.nudges += 1
        flight.asked = now
        self._write(NUDGE)
        return None

    def give_up(self) -> None:
        """Forget what is on its way and what was not yet written."""
        self.flight = None
        self._out.clear()
        self.reader.begin()

    def bytes_to_send(self) -> bytes:
        """Return what is to be written to the line, once."""
        data = bytes(self._out)
        self._out.clear()
        return data

    def _land(self, flight: Flight, silent: bool = False) -> Landing:
        came = self.reader.prompt_came
        ended = float("inf") if came is None else came
        answer = self.reader.finish()
        self.flight = None
        self.answered += not silent
        outcome: Outcome = "silent" if silent else "answered"
        if flight.nudges and not silent and not answer.spoke and flight.command is not NUDGE:
            outcome = "unsure"
        return Landing(flight.command, flight.sent, ended, outcome, answer)

    def _write(self, command: Command) -> None:
        self.sent += 1
        self._out += command.line
