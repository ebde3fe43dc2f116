"""What a voice says for the speeches of blocks: at once, or on a thread that no frame waits for."""

import queue
import threading
from collections.abc import Callable
from typing import Protocol

from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.characters import CharacterError
from cubeling.characters.speech import DEFAULT_PROFILE, Speech, TaggedText, Voice, say, utterance_of

MAX_REMEMBERED = 256
"""Lines that are remembered, so that a text that is said again is there at once."""

MAX_LETTERS = 40_000
"""Letters of the lines that are remembered: about 45 minutes, 0.2 GB of sound."""

MAX_ASKED = 32
"""Texts that wait for the voice; later ones are asked for again when there is room."""

SayText = Callable[[str, str], Speech]
"""Returns the speech of a text in a language; raises `CharacterError`."""


def say_with(voice: Voice) -> SayText:
    """Return what says texts with a voice, which the caller closes."""
    return lambda text, language: say(voice, text, language)


class LineSource(Protocol):
    """Gives the lines of speeches. Whoever opens it closes it."""

    problem: str
    """Why it says nothing; "" while all is well."""

    def line(self, text: str, language: str) -> SpokenLine | None:
        """Return what is said, in a language ("" for the usual one); None if it is not there."""
        ...

    def close(self) -> None:
        """End; a second call does nothing."""
        ...


class SilentSource:
    """Says nothing, because there is no voice."""

    def __init__(self, problem: str) -> None:
        self.problem = problem

    def line(self, text: str, language: str) -> SpokenLine | None:
        """Return None: there is no voice, so speeches last as long as estimated."""
        return None

    def close(self) -> None:
        """Do nothing: nothing was opened."""


class PatientSource:
    """Waits for a voice: for files, which are not in real time.

    Parameters
    ----------
    speak
        Says a text.
    language
        The usual language.
    close
        Called by `close`.
    """

    def __init__(
        self, speak: SayText, language: str, close: Callable[[], None] = lambda: None
    ) -> None:
        self.problem = ""
        self._speak, self._language, self._close = speak, language, close
        self._lines: dict[tuple[str, str], SpokenLine | None] = {}

    def line(self, text: str, language: str) -> SpokenLine | None:
        """Return what is said; None if the voice has failed."""
        asked = text, language or self._language
        if asked not in self._lines:
            self._lines[asked] = self._say(asked)
        return self._lines[asked]

    def _say(self, asked: tuple[str, str]) -> SpokenLine | None:
        try:
            return line_of(self._speak, *asked)
        except CharacterError as error:
            self.problem = str(error)
            return None

    def close(self) -> None:
        """Close the voice; a second call does nothing."""
        self._close()


class ThreadedSource:
    """Lets a voice speak on a thread of its own; the parameters are those of `PatientSource`."""

    def __init__(
        self, speak: SayText, language: str, close: Callable[[], None] = lambda: None
    ) -> None:
        self.problem = ""
        self._speak, self._language, self._close = speak, language, close
        self._lines: dict[tuple[str, str], SpokenLine | None] = {}
        self._asked: queue.Queue[tuple[str, str] | None] = queue.Queue()
        self._thread = threading.Thread(target=self._run, name="behaviour voice", daemon=True)
        self._thread.start()

    def line(self, text: str, language: str) -> SpokenLine | None:
        """Return what is said as soon as the voice has answered; None until then."""
        asked = text, language or self._language
        if asked not in self._lines:
            if self._asked.qsize() >= MAX_ASKED:
                return None
            self._forget(len(text))
            self._lines[asked] = None
            self._asked.put(asked)
        return self._lines[asked]

    def _forget(self, letters: int) -> None:
        """Forget the oldest lines, so that there is room for one with so many letters."""
        letters += sum(len(text) for text, _ in self._lines)
        while self._lines and (len(self._lines) >= MAX_REMEMBERED or letters > MAX_LETTERS):
            oldest = next(iter(self._lines))
            letters -= len(oldest[0])
            del self._lines[oldest]

    def close(self) -> None:
        """End the voice; a second call does nothing."""
        self._asked.put(None)
        self._close()
        self._thread.join(5.0)

    def _run(self) -> None:
        while (asked := self._asked.get()) is not None:
            try:
                line = line_of(self._speak, *asked)
            except CharacterError as error:
                self.problem = str(error)
                continue
            if asked in self._lines:
                self._lines[asked] = line


def line_of(speak: SayText, text: str, language: str) -> SpokenLine:
    """Return the line of a text, with its accents and without tags.

    Raises
    ------
    CharacterError
        If the voice fails.
    """
    speech = speak(text, language)
    utterance = utterance_of(speech, TaggedText(text, ()), DEFAULT_PROFILE.accents)
    return SpokenLine(utterance, speech.samples, speech.rate)
