"""Robots that break section 5."""

from dataclasses import replace
from typing import Any

from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import MESSAGES, pack, unpack
from tests.robot.conformance.mutants.base import Mutant, breaks


class Greeter(Mutant):
    """A robot that does something with HELLO before it is understood."""

    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number == 1 and len(body) >= 8 and session:
            session, hello = unpack(body, "host")
            self.hello(session, hello)
        else:
            super().on_body(number, session, body)

    def hello(self, session: int, hello: m.Hello) -> None:
        self.inject(hello, session)


@breaks("hello answered")
class GreetsLate(Mutant):
    def set_up(self) -> None:
        self.late: list[tuple[float, int, m.Welcome]] = []

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Welcome):
            self.late.append((self.now + 0.15, session, message))
        else:
            super().send_message(session, message)

    def on_advance(self) -> None:
        while self.late and self.late[0][0] <= self.now:
            _, session, message = self.late.pop(0)
            self.send(session, message)


@breaks("hello answered")
class ForgetsToOpenTheSession(Greeter):
    def hello(self, session: int, hello: m.Hello) -> None:
        super().hello(session, hello)
        self.inject(m.Bye())


@breaks("hello repeated")
class BeginsAnewAtARepeatedHello(Greeter):
    def hello(self, session: int, hello: m.Hello) -> None:
        if session == self.session:
            self.inject(replace(hello, host=hello.host ^ 1), session)
        super().hello(session, hello)


@breaks("session zero refused")
class OpensSessionZero(Mutant):
    inside = 0x7777

    def on_body(self, number: int, session: int, body: bytes) -> None:
        if session == 0:
            body = body[:1] + self.inside.to_bytes(2, "little") + body[3:]
        super().on_body(number, session, body)

    def send_message(self, session: int, message: Any) -> None:
        super().send_message(0 if session == self.inside else session, message)


@breaks("session zero refused")
class BelievesThatSessionZeroIsOpen(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if session == self.session == 0 and number == 3:
            self.send(0, m.Ack(1, m.RESULT_TAKEN))
        else:
            super().on_body(number, session, body)


@breaks("highest numbers accepted")
class ReadsSessionsSigned(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if session < 0x8000:
            super().on_body(number, session, body)


@breaks("newest session wins", "other session reported")
class DoesNotLookAtSessions(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number != 1 and self.session:
            body = body[:1] + self.session.to_bytes(2, "little") + body[3:]
        super().on_body(number, session, body)


@breaks("many hellos survived")
class TiresOfGreetings(Greeter):
    greeted = 0
    begin = 0.0

    def hello(self, session: int, hello: m.Hello) -> None:
        if self.now - self.begin > 0.3:
            self.begin, self.greeted = self.now, 0
        self.greeted += 1
        if self.greeted < 20:
            super().hello(session, hello)


@breaks("another host starts over", "another host goes to neutral")
class TakesAllHostsForOne(Greeter):
    def hello(self, session: int, hello: m.Hello) -> None:
        super().hello(session, replace(hello, host=5))


@breaks("another host in the same session")
class LooksAtTheHostOfNewSessionsOnly(Greeter):
    host = 0

    def hello(self, session: int, hello: m.Hello) -> None:
        if session != self.session:
            self.host = hello.host
        super().hello(session, replace(hello, host=self.host))


@breaks("same host continues", "same host keeps the emotion")
class ForgetsInEverySession(Greeter):
    host = 1

    def hello(self, session: int, hello: m.Hello) -> None:
        self.host += session != self.session
        super().hello(session, replace(hello, host=self.host))


@breaks("other session reported")
class NamesItsOwnSessionInGone(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        super().send_message(self.session if isinstance(message, m.Gone) else session, message)


@breaks("other session reported", "session ends after silence")
class NeverSaysGone(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if not isinstance(message, m.Gone):
            super().send_message(session, message)


@breaks("other session reported")
class EndsAtAnyBye(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        super().on_body(number, session, body)
        if number == 0x1F and self.session:
            self.inject(m.Bye())


@breaks("gone without session")
class SaysGoneOnlyInASession(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if self.session or not isinstance(message, m.Gone):
            super().send_message(session, message)


@breaks("gone rate bounded")
class SaysGoneToEverything(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if session != self.session and number != 1:
            self.send(session, m.Gone())
        else:
            super().on_body(number, session, body)


@breaks("silent without session", "silent after failsafe")
class CallsForAHost(Mutant):
    called = 0.0

    def on_advance(self) -> None:
        if not self.session and self.now - self.called > 0.2:
            self.called = self.now
            self.send(1, m.Gone())


@breaks("silent without session")
class AnswersBye(Mutant):
    delay = 0.0

    def on_body(self, number: int, session: int, body: bytes) -> None:
        super().on_body(number, session, body)
        if number == 0x1F:
            self.delay = self.now + 0.06

    def on_advance(self) -> None:
        if self.delay and self.now >= self.delay:
            self.delay = 0.0
            self.send(1, m.Gone())


@breaks("own session in header")
class SendsForTheSessionBefore(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        super().send_message(session, message)
        if isinstance(message, m.State):
            super().send_message(session - 1, message)


@breaks("version agreed")
class SpeaksVersion2ToAll(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Welcome):
            message = replace(message, version=2)
        super().send_message(session, message)


@breaks("earlier versions spoken")
class FlagsOfVersion2InVersion1(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State):
            message = replace(message, flags=message.flags | m.FLAG_RECKONED)
        super().send_message(session, message)


# --- The catalogue -------------------------------------------------------------------------------


@breaks("catalogue complete")
class CannotSayItsLastJoint(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if not (isinstance(message, m.Joint) and message.index == 13):
            super().send_message(session, message)


@breaks("catalogue complete")
class NamesEverythingZero(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Name):
            message = replace(message, index=0)
        super().send_message(session, message)


@breaks("names distinct")
class CallsEverythingTheSame(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Name):
            message = replace(message, name="thing")
        super().send_message(session, message)


@breaks("names distinct")
class HasNoName(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Welcome):
            message = replace(message, name="")
        super().send_message(session, message)


@breaks("joint limits sensible")
class HasAJointTheWrongWayRound(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Joint) and message.index == 3:
            message = replace(message, low=message.high, high=message.low)
        super().send_message(session, message)


@breaks("catalogue constant")
class CountsItsGreetings(Mutant):
    greeted = 0

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Welcome):
            self.greeted += 1
            message = replace(message, catalogue=self.greeted)
        super().send_message(session, message)


@breaks("catalogue constant")
class NamesThingsAnewEachTime(Mutant):
    asked = 0

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Name):
            self.asked += 1
            message = replace(message, name=f"thing {self.asked}")
        super().send_message(session, message)


@breaks("no entry beyond the catalogue")
class AnswersEveryQuestion(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number == 2 and body[4] == 255 and session == self.session:
            self.send(session, m.Name(m.ITEM_MOTION, 255, "?"))
        super().on_body(number, session, body)


assert MESSAGES[2].kind is m.Ask
assert pack(m.Bye(), 1)[0] == 0x1F
