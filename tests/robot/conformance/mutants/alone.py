"""Robots that lose, or keep, what they should not when a session ends or another begins."""

from dataclasses import replace
from math import sin
from typing import Any

from cubeling.affect import Emotion
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack, unpack
from cubeling.robot.protocol.wire import encode_frame
from tests.robot.conformance.mutants.base import Mutant, breaks
from tests.robot.conformance.mutants.heartbeat import Stating, Timed
from tests.robot.conformance.mutants.sessions import Greeter

FIRST_ACTION = 3
"""The first motion of the simulated robot that is no loop of a mood."""

# --- Greetings -----------------------------------------------------------------------------------


@breaks("session zero changes nothing")
class GoesToNeutralForSessionZero(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number == 1 and session == 0:
            self.body.neutral()
        super().on_body(number, session, body)


@breaks("session zero changes nothing")
class TakesTheHostOfSessionZero(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number == 1 and session == 0:
            target = self.body.target
            _, hello = unpack(body, "host")
            self.robot.receive(encode_frame(pack(hello, self.session)), self.now)
            self.robot.bytes_to_send()
            self.body.express(target)
        else:
            super().on_body(number, session, body)


@breaks("hello repeated")
class CountsBeatsFromEveryHello(Greeter):
    begun = False

    def on_body(self, number: int, session: int, body: bytes) -> None:
        self.begun = self.begun and number != 3
        super().on_body(number, session, body)

    def hello(self, session: int, hello: m.Hello) -> None:
        self.begun = True
        super().hello(session, hello)

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State) and self.begun:
            message = replace(message, beat=0)
        super().send_message(session, message)


@breaks("version agreed")
class KeepsTheFirstVersionOfASession(Greeter):
    version = 0

    def hello(self, session: int, hello: m.Hello) -> None:
        if session != self.session:
            self.version = hello.version
        super().hello(session, replace(hello, version=self.version))


@breaks("gone rate bounded")
class SaysGoneEvery10Milliseconds(Mutant):
    said = 0.0

    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number == 1 or session == self.session:
            super().on_body(number, session, body)
        elif self.now - self.said >= 0.010:
            self.said = self.now
            self.send(session, m.Gone())


@breaks("same host keeps the motion")
class EndsItsMotionInEverySession(Greeter):
    def hello(self, session: int, hello: m.Hello) -> None:
        target = self.body.target
        super().hello(session, hello)
        self.body.neutral()
        self.body.express(target)


# --- What keeps a session open -------------------------------------------------------------------


@breaks("session survives short silence")
class LosesPatienceALittleEarly(Timed):
    after = 0.35


@breaks("session open until 400 ms")
class LosesPatienceJustTooEarly(Timed):
    after = 0.385


class CountsAllBut(Timed):
    """A robot whose session one message does not keep open."""

    number = 0

    def counts(self, number: int, session: int) -> bool:
        return number != self.number and super().counts(number, session)


@breaks("any message counts")
class DoesNotCountPlay(CountsAllBut):
    number = 0x11


@breaks("any message counts")
class DoesNotCountStop(CountsAllBut):
    number = 0x12


@breaks("any message counts")
class DoesNotCountAsk(CountsAllBut):
    number = 0x02


@breaks("any message counts")
class DoesNotCountAVainAsk(Timed):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        heard = self.heard
        super().on_body(number, session, body)
        if number == 2 and body[3] > m.ITEM_MOOD:
            self.heard = heard


# --- Neutral -------------------------------------------------------------------------------------


class Left(Stating):
    """A robot that knows whether it went to neutral of its own accord."""

    left = False
    sound = False
    motion = False

    def set_up(self) -> None:
        neutral, express = self.body.neutral, self.body.express
        play, stop = self.body.play, self.body.stop

        def leaving() -> None:
            state = self.body.state()
            self.left = True
            self.motion = state.motion >= FIRST_ACTION and not state.flags & m.FLAG_STILL
            neutral()

        def feeling(emotion: Emotion, mood: int = m.NOTHING) -> None:
            self.left = False
            express(emotion, mood)

        def playing(item: int, index: int) -> None:
            self.left = False
            self.sound = item == m.ITEM_SOUND
            play(item, index)

        def stopping() -> None:
            stop()
            self.left = self.sound = False

        self.body.neutral, self.body.express = leaving, feeling  # type: ignore[method-assign]
        self.body.play, self.body.stop = playing, stopping  # type: ignore[method-assign]


@breaks("failsafe goes to neutral", "bye goes to neutral", "another host goes to neutral")
class SoundsOnWhenAlone(Left):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, sound=5) if self.left and self.sound else state


@breaks("failsafe goes to neutral", "bye goes to neutral", "another host goes to neutral")
class IsStoppedWhenAlone(Left):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, flags=state.flags | m.FLAG_STILL) if self.left else state


@breaks("failsafe does not jump")
class JumpsToNeutral(Left):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, valence=0.0, arousal=0.0) if self.left else state


@breaks("failsafe ends the movement")
class MovesOnWhenAlone(Left):
    def alter_state(self, state: m.State) -> m.State:
        sway = 0.3 * sin(20 * self.now) if self.left and self.motion else 0.0
        return replace(state, joints=(sway, *(0.0,) * 15))


@breaks("stopped robot stays still")
class SwaysWhenStoppedAndAlone(Left):
    def alter_state(self, state: m.State) -> m.State:
        if not (self.left and state.flags & m.FLAG_STILL):
            return state
        return replace(state, joints=(0.2, *state.joints[1:]))


@breaks("stopped robot stays still")
class WakesUpForAnotherHost(Greeter):
    host = 0

    def hello(self, session: int, hello: m.Hello) -> None:
        super().hello(session, hello)
        if hello.host != self.host:
            self.host = hello.host
            self.body.express(Emotion(0.0, 0.0))


# --- What it shows -------------------------------------------------------------------------------


@breaks("emotion shown")
class IsNeverCalmerThanCalm(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, arousal=max(state.arousal, 0.0))


@breaks("joints within limits")
class BendsTooFarInOneMotion(Stating):
    def alter_state(self, state: m.State) -> m.State:
        far = state.motion == FIRST_ACTION
        return replace(state, joints=(1.1, *state.joints[1:])) if far else state


@breaks("joints within speed")
class JerksInOneMotion(Stating):
    def alter_state(self, state: m.State) -> m.State:
        if state.motion != FIRST_ACTION:
            return state
        tail = 1.5 if self.now % 0.4 < 0.2 else -1.5
        return replace(state, joints=(*state.joints[:9], tail, *state.joints[10:]))
