"""Waiting for a language model's answer: never silent, never for ever."""

from cubeling.app.pipeline.scenario import ModelAnswer, ModelQuestion

FILLER_AFTER_S = 0.7
"""Who thinks longer says so [s]: with the voice's own time it is heard within a second."""

LOOK_ASIDE_S = 1.6
"""So long who thinks looks aside [s], and then at the player again."""

MAX_THINK_S = 9.0
"""Longest wait for an answer [s]; then the script answers."""

FILLERS = {
    "en": ("Hmm, let me think.", "Good question. Let me see.", "Well… one moment."),
    "es": ("Mmm, déjame pensar.", "Buena pregunta. A ver.", "Pues… un momento."),
}
"""What is said while an answer is awaited, by language."""

NO_FILLERS = ("Hmm.",)
"""What is said in any other language."""


class PendingQuestion:
    """The question that is open, if any. It goes by the time of the frames."""

    def __init__(self) -> None:
        self._number = 0
        self._asked_at: float | None = None
        self._filled = False
        self._text: str | None = None

    @property
    def is_open(self) -> bool:
        """Whether an answer is awaited."""
        return self._asked_at is not None

    def ask(self, text: str, now: float) -> ModelQuestion:
        """Ask something at a time [s], in the place of what was asked before."""
        self._number += 1
        self._asked_at, self._filled, self._text = now, False, None
        return ModelQuestion(self._number, text)

    def drop(self) -> None:
        """Await no answer any more."""
        self._asked_at = None

    def take(self, answer: ModelAnswer | None, now: float) -> None:
        """Take what has been answered by a time [s]; what nobody asks any more is left out."""
        if self._asked_at is None:
            return
        if answer is not None and answer.number == self._number:
            self._text = answer.text
        elif self._text is None and now - self._asked_at >= MAX_THINK_S:
            self._text = ""

    @property
    def text(self) -> str | None:
        """The answer; "" if there is none, None while it may still come."""
        return self._text if self.is_open else None

    def filler(self, language: str, now: float) -> str:
        """Return what is said meanwhile, once for a question; "" for nothing yet."""
        if self._asked_at is None or self._filled or now - self._asked_at < FILLER_AFTER_S:
            return ""
        self._filled = True
        texts = FILLERS.get(language, NO_FILLERS)
        return texts[self._number % len(texts)]

    def looks_aside(self, now: float) -> bool:
        """Return whether who is asked looks aside at a time [s]."""
        waited = -1.0 if self._asked_at is None else now - self._asked_at
        return FILLER_AFTER_S <= waited < FILLER_AFTER_S + LOOK_ASIDE_S
