"""Robots that break the rules of MOVE."""

from dataclasses import replace
from typing import Any

from cubeling.affect import Emotion
from cubeling.robot.protocol import messages as m
from tests.robot.conformance.mutants.base import Mutant, breaks
from tests.robot.conformance.mutants.commands import Commanded
from tests.robot.conformance.mutants.heartbeat import Stating
from tests.robot.conformance.mutants.sessions import Greeter

JOINTS = 14
"""Joints of the simulated robot."""

ALL = (1 << JOINTS) - 1

LEVEL = (0.0,) * m.JOINTS_MAX


class Moved(Commanded):
    """A robot that understands MOVE in its own way."""

    def on_command(self, command: Any) -> None:
        super().on_command(self.on_move(command) if isinstance(command, m.Move) else command)

    def on_move(self, move: m.Move) -> m.Move:
        return move

    def let_go(self) -> None:
        self.body.move(m.Move(1, 0.0, ALL, 0, LEVEL))


@breaks("abilities valid")
class HasAbilitiesOfItsOwn(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Welcome):
            message = replace(message, abilities=message.abilities | 4)
        super().send_message(session, message)


@breaks("abilities valid")
class MovesWithoutSayingThatItCan(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Welcome):
            message = replace(message, abilities=0)
        super().send_message(session, message)


@breaks("joint moved")
class HoldsWithoutMoving(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, joints=LEVEL) if state.held else state


@breaks("joint moved")
class DoesNotSayWhatItHolds(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, held=0)


@breaks("joint moved")
class GoesHalfTheWay(Moved):
    def on_move(self, move: m.Move) -> m.Move:
        return replace(move, angles=tuple(angle / 2 for angle in move.angles))


@breaks("joint moved evenly")
class MovesAsFastAsItCan(Moved):
    def on_move(self, move: m.Move) -> m.Move:
        return replace(move, duration=0.0)


@breaks("held joint stays")
class LetsGoToFeel(Moved):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Express):
            self.let_go()
        super().on_command(command)


@breaks("held joint stays")
class LetsGoToPlay(Moved):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Play):
            self.let_go()
        super().on_command(command)


@breaks("joint let go", "angle beyond limits refused")
class NeverLetsGo(Moved):
    def on_move(self, move: m.Move) -> m.Move:
        return replace(move, released=0)


@breaks("joint let go")
class LetsGoAfterMoving(Moved):
    def on_move(self, move: m.Move) -> m.Move:
        return replace(move, moved=move.moved & ~move.released)


@breaks("angle beyond limits refused")
class ClampsAngles(Moved):
    def on_move(self, move: m.Move) -> m.Move:
        limits = self.body.catalogue.joints
        angles = [
            min(max(angle, joint.low), joint.high)
            for angle, joint in zip(move.angles, limits, strict=False)
        ]
        return replace(move, angles=(*angles, 0.0, 0.0))


@breaks("angle beyond limits refused")
class HoldsWhatItRefuses(Moved):
    def on_move(self, move: m.Move) -> m.Move:
        if move.number > self.taken and max(map(abs, move.angles)) > 30:
            self.body.move(replace(move, angles=LEVEL))
        return move


@breaks("unknown joint refused")
class IgnoresUnknownJoints(Moved):
    def on_move(self, move: m.Move) -> m.Move:
        return replace(move, moved=move.moved & ALL, released=move.released & ALL)


@breaks("old move without effect")
class ObeysOldMoves(Moved):
    def on_move(self, move: m.Move) -> m.Move:
        if move.number <= self.taken:
            self.body.move(move)
        return move


@breaks("stop lets go")
class HoldsOnWhenStopped(Mutant):
    def set_up(self) -> None:
        self.body.stop = lambda: self.body.express(Emotion(0.0, 0.0))  # type: ignore[method-assign]


@breaks("stop lets go")
class StaysStoppedWhenMoved(Stating):
    def set_up(self) -> None:
        self.stopped = False
        stop = self.body.stop

        def stopping() -> None:
            self.stopped = True
            stop()

        self.body.stop = stopping  # type: ignore[method-assign]

    def alter_state(self, state: m.State) -> m.State:
        return replace(state, flags=state.flags | m.FLAG_STILL * self.stopped)


@breaks("failsafe lets go", "bye lets go", "another host lets go")
class HoldsOnWhenAlone(Mutant):
    def set_up(self) -> None:
        self.body.neutral = lambda: self.body.express(Emotion(0.0, 0.0))  # type: ignore[method-assign]


@breaks("same host keeps hold")
class LetsGoInEverySession(Greeter, Moved):
    def hello(self, session: int, hello: m.Hello) -> None:
        super().hello(session, hello)
        self.let_go()
