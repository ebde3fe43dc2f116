"""The menu in which the player chooses camera, character and robot while a session runs."""

from cubeling.app.ui.canvas import Canvas, Card, text_width
from cubeling.app.ui.palette import INK, PAPER, QUIET, Color, between
from cubeling.app.ui.playback.cards import ACCENT, centre, large_card
from cubeling.app.ui.playback.requests import Choose
from cubeling.app.ui.playback.status import MenuChoice

COLUMN_WIDTH, SIDE = 286.0, 28.0
ROWS_TOP, ROW_HEIGHT = 84.0, 38.0
MAX_ROWS = 12
"""Choices that are shown of each part."""

SELECTED: Color = between(PAPER, ACCENT, 0.18)
"""Background of the selected row."""

MENU_KEYS = ("←", "→", "↑", "↓", "Enter", "Space")
"""Keys that the menu takes while it is open."""

HELP = "Arrows select, Enter chooses, Esc closes"
LOOKING = "looking …"


class Menu:
    """The choices in columns, one of them selected.

    The selected row stays the same choice when others are found.
    """

    def __init__(self) -> None:
        self._columns: dict[str, list[MenuChoice]] = {}
        self._selected = ("", "")
        self._looking = True

    def update(self, choices: tuple[MenuChoice, ...], looking: bool) -> None:
        """Show these choices, or that they are still looked for."""
        columns: dict[str, list[MenuChoice]] = {}
        for choice in choices:
            column = columns.setdefault(choice.part, [])
            if len(column) < MAX_ROWS:
                column.append(choice)
        self._columns, self._looking = columns, looking
        if choices and self._place() is None:
            present = [choice for choice in choices if choice.present] or list(choices)
            self._selected = (present[0].part, present[0].value)

    def press(self, key: str) -> Choose | None:
        """Move the selection; return what Enter chooses."""
        if key in ("Enter", "Space"):
            part, value = self._selected
            return Choose(part, value) if part else None
        across, down = {"←": (-1, 0), "→": (1, 0), "↑": (0, -1), "↓": (0, 1)}.get(key, (0, 0))
        place = self._place()
        if place is not None and (across or down):
            parts = list(self._columns)
            part = parts[(place[0] + across) % len(parts)]
            rows = self._columns[part]
            row = (place[1] + down) % len(rows) if down else min(place[1], len(rows) - 1)
            self._selected = (part, rows[row].value)
        return None

    def click(self, x: float, y: float, width: float) -> Choose | None:
        """Return the choice at a place of the picture, in units of the canvas; None if none is."""
        left, top, scale = centre(self._size(), width)
        column, row = (
            int(((x - left) / scale - SIDE) // COLUMN_WIDTH),
            int(((y - top) / scale - ROWS_TOP) // ROW_HEIGHT),
        )
        parts = list(self._columns)
        if not (0 <= column < len(parts) and 0 <= row < len(self._columns[parts[column]])):
            return None
        choice = self._columns[parts[column]][row]
        self._selected = (choice.part, choice.value)
        return Choose(choice.part, choice.value)

    def draw(self, width: float, scale: float) -> Card:
        """Return the menu as a card."""
        return large_card(self._size(), width, scale, self._draw)

    def _draw(self, canvas: Canvas) -> None:
        for place, (part, choices) in enumerate(self._columns.items()):
            left = SIDE + place * COLUMN_WIDTH
            canvas.text(left + 14, 52, part.title(), 24, INK)
            for row, choice in enumerate(choices):
                self._row(canvas, left, ROWS_TOP + (row + 0.5) * ROW_HEIGHT, choice)
        words = f"{LOOKING}   {HELP}" if self._looking else HELP
        canvas.text(canvas.size[0] / 2, canvas.size[1] - 22, words, 16, QUIET, "middle")

    def _row(self, canvas: Canvas, left: float, y: float, choice: MenuChoice) -> None:
        room = COLUMN_WIDTH - 20
        if (choice.part, choice.value) == self._selected:
            canvas.bar(left, y, room, ROW_HEIGHT - 4, SELECTED)
        if choice.present:
            canvas.disc(left + 18, y, 6, ACCENT)
        size = 19 * min(1.0, (room - 46) / text_width(choice.label, 19))
        canvas.text(left + 34, y + 6.5, choice.label, size, INK)

    def _place(self) -> tuple[int, int] | None:
        """Return column and row of the selected choice; None if it is not there."""
        for column, choices in enumerate(self._columns.values()):
            for row, choice in enumerate(choices):
                if (choice.part, choice.value) == self._selected:
                    return column, row
        return None

    def _size(self) -> tuple[float, float]:
        rows = max((len(choices) for choices in self._columns.values()), default=1)
        columns = max(1, len(self._columns))
        return 2 * SIDE + columns * COLUMN_WIDTH - 20, ROWS_TOP + rows * ROW_HEIGHT + 58
