"""From an open port to a board that has reported its model: waits for its start, then asks.

Opening a port resets many boards. A starting board sends text for seconds, and loses or misreads
its input; a *new* board asks its owner whether to erase its calibration, and takes the next byte as
the answer. Therefore nothing is sent until it is quiet, and nothing at all while it asks.
"""

import re
from typing import Literal

LISTEN_S = 1.0
"""Time without sending after a port was opened [s]; a starting board sends text by then."""

QUIET_S = 0.7
"""Silence after which the start of a board is complete [s]."""

MAX_START_S = 15.0
"""Time after which a board is asked even if it never pauses [s]."""

MAX_NAMELESS_ECHOES = 3
"""Echoes of "?" without a model after which the board is taken for one without an answer."""

STARTUP_LINE_PREFIXES = ("* Start *", "Flush the serial buffer", "rst:0x", "ets Jun", "entry 0x")
"""Beginnings of lines that a board sends only while it starts."""

_READY = "Ready!"
_OWNER_QUESTION = "(Y/n)"
_MODEL_PREFIXES = ("bittle", "nybble", "dof16", "cub", "nova", "chero", "mini")
_VERSION = re.compile(r"[A-Za-z0-9.]{1,8}_[0-9]{6}\w{0,8}")

Stage = Literal["starting", "waiting for owner", "asking", "known"]


class Handshake:
    """The handshake with a board."""

    def __init__(self) -> None:
        self.stage: Stage = "starting"
        """starting: the board may be starting, so nothing is sent. waiting for owner: it waits for
        its owner's answer. asking: "?" must be sent. known: it has reported its model."""
        self.name = ""
        """Its model; empty if it does not report one."""
        self.version = ""
        """Version of its firmware; empty if it does not report one."""
        self._began = self._last_text = 0.0
        self._nameless_echoes = 0
        self._lines: list[str] = []

    def begin(self, now: float, started: bool = False) -> None:
        """Start again: the port was opened, or the board has `started`."""
        self.stage = "starting"
        self._began = now
        self._last_text = now if started else now - QUIET_S + LISTEN_S
        self._nameless_echoes = 0
        self._lines.clear()

    def ask_again(self) -> None:
        """Ask a board that may be another one by now, without waiting for a start."""
        self.stage = "asking"
        self._nameless_echoes = 0
        self._lines.clear()

    def receive_line(self, line: str, now: float) -> None:
        """Process a line that is no echo."""
        if self.stage in ("starting", "waiting for owner"):
            self._last_text = max(now, self._last_text)
            if line.startswith(_READY):
                self.stage = "asking"
            elif line:
                self._detect_question(line)
        elif self.stage == "asking" and line:
            self._lines = [*self._lines[-7:], line]

    def receive_partial(self, text: str, now: float) -> None:
        """Process received bytes whose line has not ended yet."""
        if self.stage == "starting":
            self._last_text = max(now, self._last_text)
        if self.stage != "known":
            self._detect_question(text)

    def tick(self, now: float) -> None:
        """Stop waiting when the start is complete."""
        quiet = now - self._last_text >= QUIET_S
        if self.stage == "starting" and (quiet or now - self._began >= MAX_START_S):
            self.stage = "asking"

    def receive_echo(self) -> bool:
        """Process an echo of "?"; return whether the board is known now."""
        self._read_model()
        self._nameless_echoes += 1
        if self.name or self.version or self._nameless_echoes >= MAX_NAMELESS_ECHOES:
            self.stage = "known"
        self._lines.clear()
        return self.stage == "known"

    def _read_model(self) -> None:
        """Find model and version in the lines before the echo."""
        name = version = ""
        before = ""
        for line in self._lines:
            if line.lower().startswith(_MODEL_PREFIXES) and not _VERSION.fullmatch(line):
                name = line
            elif _VERSION.fullmatch(line):
                version, name = line, name or before
            before = line if len(line) > 1 else before
        if name or version:
            self.name, self.version = name, version

    def _detect_question(self, text: str) -> None:
        if _OWNER_QUESTION in text:
            self.stage = "waiting for owner"
