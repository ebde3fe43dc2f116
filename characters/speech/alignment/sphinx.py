"""Alignment of English recordings by PocketSphinx, the extra `[align]`.

Two passes: the words first, then the phones of the pronunciations that were chosen. Words that its
dictionary lacks are pronounced as the voice does.
"""

from dataclasses import replace
from typing import Any

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.audio import resample
from cubeling.characters.speech.phones import arpabet_of_ipa, fill_pauses, ipa_of_arpabet
from cubeling.characters.speech.speech import SILENCE, Phone, Speech, Word
from cubeling.characters.speech.voices import Voice
from cubeling.characters.speech.words import written_words

RATE = 16_000
"""Sample rate of its model [Hz]."""

FRAME_S = 0.01
"""Time from frame to frame of its model [s]."""

MAX_S = 300.0
"""Longest recording that is aligned at once [s]."""

_NOISES = ("<s>", "</s>", "<sil>", "[NOISE]", "(NULL)")


def align_with_sphinx(recording: Speech, text: str, voice: Voice) -> Speech:
    """Return an English recording with the times of its words and phones.

    Raises
    ------
    CharacterError
        PocketSphinx is not installed, the text does not match, or the recording is too long.
    """
    if recording.duration > MAX_S:
        raise CharacterError(f"PocketSphinx aligns up to {MAX_S:g} s at once: cut the recording")
    written = written_words(text)
    if not written:
        raise CharacterError("there are no words to align")
    decoder = _decoder()
    for word in {_key(word) for word, _ in written}:
        if decoder.lookup_word(word) is None:
            decoder.add_word(word, _pronounce(word, voice), True)
    sound = resample(recording.samples, recording.rate, RATE)
    data = (sound.clip(-1.0, 1.0) * 32767).astype("<i2").tobytes()
    try:
        decoder.set_align_text(" ".join(_key(word) for word, _ in written))
        _decode(decoder, data)
        decoder.set_alignment()
        _decode(decoder, data)
    except RuntimeError as error:
        raise CharacterError("PocketSphinx does not find this text in the recording") from error
    entries = [
        (each.name, each.start, each.duration, [(phone.name, phone.start) for phone in each])
        for each in decoder.get_alignment() or ()  # what it yields dies with the next one
    ]
    spoken = [entry for entry in entries if entry[0] not in _NOISES]
    if len(spoken) != len(written):
        raise CharacterError("PocketSphinx does not find this text in the recording")
    words = tuple(
        Word(word, _time(start), _time(start + length), offset)
        for (word, offset), (_, start, length, _) in zip(written, spoken, strict=True)
    )
    return replace(
        recording,
        text=text,
        language="en",
        words=words,
        phones=_phones(entries, recording.duration),
    )


def _phones(
    entries: list[tuple[str, int, int, list[tuple[str, int]]]], duration: float
) -> tuple[Phone, ...]:
    marks: list[tuple[float, str]] = [(0.0, SILENCE)]
    for word, _, _, pieces in entries:
        for symbol, start in pieces:
            known = SILENCE if word in _NOISES else ipa_of_arpabet(symbol)
            marks.append((_time(start), known))
    ends = [*(start for start, _ in marks[1:]), duration]
    timed = [Phone(symbol, start, end) for (start, symbol), end in zip(marks, ends, strict=True)]
    return fill_pauses(timed, duration)


def _time(frame: int) -> float:
    return frame * FRAME_S


def _key(word: str) -> str:
    return word.lower().replace("’", "'")


def _pronounce(word: str, voice: Voice) -> str:
    """Return how a voice pronounces a word, in ARPAbet."""
    symbols = (phone.symbol for phone in voice.say(word, "en-us").phones)
    return " ".join(each for symbol in symbols for each in arpabet_of_ipa(symbol)) or "SIL"


def _decoder() -> Any:
    try:
        from pocketsphinx import Decoder
    except ImportError as error:
        raise CharacterError(
            "PocketSphinx is not installed; install it with: pip install pocketsphinx"
        ) from error
    return Decoder(lm=None, loglevel="FATAL")


def _decode(decoder: Any, data: bytes) -> None:
    decoder.start_utt()
    decoder.process_raw(data, full_utt=True)
    decoder.end_utt()
