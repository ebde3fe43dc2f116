"""The field in which a player types what is said to a character."""

from functools import lru_cache

from cubeling.app.ui.canvas import Canvas, Card, text_width
from cubeling.app.ui.cards.layout import CARD_GAP, CARD_MARGIN, HINT_HEIGHT, HINT_ROOM, HINT_TOP
from cubeling.app.ui.palette import INK, QUIET

MAX_TYPED = 200
"""Longest line [characters]."""

FIELD_HEIGHT = 48.0
TEXT_SIZE = 22.0

EMPTY_WORDS = "Type, and Enter says it; F2 to speak; Esc lets the keys be keys"
CLOSED_WORDS = "Enter: type something  ·  F2: speak"


class TypingField:
    """A line of text. While it is open, letters go into it; other keys are keys.

    Enter says what is in it, or opens it; Esc closes it.
    """

    def __init__(self) -> None:
        self.open = True
        """Whether letters go into it."""
        self.text = ""
        """What was typed."""

    def type(self, character: str) -> bool:
        """Take a character that is typed; return whether it is the first one."""
        if not character.isprintable() or len(self.text) >= MAX_TYPED:
            return False
        if character == " " and not self.text:
            return False
        self.text += character
        return len(self.text) == 1

    def press(self, key: str) -> tuple[bool, str]:
        """Handle a key; return whether it was for the field, and the line that it ends, if any."""
        if key == "Enter":
            said, self.text = " ".join(self.text.split()), ""
            self.open = True
            return True, said
        if not self.open:
            return False, ""
        if key == "Backspace":
            self.text = self.text[:-1]
        elif key == "Esc":
            self.open, self.text = False, ""
        elif len(key) > 1 and key != "Space":
            return False, ""
        return True, ""

    def draw(self, width: float, scale: float) -> Card:
        """Return its card below the hint, in a picture of a width."""
        room = min(width - 2 * CARD_MARGIN, HINT_ROOM)
        canvas = _draw(self.text, self.open, room, scale)
        return canvas.card((width - room) / 2, HINT_TOP + HINT_HEIGHT + CARD_GAP)


@lru_cache(maxsize=4)
def _draw(text: str, is_open: bool, room: float, scale: float) -> Canvas:
    canvas = Canvas(room, FIELD_HEIGHT, scale)
    if text:
        shown = text
        while text_width(shown, TEXT_SIZE) > room - 60:  # its end is what is being typed
            shown = shown[1:]
        canvas.text(24, 32, shown, TEXT_SIZE, INK)
        end = 33 + text_width(shown, TEXT_SIZE)
        canvas.line([[end, 13], [end, 35]], INK, 2)
    else:
        words = EMPTY_WORDS if is_open else CLOSED_WORDS
        size = min(TEXT_SIZE, TEXT_SIZE * (room - 48) / text_width(words, TEXT_SIZE))
        canvas.text(24, 32, words, size, QUIET)
    return canvas
