"""The host side of the Pleo Monitor console, without clock, thread or port.

A session begins when the console is found: in any state it answers an empty line with a prompt.
Then Pleo's own behaviour is ended, its joints move to neutral, and its volume is set. A console
that falls silent or restarts is searched for again, for as long as the driver exists.
"""

import math
from collections import deque
from typing import Literal

from cubeling.affect import Emotion
from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.contract.driver import DriverKind
from cubeling.robot.contract.telemetry import LinkCounts, LinkState, Telemetry
from cubeling.robot.drivers.pleo import commands, timing
from cubeling.robot.drivers.pleo.commands import Command
from cubeling.robot.drivers.pleo.console import CommandResult, Console
from cubeling.robot.drivers.pleo.scheduler import StepScheduler
from cubeling.robot.drivers.pleo.settings import PleoSettings, load_settings
from cubeling.robot.protocol import messages as m

Phase = Literal["port", "searching", "starting", "open", "closed"]
"""port: there is none. searching: for a prompt. starting: the first commands are sent."""


class PleoDriver:
    """The host side of the console; a `Driver`."""

    def __init__(self, settings: PleoSettings) -> None:
        self.joint_mover = None
        """Single joints are not turned by this driver."""
        self.catalogue: Catalogue | None = None
        """What Pleo has according to the settings; None until a console has answered."""
        self.console = Console(settings.boot_text)
        """The console."""
        self._settings = settings
        self._phase: Phase = "port"
        self._scheduler = StepScheduler(settings)
        self._start: deque[Command] = deque()
        self._unload_again = False  # whether APP UNLOAD must come next: Pleo may have restarted
        self._lost_answers = 0  # in a row
        self._last_received: float | None = None
        self._last_prompt = 0.0
        self._battery_read = 0.0
        self._battery: float | None = None
        self._complaint: str | None = None
        self._round_trip: float | None = None
        self._sessions = self._unsolicited = 0

    def express(self, emotion: Emotion) -> None:
        """Request an emotion; only the latest counts, and it is kept over all sessions."""
        self._scheduler.express(emotion)

    def play(self, item: int, index: int) -> bool:
        """Request a motion or a sound once; return False if too many wait already."""
        if self._phase != "open":
            self._scheduler.actions.dropped += 1
            return True
        if item == m.ITEM_MOTION:
            return self._scheduler.play(tuple(self._settings.motions.values())[index], "")
        return self._scheduler.play(None, tuple(self._settings.sounds.values())[index])

    def stop(self) -> None:
        """Request the neutral pose, before and instead of everything that waits."""
        self._scheduler.stop()

    def port_opened(self, now: float) -> None:
        """Search for the console, in whatever state it is."""
        self._search(now)

    def port_lost(self) -> None:
        """Send nothing until `port_opened`."""
        self._end_session()
        self._phase = "port"

    def close(self) -> None:
        """Send Pleo to its neutral pose if the console is free, and nothing afterwards."""
        # A busy console would take the line for a part of the pending command.
        if self._phase == "open" and self.console.pending is None:
            self.console.send(commands.JOINT_NEUTRAL, 0.0)
        elif self._phase != "closed":
            self._end_session()
        self._scheduler.end_session()
        self._phase = "closed"

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""
        if data and self._phase not in ("port", "closed"):
            self._last_received = now
            self.console.reader.feed(data, now)

    def tick(self, now: float) -> None:
        """Do what is due at time `now` [s]: process an answer, nudge, send the next command."""
        if self._phase in ("port", "closed"):
            return
        result = self.console.tick(now)
        if result is not None:
            self._process(result, now)
        # Only now: while a command is pending, all text belongs to its answer.
        elif self.console.pending is None:
            self._process_unsolicited(now)
        if self.console.pending is None and self._phase in ("starting", "open"):
            self._send_next(now)

    def bytes_to_send(self) -> bytes:
        """Return the bytes to write, once."""
        return self.console.bytes_to_send()

    def state(self, now: float) -> LinkState:
        """Return the state of the link at time `now` [s]; docs/pleo.md states the times."""
        if self._phase == "closed":
            return "closed"
        if self._phase != "open":
            return "connecting" if self.catalogue is None else "lost"
        pending = self.console.pending
        next_ping = self._last_prompt + timing.PING_INTERVAL_S
        waited = now - (next_ping if pending is None else pending.sent)
        timeout = timing.SHORT_TIMEOUT_S if pending is None else pending.command.timeout
        if waited >= timeout + (timing.MAX_NUDGES + 1) * timing.NUDGE_INTERVAL_S:
            return "lost"
        shaky = waited >= timing.DEGRADED_AFTER_S or self._lost_answers > 0
        return "degraded" if shaky else "ready"

    def telemetry(self, now: float) -> Telemetry:
        """Return everything that is known; the console does not report what Pleo shows."""
        scheduler = self._scheduler
        return Telemetry(
            state=self.state(now),
            commanded=scheduler.state.commanded,
            acknowledged=scheduler.state.acknowledged,
            battery=self._battery,
            complaint=self._complaint,
            stopped=scheduler.state.stopped,
            round_trip=self._round_trip,
            silence=None if self._last_received is None else now - self._last_received,
            counts=LinkCounts(
                frames_sent=self.console.sent,
                frames_received=self.console.answered,
                retries=scheduler.retries,
                skipped=self.console.reader.skipped + self._unsolicited,
                refused=scheduler.refused,
                dropped=scheduler.actions.dropped,
                sessions=self._sessions,
            ),
        )

    def _end_session(self) -> None:
        self.console.give_up()
        self._scheduler.end_session()
        self._start.clear()
        self._unload_again, self._lost_answers = False, 0

    def _search(self, now: float) -> None:
        """Search for the console, and start it from the beginning."""
        self._end_session()
        self._phase = "searching"
        self.console.send(commands.NUDGE, now, patient=True)

    def _open(self, now: float) -> None:
        self._phase = "open"
        self._sessions += 1
        self.catalogue = self._settings.catalogue
        self._last_prompt = now
        self._battery_read = float("-inf")  # at once, as a first sign of life

    def _process(self, result: CommandResult, now: float) -> None:
        """Process the result of the last command."""
        answer = result.answer
        self._complaint = answer.error or self._complaint
        if result.outcome == "silent" or (answer.restarted and self._phase != "searching"):
            self._search(now)
            return
        self._last_prompt = min(result.ended, now)
        self._battery = self._battery if answer.battery is None else answer.battery
        self._lost_answers = self._lost_answers + 1 if result.outcome == "unsure" else 0
        if self._lost_answers >= timing.MAX_LOST_ANSWERS:
            self._search(now)
        elif self._phase == "searching":
            self._phase = "starting"
            volume = commands.sound_volume(self._settings.volume)
            self._start = deque([commands.APP_UNLOAD, commands.JOINT_NEUTRAL, volume])
        elif self._phase == "starting":
            self._process_start(result, now)
        else:
            self._process_command(result)

    def _process_start(self, result: CommandResult, now: float) -> None:
        if result.outcome == "unsure":  # every one of these may be sent twice
            self._start.appendleft(result.command)
            return
        self._scheduler.record_start(result.command, result.sent)
        if not self._start:
            self._open(now)

    def _process_command(self, result: CommandResult) -> None:
        command = result.command
        took = result.ended - result.sent
        if command is commands.NUDGE and math.isfinite(result.ended):  # its answer needs no work
            before = took if self._round_trip is None else self._round_trip
            # The gain of RFC 6298, as for the other robots.
            self._round_trip = before + (took - before) / 8
        # Each of these may be a restart that was not detected.
        late = took >= timing.MIN_RESTART_S
        failed = result.answer.error is not None and command.text.startswith("MOTION PLAY")
        self._unload_again |= late or failed or result.outcome == "unsure"
        if command is commands.APP_UNLOAD:
            self._unload_again = False
        elif command in (commands.NUDGE, commands.STATS_POWER):
            pass  # not of the scheduler
        elif self._scheduler.complete(result):
            self._complaint = None

    def _process_unsolicited(self, now: float) -> None:
        """Process text that is no answer: from a console that restarts, or only noise."""
        reader = self.console.reader
        answer = reader.answer
        self._complaint = answer.error or self._complaint
        if answer.restarted or (answer.spoke and reader.has_ended(now)):
            self._unsolicited += 1
            self._search(now)

    def _send_next(self, now: float) -> None:
        """Send the next command; the console is free."""
        if self._start:
            command = self._start.popleft()
            self.console.send(command, now, patient=command is commands.APP_UNLOAD)
            return
        # Before any motion: Pleo's own behaviour, back after a restart, fights with ours for the
        # joints.
        if self._unload_again:
            self.console.send(commands.APP_UNLOAD, now)
            return
        due = self._scheduler.next(now)
        if due is None and now - self._battery_read >= self._settings.battery_every:
            self._battery_read = now
            due = commands.STATS_POWER
        if due is None and now - self._last_prompt >= timing.PING_INTERVAL_S:
            due = commands.NUDGE
        if due is not None:
            self.console.send(due, now)


PLEO = DriverKind(
    lambda host, settings: PleoDriver(load_settings(settings)), timing.BAUD, timing.ANSWER_TIMEOUT_S
)
"""Drivers of Ugobe's Pleo, over the monitor console of its USB port."""
