"""Accents that people labelled, and how well others agree with them."""

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.prosody.strength import matthews
from cubeling.characters.speech.speech import Accent, Word
from cubeling.characters.speech.textgrid import (
    PAUSES,
    PHONE_TIERS,
    TEXTGRID_FILE,
    WORD_TIERS,
    Interval,
    read_textgrid,
)
from cubeling.files import FileKind

LABELS_FILE = FileKind(
    "accent labels",
    (".csv",),
    CharacterError,
    10_000_000,
    "cubeling.characters.speech.prosody.accent_labels:read_accent_labels",
)
"""A table of times; labels may also be a tier of a TextGrid."""

MATCH_S = 0.15
"""A label and an accent are of one syllable if they are no farther apart [s]."""

TIERS = ("accents", "accent", "pitch accents", "tones", "tone", "prominence")
"""Names of tiers of accents, without capitals."""

TIME_COLUMNS = ("time", "time_s", "start", "start_s", "t")

STAR = "*"
"""What marks a pitch accent among tones (ToBI: "L+H*"); boundary tones have none."""


def read_accent_labels(path: Path) -> tuple[Interval, ...]:
    """Read when people heard accents: from a .csv, or from a tier of a TextGrid.

    A table has a column "time" [s], or its first column is that; a column "end" may follow.

    Raises
    ------
    CharacterError
        The file cannot be read, or has no accents.
    """
    is_grid = path.suffix in TEXTGRID_FILE.suffixes
    labels = _of_textgrid(path) if is_grid else _of_table(path)
    if any(STAR in each.label for each in labels):
        labels = [each for each in labels if STAR in each.label]
    if not labels:
        raise CharacterError(f"'{path}' has no accents")
    return tuple(sorted(labels, key=lambda each: each.start))


def _of_textgrid(path: Path) -> list[Interval]:
    others = {*WORD_TIERS, *PHONE_TIERS}
    tiers = [tier for tier in read_textgrid(path).tiers if tier.name.lower() not in others]
    named = [tier for tier in tiers if tier.name.lower() in TIERS] or tiers[:1]
    if not named:
        raise CharacterError(f"'{path}' has no tier of accents: name it 'accents'")
    return [each for each in named[0].intervals if each.label.lower() not in PAUSES]


def _of_table(path: Path) -> list[Interval]:
    try:
        table = csv.reader(io.StringIO(LABELS_FILE.read_text(path), newline=""))
        rows = [row for row in table if row]
    except csv.Error as error:
        raise CharacterError(f"{path}: not a CSV file: {error}") from None
    head = [cell.strip().lower() for cell in rows[0]] if rows else []
    column = next((head.index(name) for name in TIME_COLUMNS if name in head), None)
    end = next((head.index(name) for name in ("end", "end_s") if name in head), None)
    labels = []
    for number, row in enumerate(rows[column is not None :], 1 + (column is not None)):
        try:
            times = [float(row[at]) for at in (column or 0, end) if at is not None]
        except (ValueError, IndexError):
            raise CharacterError(
                f"{path}:{number}: no time in seconds in '{row[0][:40]}'"
            ) from None
        if not all(math.isfinite(time) and time >= 0.0 for time in times):
            raise CharacterError(f"{path}:{number}: no time in seconds in '{row[0][:40]}'")
        text = " ".join(row[1:]) if column is None else ""
        labels.append(Interval(times[0], max(times), text))
    return labels


@dataclass(frozen=True)
class LabelAgreement:
    """How accents agree with labels."""

    precision: float
    """Share of accents that a label is at."""

    recall: float
    """Share of labels that an accent is at."""

    words: float | None
    """Matthews' correlation of the words with an accent and those with a label; None without
    words."""

    @property
    def f1(self) -> float:
        """Harmonic mean of precision and recall."""
        both = self.precision + self.recall
        return 2.0 * self.precision * self.recall / both if both else 0.0

    @classmethod
    def of(
        cls, labels: Sequence[Interval], accents: Sequence[Accent], words: Sequence[Word] = ()
    ) -> "LabelAgreement":
        """Compare accents with labels, both in the order of time; each counts once."""
        hit = after = 0
        for label in labels:
            for index in range(after, len(accents)):
                time = accents[index].time
                if time > label.end + MATCH_S:
                    break
                if time >= label.start - MATCH_S:
                    hit, after = hit + 1, index + 1
                    break
        precision, recall = hit / max(len(accents), 1), hit / max(len(labels), 1)
        if not words:
            return cls(precision, recall, None)
        middles = [(each.start + each.end) / 2 for each in labels]
        classes = [_words_with(words, times) for times in (middles, [a.time for a in accents])]
        return cls(precision, recall, matthews(classes[0], classes[1]))


def _words_with(words: Sequence[Word], times: Sequence[float]) -> NDArray[np.bool_]:
    """Return which words have one of these times in them, (words,); else the nearest word has."""
    starts, ends = (np.array([getattr(w, name) for w in words]) for name in ("start", "end"))
    found = np.zeros(len(words), bool)
    for time in times:
        distance = np.maximum(np.maximum(starts - time, time - ends), 0.0)
        nearest = int(distance.argmin())
        found[nearest] |= distance[nearest] <= MATCH_S
    return found
