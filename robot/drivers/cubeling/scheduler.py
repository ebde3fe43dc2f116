"""Decides which command is sent next, sent again or given up: one at a time, the latest wins."""

from dataclasses import dataclass, replace

from cubeling.affect import Emotion
from cubeling.affect.words import closest_word
from cubeling.robot.drivers.commands import CommandQueue, DesiredState
from cubeling.robot.protocol import messages as m, timing

Action = m.Play | m.Move
"""The commands that are events: dropped with their session, and never restored."""

MAX_BEATS = 16
"""BEATs whose answer is awaited; older ones were lost, or their answer is of no use."""


@dataclass
class PendingCommand:
    """The command that waits for its acknowledgement."""

    command: m.Command

    emotion: Emotion | None
    """The emotion of an EXPRESS."""

    sent: float
    """Time of the last send [s]."""

    tries: int = 1
    """Number of sends, including those of commands that it replaced before an acknowledgement."""


@dataclass(frozen=True)
class Refusal:
    """A command that the robot did not take."""

    command: m.Command

    result: int
    """Why, one of `REFUSALS` or another."""


class RoundTrip:
    """Smoothed time from BEAT to STATE and its deviation (Jacobson 1988, as in RFC 6298).

    BEATs are numbered and never repeated, so an answer always belongs to one of them.
    """

    def __init__(self) -> None:
        self.smoothed: float | None = None
        """Round trip [s]; None before the first."""
        self._deviation = 0.0
        self._count = 0
        self._sent: dict[int, float] = {}

    @property
    def pending(self) -> int:
        """Number of BEATs whose answer is awaited, at most `MAX_BEATS`."""
        return len(self._sent)

    @property
    def retry_after(self) -> float:
        """Retransmission timeout [s]."""
        if self.smoothed is None:
            return timing.RETRY_FIRST
        timeout = self.smoothed + 4 * self._deviation
        # At least RETRY_MIN, or one late thread on either side sends everything twice.
        return min(max(timeout, timing.RETRY_MIN), timing.RETRY_MAX)

    def start(self, now: float) -> int:
        """Return the count of a BEAT that is sent at `now` [s]."""
        # A u16 on the wire; `MAX_BEATS` is so small that a number is never awaited twice.
        self._count = (self._count + 1) & 0xFFFF
        self._sent[self._count] = now
        if len(self._sent) > MAX_BEATS:
            # Dictionaries keep their order: the first is the oldest.
            del self._sent[next(iter(self._sent))]
        return self._count

    def stop(self, count: int, now: float) -> float | None:
        """Process the first answer to a BEAT, and return when that BEAT was sent [s].

        Later answers repeat its count and are ignored.
        """
        sent = self._sent.pop(count, None)
        if sent is None:
            return None
        took = now - sent
        if self.smoothed is None:
            self.smoothed, self._deviation = took, took / 2
        else:
            # The deviation first, from the old mean, with the gains ¼ and ⅛ of RFC 6298.
            self._deviation += (abs(took - self.smoothed) - self._deviation) / 4
            self.smoothed += (took - self.smoothed) / 8
        return sent


class CommandScheduler:
    """The commands of one link, over all its sessions."""

    def __init__(self) -> None:
        self.state = DesiredState()
        """The emotion or stop that was requested last."""
        self.actions: CommandQueue[Action] = CommandQueue(timing.ACTIONS_MAX)
        """Motions, sounds and moves that wait; they get their numbers when they are sent."""
        self.pending: PendingCommand | None = None
        """The command that waits for its acknowledgement."""
        self.retries = 0
        """Commands sent again."""
        self.refused = 0
        """Commands acknowledged but refused."""
        self.refusal: Refusal | None = None
        """The last one of them; None after a command that was taken."""
        self.moods: tuple[str, ...] = ()
        """The robot's words for its moods."""
        self._requested = False  # whether an emotion or a stop was requested at all
        self._unsent = False  # whether the desired state must still be sent
        self._state_number = 0  # number of the command that sent it last
        self._number = 0

    @property
    def tries(self) -> int:
        """Number of sends of the pending command; 0 if there is none."""
        return self.pending.tries if self.pending else 0

    @property
    def exhausted(self) -> bool:
        """Whether the pending command was sent as often as the protocol allows."""
        return self.tries >= timing.TRIES_MAX

    def express(self, emotion: Emotion) -> None:
        """Request an emotion; it replaces one that has not been sent yet."""
        if emotion != self.state.commanded:
            self._request(emotion)

    def add(self, action: Action) -> bool:
        """Request an action; return False if too many wait already.

        Moves that wait give way to one that names all of their joints.
        """
        if isinstance(action, m.Move):
            others = ~(action.moved | action.released)
            for one in tuple(self.actions):
                if isinstance(one, m.Move) and not (one.moved | one.released) & others:
                    self.actions.remove(one)
        return self.actions.add(action)

    def stop(self) -> None:
        """Request a stop, before and instead of everything that waits or is pending."""
        self.actions.drop_all()
        self._drop_pending()
        self._request(None)

    def next(self, now: float, retry_after: float) -> m.Command | None:
        """Return the command to send at time `now` [s], if one is due."""
        pending = self.pending
        if pending is None:
            return self._next_new(now)
        if now - pending.sent < retry_after or self.exhausted:
            return None
        self.retries += 1
        if self._unsent and not isinstance(pending.command, Action):
            return self._send_state(now, pending.tries + 1)  # do not repeat an outdated state
        pending.tries += 1
        pending.sent = now
        return pending.command

    def acknowledge(self, number: int, result: int = m.RESULT_TAKEN) -> None:
        """Process the acknowledgement of the command with this number."""
        pending = self.pending
        if pending is None or number != pending.command.number:
            return
        self.pending = None
        self.refusal = None
        if result != m.RESULT_TAKEN:
            self.refused += 1
            self.refusal = Refusal(pending.command, result)
        elif not isinstance(pending.command, Action):
            self.state.confirm(pending.emotion, stopped=pending.emotion is None)

    def end_session(self) -> None:
        """Drop waiting and pending actions; the desired state stays."""
        self.state.forget()
        self.actions.drop_all()
        self._drop_pending()

    def start_session(self, taken: int) -> None:
        """Start a session with a robot in which command `taken` is in force, 0 for none.

        Commands are taken in order, so a later number means that the desired state is in force.
        """
        if taken >= self._state_number > 0:
            if not self._unsent:
                self.state.confirm(self.state.commanded, stopped=self.state.commanded is None)
        else:
            self._unsent = self._requested

    def _request(self, desired: Emotion | None) -> None:
        self.state.commanded, self._requested, self._unsent = desired, True, True

    def _drop_pending(self) -> None:
        pending, self.pending = self.pending, None
        if pending is not None and isinstance(pending.command, Action):
            self.actions.dropped += 1  # never played seconds late

    def _next_new(self, now: float) -> m.Command | None:
        if self._unsent and self.state.commanded is None:
            return self._send_state(now)
        if self.actions:
            action = replace(self.actions.popleft(), number=self._next_number())
            return self._send(action, None, now)
        return self._send_state(now) if self._unsent else None

    def _send_state(self, now: float, tries: int = 1) -> m.Command:
        self._unsent = False
        number = self._state_number = self._next_number()
        emotion = self.state.commanded
        if emotion is None:
            return self._send(m.Stop(number), None, now, tries)
        word = emotion.word and closest_word(self.moods, emotion)
        mood = self.moods.index(word) if word else m.NOTHING
        express = m.Express(number, emotion.valence, emotion.arousal, mood)
        return self._send(express, emotion, now, tries)

    def _send(
        self, command: m.Command, emotion: Emotion | None, now: float, tries: int = 1
    ) -> m.Command:
        self.pending = PendingCommand(command, emotion, now, tries)
        return command

    def _next_number(self) -> int:
        self._number += 1
        return self._number
