"""Robots that break section 6."""

from dataclasses import replace
from math import sin
from typing import Any

from cubeling.affect import Emotion
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import unpack
from tests.robot.conformance.mutants.base import Mutant, breaks


class Commanded(Mutant):
    """A robot that does something with commands before they are understood."""

    taken = 0

    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number == 1:
            self.taken = 0
        if number not in (0x10, 0x11, 0x12, 0x13) or session != self.session:
            super().on_body(number, session, body)
            return
        _, command = unpack(body, "host")
        self.on_command(command)
        self.taken = max(self.taken, command.number)

    def on_command(self, command: Any) -> None:
        self.inject(command)


@breaks("command acknowledged")
class DoesNotAcknowledgeStop(Commanded):
    stopping = False

    def on_command(self, command: Any) -> None:
        self.stopping = isinstance(command, m.Stop)
        super().on_command(command)

    def send_message(self, session: int, message: Any) -> None:
        if not (self.stopping and isinstance(message, m.Ack)):
            super().send_message(session, message)


@breaks("taken reported")
class DoesNotSayWhatItHasTaken(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State):
            message = replace(message, taken=0)
        super().send_message(session, message)


@breaks("repeat acknowledged")
class AcknowledgesOnce(Commanded):
    def on_command(self, command: Any) -> None:
        if command.number > self.taken:
            super().on_command(command)


@breaks("repeat without effect", "failsafe keeps the numbers")
class ObeysRepeats(Commanded):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Express):
            self.body.express(Emotion(command.valence, command.arousal), m.NOTHING)
        super().on_command(command)


@breaks("repeat without effect")
class StopsAtOldStops(Commanded):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Stop):
            self.body.stop()
        super().on_command(command)


@breaks("numbers compared unsigned")
class ReadsNumbersSigned(Commanded):
    def on_command(self, command: Any) -> None:
        if command.number < 0x80000000:
            super().on_command(command)
        else:
            self.send(self.session, m.Ack(command.number, m.RESULT_TAKEN))


@breaks("latest wins")
class TakesTheFirstOfTwo(Commanded):
    def frames(self, data: bytes) -> list[bytes]:
        return super().frames(data)[::-1]


@breaks("unknown index refused", "unknown mood refused")
class AgreesToEverything(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Ack):
            message = replace(message, result=m.RESULT_TAKEN)
        super().send_message(session, message)


@breaks("unknown index refused", "unknown mood refused")
class DoesNotUseTheNumberOfARefusal(Commanded):
    refused = 0
    before = 0

    def on_command(self, command: Any) -> None:
        self.before = self.taken
        super().on_command(command)

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Ack) and message.result:
            self.refused = message.number
        if isinstance(message, m.State) and message.taken and message.taken == self.refused:
            message = replace(message, taken=self.before)
        super().send_message(session, message)


@breaks("unknown mood refused")
class ShowsAnotherMoodInstead(Commanded):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Express) and command.mood >= 3:
            self.body.express(Emotion(command.valence, command.arousal), m.NOTHING)
        super().on_command(command)


@breaks("motion played", "sound played")
class PlaysNothing(Mutant):
    def set_up(self) -> None:
        self.body.play = lambda item, index: None  # type: ignore[method-assign]


@breaks("stop stops", "stop holds the pose")
class DoesNotStop(Mutant):
    def set_up(self) -> None:
        self.body.stop = lambda: None  # type: ignore[method-assign]


@breaks("stop stops")
class PlaysOnWhenStopped(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State) and message.motion == m.NOTHING:
            message = replace(message, motion=1)
        super().send_message(session, message)


@breaks("stop holds the pose")
class TremblesWhenStopped(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State) and message.flags & m.FLAG_STILL:
            head = 0.1 * sin(self.now * 20)
            message = replace(message, joints=(head, *message.joints[1:]))
        super().send_message(session, message)


@breaks("stop holds the pose")
class KeepsItsFeelingsWhenStopped(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State) and message.flags & m.FLAG_STILL:
            message = replace(message, valence=0.4)
        super().send_message(session, message)


@breaks("express after stop", "play after stop")
class StaysStopped(Mutant):
    stopped = False

    def set_up(self) -> None:
        stop = self.body.stop

        def stopping() -> None:
            self.stopped = True
            stop()

        self.body.stop = stopping  # type: ignore[method-assign]

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State) and self.stopped:
            message = replace(message, flags=message.flags | m.FLAG_STILL)
        super().send_message(session, message)
