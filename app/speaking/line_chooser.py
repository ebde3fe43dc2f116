"""When a character says something: a function of the steps alone."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from cubeling.app.pipeline.step import Performance, Step
from cubeling.app.speaking.lines import ScenarioLines
from cubeling.characters.speech import Manner

SETTLED_S = 0.35
"""An action or gait that lasts so long is spoken of [s]: the cube passes others on its way."""

AGAIN_S = 9.0
"""While an action goes on, something is said again after so long [s]."""

PAUSE_S, WATCHING_PAUSE_S = 1.5, 8.0
"""Shortest time between two lines about the same action, or about events, of a character that plays
and of one that watches [s]."""

LIVELIER_SHARE = 0.12
"""How much faster and higher a line is said at full intensity, as a part."""


@dataclass(frozen=True)
class LineRequest:
    """A line that is to be said."""

    text: str
    """The line, with its tags."""

    language: str
    """Code of its language."""

    manner: Manner
    """How it is said."""

    is_reply: bool = False
    """Whether somebody waits for it: without a voice, it is said without a sound."""


def events_for(step: Step, number: int) -> tuple[str, ...]:
    """Return what has happened in a step to one of the cast, by its number.

    That are the gestures of the cube that it follows, the events of its own, and those of the
    others, as "other reached".
    """
    cubes = [step.controls, *(each.controls for each in step.players)]
    controls = cubes[number] if number < len(cubes) else step.controls
    cast = step.cast
    others = (
        f"other {event}"
        for at, each in enumerate(cast)
        if at != number
        for event in each.outcome.events
    )
    return (*controls.gestures, *cast[number].outcome.events, *others)


class LineChooser:
    """Finds what a character says, in the order of time.

    Parameters
    ----------
    lines
        What it may say.
    pause
        Shortest time between two lines [s].
    first
        With which of several lines it begins, so that two characters do not say the same.
    """

    def __init__(self, lines: ScenarioLines, pause: float = PAUSE_S, first: int = 0) -> None:
        self._lines, self._language = lines.lines, lines.language
        self._pause, self._first = pause, first
        self._counts: Counter[str] = Counter()
        self._icon, self._since = "", -math.inf
        self._said_at = -math.inf
        self._due = False

    def update(self, now: float, seen: Performance, events: Sequence[str]) -> LineRequest | None:
        """Return what is to be said after a frame [s]; None for nothing.

        `seen` is what the character does in it, and `events` are those of `events_for`.
        """
        icon = seen.outcome.icon
        if icon != self._icon:
            self._icon, self._since, self._due = icon, now, icon in self._lines
        if not seen.posed.visible:
            return None
        settled = now - self._since >= SETTLED_S
        if self._due and settled:  # a new action interrupts what is being said
            return self._say(icon, seen, now)
        if seen.command.speaks or now - self._said_at < self._pause:
            return None
        event = next((each for each in events if each in self._lines), None)
        if event is not None:
            return self._say(event, seen, now)
        acts = seen.command.action is not None and icon == seen.command.action.name != "idle"
        again = acts and not self._due and now - self._said_at > AGAIN_S
        if again and icon in self._lines:
            return self._say(icon, seen, now)
        return None

    def _say(self, moment: str, seen: Performance, now: float) -> LineRequest:
        self._due, self._said_at = False, now
        lines = self._lines[moment]
        line = lines[(self._first + self._counts[moment]) % len(lines)]
        self._counts[moment] += 1
        factor = 1.0 + LIVELIER_SHARE * seen.command.weight
        return LineRequest(line, self._language, Manner(factor, factor, factor))
