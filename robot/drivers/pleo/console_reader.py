"""Reads the text of the console: where an answer ends, and which parts of it matter.

An answer ends with the prompt, `> `. The same two characters may occur in its text, unsolicited
lines may cut into it anywhere, and a read may end anywhere. The rule:

1. Monitor lines (`mu: sensor …`, `mu: joint …`) and motor errors (`MC_… Failed: …`) are removed
   first, from wherever they begin in a line to its end.
2. The prompt is `> ` at the start of a line, followed by nothing but empty lines for
   `PROMPT_SETTLE_S`.
3. `> ` elsewhere in a line is text, unless nothing follows it for `STRAY_SETTLE_S`.
"""

import re
from dataclasses import dataclass

from cubeling.robot.contract.telemetry import complaint_of
from cubeling.robot.drivers.pleo import timing

MAX_LINE_CHARS = 512
"""Number of characters of a line that are kept, the last ones."""

_UNSOLICITED = re.compile(r"mu: (?:sensor|joint)\b|MC_\w+ Failed:")
_PROMPT = re.compile(r"\r?(?:> )+(?P<begun>(?:m|mu|mu:|mu: .*|M|MC|MC_.*)?)", re.DOTALL)
_BEGUN = re.compile(r"\r?(?:m|mu|mu:|mu: .*|M|MC|MC_.*)?", re.DOTALL)
_BATTERY = re.compile(r"Battery sensor value = (\d{1,3}(?:\.\d{1,3})?)\s*%?\s*\(", re.IGNORECASE)
_ERROR = re.compile(
    r"\b(?:error|fail(?:ed|ure)?|unknown|invalid|illegal|not found|cannot|no such)\b", re.IGNORECASE
)


@dataclass
class Answer:
    """What one answer, or the time between two, has brought so far."""

    spoke: bool = False
    """Whether there was any text, an echo included."""

    error: str | None = None
    """The first text that looks like an error, as `Telemetry.complaint` holds it."""

    battery: float | None = None
    """Charge from 0, empty, to 1, full, if reported."""

    restarted: bool = False
    """Whether it contains a text that the console sends only after a restart."""

    prompted: bool = False
    """Whether any line began with `> `."""


class ConsoleReader:
    """Reads the bytes of the console; `boot_text` are texts of which one follows a restart."""

    def __init__(self, boot_text: tuple[str, ...] = ()) -> None:
        self.answer = Answer()
        """What has arrived since `begin`."""
        self.skipped = 0
        """Number of unsolicited lines."""
        self.line = ""
        """The line that has not ended yet, at most `MAX_LINE_CHARS`."""
        self._boot_text = tuple(text.casefold() for text in boot_text)
        self._echo = ""
        self._clipped = False
        self._bare = False  # whether the last line that was not empty was only a prompt
        self._prompt_since: float | None = None
        self._stray: tuple[str, float] | None = None  # a line that ends in `> `, and its time

    def begin(self, echo: str = "") -> None:
        """Expect a new answer, to a command that the console may echo."""
        prompt = _PROMPT.fullmatch(self.line)
        self.line = prompt["begun"] if prompt else ""  # the rest of it is still to come
        self._echo = echo.casefold()
        self._clipped = self._bare = False
        self._prompt_since = self._stray = None
        self.answer = Answer()

    def feed(self, data: bytes, now: float) -> None:
        """Process bytes that arrived at time `now` [s]."""
        if not data:
            return
        *ended, rest = data.decode("latin-1").split("\n")
        for part in ended:
            self._extend(part)
            self._end_line()
        self._extend(rest)
        self._detect_prompt(now)

    @property
    def prompt_came(self) -> float | None:
        """Time of the prompt at the end [s]; None if there is none."""
        return self._stray[1] if self._stray and self._ends_stray else self._prompt_since

    def has_ended(self, now: float, settle: float = timing.PROMPT_SETTLE_S) -> bool:
        """Return whether the answer has ended: its prompt has stood for `settle` [s]."""
        if self._prompt_since is None:
            settle = max(settle, timing.STRAY_SETTLE_S)
        return self.prompt_came is not None and now - self.prompt_came >= settle

    def finish(self) -> Answer:
        """Return the answer that has ended."""
        if self._ends_stray:
            self._read_line(self.line.removesuffix("> "))
        answer = self.answer
        self.begin()
        return answer

    @property
    def _ends_stray(self) -> bool:
        """Whether the only prompt is at the end of a line of text."""
        stray = self._stray is not None and self.line == self._stray[0]
        return self._prompt_since is None and stray

    def _extend(self, text: str) -> None:
        line = self.line + text
        self._clipped |= len(line) > MAX_LINE_CHARS
        self.line = line[-MAX_LINE_CHARS:]

    def _end_line(self) -> None:
        line = self.line.rstrip("\r")
        unsolicited = _UNSOLICITED.search(line)
        if unsolicited:
            self.line = line[: unsolicited.start()]
            self.skipped += 1
            if unsolicited[0].startswith("MC_"):
                self._set_error(line[unsolicited.start() :])
            return
        self.line = ""
        if not self._clipped and re.fullmatch(r"\r?(?:> )+", line):
            self._bare = self.answer.prompted = True
        elif line.strip():
            self._bare, self._prompt_since = False, None
            self._read_line(line)
        self._clipped = False

    def _read_line(self, line: str) -> None:
        """Read a whole line of an answer."""
        self.answer.prompted |= line.startswith("> ")
        self.answer.spoke = True
        text = line.casefold()
        if text.removeprefix("> ").strip() == self._echo:
            return
        self.answer.restarted |= any(boot_text in text for boot_text in self._boot_text)
        battery = _BATTERY.search(line)
        if battery and float(battery[1]) <= 100.0:
            self.answer.battery = float(battery[1]) / 100.0
        if _ERROR.search(line):
            self._set_error(line)

    def _set_error(self, text: str) -> None:
        if self.answer.error is None:
            self.answer.error = complaint_of(text)

    def _detect_prompt(self, now: float) -> None:
        """Look for a prompt at the end of the received text."""
        prompt = not self._clipped and _PROMPT.fullmatch(self.line)
        if prompt or (self._bare and _BEGUN.fullmatch(self.line)):
            self._prompt_since = now if self._prompt_since is None else self._prompt_since
            self.answer.prompted = True
        else:
            self._prompt_since = None
            self._bare &= not self.line.strip()
        if not self.line.endswith("> "):
            if self._stray and not self.line.startswith(self._stray[0]):
                self._stray = None
        elif self._stray is None or self._stray[0] != self.line:
            self._stray = (self.line, now)
