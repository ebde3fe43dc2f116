"""What the console says: where an answer ends, and what of it matters.

An answer ends with the prompt, `> `. The same two characters may stand in an answer's text, lines
that nobody asked for may cut into it anywhere, and a read may end anywhere. The rule:

1. Monitor lines (`mu: sensor …`, `mu: joint …`) and motor errors (`MC_… Failed: …`) are taken out
   first, from wherever in a line they begin to the end of that line.
2. The prompt is `> ` at the start of a line with nothing but empty lines after it, for
   `PROMPT_SETTLES`.
3. `> ` elsewhere in a line is text, unless nothing follows it for `STRAY_SETTLES`.
"""

import re
from dataclasses import dataclass

from robot.contract.telemetry import complaint_of
from robot.drivers.pleo import timing

LINE_MAX = 512
"""Only so many characters of a line are kept, the last ones."""

_UNASKED = re.compile(r"mu: (?:sensor|joint)\b|MC_\w+ Failed:")
_PROMPT = re.compile(r"\r?(?:> )+(?P<begun>(?:m|mu|mu:|mu: .*|M|MC|MC_.*)?)", re.DOTALL)
_BEGUN = re.compile(r"\r?(?:m|mu|mu:|mu: .*|M|MC|MC_.*)?", re.DOTALL)
_BATTERY = re.compile(r"Battery sensor value = (\d{1,3}(?:\.\d{1,3})?)\s*%?\s*\(", re.IGNORECASE)
_ERROR = re.compile(
    r"\b(?:error|fail(?:ed|ure)?|unknown|invalid|illegal|not found|cannot|no such)\b", re.IGNORECASE
)


@dataclass
class Answer:
    """What one answer, or the silence between two, has brought so far."""

    spoke: bool = False
    """Whether there was any text in it, an echo included."""

    error: str | None = None
    """The first text in it that looks like an error, as `Telemetry.complaint` has it."""

    battery: float | None = None
    """From empty, 0, to full, 1, if it says so."""

    restarted: bool = False
    """Whether it holds a text by which the console is known to have just started."""

    prompted: bool = False
    """Whether any line in it began with `> `."""


class ConsoleReader:
    """Takes what the console says, however it is cut.

    Parameters
    ----------
    boot_text
        Texts of which one stands in a line when the console has just started.
    """

    def __init__(self, boot_text: tuple[str, ...] = ()) -> None:
        self.answer = Answer()
        """What has come since `begin`."""
        self.skipped = 0
        """Lines taken out because nobody asked for them."""
        self._boot_text = tuple(text.casefold() for text in boot_text)
        self._echo = ""
        self._line = ""
        self._clipped = False
        self._bare = False  # the last line with anything in it was a prompt and no more
        self._since: float | None = None  # when the prompt came that still stands
        self._stray: tuple[str, float] | None = None  # a line that ends in `> `, and when it came

    def begin(self, echo: str = "") -> None:
        """Expect a new answer, to a command that the console may repeat in it."""
        standing = _PROMPT.fullmatch(self._line)
        self._line = standing["begun"] if standing else ""  # the rest of it is still to come
        self._echo = echo.casefold()
        self._clipped = self._bare = False
        self._since = self._stray = None
        self.answer = Answer()

    def feed(self, data: bytes, now: float) -> None:
        """Take bytes that came at time `now` [s]."""
        if not data:
            return
        *ended, rest = data.decode("latin-1").split("\n")
        for part in ended:
            self._extend(part)
            self._end_line()
        self._extend(rest)
        self._look(now)

    @property
    def prompt_came(self) -> float | None:
        """When the prompt came that stands now [s]; None if none stands."""
        if self._since is None and self._stray is not None and self._line == self._stray[0]:
            return self._stray[1]
        return self._since

    def ended(self, now: float, settle: float = timing.PROMPT_SETTLES) -> bool:
        """Whether the answer has ended: the prompt stands and has stood for `settle` [s]."""
        if self._since is None:
            settle = max(settle, timing.STRAY_SETTLES)
        return self.prompt_came is not None and now - self.prompt_came >= settle

    def finish(self) -> Answer:
        """Return the answer that has ended, and expect nothing more of it."""
        if self._since is None and self._stray is not None and self._line == self._stray[0]:
            self._take(self._line.removesuffix("> "))
        answer = self.answer
        self.begin()
        return answer

    def _extend(self, text: str) -> None:
        line = self._line + text
        self._clipped |= len(line) > LINE_MAX
        self._line = line[-LINE_MAX:]

    def _end_line(self) -> None:
        line = self._line.rstrip("\r")
        unasked = _UNASKED.search(line)
        if unasked:
            self._line = line[: unasked.start()]
            self.skipped += 1
            if unasked[0].startswith("MC_"):
                self._take_error(line[unasked.start() :])
            return
        self._line = ""
        if not self._clipped and re.fullmatch(r"\r?(?:> )+", line):
            self._bare = self.answer.prompted = True
        elif line.strip():
            self._bare, self._since = False, None
            self._take(line)
        self._clipped = False

    def _take(self, line: str) -> None:
        """Read one whole line of an answer."""
        self.answer.prompted |= line.startswith("> ")
        self.answer.spoke = True
        text = line.casefold()
        if text.removeprefix("> ").strip() == self._echo:
            return
        self.answer.restarted |= any(sign in text for sign in self._boot_text)
        battery = _BATTERY.search(line)
        if battery and float(battery[1]) <= 100.0:
            self.answer.battery = float(battery[1]) / 100.0
        if _ERROR.search(line):
            self._take_error(line)

    def _take_error(self, text: str) -> None:
        if self.answer.error is None:
            self.answer.error = complaint_of(text)

    def _look(self, now: float) -> None:
        """See whether a prompt stands at the end of what has come."""
        prompt = not self._clipped and _PROMPT.fullmatch(self._line)
        if prompt or (self._bare and _BEGUN.fullmatch(self._line)):
            self._since = now if self._since is None else self._since
            self.answer.prompted = True
        else:
            self._since = None
            self._bare &= not self._line.strip()
        if not self._line.endswith("> "):
            if self._stray and not self._line.startswith(self._stray[0]):
                self._stray = None
        elif self._stray is None or self._stray[0] != self._line:
            self._stray = (self._line, now)
