"""The host's end of OpenCat's line: bytes in, bytes out, and what is known of the robot.

No clock, no thread, no port: whoever owns those calls `receive` and `tick` with the time.
"""

import math
from types import MappingProxyType
from typing import Literal

from affect import Emotion
from robot.contract.catalogue import Catalogue
from robot.contract.telemetry import LinkCounts, LinkState, Telemetry
from robot.drivers.lines import LineReader
from robot.drivers.opencat import tokens
from robot.drivers.opencat.exchange import LOST_TRIES, Exchange, Flight
from robot.drivers.opencat.greeting import STARTS, Greeting
from robot.drivers.opencat.hearsay import Hearsay
from robot.drivers.opencat.introduction import catalogue_of
from robot.drivers.opencat.models import model_of
from robot.drivers.opencat.outlet import Outlet
from robot.drivers.opencat.settings import Settings
from robot.drivers.opencat.settings_file import load_settings
from robot.drivers.opencat.wishes import REST, Wishes
from robot.protocol import messages as m

LINE_MAX = 200
"""Longest line that is listened to [bytes]; the longest that matters, 16 angles, has about 90."""

REST_ASK_EVERY = 60.0
"""A robot that lies without power is told to rest again this often [s], as its sign of life: any
other question would switch its balancing on."""

Phase = Literal["port", "greeting", "open", "closed"]


class OpenCatHost:
    """The host's end of a line to a board that runs OpenCat.

    Parameters
    ----------
    settings
        What is shown how; None for the bundled ones.
    """

    def __init__(self, settings: Settings | None = None) -> None:
        self.catalogue: Catalogue | None = None
        """What the robot has; None until its model is known."""
        self._settings = settings or load_settings()
        self.baud = self._settings.baud
        """Bits a second on the serial line."""
        self._model = self._settings.model or "other"
        self._phase: Phase = "port"
        self._reader = LineReader(LINE_MAX)
        self._greeting = Greeting()
        self._exchange = Exchange()
        self._wishes = Wishes(self._settings, self._settings.behaviours[self._model])
        self._outlet = Outlet(self._settings.commands_per_s)
        self._heard: float | None = None
        self._hearsay = Hearsay()
        self._lines_heard = self._skipped = self._sessions = self._repeats = 0

    # --- What the owner asks for ---------------------------------------------------------------

    def express(self, emotion: Emotion) -> None:
        """Ask for an emotion; only the latest counts, and it is kept through every break."""
        self._wishes.express(emotion)

    def play(self, item: int, index: int) -> bool:
        """Ask for a motion or a sound once; False if too many wait already.

        Without a link it is dropped at once: nobody wants a nod when the robot comes back.
        """
        if self._phase != "open" or self.catalogue is None:
            self._wishes.dropped += 1
            return True
        sounds, motions = self.catalogue.sounds, self.catalogue.motions
        return self._wishes.play((sounds if item == m.ITEM_SOUND else motions)[index])

    def stop(self) -> None:
        """Ask for the posture for a stop, before and instead of everything that waits."""
        self._wishes.stop()

    def port_opened(self, now: float) -> None:
        """Begin, or begin again after `port_lost`."""
        self._phase = "greeting"
        self._reader.clear()
        self._break_off()
        self._greeting.begin(now)

    def port_lost(self) -> None:
        """Send nothing until `port_opened`."""
        self._break_off()
        self._phase = "port"
        self._outlet.clear()

    def close(self) -> None:
        """Let the robot lie down and take the power from its servos, and never send again."""
        spoken = self._greeting.stage in ("asking", "known")
        if self._phase in ("greeting", "open") and spoken:
            self._outlet.send(tokens.REST, math.inf)  # whatever the rates say, and for good
        self._break_off()
        self._phase = "closed"

    # --- What the line and the clock bring -----------------------------------------------------

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line at time `now` [s]."""
        if not data or self._phase in ("port", "closed"):
            return
        for line in self._reader.feed(data):
            self._lines_heard += 1
            self._take(line, now)
        self._greeting.babble(self._reader.begun, now)

    def tick(self, now: float) -> None:
        """Do what is due at time `now` [s]: wait, ask, ask again, send."""
        if self._phase not in ("greeting", "open"):
            return
        self._greeting.tick(now)
        if self._greeting.stage in ("starting", "asked by it"):
            return
        if not self._outlet.is_free(now):
            return
        exchange = self._exchange
        if exchange.question is not None:
            if exchange.repeat_due(now):
                self._ask_again(now)
        elif exchange.doubtful or exchange.is_late(now):
            self._outlet.send(exchange.ask(now), now)
        elif exchange.flight is not None:
            return
        elif self._phase == "greeting":
            self._outlet.send(exchange.ask(now), now)
        else:
            self._act(now)

    def bytes_to_send(self) -> bytes:
        """Return what is to be written to the line, once."""
        return self._outlet.bytes_to_send()

    # --- What is known -------------------------------------------------------------------------

    def state(self, now: float) -> LinkState:
        """Return the state of the link at time `now` [s].

        degraded: a command's echo is late, or a question was asked twice. lost: it was asked three
        times in vain, the board starts anew, or the port is gone.
        """
        if self._phase == "closed":
            return "closed"
        if self._phase != "open":
            return "connecting" if self.catalogue is None else "lost"
        shaky = self._exchange.is_late(now) or self._exchange.tries > 1
        return "degraded" if shaky else "ready"

    def telemetry(self, now: float) -> Telemetry:
        """Return all that is known at time `now` [s]. What it feels the board does not tell."""
        flight = self._exchange.flight
        playing = flight.command if flight else None
        skill = playing is not None and playing.kind in ("posture", "gesture")
        beeps = playing is not None and playing.kind == "melody"
        return Telemetry(
            state=self.state(now),
            commanded=self._wishes.order.commanded,
            acknowledged=self._wishes.order.acknowledged,
            stopped=self._wishes.order.stopped,
            limp=self._wishes.limp or self._hearsay.is_weak(now),
            complaint=self._hearsay.complaint,
            joints=MappingProxyType(self._hearsay.angles),
            reckoned=True,
            motion=playing.name if playing and skill else None,
            sound=playing.name if playing and beeps else None,
            round_trip=self._exchange.round_trip,
            silence=None if self._heard is None else now - self._heard,
            counts=self._counts(),
        )

    def _counts(self) -> LinkCounts:
        return LinkCounts(
            frames_sent=self._outlet.sent,
            frames_received=self._lines_heard,
            retries=self._repeats + self._wishes.repeats,
            crc_errors=self._reader.cut,
            skipped=self._skipped,
            refused=self._wishes.refused,
            dropped=self._wishes.dropped,
            sessions=self._sessions,
        )

    # --- What a line means ---------------------------------------------------------------------

    def _take(self, line: str, now: float) -> None:
        self._heard = now
        if line.startswith(STARTS):
            self._was_restarted(now)
            return
        heard = None if self._greeting.stage == "starting" else self._exchange.hear(line, now)
        if isinstance(heard, Flight):
            if self._hearsay.is_weak(now):
                self._wishes.given_up(heard.command, now)  # echoed, and nothing has moved
            elif self._wishes.landed(heard.command, heard.refused, now):
                self._hearsay.complaint = None
        elif heard is not None:
            self._was_answered(heard.line, now)
        else:
            self._note(line, now)

    def _note(self, line: str, now: float) -> None:
        """Take a line that is no echo."""
        self._greeting.hear(line, now)
        flight = self._exchange.flight
        news = self._hearsay.take(line, self._model, now)
        if news == "power" and flight and flight.command.kind in ("posture", "gesture", "pose"):
            self._wishes.limp = False
        elif news == "weak":
            self._wishes.limp = True
            self._wishes.order.lose()
        elif news == "fell":
            self._exchange.doubt()
            self._wishes.disturb()
        elif news == "unknown" and not flight and not self._exchange.question:
            self._skipped += 1

    def _was_answered(self, question: bytes, now: float) -> None:
        given_up = self._exchange.give_up()
        if given_up is not None:
            self._wishes.given_up(given_up, now)
        if self._phase == "greeting" and question == tokens.QUERY and self._greeting.echoed():
            self._open(now)

    def _was_restarted(self, now: float) -> None:
        """Take note that the board starts: it has lost everything, and its servos have no power."""
        self._phase = "greeting"
        if self._greeting.stage != "starting":
            self._break_off()
        self._greeting.begin(now, started=True)
        self._wishes.limp = True
        self._hearsay.forget()

    def _open(self, now: float) -> None:
        """Begin a session with a board that is known."""
        greeting = self._greeting
        self._model = self._settings.model or model_of(greeting.name)
        behaviour = self._settings.behaviours[self._model]
        self._wishes.behave(behaviour)
        self._hearsay.angles = {}
        self.catalogue = catalogue_of(self._model, greeting.name, greeting.version, behaviour)
        self._phase = "open"
        self._sessions += 1

    # --- What is sent --------------------------------------------------------------------------

    def _act(self, now: float) -> None:
        """Send what is wanted; where nothing is, ask now and then whether the board is there."""
        command = None if self._hearsay.is_weak(now) else self._wishes.next(now)
        if command is None and self._answer_is_old(now):
            if not self._wishes.resting:
                self._outlet.send(self._exchange.ask(now), now)
                return
            command = REST
        if command is not None:
            self._outlet.send(self._exchange.launch(command, now), now)

    def _ask_again(self, now: float) -> None:
        """Repeat a question, and look for a board that is lost."""
        if self._phase == "open" and self._exchange.tries >= LOST_TRIES:
            self._phase = "greeting"
            self._wishes.drop_actions()
            self._wishes.order.lose()
            self._greeting.ask_again()
        self._repeats += 1
        self._outlet.send(self._exchange.ask(now), now)

    # --- Small things --------------------------------------------------------------------------

    def _answer_is_old(self, now: float) -> bool:
        every = REST_ASK_EVERY if self._wishes.resting else self._settings.ask_every
        return self._exchange.answered is None or now - self._exchange.answered >= every

    def _break_off(self) -> None:
        """Forget what is on its way and what was to be played: the board has lost it."""
        given_up = self._exchange.give_up()
        self._wishes.dropped += given_up is not None and given_up.kind in ("gesture", "melody")
        self._exchange.restart()
        self._wishes.drop_actions()
        self._wishes.order.lose()
