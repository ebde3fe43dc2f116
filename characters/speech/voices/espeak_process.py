"""The helper process of eSpeak NG; see `voice` for what it reads and writes.

It loads the library, whose licence is the GPL, and uses nothing of Cubeling.
"""

import ctypes
import json
import sys
from typing import Any

SYNCHRONOUS, PHONE_EVENTS, IPA, DO_NOT_EXIT = 2, 1, 2, 0x8000
UTF8 = 1
RATE, PITCH, RANGE = 1, 3, 4  # parameters, by the numbers of speak_lib.h
WORD, PHONE = 1, 7  # types of events
SPEAKERS = ("", "f2", "m3", "f4", "m7", "f5", "m1")  # variants of a voice
USUAL_WORDS_PER_MINUTE, USUAL_PERCENT = 165, 50


class _Id(ctypes.Union):
    _fields_ = (("number", ctypes.c_int), ("name", ctypes.c_char_p), ("string", ctypes.c_char * 8))


class _Event(ctypes.Structure):
    _fields_ = (
        ("type", ctypes.c_int),
        ("unique_identifier", ctypes.c_uint),
        ("text_position", ctypes.c_int),
        ("length", ctypes.c_int),
        ("audio_position", ctypes.c_int),
        ("sample", ctypes.c_int),
        ("user_data", ctypes.c_void_p),
        ("id", _Id),
    )


_CALLBACK = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.POINTER(_Event)
)


class Engine:
    """The library, initialised once."""

    def __init__(self, library: str, data: str | None) -> None:
        self._library = ctypes.CDLL(library)
        folder = None if data is None else data.encode()
        self.rate = self._library.espeak_Initialize(
            SYNCHRONOUS, 0, folder, PHONE_EVENTS | IPA | DO_NOT_EXIT
        )
        if self.rate <= 0:
            raise OSError("eSpeak NG does not find its data")
        self._samples = 0
        self._transcribed = self._library.espeak_TextToPhonemes
        self._transcribed.restype = ctypes.c_char_p
        self._callback = _CALLBACK(self._take)  # kept, or it would be freed
        self._library.espeak_SetSynthCallback(self._callback)

    def say(self, request: dict[str, Any]) -> None:
        """Speak the text of a request; samples and events go to the standard output."""
        language = str(request["language"])
        speaker = SPEAKERS[int(request.get("speaker", 0)) % len(SPEAKERS)]
        voice = f"{language}+{speaker}" if speaker else language
        if self._library.espeak_SetVoiceByName(voice.encode()) != 0:
            write({"error": f"no voice speaks '{language}'; see: espeak-ng --voices"})
            return
        for parameter, usual, factor in (
            (RATE, USUAL_WORDS_PER_MINUTE, "rate"),
            (PITCH, USUAL_PERCENT, "pitch"),
            (RANGE, USUAL_PERCENT, "range"),
        ):
            value = round(usual * float(request.get(factor, 1.0)))
            self._library.espeak_SetParameter(parameter, min(max(value, 0), 450), 0)
        write({"rate": self.rate})
        self._samples = 0
        text = str(request["text"]).replace("\0", " ").encode(errors="replace")
        self._transcribe(text)
        self._library.espeak_Synth(text, len(text) + 1, 0, 0, 0, UTF8, None, None)
        self._library.espeak_Synchronize()
        write({"end": self._samples})

    def _transcribe(self, text: bytes) -> None:
        """Write the text in IPA: unlike the events of phones, it marks stress."""
        left = ctypes.c_char_p(text)
        while left.value:  # the library moves the pointer on by a clause
            clause = self._transcribed(ctypes.byref(left), UTF8, IPA)
            write({"ipa": (clause or b"").decode(errors="ignore") + " "})

    def _take(self, samples: Any, count: int, events: Any) -> int:
        number = 0
        while events[number].type:
            event = events[number]
            if event.type == WORD:
                write({"word": event.text_position - 1, "length": event.length, "at": event.sample})
            elif event.type == PHONE:
                symbol = event.id.string.decode(errors="ignore")
                write({"phone": symbol, "at": event.sample})
            number += 1
        if samples and count > 0:
            write({"pcm": 2 * count})
            sys.stdout.buffer.write(ctypes.string_at(samples, 2 * count))
            self._samples += count
        return 0


def write(event: dict[str, Any]) -> None:
    """Write an event as one line of JSON."""
    sys.stdout.buffer.write(json.dumps(event).encode() + b"\n")


def main() -> None:
    """Answer texts until the standard input ends."""
    library, *data = sys.argv[1:]
    try:
        engine = Engine(library, data[0] if data else None)
    except (OSError, AttributeError) as error:
        write({"error": f"eSpeak NG cannot be loaded: {error}"})
        sys.stdout.flush()
        return
    for line in sys.stdin.buffer:
        engine.say(json.loads(line))
        sys.stdout.flush()


if __name__ == "__main__":
    main()
