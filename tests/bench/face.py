"""How well the faces speak: `python -m tests.bench.face`.

Gaps are those of the meshes' lips, in frames of 30 Hz.

closed lips, teeth on lip
    Of every p, b, m and f, v, the frame with the smallest gap; the worst of them, in parts of the
    gap of an open mouth, in syllables of all contacts and five vowels; also with a happy face
    ("smiling"), and by dominance alone ("plain").
offset
    Lag of the mouth behind the loudness of a voice at which they correlate most, negative if the
    mouth is ahead; and after a speech has cut in on another.
jump
    Largest change of the gap in a frame, after a cut and in a speech that is not cut.
a frame
    Median time of the face layer of a happy face, speaking and silent; the bar is for the speech:
    mouth, brows and their composition with the expression.
phones
    Symbols of a voice in many languages, and how many of them have no viseme.

Exits with 1 if a bar of issue 16 is missed: 2 %, one frame, 0.05 ms.
"""

import sys
import time
import unicodedata
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.affect import Emotion
from cubeling.characters import Animator, Character, CharacterCommand, Pose
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.control.layers import FrameContext
from cubeling.characters.control.layers.face import FaceLayer
from cubeling.characters.face.speech_display import SpeechDisplay
from cubeling.characters.face.visemes.coarticulation import DEFAULT, Coarticulation, MouthTrack
from cubeling.characters.face.visemes.sets import MOUTH_SHAPES, viseme_set
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.speech.speech import SILENCE, Phone, Speech, Utterance
from cubeling.characters.speech.voices import Voice, VoiceError, espeak
from tests.characters.face.mouths import MeasuredMouth

FRAME_RATE = 30.0
RATES = 4.0, 6.0, 8.0
VOWELS = "ɑ", "i", "u", "ɛ", "ɔ"
LIPS, TEETH = ("p", "b", "m"), ("f", "v")
MAX_GAP, MAX_OFFSET_S, MAX_FRAME_MS = 0.02, 1 / FRAME_RATE, 0.05
TEXTS = {
    "en": "The quick brown fox jumps over the lazy dog. Fifty-five mamas bought a puppet show.",
    "es": "Buenos días, ¿cómo está usted? Mi mamá vive en Barcelona y me espera.",
    "ca": "Bon dia a tothom, avui parlem de la ciutat de Barcelona i dels seus barris.",
    "de": "Guten Morgen, ich möchte bitte ein Brötchen mit Butter und Honig.",
    "fr": "Bonjour, je voudrais un bon vin blanc pour mes amis de la montagne.",
    "it": "Buongiorno, la mamma prepara gli gnocchi e il papà mangia la pizza.",
    "ja": "こんにちは、きょうはてんきがいいですね。",
    "cmn": "你好，今天天气很好。女儿去学校吃饭，知识，自己。",
    "ar": "مرحبا بالعالم، كيف حالك اليوم؟ صباح الخير، ضوء، قلب.",
    "hi": "नमस्ते, आप कैसे हैं? भारत बहुत बड़ा देश है। धन्यवाद, ठंडा, फूल।",
    "ru": "Здравствуйте, как ваши дела? Жизнь хороша, щука, чай, мышь.",
    "pt": "Olá, não há pão, coração, filho, manhã.",
    "pl": "W Szczebrzeszynie chrząszcz brzmi w trzcinie.",
    "tr": "Günaydın, nasılsınız, çocuk?",
    "fi": "Hyvää päivää, yö on pimeä.",
    "nl": "Goedemorgen, Scheveningen, een huis.",
    "sv": "Sju sjösjuka sjömän sköttes av sköna.",
    "vi": "Xin chào bạn khỏe không.",
}
ALOUD = "en", "es", "ca", "de"
"""Languages in which offset is measured."""


def syllables(rate: float) -> Utterance:
    """Return all contacts between all vowels, so many phones a second."""
    symbols = [s for contact in (*LIPS, *TEETH) for vowel in VOWELS for s in (vowel, contact)]
    phones = tuple(Phone(s, n / rate, (n + 1) / rate) for n, s in enumerate(symbols))
    return Utterance("", "", len(symbols) / rate, phones=phones)


def spoken(speech: Speech) -> Utterance:
    """Return what a face needs of a speech."""
    return Utterance(speech.text, speech.language, speech.duration, speech.words, speech.phones)


def weights(
    character: Character, said: Sequence[SpeechIntent], end: float, emotion: Emotion | None = None
) -> tuple[Array, Array]:
    """Return frame times [s], and the morph weights that are shown, (frames, morphs)."""
    animator = Animator(character)
    times = np.arange(-0.5, end, 1 / FRAME_RATE)
    rows = []
    for now in times.tolist():
        speech = next((intent for intent in reversed(said) if intent.start - 0.1 <= now), None)
        posed = animator.update(CharacterCommand(now, speech=speech, emotion=emotion))
        rows.append(
            np.zeros(len(character.morphs)) if posed.pose.morphs is None else posed.pose.morphs
        )
    return times, np.array(rows)


def plain_weights(character: Character, said: Utterance, times: Array) -> Array:
    """Return the weights that dominance alone gives, (frames, morphs)."""
    display = SpeechDisplay(character.morphs, 0, Coarticulation(sharpness=1.0, contacts=False))
    rows = []
    for now in times.tolist():
        display.update(1 / FRAME_RATE, said, 0.0, now, 0.0)
        row = np.zeros(len(character.morphs))
        display.apply(row, 0.0)
        rows.append(row)
    return np.array(rows)


def worst(phones: Sequence[Phone], symbols: Sequence[str], times: Array, gaps: Array) -> float:
    """Return the largest, over phones, of their smallest gap."""
    found = []
    for phone in phones:
        within = (times >= phone.start) & (times < phone.end)
        if phone.symbol in symbols and within.any():
            found.append(float(gaps[within].min()))
    return max(found)


def closures(character: Character, mouth: MeasuredMouth) -> list[tuple[str, float, float]]:
    """Return, for each case, the worst gap of lips and of teeth, in parts of an open mouth."""
    opened = np.zeros(len(character.morphs))
    opened[character.morphs.index("viseme_aa")] = 1.0
    widest = float(mouth.gap(opened))
    cases = []
    for rate in RATES:
        said = syllables(rate)
        for name, emotion in (("", None), (" smiling", Emotion(0.7, 0.6, "happy"))):
            times, shown = weights(character, [SpeechIntent(said, 0.0)], said.duration, emotion)
            cases.append((f"{rate:.0f} phones/s{name}", times, shown, said))
        cases.append(
            (f"{rate:.0f} phones/s plain", times, plain_weights(character, said, times), said)
        )
    return [
        (
            name,
            worst(said.phones, LIPS, times, mouth.gap(shown)) / widest,
            worst(said.phones, TEETH, times, mouth.teeth_over_lip(shown)) / widest,
        )
        for name, times, shown, said in cases
    ]


def loudness(speech: Speech, times: Array) -> Array:
    """Return the loudness of a speech around times [s], as the square root of its amplitude."""
    half = int(0.02 * speech.rate)
    level = np.convolve(np.abs(speech.samples), np.ones(2 * half) / (2 * half), "same")
    return np.asarray(np.sqrt(np.interp(times, np.arange(len(level)) / speech.rate, level, 0, 0)))


def offset(opening: Array, times: Array, speech: Speech, start: float) -> tuple[float, float]:
    """Return the lag of the mouth [s] at which it correlates most with the sound, and how much."""
    lags = np.arange(-0.2, 0.2001, 0.005)
    within = (times > start + 0.1) & (times < start + speech.duration)
    found = [
        np.corrcoef(opening[within], loudness(speech, times[within] - start - lag))[0, 1]
        for lag in lags.tolist()
    ]
    return float(lags[int(np.argmax(found))]), float(np.max(found))


def jaw_openings(said: Sequence[tuple[Utterance, float]], times: Array) -> Array:
    """Return how far the mouth is open at times [s] of a fine grid, (times,)."""
    display = SpeechDisplay([f"viseme_{shape}" for shape in MOUTH_SHAPES], 0)
    rows = []
    for now in times.tolist():
        utterance, start = next((each for each in reversed(said) if each[1] <= now), (None, 0.0))
        display.update(float(times[1] - times[0]), utterance, start, now, 0.0)
        rows.append(display.opening)
    return np.array(rows)


class TimedFace(FaceLayer):
    """A face layer that knows how long it took."""

    spent: ClassVar[list[float]] = []
    """Of every frame of every one of them [s]."""

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with lids, expression and mouth."""
        start = time.perf_counter()
        shown = super().update(pose, context)
        self.spent.append(time.perf_counter() - start)
        return shown


def frame_time(character: Character, said: Utterance | None) -> float:
    """Return the median time of the face layer on one frame [ms]."""
    animator = Animator(character, layers=(TimedFace,))
    intent = None if said is None else SpeechIntent(said, 0.0)
    TimedFace.spent.clear()
    for now in np.arange(0.0, 8.0, 1 / 60).tolist():
        animator.update(CharacterCommand(now, speech=intent, emotion=Emotion(0.7, 0.6, "happy")))
    return 1e3 * float(np.median(TimedFace.spent))


def report_closures(console: Console) -> bool:
    """Print how well lips and teeth meet, and return whether it is good."""
    table = Table(title="contacts, in parts of an open mouth")
    for heading in ("who", "how", "p b m", "f v"):
        table.add_column(heading, justify="right" if heading in ("p b m", "f v") else "left")
    good = True
    for name in ("human", "vleo"):
        character = Character.load(name)
        for how, lips, teeth in closures(character, MeasuredMouth.of(character)):
            table.add_row(name, how, f"{100 * lips:.1f} %", f"{100 * teeth:.1f} %")
            good &= "plain" in how or max(lips, teeth) <= MAX_GAP
    console.print(table)
    return good


def report_time(console: Console) -> bool:
    """Print the time of a frame, and return whether it is good."""
    character = Character.load("human")
    silent, speaking = frame_time(character, None), frame_time(character, syllables(6.0))
    console.print(
        f"a frame: {speaking:.3f} ms speaking, {silent:.3f} ms silent: the speech takes "
        f"{speaking - silent:.3f} ms"
    )
    track, count = MouthTrack(syllables(6.0), DEFAULT), 3000
    start = time.perf_counter()
    sums = [track.at(8.0 * number / count).sum() for number in range(count)]
    each = 1e3 * (time.perf_counter() - start) / count
    console.print(f"the mouth alone: {each:.3f} ms; weights sum to 1 ± {np.ptp(sums):.0e}")
    return speaking - silent <= MAX_FRAME_MS


def report_offsets(console: Console, voice: Voice) -> bool:
    """Print how well mouth and sound agree, and return whether they do."""
    table = Table(title="mouth and sound")
    for heading in ("language", "offset", "correlation", "after a cut", "jump", "jump after a cut"):
        table.add_column(heading, justify="left" if heading == "language" else "right")
    good = True
    for language in ALOUD:
        speech = voice.say(TEXTS[language], language)
        said, cut = spoken(speech), 0.45 * speech.duration
        times = np.arange(0.0, cut + speech.duration, 0.005)
        alone = jaw_openings([(said, 0.0)], times)
        after = jaw_openings([(said, 0.0), (said, cut)], times)
        lag, likeness = offset(alone, times, speech, 0.0)
        lag_after, _ = offset(after, times, speech, cut)
        step = round(1 / FRAME_RATE / 0.005)
        jumps = [np.abs(row[step:] - row[:-step]).max() for row in (alone, after)]
        table.add_row(
            language,
            f"{1000 * lag:+.0f} ms",
            f"{likeness:.2f}",
            f"{1000 * lag_after:+.0f} ms",
            f"{jumps[0]:.2f}",
            f"{jumps[1]:.2f}",
        )
        good &= max(abs(lag), abs(lag_after)) <= MAX_OFFSET_S + 1e-9
    console.print(table)
    return good


def report_phones(console: Console, voice: Voice) -> bool:
    """Print the phones of many languages without a viseme, and return whether there are none."""
    found = viseme_set(DEFAULT.visemes)
    symbols: set[str] = set()
    spoken_languages = []
    for language, text in TEXTS.items():
        try:
            symbols |= {phone.symbol for phone in voice.say(text, language).phones}
            spoken_languages.append(language)
        except VoiceError as error:
            console.print(str(error))
    without = sorted(s for s in symbols - {SILENCE} if not found.of(s))
    console.print(
        f"{len(symbols)} phones of {len(spoken_languages)} languages, without a viseme: "
        f"{' '.join(without) or 'none'}",
        markup=False,
    )
    return all(symbol.startswith("(") or _is_mark(symbol) for symbol in without)


def _is_mark(symbol: str) -> bool:
    """Return whether a symbol is a mark that belongs to the letter before it."""
    return all(unicodedata.category(letter) in ("Lm", "Mn", "Sk", "Po") for letter in symbol)


def main() -> int:
    """Print the tables and return an exit code."""
    console = Console(width=110)
    good = report_closures(console)
    good &= report_time(console)
    try:
        with espeak() as voice:
            good &= report_offsets(console, voice)
            good &= report_phones(console, voice)
    except VoiceError as error:
        console.print(f"{error}: nothing is heard")
    return int(not good)


if __name__ == "__main__":
    sys.exit(main())
