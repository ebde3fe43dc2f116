"""Times of phones and words beside hand labels: `python -m tests.bench.alignment`.

Recordings with phone labels in `shared/data/speech`, aligned with their texts by warping onto
eSpeak NG, and by PocketSphinx. A boundary counts where the phones on both of its sides match; the
phones of label and voice are matched by a cheapest edit of one sequence into the other, as voices
and labellers differ ("ɚ" or "ə ɹ"). "matched" is the number of such boundaries.

The recordings of PocketSphinx's tests have no labels: there, warping is beside PocketSphinx.

Exits with 1 if the median of all boundaries exceeds 25 ms by warping, or 15 ms by PocketSphinx.
"""

import itertools
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters.speech.alignment import align, align_with_sphinx
from cubeling.characters.speech.audio import read_speech
from cubeling.characters.speech.phones import fill_pauses, ipa_of_arpabet, sound_class
from cubeling.characters.speech.speech import SILENCE, Phone, Speech, Word
from cubeling.characters.speech.textgrid import read_textgrid, with_textgrid
from cubeling.characters.speech.voices import Voice, espeak

RECORDINGS = Path(__file__).parents[3] / "shared" / "data" / "speech"
MAX_WARPING_MS, MAX_SPHINX_MS = 25.0, 15.0
OMITTED = 0.8
"""Cost of a phone that only one sequence has; a phone of the same class instead costs 0.5."""

ARCTIC_TEXT = "He turned sharply, and faced Gregson across the table."
Aligner = Callable[[Speech, str, Voice], Speech]


def labelled() -> Iterator[tuple[str, Speech]]:
    """Yield recordings with their text and hand labels."""
    folder = RECORDINGS / "praatio"
    grid = read_textgrid(folder / "mary.TextGrid")
    yield "mary", with_textgrid(read_speech(folder / "mary.wav"), grid)
    bobby = read_speech(folder / "bobby.wav")
    phones = with_textgrid(bobby, read_textgrid(folder / "bobby_phones.TextGrid")).phones
    words = with_textgrid(bobby, read_textgrid(folder / "bobby_words.TextGrid"))
    yield "bobby", replace(words, phones=phones)
    arctic = read_speech(RECORDINGS / "cmu_arctic" / "arctic_a0009.wav")
    labels = RECORDINGS / "cmu_arctic" / "arctic_a0009_phone.lab"
    phones = fill_pauses(list(arctic_phones(labels)), arctic.duration)
    yield "arctic_a0009", replace(arctic, text=ARCTIC_TEXT, phones=phones)


def arctic_phones(path: Path) -> Iterator[Phone]:
    """Yield the phones of a full-context label of HTS, in units of 100 ns."""
    for line in path.read_text().splitlines():
        start, end, context = line.split()
        found = re.search(r"-(\w+)\+", context)
        symbol = found[1] if found else "sil"
        ipa = SILENCE if symbol in ("sil", "pau") else ipa_of_arpabet(symbol)
        yield Phone(ipa, int(start) / 1e7, int(end) / 1e7)


def unlabelled() -> Iterator[tuple[str, Speech]]:
    """Yield recordings with their text."""
    folder = RECORDINGS / "librivox_pocketsphinx"
    for line in (folder / "transcription").read_text().splitlines():
        found = re.fullmatch(r"<s> (.*) </s> \((.*)\)", line)
        assert found is not None
        yield found[2][-4:], replace(read_speech(folder / f"{found[2]}.wav"), text=found[1])


def phone_errors(truth: Sequence[Phone], made: Sequence[Phone]) -> list[float]:
    """Return how much later each matched boundary is than in truth [s]."""
    pairs = matched(truth, made)
    return [
        made[d].start - truth[c].start
        for (a, b), (c, d) in itertools.pairwise(pairs)
        if c == a + 1 and d == b + 1
    ]


def word_errors(truth: Sequence[Word], made: Sequence[Word]) -> list[float]:
    """Return how much later each word begins and ends than in truth [s]."""
    if len(truth) != len(made):
        return []
    pairs = zip(truth, made, strict=True)
    return [error for a, b in pairs for error in (b.start - a.start, b.end - a.end)]


def matched(truth: Sequence[Phone], made: Sequence[Phone]) -> list[tuple[int, int]]:
    """Return the indices of matching phones, by the cheapest edit."""
    costs = np.zeros((len(truth) + 1, len(made) + 1))
    costs[:, 0] = OMITTED * np.arange(len(truth) + 1)
    costs[0] = OMITTED * np.arange(len(made) + 1)
    same = np.array([[mismatch(a.symbol, b.symbol) for b in made] for a in truth])
    for i, j in np.ndindex(same.shape):
        omitted = OMITTED + min(costs[i, j + 1], costs[i + 1, j])
        costs[i + 1, j + 1] = min(costs[i, j] + same[i, j], omitted)
    pairs, i, j = [], len(truth), len(made)
    while i and j:
        if costs[i, j] == costs[i - 1, j - 1] + same[i - 1, j - 1]:
            i, j = i - 1, j - 1
            pairs.append((i, j))
        elif costs[i, j] == OMITTED + costs[i - 1, j]:
            i -= 1
        else:
            j -= 1
    return pairs[::-1]


def mismatch(a: str, b: str) -> float:
    """Return how unlike two phones are."""
    if a == b:
        return 0.0
    kinds = {sound_class(a), sound_class(b)}
    if len(kinds) == 1:
        return 0.5
    if "silence" in kinds:
        return 2.5
    return 1.6 if "vowel" in kinds else 1.0


def warping(recording: Speech, text: str, voice: Voice) -> Speech:
    """Align with the American voice."""
    return align(recording, text, voice, "en-us")


def figures(errors: Sequence[float]) -> tuple[str, str, str]:
    """Return the number of errors, their median and their 90 % quantile as text."""
    if not errors:
        return "", "", ""
    size = 1e3 * np.abs(errors)
    return str(len(size)), f"{np.median(size):.1f} ms", f"{np.quantile(size, 0.9):.0f} ms"


def main() -> int:
    """Print the table and return an exit code."""
    console = Console(width=110)
    if not RECORDINGS.is_dir():
        console.print(f"no recordings at {RECORDINGS}: nothing to measure")
        return 0
    table = Table(title="boundaries of phones and words")
    headings = ("by", "recording", "matched", "phones", "90 %", "edges", "words", "90 %", "time")
    for number, heading in enumerate(headings):
        table.add_column(heading, justify="left" if number < 2 else "right")
    medians = {}
    with espeak() as voice:
        for name, aligner in (("warping", warping), ("PocketSphinx", align_with_sphinx)):
            everything: list[float] = []
            words: list[float] = []
            for title, truth in labelled():
                start = time.perf_counter()
                made = aligner(truth, truth.text, voice)
                took = time.perf_counter() - start
                errors = phone_errors(truth.phones, made.phones)
                own = word_errors(truth.words, made.words)
                table.add_row(name, title, *figures(errors), *figures(own), f"{took:.2f} s")
                everything += errors
                words += own
            table.add_row(name, "all", *figures(everything), *figures(words), style="bold")
            medians[name] = 1e3 * float(np.median(np.abs(everything)))
        table.add_section()
        for title, recording in unlabelled():
            truth = align_with_sphinx(recording, recording.text, voice)
            start = time.perf_counter()
            made = warping(recording, recording.text, voice)
            took = time.perf_counter() - start
            own = word_errors(truth.words, made.words)
            errors = phone_errors(truth.phones, made.phones)
            row = (f"{title}, beside PocketSphinx", *figures(errors), *figures(own))
            table.add_row("warping", *row, f"{took:.2f} s")
    console.print(table)
    return int(medians["warping"] > MAX_WARPING_MS or medians["PocketSphinx"] > MAX_SPHINX_MS)


if __name__ == "__main__":
    sys.exit(main())
