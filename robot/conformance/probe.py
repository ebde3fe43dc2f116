"""The host that tests a robot: it keeps or breaks every rule of the protocol, as a check needs."""

import contextlib
from collections.abc import Callable
from typing import Any

from cubeling.robot.conformance.channel import Channel
from cubeling.robot.conformance.errors import CheckFailed, NoAnswerError
from cubeling.robot.conformance.exchange import REPLY_WITHIN_S, FrameExchange
from cubeling.robot.conformance.received import ReceivedFrame, describe_frames, format_bytes
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.schema import spec_of

EFFECT_WITHIN_S = 0.250
"""Longest time until STATE shows what a command started or ended [s] (PROTOCOL.md, section 6)."""

EMOTION_WITHIN_S = 5.0
"""Longest time until a commanded emotion is shown [s] (PROTOCOL.md, section 7)."""

EMOTION_TOLERANCE = 0.02
"""Largest distance between the emotion commanded and the one shown in the end."""

EMOTION_CHANGE = 0.05
"""Smallest change of the emotion shown that counts as one; closer to (0, 0) is neutral."""

TIMING_SLACK_S = 0.050
"""Longest delay between the sending of a frame and its reading here, on a busy computer [s]."""


class Probe(FrameExchange):
    """A host for one robot, under the checks' control; each acts as another, from `host` on."""

    def __init__(self, channel: Channel, host: int) -> None:
        super().__init__(channel)
        self.host = host % 0xFFFFFFFF or 1
        """Number of the current host."""
        self.welcome: m.Welcome | None = None
        """The last WELCOME."""
        self.catalogue: dict[tuple[int, int], m.Joint | m.Name] | None = None
        """The robot's catalogue by item and index; None before a check has read all of it."""
        self.has_moved = False
        """Whether a check has moved all of the robot."""
        self.durations: dict[int, float] | None = None
        """Duration of the last motion and sound [s], by item; None before a check measured them."""
        self.stop_pose: tuple[float, ...] | None = None
        """The joints after STOP [rad]; None before a check measured them."""
        self._beat = 0x0100
        self._number = 0

    @property
    def takes_move(self) -> bool:
        """Whether the robot says that it takes MOVE, in a session of a version that has it."""
        able = self.welcome is not None and self.welcome.abilities & m.ABILITY_MOVE
        return self.version >= 3 and bool(able)

    # No number has a zero byte, so a frame of them is one run of COBS, and any byte may be damaged.

    def next_session(self) -> int:
        """Return the number of a session that was never open."""
        self.session = _without_zeros(self.session + 1, 2)
        return self.session

    def next_host(self) -> int:
        """Return the number of a new host, and restart the numbers of its commands."""
        self.host = _without_zeros(self.host + 1, 4)
        self._number = 0
        return self.host

    def next_number(self) -> int:
        """Return the number of the next command."""
        self._number += 1
        return self._number

    def next_beat(self) -> int:
        """Return the count of the next BEAT."""
        self._beat = _without_zeros(self._beat + 1, 2)
        return self._beat

    def hello(self, within: float = REPLY_WITHIN_S, offer: int = timing.VERSION) -> m.Welcome:
        """Send HELLO in the current session, and return its WELCOME."""
        self.send(m.Hello(offer, self.host))
        self.welcome = self.expect(m.Welcome, f"HELLO (version {offer})", within)
        self.version = min(self.welcome.version, timing.VERSION)
        return self.welcome

    def open_session(self, offer: int = timing.VERSION) -> m.Welcome:
        """Open a session as a new host; raises NoAnswerError if three attempts fail."""
        self.next_host()
        for _ in range(3):
            self.next_session()
            try:
                return self.hello(offer=offer)
            except CheckFailed as failure:
                last = failure
        raise NoAnswerError(last.expected + ", at the third attempt", last.received)

    def reopen_session(self, offer: int = timing.VERSION) -> m.Welcome:
        """Open another session as the same host."""
        self.next_session()
        return self.hello(offer=offer)

    def open_neutral_session(self) -> m.Welcome:
        """Open a session as a new host, and wait until the robot shows neutral."""
        welcome = self.open_session()
        self.expect_state(
            is_neutral,
            EMOTION_WITHIN_S,
            "emotion (0, 0) after HELLO of another host",
            "valence", "arousal",
        )  # fmt: skip
        return welcome

    def end_session(self) -> None:
        """Leave the robot neutral, not stopped and without a session, whatever its state.

        All messages go in one write and no answer is awaited: the port may be about to close.
        """
        self.next_host()
        self.next_session()
        with contextlib.suppress(CheckFailed):  # the robot does not read its input
            self.send(m.Hello(1, self.host), m.Express(1, 0.0, 0.0), m.Bye(), version=1)

    def beat(self, after: str = "it") -> m.State:
        """Send BEAT and return the STATE that answers it."""
        count = self.next_beat()
        self.send(m.Beat(count))
        return self.expect(m.State, f"BEAT({count}) after {after}", beat=count)

    def command(self, command: Any, result: int = m.RESULT_TAKEN) -> int:
        """Send a command, expect its ACK, and return its number."""
        self.send(command)
        name = spec_of(type(command)).name
        self.expect(m.Ack, f"{name} {command.number}", number=command.number, result=result)
        self._number = max(self._number, command.number)
        return int(command.number)

    def express(self, valence: float, arousal: float, mood: int = m.NOTHING) -> int:
        """Command an emotion with the next number, expect its ACK, and return the number."""
        return self.command(m.Express(self.next_number(), valence, arousal, mood))

    def keep_alive(
        self, seconds: float, until: Callable[[m.State], bool] = lambda state: False
    ) -> list[m.State]:
        """Send BEAT every 50 ms and return its STATEs, for a time [s] or until a condition."""
        states: list[m.State] = []
        end = self.now + seconds
        while not states or self.now < end:
            due = self.now + timing.BEAT_EVERY
            states.append(self.beat("others"))
            if until(states[-1]):
                break
            self.receive(max(min(due, end) - self.now, 0))
        return states

    def expect_state(
        self, condition: Callable[[m.State], bool], within: float, expected: str, *shown: str
    ) -> list[m.State]:
        """Send BEATs until a STATE meets a condition, and return all STATEs.

        Raises CheckFailed if none does within a time [s]. `expected` is the condition in words, and
        after what; `shown` are the fields of the last STATE that the error reports.
        """
        states = self.keep_alive(within, condition)
        if not condition(states[-1]):
            time = f"{within:.0f} s" if within >= 1 else f"{1000 * within:.0f} ms"
            received = [f"{name}={getattr(states[-1], name)}" for name in shown]
            raise CheckFailed(f"{expected}, within {time}", ", ".join(received))
        return states

    def expect_taken(self, number: int, after: str) -> m.State:
        """Return the STATE of a BEAT; raises CheckFailed if another command was taken last."""
        state = self.beat(after)
        if state.taken != number:
            raise CheckFailed(f"STATE(taken={number}) after {after}", f"taken={state.taken}")
        return state

    def replies_to(self, *data: bytes, after: str = "it") -> list[ReceivedFrame]:
        """Send bytes, then BEAT; return the messages before its STATE, without STATEs and LOGs.

        A robot processes bytes in order, so its replies to them precede that STATE.
        """
        self.write(b"".join(data))
        count = self.next_beat()
        self.write(self.frame(m.Beat(count)), keep=True)
        found, before = self.wait_for(
            lambda one: isinstance(one.message, m.State) and one.message.beat == count,
            REPLY_WITHIN_S,
        )
        if found is None:
            expected = f"STATE(beat={count}) after {after}, then BEAT({count})"
            raise CheckFailed(expected, describe_frames(before))
        return [one for one in before if not isinstance(one.message, m.State | m.Log | None)]

    def expect_no_reply(self, data: bytes, what: str) -> None:
        """Send bytes that the robot must skip; raises CheckFailed if it answers them."""
        replies = self.replies_to(data, after=what)
        if replies:
            expected = f"no answer to {what} [{format_bytes(data)}]"
            raise CheckFailed(expected, describe_frames(replies))


def emotion_distance(state: m.State, valence: float, arousal: float) -> float:
    """Return the distance between the emotion shown and another, along the axis of the larger."""
    return max(abs(state.valence - valence), abs(state.arousal - arousal))


def is_neutral(state: m.State) -> bool:
    """Whether the emotion shown is neutral."""
    return emotion_distance(state, 0.0, 0.0) < EMOTION_CHANGE


def _without_zeros(number: int, size: int) -> int:
    """Return the number with every zero byte replaced by a one."""
    data = (number % (1 << 8 * size)).to_bytes(size, "little")
    return int.from_bytes(bytes(byte or 1 for byte in data), "little")
