"""When the character says something: a function of the steps alone."""

import math
from collections import Counter
from dataclasses import dataclass

from cubeling.app.pipeline.step import Step
from cubeling.app.speaking.lines import ScenarioLines
from cubeling.characters.speech import Manner

SETTLED_S = 0.35
"""An action or gait that lasts so long is spoken of [s]: the cube passes others on its way."""

AGAIN_S = 9.0
"""While an action goes on, something is said again after so long [s]."""

PAUSE_S = 1.5
"""Shortest time between two lines about the same action, or about events [s]."""

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


class LineChooser:
    """Finds what the character says, in the order of time."""

    def __init__(self, lines: ScenarioLines) -> None:
        self._lines, self._language = lines.lines, lines.language
        self._counts: Counter[str] = Counter()
        self._icon, self._since = "", -math.inf
        self._said_at = -math.inf
        self._due = False

    def update(self, step: Step) -> LineRequest | None:
        """Return what is to be said after a step; None for nothing."""
        now, icon = step.frame.timestamp, step.outcome.icon
        if icon != self._icon:
            self._icon, self._since, self._due = icon, now, icon in self._lines
        if not step.posed.visible:
            return None
        settled = now - self._since >= SETTLED_S
        if self._due and settled:  # a new action interrupts what is being said
            return self._say(icon, step)
        if step.command.speaks or now - self._said_at < PAUSE_S:
            return None
        happened = [*step.controls.gestures, *step.outcome.events]
        event = next((each for each in happened if each in self._lines), None)
        if event is not None:
            return self._say(event, step)
        acts = step.command.action is not None and icon == step.command.action.name != "idle"
        again = acts and not self._due and now - self._said_at > AGAIN_S
        if again and icon in self._lines:
            return self._say(icon, step)
        return None

    def _say(self, moment: str, step: Step) -> LineRequest:
        self._due, self._said_at = False, step.frame.timestamp
        lines = self._lines[moment]
        line = lines[self._counts[moment] % len(lines)]
        self._counts[moment] += 1
        factor = 1.0 + LIVELIER_SHARE * step.command.weight
        return LineRequest(line, self._language, Manner(factor, factor, factor))
