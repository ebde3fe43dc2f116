"""Sends one command at a time to the console and waits for its prompt; nudges it if need be."""

from dataclasses import dataclass
from typing import Literal

from cubeling.robot.contract.port import SendBuffer
from cubeling.robot.drivers.pleo import timing
from cubeling.robot.drivers.pleo.commands import NUDGE, Command
from cubeling.robot.drivers.pleo.console_reader import Answer, ConsoleReader

Outcome = Literal["answered", "unsure", "silent"]
"""answered: the prompt came. unsure: it came only after a nudge and without text, so the command or
its answer was lost. silent: no prompt came at all."""


@dataclass(frozen=True)
class CommandResult:
    """The result of a command."""

    command: Command

    sent: float
    """Time of the send [s]."""

    ended: float
    """Time of the prompt [s]; infinite without one."""

    outcome: Outcome
    """Whether the console has executed it."""

    answer: Answer
    """The text of the answer."""


@dataclass
class PromptedCommand:
    """The command that waits for its prompt."""

    command: Command

    sent: float
    """Time of the send [s]."""

    patient: bool
    """Whether text may follow the prompt, as it does while Pleo's own behaviour is running."""

    asked: float
    """Time of its last send or nudge [s]."""

    nudges: int = 0
    """Empty lines sent since to make the console print its prompt again."""


class Console(SendBuffer):
    """The console; for `boot_text` see `ConsoleReader`."""

    def __init__(self, boot_text: tuple[str, ...]) -> None:
        super().__init__()
        self.reader = ConsoleReader(boot_text)
        """Reads its answers."""
        self.sent = 0
        """Lines sent, empty lines included."""
        self.answered = 0
        """Answers that ended with a prompt."""
        self.pending: PromptedCommand | None = None
        """The pending command; None while the console is free."""

    def send(self, command: Command, now: float, patient: bool = False) -> None:
        """Send a command. The caller knows that the console is free, or searches for it."""
        self.pending = PromptedCommand(command, now, patient, asked=now)
        self.reader.begin(command.text)
        self._write(command)

    def tick(self, now: float) -> CommandResult | None:
        """Return the result of the pending command, once; nudge an overdue console."""
        pending = self.pending
        if pending is None:
            return None
        settle = timing.NUDGED_SETTLE_S if pending.nudges or pending.patient else None
        if self.reader.has_ended(now, settle or timing.PROMPT_SETTLE_S):
            return self._finish(pending)
        wait = timing.NUDGE_INTERVAL_S if pending.nudges else pending.command.timeout
        if now - pending.asked < wait or self.reader.prompt_came is not None:
            return None  # also while a prompt still has to settle
        # Text went on after the prompt, so it never settled; the command was executed all the same.
        if pending.patient and self.reader.answer.prompted:
            return self._finish(pending)
        searching = pending.command is NUDGE and pending.patient  # the caller sends the next one
        if searching or pending.nudges >= timing.MAX_NUDGES:
            return self._finish(pending, silent=True)
        pending.nudges += 1
        pending.asked = now
        self._write(NUDGE)
        return None

    def give_up(self) -> None:
        """Forget the pending command and the bytes that were not written."""
        self.pending = None
        self._out.clear()
        self.reader.begin()

    def _finish(self, pending: PromptedCommand, silent: bool = False) -> CommandResult:
        came = self.reader.prompt_came
        ended = float("inf") if came is None else came
        answer = self.reader.finish()
        self.pending = None
        self.answered += not silent
        outcome: Outcome = "silent" if silent else "answered"
        if pending.nudges and not silent and not answer.spoke and pending.command is not NUDGE:
            # The prompt that came may be the answer to the nudge alone.
            outcome = "unsure"
        return CommandResult(pending.command, pending.sent, ended, outcome, answer)

    def _write(self, command: Command) -> None:
        self.sent += 1
        self._out += command.line
