"""What a robot reports: its STATE, the lines of its log, and why it refused a command."""

from collections import deque
from dataclasses import replace
from types import MappingProxyType

from cubeling.affect import Emotion
from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.contract.telemetry import (
    MAX_LOG_LINES,
    ClockEstimate,
    LogLine,
    Severity,
    Telemetry,
    complaint_of,
)
from cubeling.robot.drivers.cubeling.scheduler import Refusal
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.clock import ClockSample, RobotClock

SEVERITIES: tuple[Severity, ...] = ("information", "warning", "error")
"""The words for LOG.severity."""


class RobotReports:
    """The reports of one robot, over all sessions of a link."""

    def __init__(self) -> None:
        self._state: m.State | None = None
        self._clock = RobotClock()
        self._measured: ClockSample | None = None
        self._log: deque[LogLine] = deque(maxlen=MAX_LOG_LINES)
        self._untimed: deque[tuple[m.Log, int, float]] = deque(maxlen=MAX_LOG_LINES)
        self._log_count: int | None = None

    def start_session(self) -> None:
        """Reset the clock and the count of the log: the robot may have booted."""
        self._keep_log()
        self._clock, self._log_count = RobotClock(), None

    def forget_state(self) -> None:
        """Forget the STATE: it is of another catalogue."""
        self._state = self._measured = None

    def take_state(self, state: m.State, version: int, sent: float | None, now: float) -> None:
        """Take a STATE in a session of a version; `sent` is the time of the BEAT it answers [s]."""
        self._state = state
        if version >= 3:
            if sent is not None:
                self._clock.add(state.time, sent, now)
            self._measured = self._clock.host_time(state.time)
            if self._measured is not None:
                self._keep_log()

    def take_log(self, line: m.Log, now: float) -> None:
        """Take a LOG, unless it is the last one again."""
        last, self._log_count = self._log_count, line.count
        if line.count == last:
            return
        lost = 0 if last is None else (line.count - last - 1) & 0xFFFF
        self._untimed.append((line, lost, now))
        if self._clock.host_time(line.time) is not None:
            self._keep_log()

    def _keep_log(self) -> None:
        """Keep the lines that have arrived, with the times at which they were written.

        The first ones of a session arrive before its clock is known, and wait for that.
        """
        while self._untimed:
            line, lost, arrival = self._untimed.popleft()
            written = self._clock.host_time(line.time)
            time = arrival if written is None else min(written.host, arrival)
            severity = SEVERITIES[min(line.severity, len(SEVERITIES) - 1)]
            number = self._log[-1].number + 1 if self._log else 1
            self._log.append(LogLine(number, severity, line.text, time, lost))

    def describe(
        self, link: Telemetry, catalogue: Catalogue | None, refusal: Refusal | None
    ) -> Telemetry:
        """Return the telemetry of the link with all that the robot reported."""
        state = self._state
        if state is None or catalogue is None:
            return replace(link, log=tuple(self._log))
        names = tuple(joint.name for joint in catalogue.joints)
        measured = self._measured
        return replace(
            link,
            observed=Emotion(state.valence, state.arousal, _name(catalogue.moods, state.mood)),
            battery=state.battery,
            charging=bool(state.flags & m.FLAG_CHARGING),
            stopped=bool(state.flags & m.FLAG_STILL),
            limp=bool(state.flags & m.FLAG_LIMP),
            reckoned=bool(state.flags & m.FLAG_RECKONED),
            joints=MappingProxyType(dict(zip(names, state.joints, strict=False))),
            held=frozenset(_names_of_bits(names, state.held)),
            motion=_name(catalogue.motions, state.motion),
            sound=_name(catalogue.sounds, state.sound),
            complaint=None if refusal is None else refusal_line(refusal, catalogue),
            measured_at=None if measured is None else measured.host,
            clock=None if measured is None else ClockEstimate(self._clock.drift, measured.error),
            log=tuple(self._log),
        )


def refusal_line(refusal: Refusal, catalogue: Catalogue) -> str:
    """Return what was refused and why, for a person."""
    match refusal.command:
        case m.Play(item=m.ITEM_MOTION, index=index):
            what = _name(catalogue.motions, index)
        case m.Play(index=index):
            what = _name(catalogue.sounds, index)
        case m.Move(moved=moved, released=released):
            joints = tuple(joint.name for joint in catalogue.joints)
            what = ", ".join(_names_of_bits(joints, moved | released))
        case m.Express(mood=mood):
            what = _name(catalogue.moods, mood)
        case _:
            what = None
    why = m.REFUSALS.get(refusal.result, f"for a reason of its own, {refusal.result}")
    return complaint_of(f"{what or 'the command'}: refused, {why}")


def _name(names: tuple[str, ...], index: int) -> str | None:
    return names[index] if index < len(names) else None


def _names_of_bits(names: tuple[str, ...], bits: int) -> list[str]:
    return [name for index, name in enumerate(names) if bits >> index & 1]
