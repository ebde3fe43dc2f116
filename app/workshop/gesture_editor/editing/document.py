"""What is edited: a gesture, and what of it is selected."""

from dataclasses import dataclass, replace
from typing import Literal

from cubeling.characters.behaviour import BodyKey, Hand, HandKey, SymbolicGesture

Row = Literal["right", "left", "body"]
"""Whose keys: the fields of `SymbolicGesture`."""

ROWS: tuple[Row, ...] = ("right", "left", "body")
"""The rows of the time line."""

Key = HandKey | BodyKey


@dataclass(frozen=True)
class GestureDocument:
    """A gesture that is being edited."""

    gesture: SymbolicGesture
    """The gesture; one without a name cannot be saved."""

    hand: Hand = "right"
    """Which hand the preview uses, if the gesture is one-handed."""

    row: Row = "right"
    """The selected row of keys."""

    index: int = 0
    """The selected key of that row; one behind its last means that none is selected."""

    @property
    def hand_row(self) -> Literal["right", "left"] | None:
        """The selected row if it is that of a hand."""
        return None if self.row == "body" else self.row

    @property
    def keys(self) -> tuple[Key, ...]:
        """The keys of the selected row."""
        return keys_of(self.gesture, self.row)

    @property
    def hand_key(self) -> HandKey | None:
        """The selected key of a hand."""
        key = self._key
        return key if isinstance(key, HandKey) else None

    @property
    def body_key(self) -> BodyKey | None:
        """The selected key of trunk and head."""
        key = self._key
        return key if isinstance(key, BodyKey) else None

    @property
    def _key(self) -> Key | None:
        return self.keys[self.index] if 0 <= self.index < len(self.keys) else None

    def select(self, row: Row, index: int) -> "GestureDocument":
        """Return the document with another key selected; an index out of range is clamped."""
        last = max(len(keys_of(self.gesture, row)) - 1, 0)
        return replace(self, row=row, index=min(max(index, 0), last))


EMPTY = GestureDocument(SymbolicGesture(""))
"""What a new gesture is."""


def keys_of(gesture: SymbolicGesture, row: Row) -> tuple[Key, ...]:
    """Return the keys of a row."""
    keys: dict[Row, tuple[Key, ...]] = {
        "right": gesture.right,
        "left": gesture.left,
        "body": gesture.body,
    }
    return keys[row]


def moves(gesture: SymbolicGesture) -> bool:
    """Return whether there is anything to perform."""
    return bool(gesture.right or gesture.left or gesture.body)
