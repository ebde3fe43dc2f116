"""From an open port to a board that has said what it is: waiting out its start, then asking.

Opening a port resets many boards. A board that starts says much, for seconds, and throws away or
misreads what it hears; a *new* board asks its owner whether to erase its calibration, and takes the
next byte for the answer. So nothing is sent until it is quiet, and nothing at all while it asks.
"""

import re
from typing import Literal

LISTEN_FOR = 1.0
"""Nothing is sent for so long after a port was opened [s]: a board that starts speaks up."""

QUIET_FOR = 0.7
"""A board that has been silent for so long has finished its start [s]."""

START_AT_MOST = 15.0
"""A board that has spoken for so long without a pause is asked all the same [s]."""

NAMELESS_AFTER = 3
"""A board that has echoed "?" so often without a model does not know the question."""

STARTS = ("* Start *", "Flush the serial buffer", "rst:0x", "ets Jun", "entry 0x")
"""How lines begin that a board says only while it starts."""

_READY = "Ready!"
_ASKS = "(Y/n)"
_MODELS = ("bittle", "nybble", "dof16", "cub", "nova", "chero", "mini")
_VERSION = re.compile(r"[A-Za-z0-9.]{1,8}_[0-9]{6}\w{0,8}")

Stage = Literal["starting", "asked by it", "asking", "known"]


class Greeting:
    """Where the acquaintance with a board stands."""

    def __init__(self) -> None:
        self.stage: Stage = "starting"
        """starting: it may be starting, so nothing is sent. asked by it: it waits for its owner's
        answer. asking: "?" is to be sent. known: it has introduced itself."""
        self.name = ""
        """What it calls itself; empty if it does not."""
        self.version = ""
        """Its firmware's version; empty if it does not say."""
        self._began = self._heard = 0.0
        self._silent = 0  # echoes of "?" without a model
        self._lines: list[str] = []

    def begin(self, now: float, started: bool = False) -> None:
        """Begin again: at an open port, or because the board has begun to start."""
        self.stage = "starting"
        self._began = now
        self._heard = now if started else now - QUIET_FOR + LISTEN_FOR
        self._silent = 0
        self._lines.clear()

    def ask_again(self) -> None:
        """Ask a board that may be another one by now, without waiting for a start."""
        self.stage = "asking"
        self._silent = 0
        self._lines.clear()

    def hear(self, line: str, now: float) -> None:
        """Take a line that is no echo."""
        if self.stage in ("starting", "asked by it"):
            self._heard = max(now, self._heard)
            if line.startswith(_READY):
                self.stage = "asking"
            elif line:
                self._note_question(line)
        elif self.stage == "asking" and line:
            self._lines = [*self._lines[-7:], line]

    def babble(self, begun: str, now: float) -> None:
        """Take note that bytes came, and of the line that has begun."""
        if self.stage == "starting":
            self._heard = max(now, self._heard)
        if self.stage != "known":
            self._note_question(begun)

    def tick(self, now: float) -> None:
        """Stop waiting where the start is over."""
        quiet = now - self._heard >= QUIET_FOR
        if self.stage == "starting" and (quiet or now - self._began >= START_AT_MOST):
            self.stage = "asking"

    def echoed(self) -> bool:
        """Take note that the board has echoed "?"; return whether it is known now."""
        self._read()
        self._silent += 1
        if self.name or self.version or self._silent >= NAMELESS_AFTER:
            self.stage = "known"
        self._lines.clear()
        return self.stage == "known"

    def _read(self) -> None:
        """Find the model and the version among the lines before the echo."""
        name = version = ""
        before = ""
        for line in self._lines:
            if line.lower().startswith(_MODELS) and not _VERSION.fullmatch(line):
                name = line
            elif _VERSION.fullmatch(line):
                version, name = line, name or before
            before = line if len(line) > 1 else before
        if name or version:
            self.name, self.version = name, version

    def _note_question(self, text: str) -> None:
        if _ASKS in text:
            self.stage = "asked by it"
