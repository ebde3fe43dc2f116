"""How well a talk hears: `python -m tests.bench.listening [FOLDER] [--tuning]`.

Voices say lines of the bundled script, which its recogniser is made of, alone and with noise; then
what is not in it: other sentences by the same voices, silence, noise, and the recordings of people
in a folder, cut into parts of three seconds. Prints how many lines are heard right, wrong, and not
at all, and how often something is heard in what is not in the script.

Who judges is not who the thresholds were chosen with: voices, lines, other sentences and people are
split. With `--tuning` it is the other half, by eSpeak NG. The judging voices are those of Flite,
made of recordings of two people, where that is installed (apt-get install flite), or else other
ones of eSpeak NG.

A synthetic voice that reads the grammar's own lines is an upper bound: nobody hesitates, no room
echoes, and no child has lent the model its voice.

Exits with 1 if fewer than `MIN_RIGHT` of the lines without noise are right, or more than
`MAX_FALSE` of what is not in the script is heard as something.
"""

import argparse
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.scenarios.dialogue.scenario import BUNDLED_SCRIPT
from cubeling.app.scenarios.dialogue.vocabulary import TALK_VOCABULARY
from cubeling.characters.behaviour import phrases_of, read_script
from cubeling.characters.speech import (
    Manner,
    Samples,
    Speech,
    SpeechRecognizer,
    espeak,
    read_speech,
)
from cubeling.characters.speech.recognition import CARRIERS, SpokenPhrase
from cubeling.characters.speech.voices import Voice

MIN_RIGHT, MAX_FALSE = 0.75, 0.15
"""Least share of lines that are heard right, and greatest share of others that are heard."""

TUNING = {
    "en-us": ("en-us", Manner(rate=0.85)),
    "en-us, 3, high": ("en-us", Manner(rate=0.9, pitch=1.3, speaker=3)),
    "en-gb-x-rp, 1": ("en-gb-x-rp", Manner(rate=0.85, speaker=1)),
}
"""Language and manner of the voices with which the thresholds were chosen, by name."""

JUDGING = {
    "en-us, 2, high": ("en-us", Manner(rate=0.85, pitch=1.6, speaker=2)),
    "en-gb-scotland": ("en-gb-scotland", Manner(rate=0.85)),
    "en-029": ("en-029", Manner(rate=0.85)),
}
"""The same of those that judge where there is no Flite."""

FLITE = ("rms", "awb")
"""Voices of Flite: a man from the USA, and one from Scotland. A third one, slt, showed that phones
leave pauses within clear words, so that a right line may last much longer than what they take for
speech (`MAX_COVERAGE`): it does not judge."""

TUNING_PEOPLE = ("sense_and_sensibility", "english_")
"""How the names of the recordings begin with which the thresholds were chosen."""

NOISES_DB = (None, 20.0, 10.0)
"""Signal-to-noise ratios of white noise over the speech [dB]; None for none."""

OTHER_LINES = (
    "please pass me the salt and pepper", "the train leaves at half past nine",
    "my computer needs a new keyboard", "we bought shoes in the city yesterday",
    "the committee will vote on the budget", "turn left after the second traffic light",
    "interest rates are expected to rise", "he painted the kitchen wall yellow",
)  # fmt: skip

PART_S, QUIET_S = 3.0, 0.2
"""Length of the parts of recordings, and the silence around what a voice says [s]."""


def line_of(phrase: SpokenPhrase, rng: np.random.Generator) -> str:
    """Return one of the lines of a phrase; some with a carrier where it leaves that open."""
    words = [str(rng.choice(place)) for place in phrase.places if place]
    carried = phrase.opens and len(words) == 1 and rng.uniform() < 0.5
    return " ".join([*(str(rng.choice(CARRIERS)).split() if carried else ()), *words])


def spoken(voice: Voice, line: str, who: str) -> tuple[Samples, int]:
    """Return what a voice says, with silence around it, and its rate [Hz]."""
    for plain, written in (
        ("im", "I'm"),
        ("dont", "don't"),
        ("lets", "let's"),
        ("whats", "what's"),
    ):
        line = re.sub(rf"\b{plain}\b", written, line)
    speech = _by_flite(line, who) if who in FLITE else voice.say(line, *{**TUNING, **JUDGING}[who])
    return np.pad(speech.samples, round(QUIET_S * speech.rate)), speech.rate


def _by_flite(line: str, who: str) -> Speech:
    with TemporaryDirectory() as folder:
        path = Path(folder, "line.wav")
        subprocess.run(("flite", "-voice", who, "-t", line, "-o", str(path)), check=True)
        return read_speech(path)


def with_noise(sound: Samples, ratio_db: float | None, rng: np.random.Generator) -> Samples:
    """Return a sound with white noise."""
    if ratio_db is None:
        return sound
    level = float(np.sqrt((sound**2).mean())) / 10 ** (ratio_db / 20)
    return (sound + rng.normal(0.0, level, len(sound))).astype(np.float32)


def parts_of(folder: Path) -> Iterator[tuple[str, Samples, int]]:
    """Yield the parts of the recordings in a folder, with the name of each file."""
    for path in sorted(folder.rglob("*.wav")):
        speech = read_speech(path)
        length = round(PART_S * speech.rate)
        for start in range(0, len(speech.samples) - length // 2, length):
            yield path.name, speech.samples[start : start + length], speech.rate


def main() -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(description="Measure how well a talk hears.")
    parser.add_argument("folder", nargs="?", type=Path, help="recordings of people")
    parser.add_argument("--lines", type=int, default=40)
    parser.add_argument("--tuning", action="store_true", help="the half that is not the judge")
    parser.add_argument("--details", action="store_true", help="print what is heard wrong")
    wanted = parser.parse_args()
    rng, console = np.random.default_rng(1), Console()
    phrases = phrases_of(read_script(BUNDLED_SCRIPT, TALK_VOCABULARY), "en")
    half = 0 if wanted.tuning else 1
    judging = FLITE if shutil.which("flite") else tuple(JUDGING)
    voices = tuple(TUNING) if wanted.tuning else judging
    began = time.process_time()
    with espeak() as voice:
        recognizer = SpeechRecognizer(phrases, voice)
        made_s = time.process_time() - began
        chosen = rng.permutation(len(phrases))[half::2][: wanted.lines]
        lines = [line_of(phrases[k], rng) for k in chosen]
        said = [(who, line, *spoken(voice, line, who)) for who in voices for line in lines]
        others = [
            ("other sentences", line, *spoken(voice, line, who))
            for who in voices
            for line in OTHER_LINES[half::2]
        ]
    others += [
        ("silence", "", np.zeros(48_000, np.float32), 16_000),
        *(
            ("noise", "", rng.normal(0.0, level, 48_000).astype(np.float32), 16_000)
            for level in (0.001, 0.01, 0.1)
        ),
    ]
    if wanted.folder is not None:
        others += [
            ("people", name, *part)  # type: ignore[misc]
            for name, *part in parts_of(wanted.folder)
            if name.startswith(TUNING_PEOPLE) == wanted.tuning
        ]
    table = Table(
        "noise", "who", "lines", "right", "wrong", "not heard", title="lines of the script"
    )
    right_share, seconds, took = 1.0, 0.0, 0.0
    for ratio in NOISES_DB:
        counts: Counter[tuple[str, str]] = Counter()
        for who, line, sound, rate in said:
            began = time.process_time()
            found = recognizer.weigh(with_noise(sound, ratio, rng), rate)
            took += time.process_time() - began
            seconds += len(sound) / rate
            same = re.sub("favou?rite", "", found.text) == re.sub("favou?rite", "", line)
            what = "right" if same else "wrong"
            what = what if found.is_sure else "not heard"
            counts[who, what] += 1
            if wanted.details and what != "right":
                console.print(f"{ratio} {who}: {line} → {found}", markup=False)
        for who in voices:
            figures = [counts[who, what] for what in ("right", "wrong", "not heard")]
            name = "none" if ratio is None else f"{ratio:g} dB"
            table.add_row(name, who, f"{len(lines)}", *map(str, figures))
        if ratio is None:
            right_share = sum(counts[who, "right"] for who in voices) / len(said)
    heard: Counter[tuple[str, bool]] = Counter()
    for kind, line, sound, rate in others:
        found = recognizer.weigh(sound, rate)
        heard[kind, found.is_sure] += 1
        if wanted.details:
            console.print(f"{kind}: {line} → {found}", markup=False)
    beside = Table("what", "parts", "heard as something", title="what is not in the script")
    for kind in dict.fromkeys(kind for kind, *_ in others):
        false = heard[kind, True]
        beside.add_row(kind, f"{false + heard[kind, False]}", f"{false}")
    false_share = sum(n for (_, sure), n in heard.items() if sure) / len(others)
    console.print(table, beside)
    console.print(
        f"{right_share:.0%} of the lines without noise are right (at least {MIN_RIGHT:.0%}), "
        f"{false_share:.0%} of the others are heard as something (at most {MAX_FALSE:.0%}). "
        f"{len(phrases)} phrases, made in {made_s:.1f} s; a second of sound takes "
        f"{took / seconds:.2f} s of one core. Synthetic voices are an upper bound."
    )
    return 1 if right_share < MIN_RIGHT or false_share > MAX_FALSE else 0


if __name__ == "__main__":
    sys.exit(main())
