"""A voice in a process of its own, which takes texts and answers with sound and times.

The process reads one JSON object a line from its standard input and writes to its standard output:

    asked     {"text": "Hello", "language": "en", "rate": 1.0, "pitch": 1.0, "range": 1.0}
    answered  {"rate": 22050}                                    first; the sample rate [Hz]
              {"word": 0, "length": 5, "at": 0}                  character offset, and the sample
              {"phone": "h", "at": 264}                          IPA; "" for a pause
              {"ipa": "həlˈoʊ"}                                  if it marks stress; also in parts
              {"pcm": 2048}                                      so many bytes follow: 16 bits, mono
              {"end": 26081}                                     the number of samples
              {"error": "no voice speaks 'xx'"}                  instead of "end"

A request may have a "speaker", a number from 1: one beside the usual speaker, if there are more.
Events come in any order before "end". A program that does so is a voice, whatever engine it uses;
a licence of the engine ends at the process's border.
"""

import contextlib
import json
import queue
import subprocess
import threading
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import IO, Any

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.prosody.stress import with_stress
from cubeling.characters.speech.speech import SILENCE, Phone, Speech, Word

TIMEOUT_S = 10.0
"""How long a voice may be silent before it counts as dead [s]."""

MAX_TEXT = 20_000
"""Longest text [characters]: about twenty minutes."""

MAX_BYTES = 200_000_000
"""Longest answer [B]: more than an hour of sound."""

SHORTEST_S = 0.05
"""A shorter answer says nothing: the text has signs only [s]."""

QUIET = 0.004
"""Root mean square of samples below which a phone without a symbol is a pause."""


class VoiceError(CharacterError):
    """There is no voice, or it did not speak; `remedy` says how to add one, or is ""."""

    def __init__(self, message: str, remedy: str = "") -> None:
        super().__init__(f"{message}; install it with: {remedy}" if remedy else message)
        self.remedy = remedy


class UnspeakableError(VoiceError):
    """A voice works, but cannot say a text."""


@dataclass(frozen=True)
class Manner:
    """How a text is spoken; 1 is usual everywhere."""

    rate: float = 1.0
    """Factor of the speed."""

    pitch: float = 1.0
    """Factor of the mean pitch."""

    range: float = 1.0
    """Factor of the pitch range: 0 is monotonous."""

    speaker: int = 0
    """Who speaks, of the speakers that a program has: 0 is its usual one, each other number another
    one, as far as it has so many."""


class Voice:
    """Speaks with a program; it starts with the first text and goes on until `close`.

    Not thread-safe. A program that dies, hangs or talks nonsense costs one text: the next text
    starts it again. Whoever makes it closes it; a second `close` does nothing.

    Parameters
    ----------
    command
        The program and its arguments.
    timeout
        How long it may be silent before it is given up [s].
    """

    def __init__(self, command: Sequence[str], timeout: float = TIMEOUT_S) -> None:
        self._command, self._timeout = tuple(command), timeout
        self._process: subprocess.Popen[bytes] | None = None
        self._answers: queue.Queue[_Answer] = queue.Queue()

    def say(self, text: str, language: str = "en", manner: Manner = Manner()) -> Speech:
        """Return the speech of a text.

        Raises
        ------
        VoiceError
            There is no such program or language, the program failed, or the text is empty or too
            long.
        """
        if not text.strip():
            raise UnspeakableError("there is no text to say")
        if len(text) > MAX_TEXT:
            raise UnspeakableError(
                f"the text has {len(text)} characters: up to {MAX_TEXT} can be said"
            )
        request: dict[str, Any] = {
            "text": text,
            "language": language,
            "rate": manner.rate,
            "pitch": manner.pitch,
            "range": manner.range,
        }
        if manner.speaker:
            request["speaker"] = manner.speaker
        try:
            speech = self._ask(request).speech(text, language)
        except VoiceError:
            raise
        except (OSError, ValueError, KeyError, TypeError) as error:
            self.close()
            raise VoiceError(f"the voice '{self._command[0]}' failed: {error}") from error
        if speech.duration < SHORTEST_S:
            raise UnspeakableError(f"there is nothing to say in '{text.strip()[:40]}'")
        return speech

    def close(self) -> None:
        """End the program; a second call does nothing."""
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()

    def __enter__(self) -> "Voice":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _ask(self, request: dict[str, Any]) -> "_Answer":
        """Send a request and return the answer."""
        if self._process is None or self._process.poll() is not None:
            self._start()
        process = self._process
        assert process is not None
        assert process.stdin is not None
        try:
            process.stdin.write(json.dumps(request).encode() + b"\n")
            process.stdin.flush()
            answer = self._answers.get(timeout=self._timeout)
        except queue.Empty:
            self.close()
            raise VoiceError(
                f"the voice '{self._command[0]}' has not answered in {self._timeout:g} s"
            ) from None
        except OSError:
            answer = _Answer(problem="the voice stopped")
        if answer.problem:
            self.close()
            raise VoiceError(answer.problem)
        return answer

    def _start(self) -> None:
        self.close()
        self._process = subprocess.Popen(
            self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )
        assert self._process.stdout is not None
        self._answers = queue.Queue()
        reader = threading.Thread(
            target=_read_answers, args=(self._process.stdout, self._answers), daemon=True
        )
        reader.start()


@dataclass
class _Answer:
    """What a program has answered to one text."""

    rate: int = 0
    words: list[tuple[int, int, int]] = field(default_factory=list)
    phones: list[tuple[str, int]] = field(default_factory=list)
    transcription: str = ""
    pcm: bytearray = field(default_factory=bytearray)
    problem: str = ""

    def take(self, line: bytes, pipe: IO[bytes]) -> bool:
        """Take the next line; return True if it ends the answer."""
        event = json.loads(line)
        if "pcm" in event:
            count = int(event["pcm"])
            if not 0 <= count <= MAX_BYTES - len(self.pcm):
                raise ValueError(f"{count} bytes of sound at once")
            self.pcm += pipe.read(count)
        elif "word" in event:
            word = int(event["word"]), int(event["length"]), int(event["at"])
            if word[0] >= 0 and word[1] > 0:  # eSpeak NG adds one for some commas
                self.words.append(word)
        elif "phone" in event:
            self.phones.append((str(event["phone"]), int(event["at"])))
        elif "ipa" in event:
            self.transcription += str(event["ipa"])[:MAX_TEXT]
        elif "rate" in event:
            self.rate = int(event["rate"])
        elif "error" in event:
            self.problem = str(event["error"])
        return "end" in event or "error" in event

    def speech(self, text: str, language: str) -> Speech:
        """Return it as a speech."""
        if not 1000 <= self.rate <= 200_000:
            raise ValueError(f"a sample rate of {self.rate} Hz")
        whole = bytes(self.pcm[: len(self.pcm) // 2 * 2])
        samples = np.frombuffer(whole, "<i2").astype(np.float32) / np.float32(2**15)
        end = len(samples)
        phones = with_stress(_phones(self.phones, samples, self.rate), self.transcription)
        starts = [*(min(at, end) for _, _, at in self.words), end]
        words = tuple(
            Word(
                text[offset : offset + length],
                start / self.rate,
                _last_sound(phones, start / self.rate, next_start / self.rate),
                offset,
            )
            for (offset, length, _), start, next_start in zip(
                self.words, starts, starts[1:], strict=False
            )
        )
        return Speech(samples, self.rate, text, language, words, phones)


def _last_sound(phones: Sequence[Phone], start: float, end: float) -> float:
    """Return when the last phone between two times ends [s]: a word ends before a pause."""
    ends = [min(p.end, end) for p in phones if p.symbol != SILENCE and start <= p.start < end]
    return max(ends, default=end)


def _phones(events: Sequence[tuple[str, int]], samples: np.ndarray, rate: int) -> tuple[Phone, ...]:
    """Return phones without gaps; one without a symbol is a pause, or goes on with the last."""
    end = len(samples)
    marks = sorted(((min(max(at, 0), end), symbol) for symbol, at in events), key=lambda m: m[0])
    if not marks or marks[0][0] > 0:
        marks.insert(0, (0, SILENCE))
    phones: list[Phone] = []
    for (start, symbol), (stop, _) in zip(marks, [*marks[1:], (end, SILENCE)], strict=True):
        if stop <= start:
            continue
        if phones and symbol == SILENCE:
            part = samples[start:stop].astype(float)
            silent = phones[-1].symbol == SILENCE or np.sqrt(np.mean(part * part)) < QUIET
            if not silent or phones[-1].symbol == SILENCE:
                phones[-1] = Phone(phones[-1].symbol, phones[-1].start, stop / rate)
                continue
        phones.append(Phone(symbol, start / rate, stop / rate))
    return tuple(phones)


def _read_answers(pipe: IO[bytes], answers: "queue.Queue[_Answer]") -> None:
    """Put every answer that a program writes into a queue, until it ends."""
    answer = _Answer()
    try:
        while line := pipe.readline(100_000):
            if answer.take(line, pipe):
                answers.put(answer)
                answer = _Answer()
        spoken = len(answer.pcm) / 2 / max(answer.rate, 1)
        problem = f"the voice stopped after {spoken:.1f} s of sound"
    except (OSError, ValueError, KeyError, TypeError) as error:
        problem = f"the voice sent what is no answer: {error}"
    answers.put(_Answer(problem=problem))
