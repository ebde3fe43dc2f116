"""TextGrids, the files in which Praat and forced aligners keep the times of words and phones.

The format is that of Praat's manual, "TextGrid file formats": the long and the short text form are
the same strings, numbers and flags; all else in a file is decoration.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.phones import fill_pauses, ipa_of_arpabet, is_arpabet
from cubeling.characters.speech.speech import SILENCE, Phone, Speech, Word
from cubeling.files import FileKind, write_whole

TEXTGRID_FILE = FileKind(
    "TextGrid",
    (".TextGrid", ".textgrid"),
    CharacterError,
    100_000_000,
    "cubeling.characters.speech.textgrid:read_textgrid",
)
"""A TextGrid of Praat, as text."""

WORD_TIERS, PHONE_TIERS = ("words", "word", "ort-mau"), ("phones", "phone", "segments", "mau")
"""Names of tiers, without capitals, as aligners write them."""

PAUSES = ("", "sil", "sp", "spn", "pau", "<eps>", "<sil>", "<p:>", "_", "#")
"""Labels of intervals without speech."""

_TOKEN = re.compile(r'"((?:[^"]|"")*)"|(?<!\S)(<\w+>|[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)(?!\S)')


@dataclass(frozen=True)
class Interval:
    """A labelled piece of time; a point has no length."""

    start: float
    """When it begins [s]."""

    end: float
    """When it ends [s]."""

    label: str
    """What is written in the interval; may be empty."""


@dataclass(frozen=True)
class Tier:
    """A row of a TextGrid."""

    name: str

    intervals: tuple[Interval, ...]
    """Its intervals or points, in order."""

    points: bool = False
    """Whether it has points instead of intervals."""


@dataclass(frozen=True)
class TextGrid:
    """Rows of labelled times."""

    duration: float
    """When it ends [s]."""

    tiers: tuple[Tier, ...]
    """In the order of the file."""


def read_textgrid(path: Path) -> TextGrid:
    """Read a TextGrid in the long or the short text form, in UTF-8, UTF-16 or Latin-1.

    Raises
    ------
    CharacterError
        There is no such file, or it is no TextGrid.
    """
    text = _decode(TEXTGRID_FILE.read(path))
    tokens = [
        strings.replace('""', '"') if other == "" else other
        for strings, other in _TOKEN.findall(text)
    ]
    try:
        return _Tokens(tokens).textgrid()
    except (IndexError, ValueError, OverflowError) as error:
        raise CharacterError(
            f"'{path}' is no TextGrid in text form; save it in Praat as a text file"
        ) from error


def write_textgrid(path: Path, grid: TextGrid, *, short: bool = False) -> None:
    """Write a TextGrid in UTF-8, in the long or the short text form."""
    lines = ['File type = "ooTextFile"', 'Object class = "TextGrid"', ""]
    lines += [value if short else name + value for name, value in _named_values(grid)]
    write_whole(path, "\n".join(lines) + "\n", CharacterError)


def _named_values(grid: TextGrid) -> Iterator[tuple[str, str]]:
    """Yield each value of a file, and what the long form writes before it."""
    yield from _span(0.0, grid.duration)
    yield from (("tiers? ", "<exists>"), ("size = ", str(len(grid.tiers))))
    for number, tier in enumerate(grid.tiers, 1):
        kind, rows = ("TextTier", "points") if tier.points else ("IntervalTier", "intervals")
        yield f"item [{number}]:\n    class = ", _quote(kind)
        yield "    name = ", _quote(tier.name)
        yield from _span(0.0, grid.duration, "    ")
        yield f"    {rows}: size = ", str(len(tier.intervals))
        for index, each in enumerate(tier.intervals, 1):
            head = f"    {rows} [{index}]:\n        "
            if tier.points:
                yield f"{head}number = ", f"{each.start:.9g}"
            else:
                yield from _span(each.start, each.end, "        ", head)
            yield f"        {'mark' if tier.points else 'text'} = ", _quote(each.label)


def _span(start: float, end: float, indent: str = "", head: str = "") -> Iterator[tuple[str, str]]:
    yield f"{head or indent}xmin = ", f"{start:.9g}"
    yield f"{indent}xmax = ", f"{end:.9g}"


def textgrid_of(speech: Speech) -> TextGrid:
    """Return the words and phones of a speech as tiers of these names."""
    words = _fill([Interval(w.start, w.end, w.text) for w in speech.words], speech.duration)
    phones = _fill([Interval(p.start, p.end, p.symbol) for p in speech.phones], speech.duration)
    return TextGrid(speech.duration, (Tier("words", words), Tier("phones", phones)))


def with_textgrid(speech: Speech, grid: TextGrid) -> Speech:
    """Return a speech with the words and phones of a TextGrid, in ARPAbet or IPA.

    Its tiers may have the names that Praat's users and the usual aligners give them.

    Raises
    ------
    CharacterError
        It has neither words nor phones, or is not of this recording.
    """
    words, phones = (_tier(grid, names) for names in (WORD_TIERS, PHONE_TIERS))
    if not words and not phones:
        names = ", ".join(tier.name for tier in grid.tiers) or "none"
        raise CharacterError(f"a TextGrid needs a tier 'words' or 'phones'; it has: {names}")
    if max(each.end for each in (*words, *phones)) > speech.duration + 0.1:
        raise CharacterError(
            f"the TextGrid ends at {grid.duration:.2f} s, the recording at {speech.duration:.2f} s:"
            " they do not belong together"
        )
    said = [each for each in words if each.label.lower() not in PAUSES]
    text = speech.text or " ".join(each.label for each in said)
    symbols = _symbols([each.label for each in phones])
    labelled = [
        Phone(symbol, each.start, each.end) for each, symbol in zip(phones, symbols, strict=True)
    ]
    return replace(
        speech,
        text=text,
        words=_words(said, text),
        phones=fill_pauses(labelled, speech.duration) if phones else (),
    )


def _words(said: list[Interval], text: str) -> tuple[Word, ...]:
    """Return words with their places in the text, as far as they are found in it."""
    words, after = [], 0
    for each in said:
        found = text.lower().find(each.label.lower(), after)
        offset = found if found >= 0 else after
        after = offset + (len(each.label) if found >= 0 else 0)
        words.append(Word(each.label, each.start, each.end, offset))
    return tuple(words)


def _symbols(labels: list[str]) -> list[str]:
    """Return labels of phones in IPA."""
    labels = [SILENCE if label.lower() in PAUSES else label for label in labels]
    if not is_arpabet([label for label in labels if label != SILENCE]):
        return [label.strip("ˈˌ") for label in labels]
    return [ipa_of_arpabet(label) for label in labels]


def _fill(intervals: list[Interval], duration: float) -> tuple[Interval, ...]:
    """Return intervals without gaps or overlaps, from 0 to the end."""
    filled, at = [], 0.0
    for each in intervals:
        start, end = max(each.start, at), min(each.end, duration)
        if start > at + 1e-6:
            filled.append(Interval(at, start, ""))
            at = start
        if end > at:
            filled.append(Interval(at, end, each.label))
            at = end
    if at < duration - 1e-6:
        filled.append(Interval(at, duration, ""))
    return tuple(filled)


def _tier(grid: TextGrid, names: tuple[str, ...]) -> list[Interval]:
    """Return the intervals of the first tier of such a name; "Anna - words" is one, too."""
    for tier in grid.tiers:
        if not tier.points and tier.name.lower().split(" - ")[-1].strip() in names:
            return list(tier.intervals)
    return []


def _quote(text: str) -> str:
    return '"' + text.replace('"', '""') + '"'


def _decode(data: bytes) -> str:
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


class _Tokens:
    """The strings, numbers and flags of a file, taken one by one."""

    def __init__(self, tokens: list[str]) -> None:
        self._tokens, self._at = tokens, 0

    def textgrid(self) -> TextGrid:
        if [self._next(), self._next()] != ["ooTextFile", "TextGrid"]:
            raise ValueError
        start, end = float(self._next()), float(self._next())
        exists, count = self._next(), int(self._next()) if len(self._tokens) > 5 else 0
        if exists != "<exists>" or not 0.0 <= end - start <= 1e6:
            raise ValueError
        return TextGrid(end, tuple(self._tier() for _ in range(count)))

    def _tier(self) -> Tier:
        kind, name = self._next(), self._next()
        self._at += 2  # the times of the tier are those of the file
        points = kind == "TextTier"
        if not points and kind != "IntervalTier":
            raise ValueError
        return Tier(name, tuple(self._interval(points) for _ in range(int(self._next()))), points)

    def _interval(self, point: bool) -> Interval:
        start = float(self._next())
        return Interval(start, start if point else float(self._next()), self._next())

    def _next(self) -> str:
        self._at += 1
        return self._tokens[self._at - 1]
