"""English speech to words by PocketSphinx, the extra `[listen]`, with a grammar of phrases.

Two decoders hear the same sound: one knows only the grammar, the other any sequence of phones. The
likelihood ratio of both says how well the phrase, and the worst of its words, explain the sound
(Rose and Paul, "A hidden Markov model based keyword recognition system", 1990): what is not in the
grammar has some word that does not fit.
"""

import math
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.audio import resample
from cubeling.characters.speech.phones import arpabet_of_ipa
from cubeling.characters.speech.speech import Samples
from cubeling.characters.speech.voices import Voice, VoiceError

RECOGNIZED_LANGUAGE = "en"
"""The language of the model in the package."""

RATE = 16_000
"""Sample rate of its model [Hz]."""

INSTALL = "pip install pocketsphinx"
"""Adds what the extra `[listen]` consists of, wherever Cubeling was installed from."""

MAX_HEARD_S = 10.0
"""Longest sound that is heard at once [s]; what is longer is cut."""

LEVEL, MAX_GAIN = 0.5, 20.0
"""Amplitude to which a sound is made louder, and the greatest factor: silence stays silence."""

LOUD_SHARE = 0.998
"""Share of the samples that are not louder than that: a click does not count."""

FRAME_S, QUIET_S = 0.02, 0.25
"""Length of a frame whose loudness is measured, and of the silence kept around speech [s]."""

OVER_NOISE, OVER_SILENCE = 2.0, 0.05
"""A frame of speech is louder than the quietest tenth by this factor, and than this share of the
loudest one."""

DITHER = 0.002
"""Amplitude of noise under all sounds: the model knows no digital silence, and hears "" in it."""

BEAM, WORD_BEAM = 1e-44, 1e-27
"""How much less likely a path is that is given up: wider beams take longer, and hear no more."""

MAX_DEFICIT, MAX_WORD_DEFICIT = 4.2, 5.0
"""Greatest `Hearing.deficit` of what was said, and that of its worst word; guarded by
`python -m tests.bench.listening`, which judges by other voices than they were chosen with."""

MIN_COVERAGE, MAX_COVERAGE = 0.8, 2.5
"""Least and greatest `Hearing.coverage` of it."""

CARRIERS = (
    "i like", "i love", "i like the", "i have a", "i want a", "i went to the", "i want to",
    "do you like", "do you like the", "do you know", "do you know a", "do you have a", "tell me",
    "tell me a", "tell me about", "tell me about the", "please tell me a", "what about",
    "what about the", "what is", "what is a", "what is the", "who is the", "which is the",
    "why are", "are there", "have you seen a", "can we talk about", "let's talk about",
)  # fmt: skip
"""What may be said before a phrase that leaves it open."""

CLOSINGS = ("please", "too", "dinosaurs")
"""What may be said after one. A loop of any words, or of phones, finds fewer lines, and takes eight
times as long."""

CARRIER_SHARE, CLOSING_SHARE = 0.1, 0.01
"""Probability of each of those before and after."""

SCORE_SHIFT = 1024
"""PocketSphinx divides its logarithms by this, so that they fit into an integer."""

_SILENCES = ("<sil>", "<s>", "</s>", "[NOISE]", "(NULL)", "SIL", "+NSN+", "+SPN+")

_NUMBERS = (
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
    "eleven", "twelve", "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen",
    "nineteen", "twenty",
)  # fmt: skip


@dataclass(frozen=True)
class SpokenPhrase:
    """Words that may be said, one after the other."""

    places: tuple[tuple[str, ...], ...]
    """The words of which each place has one; () where any words may stand."""

    opens: bool = False
    """Whether other words may come before."""

    closes: bool = False
    """Whether other words may come after."""


@dataclass(frozen=True)
class Hearing:
    """A phrase that a sound is most like."""

    text: str
    """Its words; "" for no word."""

    deficit: float
    """How much less likely it makes the sound than any phones, as a logarithm for each frame."""

    coverage: float
    """How long its words are, as a share of what sounds like speech."""

    worst: float = 0.0
    """The deficit of the word that fits worst."""

    @property
    def is_sure(self) -> bool:
        """Whether it was said."""
        return (
            bool(self.text)
            and self.deficit <= MAX_DEFICIT
            and self.worst <= MAX_WORD_DEFICIT
            and MIN_COVERAGE <= self.coverage <= MAX_COVERAGE
        )


NOTHING = Hearing("", 0.0, 0.0)


class _Segment(NamedTuple):
    word: str
    first: int
    last: int
    score: float

    @property
    def frames(self) -> int:
        return self.last - self.first + 1

    def score_within(self, other: "_Segment") -> float:
        """Return its share of the score in the frames of another one."""
        common = min(self.last, other.last) - max(self.first, other.first) + 1
        return self.score * max(common, 0) / self.frames


class _Decoded(NamedTuple):
    segments: tuple[_Segment, ...]
    score: float

    @property
    def spoken(self) -> list[_Segment]:
        return [each for each in self.segments if each.word not in _SILENCES]

    @property
    def frames(self) -> int:
        """Number of those that are no silence."""
        return sum(each.frames for each in self.spoken)


class SpeechRecognizer:
    """Hears which of some phrases was said. The same sound gives the same words.

    Not thread-safe. It takes a third of a second to make one.

    Parameters
    ----------
    phrases
        What can be heard.
    voice
        Pronounces words that the dictionary of PocketSphinx lacks; None to leave out what has any.

    Raises
    ------
    CharacterError
        PocketSphinx is not installed, or there is nothing to hear.
    """

    def __init__(self, phrases: Sequence[SpokenPhrase], voice: Voice | None = None) -> None:
        self._grammar = _decoder(beam=BEAM, pbeam=BEAM, wbeam=WORD_BEAM)
        words = {word for each in phrases for place in each.places for word in place}
        words |= {word for each in (*CARRIERS, *CLOSINGS) for word in each.split()}
        known = {word for word in sorted(words) if self._learn(word, voice)}
        usable = [replaced for each in phrases if (replaced := _of_known(each, known)) is not None]
        if not usable:
            raise CharacterError("there is no phrase that can be heard")
        self._read(_network(usable))
        model = _sphinx().get_model_path("en-us/en-us-phone.lm.bin")
        self._phones = _decoder(allphone=model, allphone_ci=True, lw=2.0, beam=1e-20, pbeam=1e-20)

    def hear(self, samples: Samples, rate: int) -> str:
        """Return the words of a phrase in a sound, (n,) at `rate` [Hz]; "" for none of them."""
        found = self.weigh(samples, rate)
        return found.text if found.is_sure else ""

    def weigh(self, samples: Samples, rate: int) -> Hearing:
        """Return the phrase that a sound is most like, and how well it explains the sound."""
        sound = spoken_part(resample(samples[: round(MAX_HEARD_S * rate)], rate, RATE))
        if not len(sound):
            return NOTHING
        loud = float(np.quantile(np.abs(sound), LOUD_SHARE))
        gain = min(MAX_GAIN, LEVEL / max(loud, 1e-9))
        noise = np.random.default_rng(0).normal(0.0, DITHER, len(sound))
        data = ((gain * sound + noise).clip(-1.0, 1.0) * 32767).astype("<i2").tobytes()
        heard = _decode(self._grammar, data)
        if heard is None or not heard.frames:
            return NOTHING
        free = _decode(self._phones, data, SCORE_SHIFT)
        if free is None or not free.frames:
            return NOTHING
        deficit = (free.score - heard.score) / free.frames
        worst = max(
            (sum(each.score_within(word) for each in free.segments) - word.score) / word.frames
            for word in heard.spoken
        )
        text = " ".join(each.word for each in heard.spoken)
        return Hearing(text, deficit, heard.frames / free.frames, worst)

    def _learn(self, word: str, voice: Voice | None) -> bool:
        """Let the dictionary know a word, with its other ways to say it; return whether it does."""
        decoder = self._grammar
        if word.isdecimal():
            if int(word) < len(_NUMBERS) and decoder.lookup_word(word) is None:
                decoder.add_word(word, decoder.lookup_word(_NUMBERS[int(word)]), False)
            return decoder.lookup_word(word) is not None
        said = next(filter(None, map(decoder.lookup_word, _contractions(word))), None)
        if said is not None:
            is_new = decoder.lookup_word(word) is None
            decoder.add_word(word if is_new else f"{word}(9)", said, False)
        elif decoder.lookup_word(word) is None and voice is not None:
            try:
                phones = voice.say(word, "en-us").phones
            except VoiceError:
                return False
            symbols = " ".join(a for phone in phones for a in arpabet_of_ipa(phone.symbol))
            if symbols:
                decoder.add_word(word, symbols, False)
        return decoder.lookup_word(word) is not None

    def _read(self, network: str) -> None:
        """Let the decoder follow a network; PocketSphinx reads it from a file only."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "phrases.fsg")
            path.write_text(network, encoding="utf-8")
            read = _sphinx().FsgModel.readfile(str(path), self._grammar.logmath, 6.5)
        self._grammar.add_fsg("phrases", read)
        self._grammar.activate_search("phrases")


def listening_problem() -> str:
    """Return why nothing can be recognised here, in one line; "" if it can."""
    try:
        _sphinx()
    except CharacterError as error:
        return str(error)
    return ""


def _sphinx() -> Any:
    try:
        import pocketsphinx
    except ImportError as error:
        raise CharacterError(
            f"PocketSphinx is not installed; install it with: {INSTALL}"
        ) from error
    return pocketsphinx


def _decoder(**settings: Any) -> Any:
    return _sphinx().Decoder(lm=None, loglevel="FATAL", **settings)


def spoken_part(sound: Samples) -> Samples:
    """Return a sound, (n,) at `RATE`, without the silence before and after what is loud in it.

    >>> sound = np.zeros(2 * RATE, np.float32)
    >>> sound[RATE : RATE + 1600] = 0.1
    >>> len(spoken_part(sound)) / RATE, len(spoken_part(sound[:RATE]))
    (0.6, 0)
    """
    length, kept = round(FRAME_S * RATE), round(QUIET_S * RATE)
    frames = sound[: len(sound) // length * length].reshape(-1, length)
    loudness = np.sqrt((frames**2).mean(1))
    if not loudness.max(initial=0.0):
        return sound[:0]
    least = max(OVER_NOISE * np.quantile(loudness, 0.1), OVER_SILENCE * loudness.max())
    loud = np.flatnonzero(loudness > least)
    if not len(loud):  # as loud throughout
        return sound
    return sound[max(loud[0] * length - kept, 0) : (loud[-1] + 1) * length + kept]


def _decode(decoder: Any, data: bytes, shift: float = 1.0) -> _Decoded | None:
    """Return the words of 16-bit samples and how likely their sound is, as logarithms.

    `shift` is by how much the decoder divides those of segments.
    """
    decoder.start_utt()
    decoder.process_raw(data, full_utt=True)
    decoder.end_utt()
    found = decoder.hyp()
    if found is None:
        return None
    segments = tuple(
        _Segment(
            each.word.partition("(")[0] or each.word,
            each.start_frame,
            each.end_frame,
            shift * math.log(max(each.ascore, 1e-300)),
        )
        for each in decoder.seg()
    )
    return _Decoded(segments, SCORE_SHIFT * math.log(max(found.score, 1e-300)))


def _contractions(word: str) -> Iterator[str]:
    """Yield what a word without its apostrophe may be.

    >>> list(_contractions("dont"))
    ["don't", "do'nt"]
    """
    if len(word) > 1:
        yield f"{word[:-1]}'{word[-1]}"
    if len(word) > 2:
        yield f"{word[:-2]}'{word[-2:]}"


def _of_known(phrase: SpokenPhrase, known: set[str]) -> SpokenPhrase | None:
    """Return a phrase with the words that are known; None if a place has none left."""
    places = tuple(tuple(w for w in place if w in known) for place in phrase.places)
    if any(before and not after for before, after in zip(phrase.places, places, strict=True)):
        return None
    return SpokenPhrase(places, phrase.opens, phrase.closes) if any(places) else None


def _network(phrases: Sequence[SpokenPhrase]) -> str:
    """Return the finite state grammar of phrases: from a state to another with a word each."""
    start, before, after, end, count = 0, 1, 2, 3, 4
    arcs: list[tuple[int, int, float, str]] = []

    def join(begin: int, target: int, places: Sequence[tuple[str, ...]], share: float) -> None:
        """Lead from a state to another by words, one of each place."""
        nonlocal count
        state = begin
        for number, place in enumerate(places):
            following = count if number < len(places) - 1 else target
            count += following == count
            for word in place:
                arcs.append((state, following, share / len(place), word))
            state, share = following, 1.0

    arcs += [(start, before, 1.0, ""), (after, end, 1.0, "")]
    for state, target, said, share in (
        (start, before, CARRIERS, CARRIER_SHARE),
        (after, end, CLOSINGS, CLOSING_SHARE),
    ):
        for each in said:
            join(state, target, [(word,) for word in each.split()], share)
    for phrase in phrases:
        places = [place for place in phrase.places if place]
        join(before if phrase.opens else start, after if phrase.closes else end, places, 1.0)
    lines = [f"TRANSITION {a} {b} {share:g} {word}".rstrip() for a, b, share, word in arcs]
    head = ["FSG_BEGIN phrases", f"NUM_STATES {count}", f"START_STATE {start}"]
    return "\n".join([*head, f"FINAL_STATE {end}", *lines, "FSG_END", ""])
