"""Lines in a session from a voice on a thread of its own."""

import queue
import threading
from collections.abc import Callable

from cubeling.app.pipeline.step import Step
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.app.speaking.line_chooser import LineChooser, LineRequest
from cubeling.app.speaking.lines import SILENT, ScenarioLines
from cubeling.characters import CharacterError
from cubeling.characters.motion import GestureLibrary
from cubeling.characters.speech import (
    SpeechProfile,
    TaggedText,
    Voice,
    say,
    utterance_of,
)

MAX_FAILURES = 3
"""A voice that has failed so often in a row is not asked again."""

ANSWER_S = 5.0
"""How long a session that is not in real time waits for a line [s]."""

LinesOf = Callable[[str, str], ScenarioLines | None]
"""Returns the lines of a scenario by its name and a language; None if it has none."""


class LiveSpeaker:
    """Speaks the lines of the scenarios with a voice, which no frame waits for.

    The lines of another scenario or language are taken when it is played or chosen.

    Parameters
    ----------
    voice
        The voice; `close` ends it.
    lines_of
        What is said in a scenario, by its name, in a language; None for nothing.
    languages
        The languages that can be chosen; the first one is spoken.
    profile
        How it is said with the body.
    gestures
        Those of the character, to be made ready; None for none.
    waits
        Whether the session is not in real time, so that the next frame waits for its line.
    """

    live = True

    def __init__(
        self,
        voice: Voice,
        lines_of: LinesOf,
        languages: tuple[str, ...],
        profile: SpeechProfile,
        *,
        gestures: GestureLibrary | None = None,
        waits: bool = False,
    ) -> None:
        self.problem = ""
        self.profile, self.languages, self.language = profile, languages, languages[0]
        self._voice, self._lines_of, self._waits = voice, lines_of, waits
        self._played = "", ""
        self._moments: LineChooser | None = None
        self._requests: queue.Queue[LineRequest | None] = queue.Queue()
        self._said: queue.Queue[SpokenLine | None] = queue.Queue()
        self._asked = False
        self._thread = threading.Thread(
            target=self._run, args=(gestures,), name="voice", daemon=True
        )
        self._thread.start()

    def line(self, timestamp: float) -> SpokenLine | None:
        """Return the newest line that is ready, if there is one."""
        newest = None
        if self._waits and self._asked:
            try:
                newest = self._said.get(timeout=ANSWER_S)
            except queue.Empty:
                self.problem = "the voice is too slow"
        self._asked = False
        while not self._said.empty():
            newest = self._said.get_nowait() or newest
        return newest

    def hear(self, step: Step) -> None:
        """Let the voice speak what there is to say about a step."""
        played = step.scenario, self.language
        if played != self._played:
            self._played = played
            lines = None if self.language == SILENT else self._lines_of(*played)
            self._moments = None if lines is None else LineChooser(lines)
        request = None if self._moments is None else self._moments.update(step)
        if request is not None and not self.problem:
            self._asked = True
            self._requests.put(request)

    def close(self) -> None:
        """End the voice; a second call does nothing."""
        self._requests.put(None)
        self._thread.join(timeout=1.0)
        self._voice.close()

    def _run(self, gestures: GestureLibrary | None) -> None:
        failures = 0
        self._prepare(gestures)
        while (request := self._requests.get()) is not None:
            self._prepare(gestures)
            try:
                self._said.put(line_of(self._voice, request, self.profile))
                failures = 0
            except CharacterError as error:
                self._said.put(None)
                failures += 1
                if failures == MAX_FAILURES:
                    self.problem = str(error)

    def _prepare(self, gestures: GestureLibrary | None) -> None:
        """Make what plans the gestures, which takes longer than a frame, unless it is there."""
        if gestures is not None:
            self.profile.planner(gestures)


def line_of(voice: Voice, request: LineRequest, profile: SpeechProfile) -> SpokenLine:
    """Return a line as a voice says it.

    Raises
    ------
    CharacterError
        The voice failed, or the tags of the line do not fit together.
    """
    tagged = TaggedText.read(request.text)
    speech = say(voice, tagged.text, request.language, request.manner)
    utterance = utterance_of(speech, tagged, profile.accents)
    return SpokenLine(utterance, speech.samples, speech.rate, profile)
