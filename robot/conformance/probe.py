"""What a check tries a robot with: it speaks as a host would, or as none should, and listens."""

import contextlib
from collections import deque
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from robot.conformance.heard import Heard, Log, Splitter, shown_bytes
from robot.conformance.line import Line
from robot.conformance.verdicts import SilentError, UnmetError
from robot.protocol import messages as m
from robot.protocol import timing
from robot.protocol.schema import pack, spec_of
from robot.protocol.wire import encode_frame

AT_ONCE = 0.100
"""Within this time an answer is "at once" [s] (PROTOCOL.md, section 5)."""

ACTS_WITHIN = 0.250
"""Within this time STATE shows what a command started or ended [s] (PROTOCOL.md, section 6)."""

SHOWN_WITHIN = 5.0
"""Within this time an emotion is shown that was asked for [s] (PROTOCOL.md, section 7)."""

NEUTRAL = 0.05
"""How far from (0, 0) an emotion may be that counts as neutral."""

SLACK = 0.050
"""How much later than it was sent a frame may be read here, on a busy computer [s]."""

POUR = 256
"""Bytes of noise sent in one go; a line of 115200 baud takes 22 ms for them."""

POUR_EVERY = 0.025
"""Time between two such goes [s]."""

QUEUE_MAX = 10_000
"""Frames that may wait to be looked at; older ones are given up."""

Kind = TypeVar("Kind")


class Probe:
    """A host for one robot, which keeps or breaks every rule as a check wants.

    Parameters
    ----------
    line
        The way to the robot.
    host
        Number of the first host that it says it is; each check is another one.
    """

    def __init__(self, line: Line, host: int) -> None:
        self.log = Log()
        """What is remembered of all that the robot said."""
        self.host = host % 0xFFFFFFFF or 1
        """Who it says it is now."""
        self.session = 0x2120
        """The session last opened."""
        self.version = timing.VERSION
        """The version agreed in it."""
        self.welcome: m.Welcome | None = None
        """The last greeting that was answered."""
        self.catalogue: dict[tuple[int, int], m.Joint | m.Name] | None = None
        """Its catalogue by item and index; None if it is not all known."""
        self.held_up = 0.0
        """How much longer than asked for a wait has lasted: this computer had other work [s]."""
        self.moved = False
        """Whether a check has made all of it move."""
        self.lengths: dict[int, float] | None = None
        """How long its last motion and sound take [s], by item; None if no check has seen it."""
        self.pose: tuple[float, ...] | None = None
        """The joints after STOP [rad], once a check has seen them rest."""
        self._line = line
        self._splitter = Splitter()
        self._queue: deque[Heard] = deque(maxlen=QUEUE_MAX)
        self._count = 0x0100
        self._number = 0

    @property
    def now(self) -> float:
        """The time [s]."""
        return self._line.now()

    # --- Numbers -------------------------------------------------------------------------------
    # None has a zero byte, so that a frame of them is one run of COBS and may be damaged at will.

    def next_session(self) -> int:
        """Return the number of a session that was never open."""
        self.session = _without_zeros(self.session + 1, 2)
        return self.session

    def next_host(self) -> int:
        """Return the number of a host that never spoke, and forget the numbers of its commands."""
        self.host = _without_zeros(self.host + 1, 4)
        self._number = 0
        return self.host

    def next_number(self) -> int:
        """Return the number of the next command."""
        self._number += 1
        return self._number

    def next_count(self) -> int:
        """Return the number of the next BEAT."""
        self._count = _without_zeros(self._count + 1, 2)
        return self._count

    # --- Speaking ------------------------------------------------------------------------------

    def write(self, data: bytes) -> None:
        """Send bytes as they are; what was heard before is over."""
        self.hear(0)
        self._line.write(data)

    def send(self, data: bytes) -> None:
        """Send bytes as they are; what was heard before can still be waited for."""
        self._line.write(data)

    def pour(self, data: bytes) -> None:
        """Send many bytes, no faster than a serial line takes them."""
        for start in range(0, len(data), POUR):
            self._line.write(data[start : start + POUR])
            self.hear(POUR_EVERY)

    def say(self, *messages: Any, session: int | None = None, version: int | None = None) -> None:
        """Send messages in one go, in the session that is open or in another."""
        self.write(b"".join(self.frame(one, session, version) for one in messages))

    def frame(self, message: Any, session: int | None = None, version: int | None = None) -> bytes:
        """Return the bytes of a message, edges included."""
        session = self.session if session is None else session
        return encode_frame(pack(message, session, version or self.version))

    # --- Listening -----------------------------------------------------------------------------

    def hear(self, seconds: float) -> list[Heard]:
        """Return all that comes within a time [s], and what had come before."""
        end = self.now + seconds
        while True:
            self._take(end)
            if self.now >= end:
                break
        heard = list(self._queue)
        self._queue.clear()
        return heard

    def wait_for(
        self, wanted: Callable[[Heard], bool], within: float
    ) -> tuple[Heard | None, list[Heard]]:
        """Return the first frame that is wanted, or None after a time [s], and those before it."""
        end = self.now + within
        before: list[Heard] = []
        while True:
            while self._queue:
                heard = self._queue.popleft()
                if wanted(heard):
                    return heard, before
                before.append(heard)
                del before[:-QUEUE_MAX]
            if self.now >= end:
                return None, before
            self._take(end)

    def expect(self, kind: type[Kind], after: str, within: float = AT_ONCE, **content: Any) -> Kind:
        """Return the message of this kind, session and content; raises UnmetError without it."""

        def wanted(heard: Heard) -> bool:
            return (
                type(heard.message) is kind
                and heard.session == self.session
                and all(getattr(heard.message, key) == value for key, value in content.items())
            )

        found, before = self.wait_for(wanted, within)
        if found is None:
            words = ", ".join(f"{key}={value}" for key, value in content.items())
            name = spec_of(kind).name + (f"({words})" if words else "")
            expected = f"{name} in session {self.session} within {1000 * within:.0f} ms"
            raise UnmetError(f"{expected} after {after}", told(before))
        answer: Kind = found.message
        return answer

    def _take(self, until: float) -> None:
        until = max(until, self.now)
        data = self._line.read(until)
        self.held_up = max(self.held_up, self.now - until)
        self.log.bytes += len(data)
        for heard in self._splitter.feed(data, self.now):
            self.log.enter(heard)
            self._queue.append(heard)

    # --- What a host does ----------------------------------------------------------------------

    def greet(self, within: float = AT_ONCE, offer: int = timing.VERSION) -> m.Welcome:
        """Say HELLO in the session named last, and return its WELCOME."""
        self.say(m.Hello(offer, self.host))
        self.welcome = self.expect(m.Welcome, f"HELLO (version {offer})", within)
        self.version = min(self.welcome.version, timing.VERSION)
        return self.welcome

    def fresh(self, offer: int = timing.VERSION) -> m.Welcome:
        """Open a session as a host that never spoke; raises SilentError if that fails thrice."""
        self.next_host()
        for _ in range(3):
            self.next_session()
            try:
                return self.greet(offer=offer)
            except UnmetError as unmet:
                last = unmet
        raise SilentError(last.expected + ", at the third try", last.came)

    def calm(self) -> m.Welcome:
        """Open a session as a host that never spoke, and wait until the robot shows neutral."""
        welcome = self.fresh()

        def neutral(state: m.State) -> bool:
            return max(abs(state.valence), abs(state.arousal)) < NEUTRAL

        last = self.live(SHOWN_WITHIN, neutral)[-1]
        if not neutral(last):
            expected = f"emotion (0, 0) within {SHOWN_WITHIN:.0f} s after HELLO of another host"
            raise UnmetError(expected, f"({last.valence}, {last.arousal})")
        return welcome

    def again(self, offer: int = timing.VERSION) -> m.Welcome:
        """Open another session as the same host."""
        self.next_session()
        return self.greet(offer=offer)

    def beat(self, after: str = "it") -> m.State:
        """Say BEAT and return the STATE that answers it."""
        count = self.next_count()
        self.say(m.Beat(count))
        return self.expect(m.State, f"BEAT({count}) after {after}", beat=count)

    def command(self, command: Any, result: int = m.TAKEN) -> int:
        """Say a command, see its ACK, and return its number."""
        self.say(command)
        name = spec_of(type(command)).name
        self.expect(m.Ack, f"{name} {command.number}", number=command.number, result=result)
        self._number = max(self._number, command.number)
        return int(command.number)

    def express(self, valence: float, arousal: float, mood: int = m.NOTHING) -> int:
        """Command an emotion under the next number, see its ACK, and return the number."""
        return self.command(m.Express(self.next_number(), valence, arousal, mood))

    def live(
        self, seconds: float, until: Callable[[m.State], bool] = lambda state: False
    ) -> list[m.State]:
        """Say BEAT every 50 ms and return the STATEs of that time [s]; ends early where it may."""
        states: list[m.State] = []
        end = self.now + seconds
        while not states or self.now < end:
            due = self.now + timing.BEAT_EVERY
            states.append(self.beat("others"))
            if until(states[-1]):
                break
            self.hear(max(min(due, end) - self.now, 0))
        return states

    def reaction(self, *said: bytes, after: str = "it") -> list[Heard]:
        """Send bytes, then BEAT; return the messages before its STATE, apart from other STATEs.

        A robot takes bytes in their order, so whatever it says to them comes before that STATE.
        """
        self.write(b"".join(said))
        count = self.next_count()
        self._line.write(self.frame(m.Beat(count)))
        found, before = self.wait_for(
            lambda heard: isinstance(heard.message, m.State) and heard.message.beat == count,
            AT_ONCE,
        )
        if found is None:
            raise UnmetError(f"STATE(beat={count}) after {after}, then BEAT({count})", told(before))
        return [one for one in before if not isinstance(one.message, m.State | None)]

    def unanswered(self, data: bytes, what: str) -> None:
        """Send bytes that must be skipped; raises UnmetError if anything answers them."""
        came = self.reaction(data, after=what)
        if came:
            raise UnmetError(f"no answer to {what} [{shown_bytes(data)}]", told(came))

    def goodbye(self) -> None:
        """Leave the robot neutral, not stopped and without a session, whatever it was doing.

        It is all said at once and nothing waited for: the port may be about to close.
        """
        self.next_host()
        self.next_session()
        with contextlib.suppress(UnmetError):  # it does not read its line
            self.say(m.Hello(1, self.host), m.Express(1, 0.0, 0.0), m.Bye(), version=1)


def told(heard: Iterable[Heard]) -> str:
    """Write what came for a person: the last of it in full."""
    frames = list(heard)
    if not frames:
        return "nothing"
    *others, last = frames
    names: dict[str, int] = {}
    for one in others:
        names[one.name] = names.get(one.name, 0) + 1
    before = ", ".join(f"{count} × {name}" for name, count in names.items())
    return f"{before}, then {last}" if before else str(last)


def _without_zeros(number: int, size: int) -> int:
    """Return the number with a one in place of every zero byte."""
    data = (number % (1 << 8 * size)).to_bytes(size, "little")
    return int.from_bytes(bytes(byte or 1 for byte in data), "little")
