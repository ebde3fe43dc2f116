"""Subtitles: the part of a line that is being said."""

from collections.abc import Sequence
from functools import lru_cache

from cubeling.app.pipeline.step import Rect
from cubeling.app.ui.canvas import PICTURE_HEIGHT, Canvas, can_be_written, text_width, wrap_text
from cubeling.app.ui.cards.layout import CARD_GAP, CARD_MARGIN, are_apart
from cubeling.app.ui.palette import INK
from cubeling.characters import SpeechIntent
from cubeling.characters.speech import Utterance

SIZE, LINE_HEIGHT = 24.0, 32.0
"""Height of the letters, and distance between the lines."""

MIN_SIZE = 8.0
"""Height of the smallest letters, for words that need very many lines."""

MAX_HEIGHT = 184.0
"""Height that hint and cards leave free where they lie above each other, in a narrow picture."""

MAX_LETTERS = 76
"""Letters that are shown at one time: two or three lines."""

MIN_WIDTH = 240.0
"""Least width between the cards in the corners: with less, a subtitle lies above them."""


def subtitle(speech: SpeechIntent | None, now: float) -> str:
    """Return the part of a line that is being said at a time [s]; "" for nothing.

    Also nothing for words in a script without glyphs.

    A long line is shown in parts, each from its first word on.
    """
    if speech is None or not can_be_written(speech.utterance.text):
        return ""
    shown = ""
    for start, words in parts(speech.utterance):
        if shown and start > now - speech.start:
            break
        shown = words
    return shown


@lru_cache(maxsize=8)
def parts(utterance: Utterance) -> tuple[tuple[float, str], ...]:
    """Return the parts of a line with the times at which they begin [s]; at least one.

    A part ends where a sentence does, if it is long, or else where no further word fits.
    """
    text = utterance.text
    starts = [0]
    for word in utterance.words:
        length = word.offset - starts[-1]
        sentence_ends = text[: word.offset].rstrip()[-1:] in (".", "!", "?", "…")
        end = word.offset + len(word.text)
        if end - starts[-1] > MAX_LETTERS or (sentence_ends and length > MAX_LETTERS / 2):
            starts.append(word.offset)
    begins = {word.offset: word.start for word in utterance.words}
    ends = [*starts[1:], len(text)]
    return tuple(
        (begins.get(start, 0.0), " ".join(text[start:end].split()))
        for start, end in zip(starts, ends, strict=True)
    )


def subtitle_room(picture_width: float, card_width: float) -> float:
    """Return the width of the widest subtitle, with the widest card in the corners beside it.

    >>> subtitle_room(1280.0, 292.0), subtitle_room(405.0, 292.0)
    (624.0, 357.0)
    """
    between = picture_width - 2 * (CARD_MARGIN + card_width + CARD_GAP)
    return between if between >= MIN_WIDTH else picture_width - 2 * CARD_MARGIN


@lru_cache(maxsize=8)
def draw_subtitle(words: str, room: float, scale: float) -> Canvas:
    """Return the card of a subtitle that is at most as wide as its room, if its words are not."""
    size = SIZE
    lines = wrap_text(words, room - 40, size)
    while size > MIN_SIZE and (
        LINE_HEIGHT * len(lines) * size / SIZE + 18 > MAX_HEIGHT
        or max(text_width(line, size) for line in lines) > room - 40
    ):
        size -= 2
        lines = wrap_text(words, room - 40, size)
    line_height = LINE_HEIGHT * size / SIZE
    card_width = max(text_width(line, size) for line in lines) + 40
    canvas = Canvas(card_width, line_height * len(lines) + 18, scale)
    for number, line in enumerate(lines):
        canvas.text(card_width / 2, (number + 1) * line_height, line, size, INK, "middle")
    return canvas


def subtitle_place(
    size: tuple[float, float], picture_width: float, cards: Sequence[Rect] = ()
) -> tuple[float, float]:
    """Return the top left corner of a subtitle: at the bottom, above the cards in its way.

    >>> subtitle_place((300.0, 50.0), 405.0)
    (52.5, 646.0)
    >>> subtitle_place((300.0, 50.0), 405.0, [(24.0, 588.0, 316.0, 696.0)])
    (52.5, 526.0)
    """
    width, height = size
    x, y = (picture_width - width) / 2, PICTURE_HEIGHT - height - CARD_MARGIN
    for card in sorted(cards, key=lambda card: card[3], reverse=True):
        if not are_apart((x, y, x + width, y + height), [card]):
            y = card[1] - CARD_GAP - height
    return x, y
