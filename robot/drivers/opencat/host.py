"""The host side of OpenCat's line, without clock, thread or port."""

import math
from types import MappingProxyType
from typing import Literal

from cubeling.affect import Emotion
from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.contract.driver import DriverKind
from cubeling.robot.contract.telemetry import LinkCounts, LinkState, Telemetry
from cubeling.robot.drivers.lines import LineReader
from cubeling.robot.drivers.opencat import tokens
from cubeling.robot.drivers.opencat.echo import MAX_QUESTION_TRIES, EchoMatcher, PendingLine
from cubeling.robot.drivers.opencat.handshake import STARTUP_LINE_PREFIXES, Handshake
from cubeling.robot.drivers.opencat.models import model_of
from cubeling.robot.drivers.opencat.scheduler import REST_COMMAND, SkillScheduler
from cubeling.robot.drivers.opencat.settings import OpenCatSettings, load_settings
from cubeling.robot.drivers.opencat.telemetry_parser import TelemetryParser
from cubeling.robot.protocol import messages as m

MAX_LINE_BYTES = 200
"""Longest line that is read [bytes]; the longest that matters, 16 angles, has about 90."""

REST_INTERVAL_S = 60.0
"""Interval at which the rest command is repeated to a resting robot, as a sign of life [s]: any
question would switch its balancing on."""

Phase = Literal["port", "greeting", "open", "closed"]
"""port: there is none. greeting: the model is not known yet."""


class OpenCatHost:
    """The host side of a line to a board with OpenCat; a `Driver`. None: the bundled settings."""

    def __init__(self, settings: OpenCatSettings | None = None) -> None:
        self.joint_mover = None
        """Single joints are not turned by this driver."""
        self.catalogue: Catalogue | None = None
        """What the robot has; None until its model is known."""
        self._settings = settings or load_settings()
        self.baud = self._settings.baud
        """Bits per second on the serial line."""
        self._model = self._settings.model or "other"
        self._phase: Phase = "port"
        self._reader = LineReader(MAX_LINE_BYTES)
        self._handshake = Handshake()
        self._echoes = EchoMatcher()
        self._scheduler = SkillScheduler(self._settings, self._settings.behaviours[self._model])
        self._writer = tokens.RateLimitedWriter(self._settings.commands_per_s)
        self._parser = TelemetryParser()
        self._last_received: float | None = None
        self._lines_received = self._skipped = self._sessions = self._repeats = 0

    def express(self, emotion: Emotion) -> None:
        """Request an emotion; only the latest counts, and it is kept over all sessions."""
        self._scheduler.express(emotion)

    def play(self, item: int, index: int) -> bool:
        """Request a motion or a sound once; return False if too many wait already."""
        if self._phase != "open" or self.catalogue is None:
            self._scheduler.actions.dropped += 1
            return True
        sounds, motions = self.catalogue.sounds, self.catalogue.motions
        return self._scheduler.play((sounds if item == m.ITEM_SOUND else motions)[index])

    def stop(self) -> None:
        """Request the posture for a stop, before and instead of everything that waits."""
        self._scheduler.stop()

    def port_opened(self, now: float) -> None:
        """Wait for the board to boot and greet it; what was known of it is forgotten."""
        self._phase = "greeting"
        self._reader.clear()
        self._end_session()
        self._handshake.begin(now)

    def port_lost(self) -> None:
        """Send nothing until `port_opened`."""
        self._end_session()
        self._phase = "port"
        self._writer.clear()

    def close(self) -> None:
        """Let the robot lie down and switch its servos off; send nothing afterwards."""
        asked = self._handshake.stage in ("asking", "known")
        if self._phase in ("greeting", "open") and asked:
            self._writer.send(tokens.REST, math.inf)  # regardless of the rate limit; the last line
        self._end_session()
        self._phase = "closed"

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""
        if not data or self._phase in ("port", "closed"):
            return
        for line in self._reader.feed(data):
            self._lines_received += 1
            self._process(line, now)
        self._handshake.receive_partial(self._reader.partial, now)

    def tick(self, now: float) -> None:
        """Do what is due at time `now` [s]: wait, ask, repeat a question, or send a command."""
        if self._phase not in ("greeting", "open"):
            return
        self._handshake.tick(now)
        if self._handshake.stage in ("starting", "waiting for owner"):
            return
        if not self._writer.is_free(now):
            return
        echoes = self._echoes
        if echoes.question is not None:
            if echoes.repeat_due(now):
                self._repeat_question(now)
        elif echoes.doubtful or echoes.is_late(now):
            self._writer.send(echoes.ask(now), now)
        elif echoes.pending is not None:
            return
        elif self._phase == "greeting":
            self._writer.send(echoes.ask(now), now)
        else:
            self._send_next(now)

    def bytes_to_send(self) -> bytes:
        """Return the bytes to write, once."""
        return self._writer.bytes_to_send()

    def state(self, now: float) -> LinkState:
        """Return the state of the link; degraded: an echo is late, or a question was repeated."""
        if self._phase == "closed":
            return "closed"
        if self._phase != "open":
            return "connecting" if self.catalogue is None else "lost"
        shaky = self._echoes.is_late(now) or self._echoes.tries > 1
        return "degraded" if shaky else "ready"

    def telemetry(self, now: float) -> Telemetry:
        """Return everything that is known at time `now` [s]. The board does not report its mood."""
        scheduler, pending = self._scheduler, self._echoes.pending
        playing = pending.command if pending else None
        skill = playing is not None and playing.kind in ("posture", "gesture")
        melody = playing is not None and playing.kind == "melody"
        return Telemetry(
            state=self.state(now),
            commanded=scheduler.desired.commanded,
            acknowledged=scheduler.desired.acknowledged,
            stopped=scheduler.desired.stopped,
            limp=scheduler.limp or self._parser.is_weak(now),
            complaint=self._parser.complaint,
            joints=MappingProxyType(self._parser.angles),
            reckoned=True,
            motion=playing.name if playing and skill else None,
            sound=playing.name if playing and melody else None,
            round_trip=self._echoes.round_trip,
            silence=None if self._last_received is None else now - self._last_received,
            counts=LinkCounts(
                frames_sent=self._writer.sent,
                frames_received=self._lines_received,
                retries=self._repeats + scheduler.retries,
                crc_errors=self._reader.too_long,
                skipped=self._skipped,
                refused=scheduler.refused,
                dropped=scheduler.actions.dropped,
                sessions=self._sessions,
            ),
        )

    def _process(self, line: str, now: float) -> None:
        self._last_received = now
        if line.startswith(STARTUP_LINE_PREFIXES):
            self._handle_restart(now)
            return
        starting = self._handshake.stage == "starting"
        matched = None if starting else self._echoes.match(line, now)
        if isinstance(matched, PendingLine):
            if self._parser.is_weak(now):
                self._scheduler.give_up(matched.command, now)  # echoed, but nothing has moved
            elif self._scheduler.complete(matched.command, matched.refused, now):
                self._parser.complaint = None
        elif matched is not None:
            self._handle_answer(matched.line, now)
        else:
            self._handle_text(line, now)

    def _handle_text(self, line: str, now: float) -> None:
        """Process a line that is no echo."""
        self._handshake.receive_line(line, now)
        pending = self._echoes.pending
        report = self._parser.parse(line, self._model, now)
        if report == "power" and pending and pending.command.kind in ("posture", "gesture", "pose"):
            self._scheduler.limp = False
        elif report == "weak":
            self._scheduler.limp = True
            self._scheduler.desired.lose()
        elif report == "fell":
            self._echoes.doubt()
            self._scheduler.disturb()
        elif report == "unknown" and not pending and not self._echoes.question:
            self._skipped += 1

    def _handle_answer(self, question: bytes, now: float) -> None:
        """Process the echo of a question."""
        command = self._echoes.give_up()
        if command is not None:
            self._scheduler.give_up(command, now)
        model_asked = self._phase == "greeting" and question == tokens.QUERY
        if model_asked and self._handshake.receive_echo():
            self._open()

    def _handle_restart(self, now: float) -> None:
        """Process a restart of the board: it has lost everything, and its servos are off."""
        self._phase = "greeting"
        if self._handshake.stage != "starting":
            self._end_session()
        self._handshake.begin(now, started=True)
        self._scheduler.limp = True
        self._parser.restart()

    def _open(self) -> None:
        """Start a session with a board whose model is known."""
        handshake = self._handshake
        self._model = self._settings.model or model_of(handshake.name)
        behaviour = self._settings.behaviours[self._model]
        self._scheduler.set_behaviour(behaviour)
        self._parser.angles = {}
        self.catalogue = behaviour.catalogue(self._model, handshake.name, handshake.version)
        self._phase = "open"
        self._sessions += 1

    def _send_next(self, now: float) -> None:
        """Send the next command, or now and then a question if there is none."""
        command = None if self._parser.is_weak(now) else self._scheduler.next(now)
        if command is None and self._question_due(now):
            if not self._scheduler.resting:
                self._writer.send(self._echoes.ask(now), now)
                return
            command = REST_COMMAND
        if command is not None:
            self._writer.send(self._echoes.send(command, now), now)

    def _repeat_question(self, now: float) -> None:
        """Repeat a question; after too many tries the board is lost."""
        if self._phase == "open" and self._echoes.tries >= MAX_QUESTION_TRIES:
            self._phase = "greeting"
            self._scheduler.actions.drop_all()
            self._scheduler.desired.lose()
            self._handshake.ask_again()
        self._repeats += 1
        self._writer.send(self._echoes.ask(now), now)

    def _question_due(self, now: float) -> bool:
        interval = REST_INTERVAL_S if self._scheduler.resting else self._settings.ask_every
        return self._echoes.answered is None or now - self._echoes.answered >= interval

    def _end_session(self) -> None:
        """Drop what is pending and what waits: the board has lost it."""
        command = self._echoes.give_up()
        dropped = command is not None and command.kind in ("gesture", "melody")
        self._scheduler.actions.dropped += dropped
        self._echoes.restart()
        self._scheduler.actions.drop_all()
        self._scheduler.desired.lose()


OPENCAT = DriverKind(
    lambda host, settings: OpenCatHost(load_settings(settings)),
    115200,
    25.0,  # a board takes seconds to start when its port is opened, and a new one asks its owner
    spacing=0.1,  # lines that arrive within a few milliseconds are read as one
)
"""Drivers of OpenCat boards: Petoi's Bittle and Nybble."""
