"""The host's end of the Pleo Monitor console: bytes in, bytes out, and what is known of Pleo.

No clock, no thread, no port: whoever owns those calls `receive` and `tick` with the time.

A session begins when the console is found: an empty line, whatever state it is in, is answered by
a prompt. Then Pleo's own behaviour is ended, its joints go to neutral, and its volume is set. A
console that falls silent, or has just started, is looked for again, for as long as this lives.
"""

import math
from collections import deque
from typing import Literal

from affect import Emotion
from robot.contract.catalogue import Catalogue
from robot.contract.telemetry import LinkCounts, LinkState, Telemetry
from robot.drivers.pleo import commands, timing
from robot.drivers.pleo.commands import Command
from robot.drivers.pleo.console import Console, Landing
from robot.drivers.pleo.settings import Settings
from robot.drivers.pleo.wishes import Wishes
from robot.protocol import messages as m

Phase = Literal["port", "seeking", "starting", "open", "closed"]


class PleoDriver:
    """The host's end of the console.

    Parameters
    ----------
    settings
        What Pleo plays for each mood, and how often it is asked for what.
    """

    def __init__(self, settings: Settings) -> None:
        self.catalogue: Catalogue | None = None
        """What Pleo has, by the settings; None until a console has answered."""
        self._settings = settings
        self._phase: Phase = "port"
        self._console = Console(settings.boot_text)
        self._wishes = Wishes(settings)
        self._start: deque[Command] = deque()
        self._reassure = False  # whether APP UNLOAD must come next: Pleo may have restarted
        self._unsure = 0  # answers lost in a row
        self._heard: float | None = None
        self._pinged = 0.0
        self._battery_asked = 0.0
        self._battery: float | None = None
        self._complaint: str | None = None
        self._round_trip: float | None = None
        self._sessions = self._outside = 0

    # --- What the owner asks for ---------------------------------------------------------------

    def express(self, emotion: Emotion) -> None:
        """Ask for an emotion; only the latest counts, and it is kept through every break."""
        self._wishes.express(emotion)

    def play(self, item: int, index: int) -> bool:
        """Ask for a motion or a sound of the catalogue once; False if too many wait already.

        Without a session it is dropped at once: nobody wants a nod when Pleo comes back.
        """
        if self._phase != "open":
            self._wishes.dropped += 1
            return True
        if item == m.ITEM_MOTION:
            return self._wishes.play(tuple(self._settings.motions.values())[index], "")
        return self._wishes.play(None, tuple(self._settings.sounds.values())[index])

    def stop(self) -> None:
        """Ask for the neutral pose, before and instead of everything that waits."""
        self._wishes.stop()

    def port_opened(self, now: float) -> None:
        """Look for the console, whatever state it is in."""
        self._seek(now)

    def port_lost(self) -> None:
        """Send nothing until `port_opened`."""
        self._break_off()
        self._phase = "port"

    def close(self) -> None:
        """Leave Pleo in its neutral pose if the prompt is free, and never send again."""
        if self._phase == "open" and self._console.flight is None:
            self._console.send(commands.JOINT_NEUTRAL, 0.0)
        elif self._phase != "closed":
            self._break_off()
        self._wishes.break_off()
        self._phase = "closed"

    # --- What the line and the clock bring -----------------------------------------------------

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line at time `now` [s]."""
        if data and self._phase not in ("port", "closed"):
            self._heard = now
            self._console.reader.feed(data, now)

    def tick(self, now: float) -> None:
        """Do what is due at time `now` [s]: hear answers, nudge, and send the next command."""
        if self._phase in ("port", "closed"):
            return
        landing = self._console.tick(now)
        if landing is not None:
            self._land(landing, now)
        elif self._console.flight is None:
            self._listen(now)
        if self._console.flight is None and self._phase in ("starting", "open"):
            self._send_next(now)

    def bytes_to_send(self) -> bytes:
        """Return what is to be written to the line, once."""
        return self._console.bytes_to_send()

    # --- What is known -------------------------------------------------------------------------

    def state(self, now: float) -> LinkState:
        """Return the state of the link at time `now` [s]; docs/pleo.md states the times."""
        if self._phase == "closed":
            return "closed"
        if self._phase != "open":
            return "connecting" if self.catalogue is None else "lost"
        flight = self._console.flight
        waited = now - (self._pinged + timing.PING_EVERY if flight is None else flight.sent)
        longest = timing.SHORT_WITHIN if flight is None else flight.command.within
        if waited >= longest + (timing.NUDGES_MAX + 1) * timing.NUDGE_EVERY:
            return "lost"
        shaky = waited >= timing.DEGRADED_AFTER or self._unsure > 0
        return "degraded" if shaky else "ready"

    def telemetry(self, now: float) -> Telemetry:
        """Return all that is known at time `now` [s].

        The console does not tell what Pleo shows, so `observed`, `label`, `motion`, `sound` and
        `joints` stay empty.
        """
        return Telemetry(
            state=self.state(now),
            commanded=self._wishes.commanded,
            acknowledged=self._wishes.acknowledged,
            battery=self._battery,
            complaint=self._complaint,
            stopped=self._wishes.stopped,
            round_trip=self._round_trip,
            silence=None if self._heard is None else now - self._heard,
            counts=LinkCounts(
                frames_sent=self._console.sent,
                frames_received=self._console.answered,
                retries=self._wishes.retries,
                skipped=self._console.reader.skipped + self._outside,
                refused=self._wishes.refused,
                dropped=self._wishes.dropped,
                sessions=self._sessions,
            ),
        )

    # --- Sessions ------------------------------------------------------------------------------

    def _break_off(self) -> None:
        self._console.give_up()
        self._wishes.break_off()
        self._start.clear()
        self._reassure, self._unsure = False, 0

    def _seek(self, now: float) -> None:
        """Look for the console, and begin with it from the beginning."""
        self._break_off()
        self._phase = "seeking"
        self._console.send(commands.NUDGE, now, patient=True)

    def _greet(self) -> None:
        """Begin a session: end Pleo's own behaviour, take its joints to neutral, set its volume."""
        self._phase = "starting"
        volume = commands.sound_volume(self._settings.volume)
        self._start = deque([commands.APP_UNLOAD, commands.JOINT_NEUTRAL, volume])

    def _open(self, now: float) -> None:
        self._phase = "open"
        self._sessions += 1
        self.catalogue = self._settings.catalogue
        self._pinged = now
        self._battery_asked = float("-inf")  # at once: it is the first sign that all is well

    def _land(self, landing: Landing, now: float) -> None:
        """Take what came of the last command."""
        answer = landing.answer
        self._complaint = answer.error or self._complaint
        if landing.outcome == "silent" or (answer.restarted and self._phase != "seeking"):
            self._seek(now)
            return
        self._pinged = min(landing.ended, now)
        self._battery = self._battery if answer.battery is None else answer.battery
        self._unsure = self._unsure + 1 if landing.outcome == "unsure" else 0
        if self._unsure >= timing.UNSURE_MAX:
            self._seek(now)
        elif self._phase == "seeking":
            self._greet()
        elif self._phase == "starting":
            self._started(landing, now)
        else:
            self._measure(landing)
            # All of these may be a restart that nobody saw.
            late = landing.ended - landing.sent >= timing.RESTART_TAKES
            failed = answer.error is not None and landing.command.text.startswith("MOTION PLAY")
            self._reassure |= late or failed or landing.outcome == "unsure"
            if landing.command is commands.APP_UNLOAD:
                self._reassure = False
            elif landing.command in (commands.NUDGE, commands.STATS_POWER):
                pass  # nobody's wish
            elif self._wishes.land(landing):
                self._complaint = None

    def _started(self, landing: Landing, now: float) -> None:
        if landing.outcome == "unsure":  # all of these may be sent twice
            self._start.appendleft(landing.command)
            return
        self._wishes.began(landing.command, landing.sent)
        if not self._start:
            self._open(now)

    def _listen(self, now: float) -> None:
        """Hear what nobody asked for: a console that starts, or only noise."""
        reader = self._console.reader
        answer = reader.answer
        self._complaint = answer.error or self._complaint
        if answer.restarted or (answer.spoke and reader.ended(now)):
            self._outside += 1
            self._seek(now)

    def _send_next(self, now: float) -> None:
        """Send what is due, now that the prompt is free."""
        if self._start:
            command = self._start.popleft()
            self._console.send(command, now, patient=command is commands.APP_UNLOAD)
            return
        if self._reassure:
            self._console.send(commands.APP_UNLOAD, now)
            return
        command_due = self._wishes.next(now)
        if command_due is None and now - self._battery_asked >= self._settings.battery_every:
            self._battery_asked = now
            command_due = commands.STATS_POWER
        if command_due is None and now - self._pinged >= timing.PING_EVERY:
            command_due = commands.NUDGE
        if command_due is not None:
            self._console.send(command_due, now)

    def _measure(self, landing: Landing) -> None:
        """Smooth the time from an empty line to its prompt, as its answer takes no work."""
        if landing.command is commands.NUDGE and math.isfinite(landing.ended):
            took = landing.ended - landing.sent
            before = took if self._round_trip is None else self._round_trip
            self._round_trip = before + (took - before) / 8
