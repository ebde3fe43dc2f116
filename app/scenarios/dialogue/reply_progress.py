"""How far a reply is: asked for, being said, or heard."""

from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.characters.behaviour import heard_of

MAX_WAIT_S = 6.0
"""A voice that has not answered after so long does not answer any more [s]."""


class ReplyProgress:
    """Follows one reply at a time. It ends by the clock, so that no event can be missed."""

    def __init__(self) -> None:
        self._asked: float | None = None
        self._line: SpokenLine | None = None
        self._start = 0.0

    def ask(self, now: float) -> None:
        """Ask for a reply at a time [s]."""
        self._asked = now

    def begin(self, line: SpokenLine, now: float) -> bool:
        """Begin to say a line; return False for one that nobody waits for any more."""
        if self._asked is None:
            return False
        self._asked, self._line, self._start = None, line, now
        return True

    def finished(self, now: float) -> str:
        """Return the text of a line that has just been heard to its end; "" for none."""
        if self._line is None or now < self._start + self._line.utterance.duration:
            return ""
        return self.stop(now)

    def stop(self, now: float) -> str:
        """Break off, and return what was heard until then; "" for nothing."""
        line, self._line, self._asked = self._line, None, None
        return "" if line is None else heard_of(line.utterance, now - self._start)

    @property
    def speaks(self) -> bool:
        """Whether a line is being said."""
        return self._line is not None

    def is_busy(self, now: float) -> bool:
        """Return whether a line is being said, or asked for, at a time [s]."""
        return self.speaks or (self._asked is not None and now - self._asked < MAX_WAIT_S)
