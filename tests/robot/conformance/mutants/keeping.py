"""Robots that forget what they should keep, or keep what a later message replaces."""

from dataclasses import replace
from typing import Any

from cubeling.robot.protocol import messages as m
from tests.robot.conformance.mutants.base import Mutant, breaks
from tests.robot.conformance.mutants.commands import Commanded
from tests.robot.conformance.mutants.playing import ACTIONS
from tests.robot.conformance.mutants.sessions import Greeter


@breaks("bye keeps the numbers")
class ForgetsTheNumberAtBye(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        super().on_body(number, session, body)
        if number == 0x1F and not self.session:
            self.robot.link.last_command = 0


class NotInForce(Commanded):
    """A robot whose WELCOME does not name some commands."""

    out_of_force = False

    def on_command(self, command: Any) -> None:
        if command.number > self.taken:
            self.out_of_force = self.ignores(command)
        super().on_command(command)

    def ignores(self, command: Any) -> bool:
        raise NotImplementedError

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Welcome) and self.out_of_force:
            message = replace(message, taken=0)
        super().send_message(session, message)


@breaks("stop and refusal in force")
class DoesNotCountStopInWelcome(NotInForce):
    def ignores(self, command: Any) -> bool:
        return isinstance(command, m.Stop)


@breaks("stop and refusal in force")
class DoesNotCountRefusalsInWelcome(NotInForce):
    def ignores(self, command: Any) -> bool:
        return isinstance(command, m.Play) and command.index >= len(self.body.catalogue.motions)


@breaks("hello after failsafe")
class IgnoresHelloWithTheOldSession(Greeter):
    last = 0

    def hello(self, session: int, hello: m.Hello) -> None:
        if self.session or session != self.last:
            super().hello(session, hello)
        self.last = session


@breaks("version of the last hello")
class SendsFlagsOfTheFirstVersion(Greeter):
    version = 2

    def hello(self, session: int, hello: m.Hello) -> None:
        if session != self.session:
            self.version = hello.version
        super().hello(session, hello)

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State) and self.version >= 2:
            message = replace(message, flags=message.flags | m.FLAG_RECKONED)
        super().send_message(session, message)


@breaks("version of the last hello")
class NeverGoesBackUp(Greeter):
    lowest = 2

    def hello(self, session: int, hello: m.Hello) -> None:
        self.lowest = min(hello.version, 2 if session != self.session else self.lowest)
        super().hello(session, replace(hello, version=self.lowest))


@breaks("refused express ends nothing")
class EndsMotionsAtARefusedExpress(Commanded):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Express) and command.mood == m.NOTHING - 1:
            self.body.neutral()
        super().on_command(command)


@breaks("second play replaces the first")
class IgnoresASecondMotion(Commanded):
    def set_up(self) -> None:
        play = self.body.play

        def playing(item: int, index: int) -> None:
            if item == m.ITEM_SOUND or self.body.state().motion < ACTIONS:
                play(item, index)

        self.body.play = playing  # type: ignore[method-assign]


@breaks("second play replaces the first")
class IgnoresASecondSound(Commanded):
    def set_up(self) -> None:
        play = self.body.play

        def playing(item: int, index: int) -> None:
            if item == m.ITEM_MOTION or self.body.state().sound == m.NOTHING:
                play(item, index)

        self.body.play = playing  # type: ignore[method-assign]
