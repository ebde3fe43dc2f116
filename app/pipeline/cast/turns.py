"""Turn-taking: of several characters, one speaks at a time."""

from collections.abc import Sequence
from dataclasses import dataclass

from cubeling.app.pipeline.table.spoken_line import SpokenLine

MAX_WAIT_S = 2.5
"""A line that has waited for longer is given up [s]: what it is about is over."""

PAUSE_S = 0.25
"""Between the end of a line and the beginning of the next one's [s]."""


@dataclass(frozen=True)
class Turn:
    """What changes in a frame. The numbers are those of the cast."""

    begins: int | None = None
    """Who begins to speak; None for nobody."""

    line: SpokenLine | None = None
    """The line with which it begins; None for nobody."""

    interrupted: tuple[int, ...] = ()
    """Who falls silent for it."""


class Turns:
    """Lets one character speak at a time.

    Who is led by a cube takes the turn from one that only watches, since its player waits for an
    answer. Else who wants to speak while another does waits, and gives up after `MAX_WAIT_S`.

    Parameters
    ----------
    led
        Whether a cube leads each of the cast.
    """

    def __init__(self, led: Sequence[bool]) -> None:
        self._led = tuple(led)
        self._waiting: dict[int, tuple[float, SpokenLine]] = {}

    def waits(self, number: int) -> bool:
        """Return whether one of the cast waits for its turn."""
        return number in self._waiting

    def update(self, now: float, lines: Sequence[SpokenLine | None], ends: Sequence[float]) -> Turn:
        """Return who begins to speak at a time [s].

        `lines` are what each wants to say from now on, None for nothing new; `ends` are when what
        each says is over [s], −∞ for silence.
        """
        new = {at: (now, line) for at, line in enumerate(lines) if line is not None}
        self._waiting = {
            at: wish for at, wish in (self._waiting | new).items() if now - wish[0] <= MAX_WAIT_S
        }
        if not self._waiting:
            return Turn()
        first = min(self._waiting, key=lambda at: (not self._led[at], self._waiting[at][0], at))
        speaking = [at for at, end in enumerate(ends) if at != first and now < end]
        paused = any(at != first and now < end + PAUSE_S for at, end in enumerate(ends))
        takes = self._led[first] and not any(self._led[at] for at in speaking)
        if (speaking and not takes) or (paused and not speaking):
            return Turn()
        return Turn(first, self._waiting.pop(first)[1], tuple(speaking))

    def clear(self) -> None:
        """Forget what anybody wants to say."""
        self._waiting.clear()
