"""Alignment of a recording with its text: dynamic time warping against a voice that says it.

The voice speaks the text in several variants; their cepstra are averaged phone by phone, and warped
onto those of the recording. Pauses are cut out of both and put back afterwards, so a speaker may
pause where the voice does not. This works in every language of the voice, without a trained model.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.alignment.mfcc import HOP_S, cepstra
from cubeling.characters.speech.alignment.warping import warp
from cubeling.characters.speech.closures import with_closures
from cubeling.characters.speech.frames import runs
from cubeling.characters.speech.phones import fill_pauses
from cubeling.characters.speech.speech import SILENCE, Phone, Speech, Word
from cubeling.characters.speech.voices import Voice, VoiceError
from cubeling.characters.speech.words import with_every_word

MAX_S = 1200.0
"""Longest recording [s]; as long as what a voice says at once."""

VARIANTS = ("", "+f2", "+f3", "+m3")
"""Speakers of eSpeak NG that say a text; another voice has one."""

DIALECTS = {"en": ("en", "en-us"), "es": ("es", "es-419"), "pt": ("pt", "pt-br")}
"""Accents of a language that are tried."""

MAX_VARIANTS_TEXT = 2000
"""Longest text that is tried in every variant and accent [characters]."""

MIN_PAUSE_S = 0.15
"""Shortest pause that is cut out [s]: longer than the closure of a stop."""

SILENT = 1e-3
"""Peak below which a recording is silent."""

MIN_S = 0.1
"""Shortest recording that is aligned [s]."""

TEMPO = (0.25, 4.0)
"""How fast the speaker may be beside the voice."""


def align(recording: Speech, text: str, voice: Voice, language: str = "en") -> Speech:
    """Return a recording with the times of its words and phones.

    Of a language with several accents, such as English, the one that suits the recording is taken.

    Raises
    ------
    CharacterError
        The recording is silent, too short or too long, the text is much too long or short for it,
        or the voice cannot say it.
    """
    if recording.duration > MAX_S:
        raise CharacterError(
            f"the recording is {recording.duration / 60:.0f} minutes long: cut it in parts of up to"
            f" {MAX_S / 60:.0f} minutes, each with its text"
        )
    if float(np.abs(recording.samples).max(initial=0.0)) < SILENT:
        raise CharacterError("the recording is silent: there is nothing to align")
    if recording.duration < MIN_S:
        raise CharacterError(
            f"the recording lasts {1e3 * recording.duration:.0f} ms: too short for a word"
        )
    spoken = cepstra(recording.samples, recording.rate)
    frames = _voiced_frames(spoken.level)
    features = spoken.features[frames]
    dialects = (
        DIALECTS.get(language, (language,)) if len(text) <= MAX_VARIANTS_TEXT else (language,)
    )
    fits = [_Fit(_speak_variants(text, voice, dialect), features) for dialect in dialects]
    best = min(fits, key=lambda fit: fit.distance)
    bounds = _snap(best.begins.clip(0, len(frames) - 1), frames)
    timed = _time_phones(best.phones, bounds, frames)
    words = _words(best.said, best.phones, timed)
    filled = fill_pauses(timed, recording.duration)
    return replace(recording, text=text, language=language, words=words, phones=filled)


class _Fit:
    """What a voice has said, warped onto the features of a recording without its pauses."""

    def __init__(self, variants: Sequence[Speech], features: NDArray[np.float32]) -> None:
        self.said = variants[0]
        self.phones = [phone for phone in self.said.phones if phone.symbol != SILENCE]
        duration = sum(phone.end - phone.start for phone in self.phones)
        tempo = duration / (len(features) * HOP_S)
        if not TEMPO[0] <= tempo <= TEMPO[1]:
            raise CharacterError(
                f"the text takes {duration:.1f} s, and the recording has"
                f" {len(features) * HOP_S:.1f} s of speech: they do not belong together"
            )
        template, marks = _template(variants, tempo)
        path = warp(features, template)
        self.begins = np.searchsorted(path, marks)
        """Which frame each phone begins with."""
        self.distance = float(np.abs(features - template[path]).mean())
        """How unlike they are."""


def _speak_variants(text: str, voice: Voice, language: str) -> list[Speech]:
    """Return the text as the variants of a voice say it, all with the same phones."""
    said = [with_every_word(with_closures(voice.say(text, language)))]
    if not any(phone.symbol != SILENCE for phone in said[0].phones):
        raise CharacterError(f"the voice finds nothing to say in the text, by '{language}'")
    if "+" in language or len(text) > MAX_VARIANTS_TEXT:
        return said
    symbols = [phone.symbol for phone in said[0].phones]
    for variant in VARIANTS[1:]:
        try:
            other = with_closures(voice.say(text, language + variant))
        except VoiceError:
            continue
        if [phone.symbol for phone in other.phones] == symbols:
            said.append(other)
    return said


def _template(
    said: Sequence[Speech], tempo: float
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Return the mean features of what was said, as long as the recording, without pauses.

    Also the row with which each phone begins.
    """
    rows, marks, count = [], [], 0
    features = [cepstra(speech.samples, speech.rate).features for speech in said]
    for same in zip(*(speech.phones for speech in said), strict=True):
        if same[0].symbol == SILENCE:
            continue
        length = max(1, round((same[0].end - same[0].start) / tempo / HOP_S))
        part = (np.arange(length) + 0.5) / length
        at = [phone.start + part * (phone.end - phone.start) for phone in same]
        rows.append(
            np.mean(
                [
                    own[(times / HOP_S).astype(int).clip(0, len(own) - 1)]
                    for own, times in zip(features, at, strict=True)
                ],
                0,
            )
        )
        marks.append(count)
        count += length
    return np.concatenate(rows), np.array(marks)


def _voiced_frames(level: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the frames that are in no pause."""
    floor, loud = np.quantile(level, (0.05, 0.95))
    quiet = level < np.clip(floor + 8.0, loud - 45.0, loud - 20.0)
    kept = np.ones(len(level), bool)
    for start, end in runs(quiet):
        if (end - start) * HOP_S >= MIN_PAUSE_S or start == 0 or end == len(level):
            kept[start:end] = False
    return np.flatnonzero(kept)


def _snap(begins: NDArray[np.intp], frames: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return where phones begin, so that each pause that was cut out lies between two phones."""
    bounds = begins.copy()
    bounds[0] = 0
    for gap in np.flatnonzero(np.diff(frames) > 1) + 1:
        nearest = int(np.abs(bounds[1:] - gap).argmin()) + 1 if len(bounds) > 1 else 0
        if nearest:
            bounds[nearest] = gap
    return np.maximum.accumulate(bounds)


def _time_phones(
    phones: Sequence[Phone], bounds: NDArray[np.intp], frames: NDArray[np.intp]
) -> list[Phone]:
    """Return phones with the times of a recording; one may be empty."""
    ends = np.append(bounds[1:], len(frames))
    return [
        replace(
            phone,
            start=float(frames[start] * HOP_S),
            end=float((frames[end - 1 if end > start else start] + (end > start)) * HOP_S),
        )
        for phone, start, end in zip(phones, bounds.tolist(), ends.tolist(), strict=True)
    ]


def _words(said: Speech, phones: Sequence[Phone], timed: Sequence[Phone]) -> tuple[Word, ...]:
    """Return the words with the times of their first and last phones."""
    starts = np.array([phone.start for phone in phones])
    words = []
    for index, word in enumerate(said.words):
        after = said.words[index + 1].start if index + 1 < len(said.words) else np.inf
        first, last = np.searchsorted(starts, (word.start - 1e-6, after - 1e-6)).tolist()
        if last > first:
            words.append(replace(word, start=timed[first].start, end=timed[last - 1].end))
    return tuple(words)
