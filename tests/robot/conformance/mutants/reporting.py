"""Robots that break the rules of results, of the clock, and of the log."""

from dataclasses import replace
from typing import Any

from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack
from cubeling.robot.protocol.wire import encode_frame
from tests.robot.conformance.mutants.base import Mutant, breaks
from tests.robot.conformance.mutants.heartbeat import Stating


@breaks("result in state")
class StatesNoResult(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, result=0)


@breaks("result in state")
class KeepsTheResultForAnotherHost(Stating):
    result = 0

    def send_message(self, session: int, message: Any) -> None:
        self.result = message.result if isinstance(message, m.Ack) else self.result
        super().send_message(session, message)

    def alter_state(self, state: m.State) -> m.State:
        return replace(state, result=self.result)


@breaks("refusal in earlier versions")
class GivesReasonsToAll(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Ack) and message.result:
            message = replace(message, result=m.RESULT_OUT_OF_RANGE)
        super().send_message(session, message)


@breaks("earlier versions spoken")
class SendsNewFieldsToAll(Mutant):
    def send(self, session: int, message: Any) -> None:
        self.write(encode_frame(pack(message, session)))


class Logger(Mutant):
    """A robot whose log is not what it should be."""

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Log):
            message = self.alter_log(message)
        super().send_message(session, message)

    def alter_log(self, line: m.Log) -> m.Log:
        return line


@breaks("earlier versions spoken", "log rate bounded")
class LogsEveryRefusalAtOnce(Mutant):
    count = 0

    def send_message(self, session: int, message: Any) -> None:
        super().send_message(session, message)
        if isinstance(message, m.Ack) and message.result:
            self.count += 1
            line = m.Log(self.count, round(1000 * self.now), m.SEVERITY_WARNING, "I refuse")
            super().send_message(session, line)


@breaks("log lines valid")
class LogsControlCodes(Logger):
    def alter_log(self, line: m.Log) -> m.Log:
        return replace(line, text="\x1b[2J" + line.text)


@breaks("log lines valid")
class LogsNothing(Logger):
    def alter_log(self, line: m.Log) -> m.Log:
        return replace(line, text="")


@breaks("log lines valid")
class CountsNoLines(Logger):
    def alter_log(self, line: m.Log) -> m.Log:
        return replace(line, count=7)


@breaks("clock runs true")
class HasNoClock(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, time=0)


@breaks("clock runs true")
class HasAFastClock(Stating):
    def alter_state(self, state: m.State) -> m.State:
        return replace(state, time=round(1.05 * state.time))


@breaks("clock runs true")
class BeginsItsClockInEverySession(Stating):
    session_start = 0

    def send_message(self, session: int, message: Any) -> None:
        if isinstance(message, m.Welcome):
            self.session_start = round(1000 * self.now)
        super().send_message(session, message)

    def alter_state(self, state: m.State) -> m.State:
        return replace(state, time=round(1000 * self.now) - self.session_start)
