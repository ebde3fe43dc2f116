"""The small cards below the hint: what the session does, and notices."""

from collections.abc import Callable, Sequence

from cubeling.app.pipeline.step import Rect
from cubeling.app.ui.canvas import Card
from cubeling.app.ui.palette import ANGRY, QUIET, Color
from cubeling.app.ui.playback.cards import draw_pills
from cubeling.app.ui.playback.status import SessionStatus

NOTICE_S = 4.0
"""How long a notice is shown."""

QUICK_SEEK_S = 0.4
"""A seek that takes longer is named over the picture."""


class Announcements:
    """Says that a session records, is paused or seeks, and shows a notice for some seconds.

    `clock` returns the time [s].
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._notice, self._until = "", 0.0
        self._seeking_since: float | None = None

    @property
    def changed(self) -> bool:
        """Whether the notice that was drawn last is over."""
        return bool(self._notice) and self._clock() >= self._until

    def notify(self, words: str) -> None:
        """Show a notice, in the place of the one before."""
        self._notice, self._until = words, self._clock() + NOTICE_S

    def draw(
        self, status: SessionStatus, width: float, scale: float, taken: Sequence[Rect] = ()
    ) -> list[Card]:
        """Return the cards for a state of the session; all in units of the canvas.

        They lie in a picture of a width, and over none of the rectangles that are `taken`.
        """
        pills: list[tuple[str, Color | None]] = []
        if status.recording is not None:
            minutes, seconds = divmod(int(status.recording), 60)
            pills.append((f"recording {minutes}:{seconds:02}  ·  R ends it", ANGRY))
        if status.hears:
            pills.append(("I hear you  ·  F2 when you have said it", ANGRY))
        if self._seeks_long(status):
            pills.append(("Seeking …", QUIET))
        elif status.paused and status.ending is None:
            pills.append(("Paused: Space goes on", QUIET))
        if self._clock() >= self._until:
            self._notice = ""
        if self._notice:
            pills.append((self._notice, None))
        return draw_pills(tuple(pills), width, scale, taken)

    def _seeks_long(self, status: SessionStatus) -> bool:
        if not status.seeking:
            self._seeking_since = None
            return False
        now = self._clock()
        self._seeking_since = now if self._seeking_since is None else self._seeking_since
        return now - self._seeking_since >= QUICK_SEEK_S
