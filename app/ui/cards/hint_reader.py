"""Leaves out a hint that was there for long enough to be read."""

from dataclasses import replace

from cubeling.app.pipeline.step import Step

READING_S, LETTER_S = 4.0, 0.1
"""How long a hint is shown at least, and more for each letter [s]."""


class HintReader:
    """Follows the hints of the frames that one player sees.

    A hint goes only while the cube is in view: without it, the player needs to be told what to do.
    """

    def __init__(self) -> None:
        self._words = ""
        self._since = 0.0

    def update(self, step: Step) -> Step:
        """Return a step, without its hint if that was read."""
        words, now = step.outcome.hint, step.frame.timestamp
        if words != self._words or now < self._since or not step.state.visible:
            self._words, self._since = words, now
        if now - self._since < READING_S + LETTER_S * len(words):
            return step
        return replace(step, outcome=replace(step.outcome, hint=""))
