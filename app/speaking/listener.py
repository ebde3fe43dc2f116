"""Push to talk: what a player says into the microphone between two presses of a key, as text."""

import queue
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

import numpy as np

from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.sound import NoSoundError
from cubeling.app.speaking.microphone import MICROPHONE_HZ, SILENT_S, Microphone
from cubeling.app.thread_turns import taken
from cubeling.characters import CharacterError
from cubeling.characters.speech import Samples

# Few sessions listen: what that takes is loaded for those.
if TYPE_CHECKING:
    from cubeling.characters.behaviour import DialogueScript
    from cubeling.characters.speech import SpeechRecognizer

MAX_LISTEN_S = 8.0
"""Who holds a microphone open longer has forgotten it [s]."""

READ_INTERVAL_S = 0.02
"""The microphone's blocks are read so often [s]."""

CLOSE_TIMEOUT_S = 1.0
"""How long a session waits at its end for a microphone that does not answer [s]."""

NOTHING_HEARD = "That is not in the script, or too quiet: say it again, or type it"


class SoundInput(Protocol):
    """A `Microphone`, or what stands in for one."""

    def read(self) -> Samples:
        """Return what was heard since the last call, (n,), at `MICROPHONE_HZ`."""
        ...

    def close(self) -> None:
        """Stop; a second call does nothing."""
        ...


def recognizer_for(script: "DialogueScript", language: str) -> "SpeechRecognizer":
    """Return what hears the phrases of a script.

    Raises
    ------
    AppError
        It knows another language only, or is not installed.
    CharacterError
        Nothing in the script can be heard.
    """
    from cubeling.characters.behaviour import phrases_of
    from cubeling.characters.speech import (
        RECOGNIZED_LANGUAGE,
        SpeechRecognizer,
        VoiceError,
        espeak,
        listening_problem,
    )

    if language != RECOGNIZED_LANGUAGE:
        raise AppError(f"speech is understood in English only, not in '{language}': type instead")
    problem = listening_problem()
    if problem:
        raise AppError(f"{problem}; typing goes on")
    try:
        voice = espeak()
    except VoiceError:  # then words that no dictionary has are left out
        return SpeechRecognizer(phrases_of(script, language))
    with voice:
        return SpeechRecognizer(phrases_of(script, language), voice)


class PushToTalk:
    """Listens while the player asks for it. No method waits, except `close` for a moment.

    Whoever makes it closes it; a second `close` does nothing.

    Parameters
    ----------
    open_microphone
        Opens what is listened to; raises NoSoundError.
    clock
        Returns the time [s].
    """

    def __init__(
        self,
        open_microphone: Callable[[], SoundInput] = Microphone,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._open, self._clock = open_microphone, clock
        self._heard: queue.Queue[Inputs] = queue.Queue()
        self._notices: queue.Queue[str] = queue.Queue()
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        self._known: tuple[DialogueScript, str, SpeechRecognizer] | None = None

    @property
    def listening(self) -> bool:
        """Whether what is said now is heard."""
        alive = self._thread is not None and self._thread.is_alive()
        return alive and not self._ended.is_set()

    def begin(self, script: "DialogueScript", language: str) -> None:
        """Listen for the phrases of a script, until `end` or for `MAX_LISTEN_S`."""
        if self._thread is not None and self._thread.is_alive():
            self._notices.put("One moment: what you said before is still being heard")
            return
        self._ended.clear()
        self._thread = threading.Thread(
            target=self._run, args=(script, language), name="listener", daemon=True
        )
        self._thread.start()

    def end(self) -> None:
        """Let it be said: its words follow in `inputs` as soon as they are known."""
        self._ended.set()

    def inputs(self) -> Inputs:
        """Return what has been heard since the last call: who begins to speak interrupts."""
        return taken(self._heard, Inputs())

    def notice(self) -> str:
        """Return what the player should know, in one line, once; "" for nothing."""
        return taken(self._notices, "")

    def close(self) -> None:
        """Close the microphone, within a bounded time."""
        self._ended.set()
        if self._thread is not None:
            self._thread.join(CLOSE_TIMEOUT_S)

    def _run(self, script: "DialogueScript", language: str) -> None:
        try:
            recognizer = self._recognizer(script, language)
            microphone = self._open()
        except NoSoundError as error:
            self._notices.put(f"{error.advice}; typing goes on")
            return
        except (AppError, CharacterError) as error:
            self._notices.put(str(error))
            return
        try:
            self._heard.put(Inputs(hush=True))
            sound = self._record(microphone)
        finally:
            microphone.close()
        text = recognizer.hear(sound, MICROPHONE_HZ)
        if text:
            self._heard.put(Inputs(typed=text))
        else:
            self._notices.put(NOTHING_HEARD)

    def _recognizer(self, script: "DialogueScript", language: str) -> "SpeechRecognizer":
        if self._known is None or self._known[:2] != (script, language):
            self._known = script, language, recognizer_for(script, language)
        return self._known[2]

    def _record(self, microphone: SoundInput) -> Samples:
        """Return what is said until the end, (n,)."""
        blocks, begin = [np.zeros(0, np.float32)], self._clock()
        last = begin
        while not self._ended.wait(READ_INTERVAL_S):
            block, now = microphone.read(), self._clock()
            blocks.append(block)
            last = now if len(block) else last
            if now - begin > MAX_LISTEN_S:
                break
            if now - last > SILENT_S:
                self._notices.put("The microphone was lost; typing goes on")
                break
        self._ended.set()
        return np.concatenate([*blocks, microphone.read()])
