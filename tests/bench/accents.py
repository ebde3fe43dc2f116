"""Whether pitch accents are found that are known by construction: `python -m tests.bench.accents`.

bursts
    Buzzing sounds of one to three syllables with unvoiced noise or silence in between; some
    syllables are higher by 4 to 8 semitones and louder by 6 to 12 dB at known times, the others by
    up to one semitone.
resynthesis
    Texts spoken by eSpeak NG with its own intonation, compressed to 3 semitones; chosen vowels, of
    stressed and other syllables (so phones are told without stress), are raised by 5 to 8 semitones
    and 4 to 7 dB, by Praat's overlap-add (parselmouth). The truth is the time of the highest pitch.
emphasis
    Texts spoken by eSpeak NG with chosen words in `<prosody pitch volume>`, the others in a small
    range but as loud as ever. Every syllable of a chosen word is emphasised, so that any accent in
    it is right, and one is enough.

telephone
    The resynthesis from 300 to 3400 Hz, at 8 kHz, with noise 15 dB below it.

Of the others, an accent is right within 50 ms of a true one, each once. "phones" says whether the
detector was told them. The default threshold finds what people hear in running speech, which is
more than these emphasised syllables; loudness alone makes half of the strength, so that 0.5 finds
loud words, too, and the stricter threshold the emphasised ones only. Exits with 1 if the F1 of
bursts or resynthesis at 0.5, or of emphasis at the stricter one, is below 0.95.
"""

import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import parselmouth
from numpy.typing import NDArray
from parselmouth.praat import call
from rich.console import Console
from rich.table import Table

from cubeling.characters.speech.alignment import align
from cubeling.characters.speech.audio import read_speech
from cubeling.characters.speech.phones import is_vowel
from cubeling.characters.speech.prosody.accents import AccentSettings, detect_accents
from cubeling.characters.speech.prosody.contours import measure_prosody
from cubeling.characters.speech.prosody.strength import AccentMeasures, ev, ev2, matthews, psi
from cubeling.characters.speech.speech import Phone, Samples, Speech
from cubeling.characters.speech.voices import Voice, espeak

RATE = 16_000
TOLERANCE_S = 0.05
TWICE_S = 2 * TOLERANCE_S + 1e-9
MIN_F1 = 0.95
MIN_RAISED = 3.0
"""Accents of bursts are raised by more [semitones]."""

STRICTER = 0.65
Case = tuple[Speech, list[tuple[float, float]]]
"""A speech, and the earliest and the latest time of each of its accents [s]."""

TEXTS = {
    "en-us": (
        "The man who lives beside the river never sells his boat to a stranger.",
        "Tomorrow morning we are going to move the piano into the other room.",
        "My little brother wanted a yellow bicycle for his birthday.",
        "Nobody remembers when the old library was built on the hill.",
        "The children were running around the garden all afternoon.",
        "You will need seven lemons and a large bowl of warm water.",
    ),
    "es": (
        "La niña de mi vecina lleva una mochila verde al colegio.",
        "Mañana por la mañana vamos a mover el piano a otra habitación.",
        "Nadie recuerda cuándo levantaron la vieja biblioteca en la colina.",
    ),
    "ca": (
        "El meu germà petit volia una bicicleta groga per al seu aniversari.",
        "Demà al matí anirem a la platja amb els nens de la veïna.",
    ),
    "de": (
        "Meine Nachbarin verkauft ihr altes Boot niemals an einen Fremden.",
        "Morgen wollen wir das Klavier in das andere Zimmer bringen.",
    ),
}


def main() -> int:
    """Print the tables and return an exit code."""
    console = Console(width=100)
    table = Table(title="pitch accents within 50 ms")
    for heading in (
        "speech",
        "phones",
        "threshold",
        "accents",
        "found",
        "precision",
        "recall",
        "F1",
    ):
        table.add_column(heading, justify="left" if heading == "speech" else "right")
    good = True
    with espeak() as voice:
        sets = {
            "bursts": list(bursts(np.random.default_rng(1), 60)),
            "resynthesis": list(resynthesised(voice, np.random.default_rng(2))),
            "telephone": [],
            "emphasis": list(emphasised(voice, np.random.default_rng(3))),
        }
    sets["telephone"] = [
        (telephoned(speech, np.random.default_rng(n)), true)
        for n, (speech, true) in enumerate(sets["resynthesis"])
    ]
    for name, told, threshold, decides in (
        ("bursts", False, 0.5, True),
        ("resynthesis", False, 0.5, True),
        ("resynthesis", True, 0.5, True),
        ("telephone", False, 0.5, False),
        ("resynthesis", True, AccentSettings().threshold, False),
        ("emphasis", True, 0.5, False),
        ("emphasis", False, STRICTER, True),
        ("emphasis", True, STRICTER, True),
    ):
        counted = counts(sets[name], told, threshold)
        true, found, hit, right = (sum(each) for each in zip(*counted, strict=True))
        precision, recall = right / max(found, 1), hit / max(true, 1)
        f1 = 2 * precision * recall / max(precision + recall, 1e-9)
        good &= f1 >= MIN_F1 or not decides
        row = (f"{precision:.3f}", f"{recall:.3f}", f"{f1:.3f}")
        table.add_row(
            name, "yes" if told else "no", f"{threshold:g}", *map(str, (true, found)), *row
        )
    console.print(table)
    table = Table(title="weak and strong accents, labelled by construction: MCC")
    for name in ("PSI", "EV2", "EV"):
        table.add_column(name, justify="right")
    scores = strengths(np.random.default_rng(4))
    table.add_row(*(f"{score:.3f}" for score in scores))
    console.print(table)
    return int(not (good and scores[0] > scores[1] > scores[2]))


def counts(
    cases: Sequence[Case], told: bool, threshold: float
) -> Iterator[tuple[int, int, int, int]]:
    """Yield the accents of each speech, the found ones, the true ones hit, and the right ones."""
    settings = AccentSettings(threshold)
    for speech, true in cases:
        phones = speech.phones if told else ()
        accents = detect_accents(speech.samples, speech.rate, settings, phones)
        found = [accent.time for accent in accents]
        hit = matched(true, found)
        in_words = [t for t in found if any(a <= t <= b for a, b in true if b - a > TWICE_S)]
        yield len(true), len(found), hit, max(hit, len(in_words))


def matched(true: Sequence[tuple[float, float]], found: Sequence[float]) -> int:
    """Return how many accents are found, each by one of its own, from the first to the last."""
    hit, after = 0, 0
    for start, end in sorted(true):
        for index in range(after, len(found)):
            if start <= found[index] <= end:
                hit, after = hit + 1, index + 1
                break
    return hit


def bursts(random: np.random.Generator, count: int) -> Iterator[Case]:
    """Yield buzzing sounds with known peaks of pitch and intensity."""
    for _ in range(count):
        base, noise = random.uniform(90, 220), random.uniform(0.0, 0.004)
        times, levels, raised, gaps = [], [], [], []
        at, quiet = 0.3, 2
        for _ in range(14):
            accented = quiet >= 2 and random.random() < 0.5  # accents are at least 0.36 s apart
            quiet = 0 if accented else quiet + 1
            times.append(at)
            raised.append(random.uniform(4, 8) if accented else random.uniform(0.0, 1.0))
            levels.append(random.uniform(-2, 0) if accented else random.uniform(-12, -8))
            gaps.append(random.random() < 0.5)  # a syllable is its own voiced region
            at += random.uniform(0.18, 0.26)
        if max(raised) < MIN_RAISED:
            continue
        sound = buzz(at + 0.2, base, times, levels, raised, gaps)
        sound += random.normal(0.0, noise + 1e-5, len(sound))
        true = [around(t) for t, r in zip(times, raised, strict=True) if r > MIN_RAISED]
        yield Speech(sound.astype(np.float32), RATE), true


def buzz(
    duration: float,
    base: float,
    times: Sequence[float],
    levels: Sequence[float],
    raised: Sequence[float],
    gaps: Sequence[bool],
) -> NDArray[np.float64]:
    """Return syllables of harmonics: Gaussian peaks of level [dB] and pitch [semitones]."""
    t = np.arange(round(duration * RATE)) / RATE
    semitones, amplitude, open_glottis = np.zeros(len(t)), np.zeros(len(t)), np.ones(len(t))
    for time, level, raise_by, gap in zip(times, levels, raised, gaps, strict=True):
        semitones += raise_by * np.exp(-(((t - time) / 0.06) ** 2) / 2)
        peak = 10 ** (level / 20) * np.exp(-(((t - time) / 0.05) ** 2) / 2)
        amplitude = np.maximum(amplitude, peak)
        if gap:
            open_glottis[np.abs(t - time - 0.1) < 0.025] = 0.0
    phase = 2 * np.pi * np.cumsum(base * 2 ** (semitones / 12)) / RATE
    tone = sum(np.sin(k * phase) / k for k in range(1, 12))
    return np.asarray(0.3 * tone * amplitude * open_glottis)


def chosen_vowels(speech: Speech, random: np.random.Generator) -> list[Phone]:
    """Return vowels at least 0.4 s apart, about one in three."""
    chosen: list[Phone] = []
    vowels = [p for p in speech.phones if is_vowel(p.symbol) and p.end - p.start >= 0.05]
    for vowel in vowels[int(random.integers(3)) :]:
        if (not chosen or vowel.start - chosen[-1].start >= 0.4) and random.random() < 0.6:
            chosen.append(vowel)
    return chosen or vowels[:1]


def resynthesised(voice: Voice, random: np.random.Generator) -> Iterator[Case]:
    """Yield spoken texts with raised vowels."""
    for language, texts in TEXTS.items():
        for text in texts:
            said = voice.say(text, language)
            speech = replace(said, phones=tuple(replace(p, stressed=None) for p in said.phones))
            for _ in range(2):
                yield raised_vowels(speech, chosen_vowels(speech, random), random)


def raised_vowels(speech: Speech, vowels: Sequence[Phone], random: np.random.Generator) -> Case:
    """Return a speech whose pitch and level peak in the middle of vowels."""
    middles = [(p.start + p.end) / 2 for p in vowels]
    sound = parselmouth.Sound(speech.samples.astype(float), speech.rate)
    manipulation = call(sound, "To Manipulation", 0.01, 60, 500)
    tier = call(manipulation, "Extract pitch tier")
    prosody = measure_prosody(speech.samples, speech.rate)
    voiced = prosody.f0 > 0
    pitch = 12 * np.log2(prosody.f0[voiced])
    centre = float(np.median(pitch))
    own = centre + (pitch - centre) * min(1.0, 3.0 / max(float(np.ptp(pitch)), 1e-3))
    times = np.arange(len(speech.samples)) / speech.rate
    gain = np.zeros(len(times))
    for middle in middles:
        own += random.uniform(5, 8) * np.exp(-(((prosody.times[voiced] - middle) / 0.07) ** 2) / 2)
        gain += random.uniform(4, 7) * np.exp(-(((times - middle) / 0.07) ** 2) / 2)
    call(tier, "Remove points between", 0, speech.duration)
    for time, value in zip(prosody.times[voiced], own, strict=True):
        call(tier, "Add point", float(time), float(2 ** (value / 12)))
    call([manipulation, tier], "Replace pitch tier")
    made = call(manipulation, "Get resynthesis (overlap-add)").values[0][: len(times)]
    made = made * 10 ** (gain[: len(made)] / 20)
    made = (made / np.abs(made).max() * 0.9).astype(np.float32)
    return replace(speech, samples=made), [around(middle) for middle in middles]


def emphasised(voice: Voice, random: np.random.Generator) -> Iterator[Case]:
    """Yield texts whose chosen words eSpeak NG emphasises."""
    for language, texts in TEXTS.items():
        for text in texts:
            words = text.split()
            long = [n for n, word in enumerate(words) if len(word) > 4]
            first = int(random.integers(2))
            chosen = set(long[first::2])
            spoken, rate = spoken_ssml(words, chosen, language)
            plain = align(Speech(spoken, rate), text, voice, language)
            true = [plain.words[n] for n in sorted(chosen)]
            yield plain, [around(word.start, word.end) for word in true]


def spoken_ssml(words: Sequence[str], chosen: set[int], language: str) -> tuple[Samples, int]:
    """Return what the program espeak-ng makes of words, some of them emphasised."""
    marked = " ".join(
        f'<prosody pitch="+60%" volume="+6dB">{word}</prosody>' if n in chosen else word
        for n, word in enumerate(words)
    )
    command = ["espeak-ng", "-v", language, "-m", "-p", "35", "--stdout"]
    ssml = f'<speak><prosody range="20%">{marked}</prosody></speak>'
    made = subprocess.run(
        command, input=ssml.encode(), capture_output=True, check=True, timeout=60
    ).stdout
    with tempfile.NamedTemporaryFile(suffix=".wav") as file:
        file.write(made)
        file.flush()
        speech = read_speech(Path(file.name))
    return speech.samples, speech.rate


def telephoned(speech: Speech, random: np.random.Generator) -> Speech:
    """Return a speech as a telephone lets it through, with noise 15 dB below it."""
    count, rate = len(speech.samples), 8000
    keep = int(count * rate / speech.rate)
    spectra = [np.fft.rfft(each) for each in (speech.samples, random.normal(0.0, 1.0, count))]
    frequencies = np.fft.rfftfreq(count, 1 / speech.rate)
    band = (frequencies > 300) & (frequencies < 3400)
    own, noise = (
        np.fft.irfft((spectrum * band)[: keep // 2 + 1], keep) * keep / count
        for spectrum in spectra
    )
    noise *= np.sqrt(np.mean(own**2) / np.mean(noise**2)) * 10 ** (-15 / 20)
    return replace(speech, samples=(own + noise).astype(np.float32), rate=rate)


def around(start: float, end: float | None = None) -> tuple[float, float]:
    """Return the earliest and the latest time at which an accent is right."""
    return start - TOLERANCE_S, (start if end is None else end) + TOLERANCE_S


def strengths(random: np.random.Generator, count: int = 1000) -> tuple[float, ...]:
    """Return the MCC of PSI, EV2 and EV on accents that are labelled by construction.

    Strong accents are longer, louder and either rise or, every fourth, stay flat and high.
    """
    strong = random.random(count) < 0.5
    flat = random.random(count) < 0.25
    wide, high = strong & ~flat, strong & flat
    noise = random.normal(0.0, 1.0, (4, count))
    measures = AccentMeasures(
        np.exp(np.log(0.09) + 0.25 * strong + 0.25 * noise[0]),
        np.exp(np.log(0.01) + 0.7 * strong + 0.5 * noise[1]),
        (2.0 + 3.0 * wide - 1.0 * high + 1.0 * noise[2]).clip(0.0),
        85.0 + 1.0 * wide + 5.0 * high + 1.5 * noise[3],
    )
    return tuple(best_matthews(score(measures), strong) for score in (psi, ev2, ev))


def best_matthews(scores: NDArray[np.float64], strong: NDArray[np.bool_]) -> float:
    """Return the MCC at the threshold that separates best."""
    thresholds = np.quantile(scores, np.linspace(0.05, 0.95, 91))
    return max(matthews(strong, scores > threshold) for threshold in thresholds)


if __name__ == "__main__":
    sys.exit(main())
