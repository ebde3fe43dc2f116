"""Robots that break section 7."""

from dataclasses import replace
from typing import Any

from cubeling.affect import Emotion
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import MESSAGES
from tests.robot.conformance.mutants.base import Mutant, breaks
from tests.robot.conformance.mutants.sessions import Greeter


class Stating(Mutant):
    """A robot whose STATE is not what it should be."""

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State):
            message = self.alter_state(message)
        super().send_message(session, message)

    def alter_state(self, state: m.State) -> m.State:
        return state


@breaks("beat answered")
class CountsBeatsInSevenBits(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, beat=state.beat & 0x7FFF)


@breaks("beat forgotten in a new session")
class RemembersTheLastBeat(Stating):
    last = 0

    def alter_state(self, state: m.State) -> m.State:
        self.last = state.beat or self.last
        return replace(state, beat=self.last)


@breaks("state sent without beat")
class SpeaksOnlyWhenAsked(Mutant):
    asked = False

    def on_body(self, number: int, session: int, body: bytes) -> None:
        self.asked = number == 3
        super().on_body(number, session, body)
        self.asked = False

    def send_message(self, session: int, message: Any) -> None:
        if self.asked or not isinstance(message, m.State):
            super().send_message(session, message)


@breaks("state values valid")
class ShowsAMoodThatItDoesNotHave(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, mood=9)


@breaks("state values valid")
class HasAJointTooMany(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, joints=(*state.joints[:15], 0.5))


@breaks("state values valid")
class HasFlagsOfItsOwn(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, flags=state.flags | 0x40)


@breaks("emotion shown")
class NeverGetsThere(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, valence=0.8 * state.valence)


@breaks("emotion shown")
class WaversOnItsWay(Stating):
    def alter_state(self, state: m.State) -> m.State:
        wavering = 0.3 < state.valence < 0.5 and state.beat % 2
        return replace(state, valence=0.0) if wavering else state


@breaks("emotion rate bounded")
class TellsWhatItWasTold(Stating):
    def alter_state(self, state: m.State) -> m.State:
        told = self.body.target
        return replace(state, valence=told.valence, arousal=told.arousal)


@breaks("joints within limits")
class BendsAJointTooFar(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, joints=(1.1, *state.joints[1:]))


@breaks("joints within speed")
class JerksItsTail(Stating):
    def alter_state(self, state: m.State) -> m.State:
        tail = 1.5 if self.now % 0.6 < 0.3 else -1.5
        return replace(state, joints=(*state.joints[:9], tail, *state.joints[10:]))


@breaks("state rate bounded")
class SaysEverythingThreeTimes(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        for _ in range(3):
            super().send_message(session, message)


@breaks("round trip short")
class IsSlow(Mutant):
    def set_up(self) -> None:
        self.late: list[tuple[float, bytes]] = []

    def write(self, data: bytes) -> None:
        self.late.append((self.now + 0.03, data))

    def on_advance(self) -> None:
        while self.late and self.late[0][0] <= self.now:
            self.out += self.late.pop(0)[1]


# --- The failsafe --------------------------------------------------------------------------------


@breaks("session ends after silence", "silent after failsafe", "failsafe forgets the emotion")
class HasNoFailsafe(Mutant):
    def on_advance(self) -> None:
        if self.session:
            self.keep_alive()


class Timed(Mutant):
    """A robot with a clock of its own for the failsafe."""

    after = 0.45
    heard = 0.0

    def on_body(self, number: int, session: int, body: bytes) -> None:
        if self.counts(number, session):
            self.heard = self.now
        super().on_body(number, session, body)

    def counts(self, number: int, session: int) -> bool:
        return session == self.session or number == 1

    def on_advance(self) -> None:
        if self.session and self.now - self.heard >= self.after:
            self.inject(m.Bye())


@breaks("session survives short silence")
class LosesPatience(Timed):
    after = 0.2


@breaks("session ends after silence")
class IsPatient(Timed):
    after = 0.6

    def on_advance(self) -> None:
        super().on_advance()
        if self.session:
            self.keep_alive()


@breaks("any message counts")
class CountsBeatsAlone(Timed):
    def counts(self, number: int, session: int) -> bool:
        return number == 3 or (number == 1 and session != self.session)


@breaks("failsafe forgets the emotion", "bye ends the session")
class SaysThatItIsStillInForce(Mutant):
    taken = 0

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Ack):
            self.taken = message.number
        if isinstance(message, m.Welcome):
            message = replace(message, taken=self.taken)
        super().send_message(session, message)


@breaks("failsafe keeps the numbers")
class ForgetsNumbersWithTheSession(Greeter):
    host = 1

    def hello(self, session: int, hello: m.Hello) -> None:
        self.host += not self.session
        super().hello(session, replace(hello, host=self.host))


@breaks("failsafe goes to neutral", "bye goes to neutral", "another host goes to neutral")
class DoesNotGoToNeutral(Mutant):
    def set_up(self) -> None:
        self.body.neutral = lambda: None  # type: ignore[method-assign]


@breaks("failsafe goes to neutral", "bye goes to neutral", "another host goes to neutral")
class PlaysOnWhenAlone(Mutant):
    played: int | None = None

    def set_up(self) -> None:
        play = self.body.play

        def playing(item: int, index: int) -> None:
            if item == m.ITEM_MOTION:
                self.played = index
            play(item, index)

        self.body.play = playing  # type: ignore[method-assign]

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State) and self.played is not None:
            message = replace(message, motion=self.played)
        super().send_message(session, message)


@breaks("failsafe goes to neutral", "bye goes to neutral", "another host goes to neutral")
class KeepsItsMoodWhenAlone(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, mood=2)


@breaks("failsafe acts in time")
class GoesToNeutralWhenGreeted(Mutant):
    def set_up(self) -> None:
        self.neutral = self.body.neutral
        self.body.neutral = lambda: None  # type: ignore[method-assign]

    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number == 1 and not self.session:
            self.neutral()
        super().on_body(number, session, body)


@breaks("failsafe not reset by noise")
class CountsAnyByte(Mutant):
    def frames(self, data: bytes) -> list[bytes]:
        if self.session:
            self.keep_alive()
        return super().frames(data)


@breaks("failsafe not reset by other sessions")
class CountsAnySession(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if self.session and number in MESSAGES:
            self.keep_alive()
        super().on_body(number, session, body)


@breaks("failsafe not reset by skipped bodies")
class CountsAnyFrameOfItsSession(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if self.session and session == self.session:
            self.keep_alive()
        super().on_body(number, session, body)


@breaks("bye ends the session", "gone without session")
class IgnoresBye(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number != 0x1F:
            super().on_body(number, session, body)


@breaks("same host keeps the emotion")
class GoesToNeutralInEverySession(Greeter):
    def hello(self, session: int, hello: m.Hello) -> None:
        super().hello(session, hello)
        self.body.express(Emotion(0.0, 0.0), m.NOTHING)


@breaks("stopped robot stays still")
class WakesUpWhenAlone(Mutant):
    def set_up(self) -> None:
        neutral = self.body.neutral
        stop = self.body.stop
        inside = False

        def waking() -> None:
            neutral()
            if not inside:
                self.body.express(Emotion(0.0, 0.0), m.NOTHING)

        def stopping() -> None:
            nonlocal inside
            inside = True
            stop()
            inside = False

        self.body.neutral = waking  # type: ignore[method-assign]
        self.body.stop = stopping  # type: ignore[method-assign]
