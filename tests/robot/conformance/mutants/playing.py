"""Robots that break section 6 in what they play, in the moods that they show, and when stopped."""

from dataclasses import replace
from math import sin
from typing import Any

from cubeling.affect import Emotion
from cubeling.robot.protocol import messages as m
from tests.robot.conformance.mutants.base import Mutant, breaks
from tests.robot.conformance.mutants.commands import Commanded
from tests.robot.conformance.mutants.heartbeat import Stating

ACTIONS = 3
"""The first motion of the simulated robot that is no loop of a mood."""

MOTIONS = 8
"""Motions that it has."""


@breaks("played once")
class PlaysWithoutEnd(Stating):
    playing = m.NOTHING

    def set_up(self) -> None:
        play, neutral = self.body.play, self.body.neutral

        def playing(item: int, index: int) -> None:
            play(item, index)
            self.playing = index if item == m.ITEM_MOTION else self.playing

        def ending() -> None:
            neutral()
            self.playing = m.NOTHING

        self.body.play, self.body.neutral = playing, ending  # type: ignore[method-assign]

    def alter_state(self, state: m.State) -> m.State:
        return state if self.playing == m.NOTHING else replace(state, motion=self.playing)


@breaks("old play without effect")
class PlaysOldPlays(Commanded):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Play) and command.number < self.taken:
            self.body.play(command.item, command.index)
        super().on_command(command)


@breaks("old play without effect")
class BeginsAgainAtARepeat(Commanded):
    played = (0, 0)

    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Play):
            played = (command.item, command.index)
            if command.number == self.taken and played == self.played:
                self.body.play(*played)
            if command.number > self.taken:
                self.played = played
        super().on_command(command)


@breaks("old play without effect")
class BeginsAgainWhenItIsOver(BeginsAgainAtARepeat):
    def on_command(self, command: Any) -> None:
        state = self.body.state()
        if self.played[1] in (state.motion, state.sound):
            Commanded.on_command(self, command)
        else:
            super().on_command(command)


@breaks("motion and sound together")
class PlaysOneAtATime(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return state if state.sound == m.NOTHING else replace(state, motion=m.NOTHING)


@breaks("motion and sound together")
class FallsSilentWhenItMoves(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return state if state.motion < ACTIONS else replace(state, sound=m.NOTHING)


@breaks("refused play ends nothing")
class EndsEverythingAtARefusal(Commanded):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Play) and command.index >= MOTIONS:
            self.body.neutral()
        super().on_command(command)


@breaks("refusal changes nothing")
class WakesUpAtARefusal(Commanded):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Express) and command.mood != m.NOTHING:
            self.body.express(Emotion(0.0, 0.0), m.NOTHING)
        super().on_command(command)


@breaks("refusal changes nothing")
class AgreesAtTheSecondTime(Mutant):
    refused = 0

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Ack) and message.result:
            if message.number == self.refused:
                message = replace(message, result=m.RESULT_TAKEN)
            self.refused = message.number
        super().send_message(session, message)


@breaks("motion survives an emotion")
class EndsMotionsForEmotions(Commanded):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Express):
            self.body.neutral()
        super().on_command(command)


# --- Moods ---------------------------------------------------------------------------------------


@breaks("named mood shown at once")
class ShowsItsMoodOnceItIsFelt(Stating):
    def alter_state(self, state: m.State) -> m.State:
        near = abs(self.body.target.valence - state.valence) < 0.3
        return state if near else replace(state, mood=0)


@breaks("named mood shown at once")
class FeelsOnlyWithoutANamedMood(Commanded):
    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Express) and command.mood != m.NOTHING:
            command = replace(command, valence=0.0, arousal=0.0)
        super().on_command(command)


class Named(Commanded):
    """A robot that remembers which mood was named last."""

    named = m.NOTHING

    def on_command(self, command: Any) -> None:
        if isinstance(command, m.Express) and command.mood != m.NOTHING:
            self.named = command.mood
        super().on_command(command)

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.State) and self.named != m.NOTHING and self.keeps(message):
            message = replace(message, mood=self.named)
        super().send_message(session, message)

    def keeps(self, state: m.State) -> bool:
        return True


@breaks("mood 255 leaves the choice")
class KeepsTheNamedMood(Named):
    pass


@breaks("stop ends a named mood")
class KeepsItsMoodWhenStopped(Named):
    def keeps(self, state: m.State) -> bool:
        return bool(state.flags & m.FLAG_STILL)


@breaks("failsafe goes to neutral", "bye goes to neutral", "another host goes to neutral")
class KeepsItsMoodWithoutItsHost(Named):
    keeps_until = 0.0

    def set_up(self) -> None:
        neutral, express = self.body.neutral, self.body.express

        def leaving() -> None:
            self.keeps_until = self.now + 0.5
            neutral()

        def feeling(emotion: Emotion, mood: int = m.NOTHING) -> None:
            self.keeps_until = 0.0
            express(emotion, mood)

        self.body.neutral, self.body.express = leaving, feeling  # type: ignore[method-assign]

    def keeps(self, state: m.State) -> bool:
        return self.now < self.keeps_until


# --- Stopped -------------------------------------------------------------------------------------


@breaks("stop takes the same pose")
class TakesAnotherPoseEachTime(Stating):
    stops = 0

    def set_up(self) -> None:
        stop = self.body.stop

        def stopping() -> None:
            stop()
            self.stops += 1

        self.body.stop = stopping  # type: ignore[method-assign]

    def alter_state(self, state: m.State) -> m.State:
        if not state.flags & m.FLAG_STILL:
            return state
        return replace(state, joints=(0.1 * (self.stops % 2), *state.joints[1:]))


@breaks("stop holds the pose")
class SwaysSlowlyWhenStopped(Stating):
    def alter_state(self, state: m.State) -> m.State:
        if not state.flags & m.FLAG_STILL:
            return state
        return replace(state, joints=(0.1 * sin(self.now), *state.joints[1:]))
