"""Two buttons in the top right corner: the keys, and the menu."""

from functools import lru_cache

from cubeling.app.ui.canvas import Canvas, Card
from cubeling.app.ui.cards.layout import CARD_GAP, CARD_MARGIN
from cubeling.app.ui.palette import INK
from cubeling.app.ui.playback.requests import WindowRequest

BUTTON_WIDTH, HEIGHT = 44.0, 36.0
REQUESTS = (WindowRequest.KEYS, WindowRequest.MENU)
"""What the buttons ask for, from left to right."""

ROOM_BELOW = CARD_MARGIN + HEIGHT + CARD_GAP
"""Where cards in this corner begin, in units of the canvas."""

WIDTH = BUTTON_WIDTH * len(REQUESTS)


@lru_cache(maxsize=2)
def draw_buttons(width: float, scale: float) -> Card:
    """Return the buttons over a picture of a width, in units of the canvas."""
    canvas = Canvas(WIDTH, HEIGHT, scale)
    canvas.text(BUTTON_WIDTH / 2 + 3, 26, "?", 22, INK, "middle")
    for y in (12.0, 18.0, 24.0):
        left = 1.5 * BUTTON_WIDTH - 11
        canvas.line([[left, y], [left + 16, y]], INK, 2.4)
    return canvas.card(width - CARD_MARGIN - WIDTH, CARD_MARGIN, 0.85)


def button_at(x: float, y: float, width: float) -> WindowRequest | None:
    """Return what the button at a place of the picture asks for; None if there is none."""
    place = (x - (width - CARD_MARGIN - WIDTH)) // BUTTON_WIDTH
    on_row = CARD_MARGIN <= y <= CARD_MARGIN + HEIGHT
    return REQUESTS[int(place)] if on_row and 0 <= place < len(REQUESTS) else None
