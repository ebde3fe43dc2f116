"""Subtitles: the part of a line that is being said."""

from functools import lru_cache

from app.ui.canvas import PICTURE_HEIGHT, Canvas, Card, can_be_written, text_width
from app.ui.palette import INK
from characters.control.command import SpeechIntent
from characters.speech.speech import Utterance

SIZE, LINE_HEIGHT = 24.0, 32.0
"""Height of the letters, and distance between the lines."""

MAX_LETTERS = 76
"""Letters that are shown at one time: two or three lines."""

SIDE_CARDS_WIDTH = 336.0
"""Width that is left free on both sides for the cards in the corners."""

MIN_WIDTH = 300.0

BOTTOM_MARGIN = 24.0


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


@lru_cache(maxsize=8)
def draw_subtitle(words: str, width: float, scale: float, beside: float = SIDE_CARDS_WIDTH) -> Card:
    """Return the card of a subtitle at the bottom of a picture of this width.

    So much room is left free on both sides, `beside`.
    """
    room = max(width - 2 * beside, MIN_WIDTH)
    lines = wrapped(words, room - 40)
    card_width = max(text_width(line, SIZE) for line in lines) + 40
    height = LINE_HEIGHT * len(lines) + 18
    canvas = Canvas(card_width, height, scale)
    for number, line in enumerate(lines):
        canvas.text(card_width / 2, 32 + number * LINE_HEIGHT, line, SIZE, INK, "middle")
    return canvas.card((width - card_width) / 2, PICTURE_HEIGHT - height - BOTTOM_MARGIN)


def wrapped(words: str, width: float) -> list[str]:
    """Return words in lines of at most this width; a longer word has a line of its own."""
    lines = [""]
    for word in words.split():
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and text_width(longer, SIZE) > width:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines
