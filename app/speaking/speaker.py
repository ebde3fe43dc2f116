"""Lines in a session from a voice on a thread of its own."""

import queue
import threading
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from textwrap import shorten

import numpy as np

from cubeling.affect import Emotion
from cubeling.app.pipeline.scenario import Reply
from cubeling.app.pipeline.step import Performance, Step
from cubeling.app.pipeline.table.spoken_line import LEAD, Lines, SpokenLine
from cubeling.app.speaking.cast_voices import combined, voices_of_cast
from cubeling.app.speaking.line_chooser import (
    PAUSE_S,
    WATCHING_PAUSE_S,
    LineChooser,
    LineRequest,
    events_for,
)
from cubeling.app.speaking.lines import DEFAULT_LANGUAGE, SILENT, WATCHING, ScenarioLines
from cubeling.app.thread_turns import taken
from cubeling.characters.behaviour import estimate
from cubeling.characters.motion import GestureLibrary
from cubeling.characters.speech import (
    Manner,
    SpeechProfile,
    TaggedText,
    UnspeakableError,
    Voice,
    VoiceError,
    manner_of,
    say,
    utterance_of,
)

MAX_FAILURES = 3
"""A voice that has failed so often in a row is not asked again."""

SOUNDLESS_HZ = 8000
"""Sample rate of a line without a sound [Hz]."""

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
        The voice; `close` ends it. None to say replies without a sound, and nothing else.
    lines_of
        What is said in a scenario, by its name, in a language; None for nothing.
    languages
        The languages that can be chosen; the first one is spoken.
    profile
        How it is said with the body.
    gestures
        Those of the characters, to be made ready.
    waits
        Whether the session is not in real time, so that the next frame waits for its line.
    """

    live = True

    def __init__(
        self,
        voice: Voice | None,
        lines_of: LinesOf,
        languages: tuple[str, ...],
        profile: SpeechProfile,
        *,
        gestures: Sequence[GestureLibrary] = (),
        waits: bool = False,
    ) -> None:
        self.problem = ""
        self.profile, self.languages, self.language = profile, languages, languages[0]
        self._voice, self._lines_of, self._waits = voice, lines_of, waits
        self._played: dict[str, tuple[str, str]] = {}
        self._choosers: dict[str, LineChooser] = {}
        self._voices: dict[str, Manner] = {}
        self._last = ""  # the one that has spoken last of those that only watch
        self._requests: queue.Queue[tuple[str, int, LineRequest] | None] = queue.Queue()
        self._said: queue.Queue[tuple[str, int, SpokenLine | None]] = queue.Queue()
        self._notices: queue.Queue[str] = queue.Queue()
        self._newest: Counter[str] = Counter()
        self._asked = 0
        self._thread = threading.Thread(
            target=self._run, args=(gestures,), name="voice", daemon=True
        )
        self._thread.start()

    def lines(self, timestamp: float) -> Lines:
        """Return the newest line of each of the cast that is ready."""
        ready = []
        try:
            for _ in range(self._asked if self._waits else 0):
                ready.append(self._said.get(timeout=ANSWER_S))
        except queue.Empty:
            self.problem = "the voice is too slow"
        self._asked = 0
        while not self._said.empty():
            ready.append(self._said.get_nowait())
        return {
            name: line
            for name, number, line in ready
            if line is not None and number == self._newest[name]
        }

    def hear(self, step: Step) -> None:
        """Let the voice speak what there is to say about a step."""
        wishes = {}
        for number, (name, seen) in enumerate(members := _named(step)):
            chooser = self._chooser(name, seen.scenario, number)
            if chooser is not None:
                request = chooser.update(step.frame.timestamp, seen, events_for(step, number))
                if request is not None:
                    wishes[name] = request
            if seen.outcome.hush:
                self._newest[name] += 1  # what the voice still works at is not wanted any more
            if seen.outcome.reply is not None:
                reply = seen.outcome.reply
                reply = replace(reply, language=reply.language or self._spoken)
                wishes[name] = reply_request(reply, seen.emotion.emotion)
        if len(members) - 1 != len(self._voices):
            self._voices = voices_of_cast([name for name, _ in members[1:]])
        for name in self._chosen(wishes):
            wish, voice = wishes[name], self._voices.get(name, Manner())
            if self.problem and not wish.is_reply:
                continue
            self._asked += 1
            self._newest[name] += 1
            wish = replace(wish, manner=combined(wish.manner, voice))
            self._requests.put((name, self._newest[name], wish))

    def notice(self) -> str:
        """Return what the player should know, in one line, once; "" for nothing."""
        return taken(self._notices, "")

    @property
    def _spoken(self) -> str:
        """The language of a reply that does not say its own."""
        return DEFAULT_LANGUAGE if self.language == SILENT else self.language

    def _chooser(self, name: str, scenario: str, number: int) -> LineChooser | None:
        """Return what chooses the lines of one of the cast; None for silence."""
        played = scenario, self.language
        if self._played.get(name) != played:
            self._played[name] = played
            self._choosers.pop(name, None)
            lines = None if self.language == SILENT else self._lines_of(*played)
            if lines is not None:
                pause = WATCHING_PAUSE_S if scenario == WATCHING else PAUSE_S
                self._choosers[name] = LineChooser(lines, pause, number)
        return self._choosers.get(name)

    def _chosen(self, wishes: Mapping[str, LineRequest]) -> list[str]:
        """Return who is to speak; of those that only watch it is one, and they take turns."""
        watching = [name for name in wishes if self._played[name][0] == WATCHING]
        chosen = [name for name in wishes if name not in watching]
        if watching:
            self._last = next((name for name in watching if name > self._last), watching[0])
            chosen.append(self._last)
        return chosen

    def close(self) -> None:
        """End the voice; a second call does nothing."""
        self._requests.put(None)
        self._thread.join(timeout=1.0)
        if self._voice is not None:
            self._voice.close()

    def _run(self, gestures: Sequence[GestureLibrary]) -> None:
        failures, told = 0, ""
        self._prepare(gestures)
        while (asked := self._requests.get()) is not None:
            name, number, request = asked
            self._prepare(gestures)
            tagged, wrong = TaggedText.read_or_plain(request.text)
            line = None
            wanted = number == self._newest[name]  # else it was cut off, or another one came
            voice = None if self.language == SILENT else self._voice
            if voice is not None and wanted and failures < MAX_FAILURES:
                try:
                    line = line_of(voice, request, self.profile)
                    failures = 0
                except UnspeakableError as error:
                    wrong = wrong or str(error)  # of this text; the voice says the next one
                except VoiceError as error:
                    failures += 1
                    if failures == MAX_FAILURES:
                        self.problem = str(error)
            if line is None and wanted and request.is_reply:
                line = soundless_line(request, self.profile)
            if wrong not in ("", told):
                self._notices.put(f"“{shorten(tagged.text, 40, placeholder='…')}”: {wrong}")
                told = wrong
            self._said.put((name, number, line))

    def _prepare(self, gestures: Sequence[GestureLibrary]) -> None:
        """Make what plans the gestures, which takes longer than a frame, unless it is there."""
        for each in gestures:
            self.profile.planner(each)


def _named(step: Step) -> list[tuple[str, Performance]]:
    """Return what the cast does in a step, by their names as `Lines` have them."""
    first, *others = step.cast
    return [(LEAD, first), *((each.name, each) for each in others)]


def reply_request(reply: Reply, emotion: Emotion) -> LineRequest:
    """Return how a voice is asked for a reply that is spoken in an emotion."""
    return LineRequest(reply.text, reply.language, manner_of(emotion), is_reply=True)


def soundless_line(request: LineRequest, profile: SpeechProfile) -> SpokenLine:
    """Return a line that takes as long as a voice would, for who reads it."""
    tagged, _ = TaggedText.read_or_plain(request.text)
    said = estimate(tagged.text)
    spans = tagged.gesture_spans(said.words, said.duration)
    said = replace(said, language=request.language, gestures=spans)
    silence = np.zeros(round(said.duration * SOUNDLESS_HZ), np.float32)
    return SpokenLine(said, silence, SOUNDLESS_HZ, profile)


def line_of(voice: Voice, request: LineRequest, profile: SpeechProfile) -> SpokenLine:
    """Return a line as a voice says it; without its gestures if their tags do not fit together.

    Raises
    ------
    VoiceError
        The voice failed, or cannot say this text.
    """
    tagged, _ = TaggedText.read_or_plain(request.text)
    speech = say(voice, tagged.text, request.language, request.manner)
    utterance = utterance_of(speech, tagged, profile.accents)
    return SpokenLine(utterance, speech.samples, speech.rate, profile)
